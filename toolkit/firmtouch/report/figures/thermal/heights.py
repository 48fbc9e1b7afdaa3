"""How high each entry of a stack is drawn, so that films of 100 nm and foams of 1 mm are seen in one picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

CUT: Final = 2.4
"""Least height of a layer that is cut short, by that of a row; it is no less high than the others."""


@dataclass(frozen=True, slots=True)
class Heights:
    """Heights in the unit of `row`, from the touched face inward; which layers are cut, and which are too high.

    All others are to scale, by `scale` (1/m).
    """

    heights: tuple[float, ...]
    cut: frozenset[int]
    raised: frozenset[int]
    scale: float

    @property
    def to_scale(self) -> bool:
        """Tell whether all layers are to one scale, without any film or joint."""
        return not self.cut and not self.raised


def true_heights(thicknesses: Sequence[float | None], room: float) -> tuple[float, ...]:
    """Share the room by thickness; what has none is a line."""
    whole = sum(each or 0.0 for each in thicknesses)
    return tuple((each or 0.0) / whole * room if whole else room / len(thicknesses) for each in thicknesses)


def readable_heights(thicknesses: Sequence[float | None], room: float, row: float) -> Heights:
    """Give each entry a row at least, and cut as few of the thickest as lets the others be to scale.

    What has no thickness has one row; where no cutting helps, thin layers are drawn too high.
    """
    layers = [i for i, each in enumerate(thicknesses) if each]
    by_size = sorted(layers, key=lambda i: -(thicknesses[i] or 0.0))
    tried = [_with_cut(thicknesses, frozenset(by_size[:k]), room, row) for k in range(max(len(layers), 1))]
    fitting = [each for each in tried if sum(each.heights) <= room * (1 + 1e-9)] or tried[:1]
    return min(fitting, key=lambda each: (len(each.raised & frozenset(layers)), len(each.cut)))


def _with_cut(thicknesses: Sequence[float | None], cut: frozenset[int], room: float, row: float) -> Heights:
    """Draw the layers that are not cut to one scale, or a row high where that is more."""

    def heights(scale: float) -> list[float]:
        found = [0.0 if i in cut else max(row, (each or 0.0) * scale) for i, each in enumerate(thicknesses)]
        tallest = max(CUT * row, *found)
        return [tallest if i in cut else each for i, each in enumerate(found)]

    low, high = 0.0, room / min((each for each in thicknesses if each), default=1.0)
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (middle, high) if sum(heights(middle)) <= room else (low, middle)
    found = heights(low)
    raised = frozenset(
        i for i, each in enumerate(thicknesses) if i not in cut and found[i] > (each or 0.0) * low * (1 + 1e-9)
    )
    return Heights(tuple(found), cut, raised, low)
