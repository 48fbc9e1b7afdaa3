"""Frequencies: `80 Hz` counts cycles, `500 rad/s` radians, and either becomes rad/s."""

from __future__ import annotations

import math
import re
from typing import Final

from pydantic import ValidationInfo

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields.checked import Checked, refuse
from firmtouch.modelfile.fields.quantity import QUANTITY_SCHEMA, expect_dimension, read_quantity
from firmtouch.modelfile.units import SECOND, Dimension

_HERTZ: Final = re.compile(r"hz|hertz", re.IGNORECASE)
_RADIANS: Final = re.compile(r"\brad(ians?)?\b")


def frequency_between(least: float, most: float) -> Checked:
    """Make the type of a frequency between two bounds in rad/s; units.py knows only 1/s, so the 2 pi comes in here."""

    def read(raw: object, info: ValidationInfo) -> float:  # noqa: ARG001  # the signature is pydantic's
        quantity = read_quantity(raw, example="80 Hz")
        cycles = bool(_HERTZ.search(quantity.text))
        if cycles or not quantity.bare:
            expect_dimension(quantity, Dimension() / SECOND)
        if not cycles and not _RADIANS.search(quantity.text):
            refuse(Problem("this may count cycles or radians; write `80 Hz` (cycles) or `500 rad/s`"))
        value = quantity.value * (2 * math.pi if cycles else 1)
        if not least <= value <= most:
            refuse(Problem(f"{value:.4g} rad/s is out of range; it must lie between {least:g} and {most:g} rad/s"))
        return value

    return Checked(read, QUANTITY_SCHEMA)
