"""Which cells are accepted, which of the others touch them, and how low a measure is where they do."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from firmtouch.certificate.attraction.chart import Cell
from firmtouch.certificate.attraction.piece import Piece
from firmtouch.certificate.matrices import BallMatrix

BETTER: Final = 1.02
"""The bound on a face of the box is refined for as long as that makes it this much higher."""


@dataclass(frozen=True, slots=True)
class Wall:
    """A face of the box, or a part of it, that an accepted piece reaches; `final` says that refining it is in vain."""

    face: Cell
    owner: Piece
    final: bool


class Frontier:
    """Accepted pieces that start with the central one, and around them what remains of the box, as cells.

    An entry bounds `measure` from below on what a cell shares with accepted ones: p itself, which a motion must have to
    get there, or the distance from q_d.
    """

    def __init__(self, outer: Cell, central: Piece, measure: Callable[[Piece, Cell], float]) -> None:
        self.measure = measure
        self.accepted: list[Piece] = []
        self._outer = outer
        rest = [each for each in outer.shell(central.place.cell) if each.is_solid]
        self._entries: dict[Cell, float] = dict.fromkeys(rest, np.inf)
        self._known: dict[Cell, Piece] = {}
        self._count = itertools.count()
        self._heap: list[tuple[float, int, Cell | Wall]] = []
        self.accept(central)

    @property
    def lowest(self) -> float:
        """The lowest entry: the measure is at least this on every face through which the accepted cells can be left."""
        while self._heap:
            entry, _, item = self._heap[0]
            if isinstance(item, Wall) or self._entries.get(item) == entry:
                return entry
            heapq.heappop(self._heap)  # a cell that is gone, or has another entry by now
        return np.inf

    def pop(self) -> tuple[float, Cell | Wall]:
        """Take what has the lowest entry; a cell is to be learned of, accepted or split then."""
        entry, _, item = heapq.heappop(self._heap)
        return entry, item

    def beside(self, cell: Cell) -> list[tuple[Cell, Piece]]:
        """Give the accepted pieces that share a face with a cell, each with what they share."""
        found = ((cell.shared(each.place.cell), each) for each in self.accepted)
        return [(face, each) for face, each in found if face is not None]

    def known(self, cell: Cell) -> Piece | None:
        """Give the piece over a cell that is not accepted, if it is known."""
        return self._known.get(cell)

    def learn(self, piece: Piece) -> None:
        """Take a piece that agrees with its accepted neighbours: it may know its faces better than they do."""
        cell = piece.place.cell
        self._known[cell] = piece
        entry = min(self._bound(cell, face, other) for face, other in self.beside(cell))
        self._entries[cell] = max(self._entries[cell], entry)
        self._push(self._entries[cell], cell)

    def guess(self, cell: Cell) -> BallMatrix:
        """Extrapolate the nearest accepted piece to a cell's centre."""

        def distance(piece: Piece) -> float:
            return sum((a - b) ** 2 for a, b in zip(piece.place.cell.centre, cell.centre, strict=True))

        nearest = min((piece for _, piece in self.beside(cell)), key=distance)
        return nearest.place.axis(cell.centre)

    def accept(self, piece: Piece) -> None:
        """Move a cell behind the frontier."""
        self.accepted.append(piece)
        cell = piece.place.cell
        self._entries.pop(cell, None)
        self._known.pop(cell, None)
        for other, entry in self._entries.items():
            face = cell.shared(other)
            if face is not None:
                self._enter(other, min(entry, self._bound(other, face, piece)))
        for face in cell.faces():
            if any(face.within(each) for each in self._outer.faces()):
                self._push(self.measure(piece, face), Wall(face, piece, final=False))

    def split(self, cell: Cell) -> None:
        """Replace a cell by its halves; neither is entered lower than the whole."""
        before = self._entries.pop(cell)
        self._known.pop(cell, None)
        for half in cell.halves():
            entries = [self._bound(half, face, piece) for face, piece in self.beside(half)]
            self._entries[half] = np.inf
            if entries:
                self._enter(half, max(before, min(entries)))

    def _bound(self, cell: Cell, face: Cell, accepted: Piece) -> float:
        """Bound p on a shared face by what either side knows of it."""
        low = self.measure(accepted, face)
        known = self._known.get(cell)
        return low if known is None else max(low, self.measure(known, face))

    def refine(self, wall: Wall, entry: float, piece: Piece | None) -> None:
        """Put a wall back with a better bound, or as final; the piece is that of the wall alone."""
        good = piece is not None and wall.owner.place.holds(piece.place.cell.centre, piece.place.start, piece.place.off)
        bound = max(entry, self.measure(piece, wall.face)) if piece is not None and good else entry
        if not bound > BETTER * entry:
            self._push(bound, Wall(wall.face, wall.owner, final=True))
        elif not any(wall.face.widths):
            self._push(bound, wall)
        else:
            for half in wall.face.halves():
                self._push(bound, Wall(half, wall.owner, final=False))

    def _enter(self, cell: Cell, entry: float) -> None:
        if entry < self._entries[cell]:
            self._entries[cell] = entry
            self._push(entry, cell)

    def _push(self, entry: float, item: Cell | Wall) -> None:
        heapq.heappush(self._heap, (entry, next(self._count), item))
