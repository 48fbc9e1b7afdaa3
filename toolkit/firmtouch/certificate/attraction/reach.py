"""From a level to a distance, and from a distance to a level, over the cells of a basin."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from firmtouch.certificate.attraction.chart import Cell
from firmtouch.certificate.attraction.piece import Piece
from firmtouch.certificate.attraction.proof import Basin, by_energy, farthest, nearest
from firmtouch.certificate.attraction.rounding import lower, upper

GAP: Final = 0.02
"""A bound is made better until it is this close to what it bounds."""

_Measure = Callable[[Piece, Cell], float]


def reach(basin: Basin, level: float, units: Sequence[float], most_cells: int) -> float:
    """Bound from below the least max_i |q_i - q_di| / units_i where p >= level on a basin's graph.

    A path on the surface that starts at q* and stays in the box |q_i - q_di| < reach units_i stays on the graph, and
    where p < level: to get off the graph it would first have to pass a point with p >= the basin's bound >= level.
    """
    landscape = basin.landscape
    return _least(
        basin,
        lambda piece, part: nearest(landscape, piece, part, units),
        lambda piece, part: farthest(landscape, piece, part, units),
        may=lambda piece, part: upper(piece.bounds(part)[1]) >= level,
        does=lambda piece, part: lower(piece.bounds(part)[0]) >= level,
        most_cells=most_cells,
    )


def level_outside(basin: Basin, distance: float, units: Sequence[float], most_cells: int) -> float:
    """Bound p from below on a basin's graph where max_i |q_i - q_di| / units_i >= distance."""
    landscape = basin.landscape
    return _least(
        basin,
        by_energy,
        lambda piece, part: upper(piece.bounds(part)[1]),
        may=lambda piece, part: farthest(landscape, piece, part, units) >= distance,
        does=lambda piece, part: nearest(landscape, piece, part, units) >= distance,
        most_cells=most_cells,
    )


def _least(
    basin: Basin,
    low: _Measure,
    high: _Measure,
    *,
    may: Callable[[Piece, Cell], bool],
    does: Callable[[Piece, Cell], bool],
    most_cells: int,
) -> float:
    """Bound a function from below on all points with a property: the lowest parts of cells are looked at first.

    `may` is true of every part that has such a point, `does` only of parts all of whose points have the property.
    """
    landscape, count = basin.landscape, itertools.count()
    heap = [(low(each, each.place.cell), next(count), each, each.place.cell) for each in basin.pieces]
    heapq.heapify(heap)
    attained, seen = np.inf, 0
    while heap and seen < most_cells:
        if attained < np.inf and heap[0][0] >= attained - GAP * abs(attained):
            break
        bound, _, owner, part = heapq.heappop(heap)
        if not may(owner, part):
            continue
        seen += 1
        found = landscape.piece(part, owner.place.axis(part.centre))
        if found is not None and owner.place.holds(part.centre, found.place.start, found.place.off):
            owner = found
            if not may(owner, part):
                continue
            centre = Cell(part.centre, part.centre)
            if does(owner, centre):
                attained = min(attained, high(owner, centre))
        for half in part.halves():
            heapq.heappush(heap, (max(bound, low(owner, half)), next(count), owner, half))
    return heap[0][0] if heap else np.inf
