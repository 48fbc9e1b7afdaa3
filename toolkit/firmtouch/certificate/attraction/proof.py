"""The proof: how high p may be for every start below to come to rest at q*, and where those starts are.

Cells of a box of x2 are accepted one after the other, from q_d outwards. Let G be the surface's graph over the
accepted ones and p the energy of `landscape` on it. It is proven for a level c that

    (a) over each accepted cell the surface is one graph in a tube, J V1 is nonsingular, and cells that share a face
        have the same graph there: two graphs over a connected set that agree in one point of it agree in all, since
        by the implicit function theorem they agree near each point where they do;
    (b) an accepted cell has no critical point of p, but for the central one, where q* is the only one     [T10] (i)
    (c) p >= c on every face of an accepted cell that is not shared with another one                      [T10] (ii)

At a point of G with p < c all cells that touch there are accepted, by (c), one after the other; so {p < c} on G is open
in the surface. A start in it with J q' = 0 and V = q'^T M q' / 2 + p < c can leave G through p >= c only, and does not,
since V' = -q'^T C q' <= 0; by LaSalle (C > 0) it comes to rest at an equilibrium with p < c, and q* is the only one.

On the central cell p_x(x2) - p_x(x2*) = H (x2 - x2*) with H the mean of p_xx along the segment: one interval matrix
that |I - R H| < 1 proves nonsingular. q* is a zero of p_x by Krawczyk's operator. Elsewhere p_x = F + H xi excludes 0.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Final

import numpy as np

from firmtouch.certificate.attraction.chart import Cell, box
from firmtouch.certificate.attraction.frontier import Frontier, Wall
from firmtouch.certificate.attraction.landscape import Landscape
from firmtouch.certificate.attraction.piece import Piece
from firmtouch.certificate.attraction.rounding import lower, upper
from firmtouch.certificate.attraction.zeros import has_no_zero, has_zero, is_regular
from firmtouch.mechanics.balls import Ball

CENTRAL: Final = tuple(0.8**k for k in range(40))
"""The central cell's size, in sizes of the box: the first that is proven."""
NEAR: Final = 1e-11
"""Half-width in rad or m of where q* is looked for: the rounding of the bias and of q_d moves it that little."""
SMALLEST: Final = 1 / 1000
"""A cell this small, in sizes of the box, is cut no further: there is a critical point, or the surface turns away."""


LEAK: Final = 0.3
"""No cell is accepted where p might be below this part of what is proven: it may lie behind a ridge."""


GROWTH: Final = 2.5
"""Cells that are larger than all their neighbours by more than this are cut untried."""


class Limit(Enum):
    """What kept the level from being higher."""

    ASKED = "as much as was asked for is proven"
    BOX = "the box ends there"
    POINT = "there another equilibrium may be, or the surface turns away from its tangent space"
    CELLS = "the cells that were allowed are used up"


@dataclass(frozen=True, slots=True)
class Rest:
    """The exact regulation point: q* (n balls) and p there."""

    q: list[Ball]
    value: Ball


@dataclass(frozen=True, slots=True)
class Basin:
    """Accepted cells, and what the measure is at least on every face through which they can be left."""

    landscape: Landscape
    rest: Rest
    pieces: tuple[Piece, ...]
    bound: float
    limit: Limit
    cells: int


def by_energy(piece: Piece, part: Cell) -> float:
    """Measure p, in J."""
    return lower(piece.bounds(part)[0])


def nearest(landscape: Landscape, piece: Piece, part: Cell, units: Sequence[float]) -> float:
    """Bound max_i |q_i - q_di| / units_i on a part of a piece's cell from below."""
    q, q_d = landscape.hull(piece.place, part), landscape.chart.q_d.tolist()
    return max(0.0, *(lower((abs(x - y) / u).lower()) for x, y, u in zip(q, q_d, units, strict=True)))


def farthest(landscape: Landscape, piece: Piece, part: Cell, units: Sequence[float]) -> float:
    """Bound it from above."""
    q, q_d = landscape.hull(piece.place, part), landscape.chart.q_d.tolist()
    return max(upper((abs(x - y) / u).upper()) for x, y, u in zip(q, q_d, units, strict=True))


def by_distance(landscape: Landscape, units: Sequence[float]) -> Callable[[Piece, Cell], float]:
    """Measure max_i |q_i - q_di| / units_i."""
    return lambda piece, part: nearest(landscape, piece, part, units)


