"""[T10] as it is printed: a box of all joint coordinates is covered, however the surface turns in it.

Nothing is said of graphs here, and nothing of connected parts: cells of q are dropped where Phi does not vanish, and in
all others `ambient` has no equilibrium but q*. Cells grow in number like the n-th power of the box's size: n <= 3.
"""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import flint
import numpy as np
from flint import arb

from firmtouch.certificate.attraction.ambient import Ambient
from firmtouch.certificate.attraction.attraction import BITS, NotProvenError
from firmtouch.certificate.attraction.chart import Cell, box
from firmtouch.certificate.attraction.rounding import lower
from firmtouch.certificate.matrices import exact, is_positive_definite
from firmtouch.regulation import ClosedLoop

MOST_CELLS: Final = 4000
FACE_SHARE: Final = 0.25
CENTRAL: Final = tuple(0.8**k for k in range(30))
GAP: Final = 0.05
SMALLEST: Final = 1 / 500
"""A cell this small, in sizes of the box, is not cut: an equilibrium is near, or the surface's end."""
FIRST: Final = 0.02
GROWTH: Final = 1.5
BISECTIONS: Final = 2
LARGEST: Final = 2.0
MOST_JOINTS: Final = 3
SMALL: Final = 1 / 12
"""Cells on the boundary are cut down to this size, in sizes of the box, before a bound is taken as good enough."""


@dataclass(frozen=True, slots=True)
class WholeBox:
    """Of the surface in |q_i - q_di| <= half_width units_i only q* is an equilibrium, and p >= level (J) on its edge.

    So every start there with J q' = 0 and V < level converges. `cells` were looked at.
    """

    half_width: float
    level: float
    units: tuple[float, ...]
    cells: int


def find_whole_box(loop: ClosedLoop, *, units: Sequence[float] | None = None, most_cells: int = MOST_CELLS) -> WholeBox:
    """Search for a large box: grown by steps, then the last step bisected. For n <= 3.

    Raises
    ------
    NotProvenError
        If n > 3, or none is proven.
    """
    n = loop.operating_point.n
    if n > MOST_JOINTS:
        raise NotProvenError(f"a box of {n} joint coordinates has too many cells; the surface alone has fewer")
    best = prove_whole_box(loop, FIRST, units=units, most_cells=most_cells)
    tried = best.half_width * GROWTH
    while tried <= LARGEST:
        try:
            best = prove_whole_box(loop, tried, units=units, most_cells=most_cells)
        except NotProvenError:
            break
        tried *= GROWTH
    for _ in range(BISECTIONS):
        middle_width = (best.half_width + tried) / 2
        try:
            best = prove_whole_box(loop, middle_width, units=units, most_cells=most_cells)
        except NotProvenError:
            tried = middle_width
    return best


def prove_whole_box(
    loop: ClosedLoop, half_width: float, *, units: Sequence[float] | None = None, most_cells: int = MOST_CELLS
) -> WholeBox:
    """Prove [T10] on a box of joint coordinates.

    Raises
    ------
    NotProvenError
        If that does not succeed.
    """
    if is_positive_definite(exact(loop.gains.C)) is not True:
        raise NotProvenError("C > 0 does not hold, or only just")
    u = (1.0,) * loop.operating_point.n if units is None else tuple(float(each) for each in units)
    with flint.ctx.workprec(BITS):
        ambient = Ambient(loop)
        outer = box(tuple(half_width * each for each in u))
        central = next((c for c in (_scaled(outer, s) for s in CENTRAL) if ambient.has_one(c)), None)
        if central is None:
            raise NotProvenError("A(q) may be singular in every cell around q_d")
        level, faces = _boundary(ambient, outer, int(FACE_SHARE * most_cells))
        proven = lower(arb(level) - ambient.bottom.upper()) if np.isfinite(level) else 0.0
        if not proven > 0:
            raise NotProvenError(f"p > 0 on the boundary of the box of +-{half_width:g}, with {faces} cells")
        cells = _inside(
            ambient,
            [each for each in outer.shell(central) if each.is_solid],
            most_cells - faces,
            min(outer.high) * SMALLEST,
        )
        return WholeBox(half_width, level, u, faces + cells)


def _scaled(cell: Cell, size: float) -> Cell:
    return box(tuple(size * each for each in cell.high))


def _inside(ambient: Ambient, waiting: list[Cell], most_cells: int, smallest: float) -> int:
    """Prove cells to have no equilibrium; gives how many that took."""
    seen = 0
    while waiting:
        cell = waiting.pop()
        if seen >= most_cells or max(cell.widths) < smallest:
            raise NotProvenError(f"{len(waiting) + 1} cells of the box are left after {seen}: another equilibrium?")
        seen += 1
        if not ambient.has_none(cell):
            waiting.extend(cell.halves())
    return seen


def _boundary(ambient: Ambient, outer: Cell, most_cells: int) -> tuple[float, int]:
    """Bound p on the surface in the boundary from below, the lowest cells first."""
    count = itertools.count()
    heap = [(-np.inf, next(count), each) for each in outer.faces()]
    seen, done = 0, np.inf
    while heap and seen < most_cells and heap[0][0] < done:
        bound, _, cell = heapq.heappop(heap)
        seen += 1
        found = ambient.bounds(cell)
        if found is None:
            continue
        low, high = max(bound, found[0]), found[1]
        small = all(w <= SMALL * b for w, b in zip(cell.widths, outer.high, strict=True))
        if small and 0 < high - low < GAP * low:  # the surface itself may be absent from a cell, so cut it first
            done = min(done, low)
            continue
        for half in cell.halves():
            heapq.heappush(heap, (low, next(count), half))
    return min(done, heap[0][0] if heap else np.inf), seen
