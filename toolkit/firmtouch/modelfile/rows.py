"""The rows of Phi that one entry of `constraints` stands for, each with a name, a unit and words.

An entry on frames may be several rows: a tool on a surface and square to it is three. The first reading of a file needs
their names before the entry itself is read, so all is found from raw data here; what is wrong in it gives no row.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

AXES: Final = ("x", "y", "z")


@dataclass(frozen=True, slots=True)
class Row:
    """One row of an entry: the end of its name (nothing for the row that is named as the entry), unit and words.

    A row whose multiplier need not be given (`optional`) counts as zero there.
    """

    suffix: str
    unit: str
    words: str
    optional: bool = True

    def name(self, entry: str) -> str:
        """Give the row's name."""
        return f"{entry}_{self.suffix}" if self.suffix else entry


ON_SURFACE: Final = Row("", "m", "distance from the surface", optional=False)
ROD: Final = Row("", "m", "length between the points", optional=False)
_ABOUT: Final = {axis: Row(f"about_{axis}", "rad", f"turn about its {axis} axis") for axis in AXES}
_ALONG: Final = {axis: Row(axis, "m", f"gap along {axis}") for axis in AXES}
_BESIDE: Final = tuple(Row(f"beside_{i}", "m", f"distance from the curve, direction {i}") for i in (1, 2))


def others(axis: str) -> tuple[str, str]:
    """Give the two axes that make a right-handed frame before this one."""
    i = AXES.index(axis)
    return AXES[(i + 1) % 3], AXES[(i + 2) % 3]


def contact_rows(align: str | None) -> tuple[Row, ...]:
    """Give the rows of a point on a surface, and of an axis (x, y or z) along its normal."""
    return (ON_SURFACE, *(_ABOUT[each] for each in others(align))) if align else (ON_SURFACE,)


HELD: Final = ("point", "axis", "frame")
"""What of a frame is held by a curve or by another frame: its origin; its z axis too; all of it."""


def rail_rows(hold: str) -> tuple[Row, ...]:
    """Give the rows of a frame on a curve."""
    return (*_BESIDE, *_turns(hold))


def join_rows(hold: str) -> tuple[Row, ...]:
    """Give the rows of two frames that are joined."""
    return (*_ALONG.values(), *_turns(hold))


def _turns(hold: str) -> tuple[Row, ...]:
    return tuple(_ABOUT[each] for each in AXES[: {"point": 0, "axis": 2, "frame": 3}[hold]])


def sort_of(raw: object) -> str:
    """Tell which sort of entry this is, by the key that says what must be kept."""
    keys = raw.keys() if isinstance(raw, dict) else ()
    return next((each for each in ("surface", "rail", "distance", "join") if each in keys), "expression")


def rows_written(raw: object) -> tuple[Row, ...]:
    """Find the rows of an entry on frames, as far as it is right; none for an expression."""
    if not isinstance(raw, dict):
        return ()
    without = raw.get("without")
    left_out = without if isinstance(without, list) else []
    return tuple(each for each in _all_rows(raw) if each.suffix not in left_out or not each.optional)


def _all_rows(raw: Mapping[str, Any]) -> tuple[Row, ...]:
    hold = raw.get("hold", {"rail": "point"}.get(sort_of(raw), "frame"))
    hold = hold if hold in HELD else "point"
    match sort_of(raw):
        case "surface":
            align = raw.get("align")
            return contact_rows(align if align in AXES else None)
        case "rail":
            return rail_rows(hold)
        case "distance":
            return (ROD,)
        case "join":
            return join_rows(hold)
        case _:
            return ()