def explore(
    landscape: Landscape, outer: Cell, *, most_cells: int, at_most: float = np.inf, units: Sequence[float] | None = None
) -> Basin | None:
    """Accept cells of a box in the order of p, or with `units` of the distance; None if not even q* is proven.

    It ends where the measure is `at_most` on all faces through which the accepted cells can be left, or at a limit.
    `outer` is symmetric around q_d. Cells are counted, and nothing else is: the same call gives the same basin.
    """
    start = find_rest(landscape, outer)
    if start is None:
        return None
    rest, central = start
    measure = by_energy if units is None else by_distance(landscape, units)
    frontier, seen, best = Frontier(outer, central, measure), 1, (0.0, 1)
    while True:
        best = max(best, (frontier.lowest, len(frontier.accepted)))
        if frontier.lowest >= at_most:
            limit = Limit.ASKED
            break
        entry, item = frontier.pop()
        found = _limit(item, outer, frontier, full=seen >= most_cells)
        if found is not None:
            limit = found
            break
        if isinstance(item, Wall):
            frontier.refine(item, entry, landscape.piece(item.face, item.owner.place.axis(item.face.centre)))
            seen += 1
        elif frontier.known(item) is None:
            seen += _learn(landscape, frontier, item)
        else:
            _decide(landscape, frontier, item, LEAK * best[0] if units is None else -np.inf)
    bound, count = best
    return Basin(landscape, rest, tuple(frontier.accepted[:count]), min(bound, at_most), limit, seen)


def _learn(landscape: Landscape, frontier: Frontier, cell: Cell) -> int:
    """Enclose p over a cell that is reached for the first time, or split it; gives how many cells were enclosed."""
    beside = frontier.beside(cell)
    if _dwarfs(cell, [each.place.cell for _, each in beside]):
        frontier.split(cell)
        return 0
    piece = landscape.piece(cell, frontier.guess(cell))
    if piece is not None and _joined(landscape, piece, beside):
        frontier.learn(piece)
    else:
        frontier.split(cell)
    return 1


def _decide(landscape: Landscape, frontier: Frontier, cell: Cell, least: float) -> None:
    """Accept a known cell if no equilibrium is in it, or split it; it may have other neighbours than when learned."""
    piece = frontier.known(cell)
    assert piece is not None
    low = by_energy(piece, cell) >= least
    if low and has_no_zero(piece) and _joined(landscape, piece, frontier.beside(cell)):
        frontier.accept(piece)
    else:
        frontier.split(cell)


def _dwarfs(cell: Cell, others: list[Cell]) -> bool:
    """Tell whether a cell is much larger than its accepted neighbours, so that it is not worth trying as a whole."""
    return all(max(a / b for a, b in zip(cell.widths, each.widths, strict=True)) > GROWTH for each in others)


def _limit(item: Cell | Wall, outer: Cell, frontier: Frontier, *, full: bool) -> Limit | None:
    """Tell what ends the exploration at the lowest entry, if anything does."""
    if isinstance(item, Wall):
        return Limit.BOX if item.final else Limit.CELLS if full else None
    if frontier.known(item) is None and full:
        return Limit.CELLS
    small = all(w <= SMALLEST * b for w, b in zip(item.widths, outer.high, strict=True))
    return Limit.POINT if small and frontier.known(item) is None else None


def find_rest(landscape: Landscape, outer: Cell) -> tuple[Rest, Piece] | None:
    """Prove that there is a q* near q_d, and that it is alone in a central cell, as large as possible."""
    near = landscape.piece(box((NEAR,) * len(outer.high)))
    if near is None or not has_zero(near):
        return None
    low, high = near.bounds()
    for size in CENTRAL:
        central = landscape.piece(box(tuple(max(size * each, 2 * NEAR) for each in outer.high)))
        if central is None or not central.place.holds(near.place.cell.centre, near.place.start, near.place.off):
            continue
        # the mean of p_xx from x2* to x2 starts in x2*, not in the centre
        if is_regular(central.mean_hessian(NEAR / min(central.place.cell.widths))):
            return Rest(landscape.hull(near.place, near.place.cell), low.union(high)), central
    return None


def _joined(landscape: Landscape, piece: Piece, others: list[tuple[Cell, Piece]]) -> bool:
    """Prove that a piece's graph is that of its neighbours: in one point of each shared face."""
    for face, other in others:
        x2 = face.centre
        root = landscape.root(x2, piece.place.axis(x2))
        if root is None or not (piece.place.holds(x2, *root) and other.place.holds(x2, *root)):
            return False
    return True
