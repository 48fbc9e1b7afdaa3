"""What inverse kinematics found, and which of it was taken."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from firmtouch.modelfile import ModelSpec
from firmtouch.regulation.inverse_kinematics import Reached
from firmtouch.regulation.inverse_kinematics.solution import FARTHEST
from firmtouch.report.document import Block, Line, Math, Paragraph, Strong, Table
from firmtouch.report.mathematics import symbol
from firmtouch.report.numbers import number

MOST: Final = 8
"""Configurations that are listed."""


def configurations(reached: Reached, spec: ModelSpec) -> Iterator[Block]:
    """Write how q_d was chosen among the configurations that were found."""
    count, best = len(reached.solutions), reached.solutions[0]
    several = f"{count} different configurations" if count > 1 else "one configuration"
    taken = f"The one that is {reached.because} was taken" if count > 1 else "It was taken"
    how = ""
    if count > 1 and reached.because == FARTHEST:
        how = ": the product of its manipulability and of how far inside its range each joint is, is greatest"
    yield Paragraph(
        (
            f"Inverse kinematics found {several} within all limits, from {reached.starts} starts of which "
            f"{reached.met} ended at one. {taken}{how}. Its manipulability is {number(best.manipulability, 3)}: the "
            "product of the singular values of the tool’s Jacobian (Yoshikawa), in metres for each direction in which "
            "the tool moves and in radians for each in which it turns. The least of these values is "
            f"{number(best.least_singular_value, 3)}, and would be 0 at a singularity. {_margin(best.margin)}",
        )
    )
    yield Paragraph((_neighbours(reached),))
    if count > 1:
        yield _table(reached, spec)


def _margin(margin: float) -> str:
    if not np.isfinite(margin):
        return "No joint is limited."
    return f"The nearest joint limit is {number(100 * margin, 3)} % of that joint’s range away, of 50 % at most."


def _neighbours(reached: Reached) -> str:
    if reached.isolated:
        return "It is isolated: near it no other configuration does the same."
    free = len(reached.q) - reached.rank
    ways = "one direction" if free == 1 else f"{free} directions"
    return (
        f"What was asked leaves {ways} free there, so that such configurations are not single ones but continua, of "
        "which the best places stand for all."
    )


def _table(reached: Reached, spec: ModelSpec) -> Table:
    """Write a column for each configuration, the one that was taken in bold."""
    shown = reached.solutions[:MOST]
    columns = [_column(each.q, spec) for each in shown]
    columns = [
        (
            *column,
            number(each.manipulability, 3),
            number(each.least_singular_value, 3),
            f"{number(100 * each.margin, 3)} %" if np.isfinite(each.margin) else "no limits",
        )
        for column, each in zip(columns, shown, strict=True)
    ]
    names: list[Line] = [(Math(symbol(name)),) for name in spec.coordinates]
    names += [("manipulability",), ("least singular value",), ("distance to a limit",)]
    rows = tuple(
        (name, (Strong(texts[0]),), *((text,) for text in texts[1:]))
        for name, texts in zip(names, zip(*columns, strict=True), strict=True)
    )
    headings: tuple[Line, ...] = (("",), ("taken",), *((str(i),) for i in range(2, len(shown) + 1)))
    rest = len(reached.solutions) - len(shown)
    caption = f"The first {len(shown)} of {len(reached.solutions)} configurations." if rest else "All configurations."
    distance = " Distances to the nearest joint limit are parts of that joint’s range."
    return Table(headings, rows, frozenset(range(1, len(headings))), (caption + distance,))


def _column(q: np.ndarray, spec: ModelSpec) -> tuple[str, ...]:
    """Write joints that turn in degrees, and joints that slide in metres."""
    units = [each.unit for each in spec.coordinates.values()]
    return tuple(
        f"{number(round(float(np.degrees(value)), 2), 5)}°" if unit == "rad" else f"{number(round(float(value), 4))} m"
        for value, unit in zip(q, units, strict=True)
    )
