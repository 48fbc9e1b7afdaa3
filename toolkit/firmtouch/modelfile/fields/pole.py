"""Poles: `-4`, or `-4+3j`."""

from __future__ import annotations

import math
import re
from typing import Final

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields.checked import refuse
from firmtouch.modelfile.words import shown

FASTEST: Final = 1e6
_COMPLEX: Final = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")


def read_pole(raw: object) -> complex:
    """Read a pole: `-4`, or `-4 + 3j`."""
    if isinstance(raw, int | float) and not isinstance(raw, bool):
        value = complex(raw)
    else:
        compact = raw.replace(" ", "").replace("i", "j") if isinstance(raw, str) and len(raw) < 80 else ""
        try:
            value = complex(compact) if _COMPLEX.match(compact) else complex("?")
        except ValueError:
            refuse(Problem(f"{shown(str(raw))} is no pole; write `-4` or `-4+3j`, in 1/s"))
    if not math.hypot(value.real, value.imag) <= FASTEST:
        refuse(Problem(f"{shown(str(raw))} is no pole of a usable size (at most {FASTEST:g} 1/s)"))
    if value.real >= 0:
        refuse(Problem(f"the pole {shown(str(raw))} is not stable; its real part must be negative"))
    return value
