"""Coordinates of the surface: q = q_d + V1 x1 + V2 x2, and boxes of x2."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation import ClosedLoop


@dataclass(frozen=True, slots=True)
class Chart:
    """q = q_d + V1 x1 + V2 x2 with q_d (n), V1 (n x m) and V2 (n x (n-m)) as they are in binary64.

    Any V1, V2 with J V1 nonsingular will do: nothing is proven from J V2 = 0 or from orthogonality.
    """

    q_d: Array
    V1: Array
    V2: Array

    @property
    def free(self) -> int:
        """The number n - m of coordinates x2."""
        return int(self.V2.shape[1])


def stiffness_chart(loop: ClosedLoop) -> Chart:
    """Turn V2 so that K22 is diagonal: near q_d, level sets of P_cd are ellipsoids along these axes."""
    V2 = loop.split.V2
    _, turn = np.linalg.eigh(V2.T @ loop.K @ V2)
    V2 = V2 @ turn
    peaks = V2[np.argmax(np.abs(V2), axis=0), np.arange(V2.shape[1])]
    return Chart(loop.operating_point.q_d, loop.split.V1, frozen(V2 * np.where(peaks < 0, -1.0, 1.0)))


@dataclass(frozen=True, slots=True)
class Cell:
    """low_i <= x2_i <= high_i. Parts of a cell have the very same numbers for the edges that they share."""

    low: tuple[float, ...]
    high: tuple[float, ...]

    @property
    def centre(self) -> tuple[float, ...]:
        """A point near the middle."""
        return tuple((a + b) / 2 for a, b in zip(self.low, self.high, strict=True))

    @property
    def widths(self) -> tuple[float, ...]:
        """How far no point of it is from `centre`: half the edges, rounded up."""
        return tuple(
            0.0 if a == b else float(np.nextafter(max(b - c, c - a), np.inf))
            for a, b, c in zip(self.low, self.high, self.centre, strict=True)
        )

    @property
    def is_solid(self) -> bool:
        """Whether no edge is without length."""
        return all(a < b for a, b in zip(self.low, self.high, strict=True))

    def halves(self) -> tuple[Cell, Cell]:
        """Cut it across its longest edge."""
        i = max(range(len(self.low)), key=lambda k: self.high[k] - self.low[k])
        middle = self.centre[i]
        return self._with(i, self.low[i], middle), self._with(i, middle, self.high[i])

    def faces(self) -> list[Cell]:
        """Give its boundary, two faces for each axis."""
        return [self._with(i, end[i], end[i]) for i in range(len(self.low)) for end in (self.low, self.high)]

    def shell(self, inner: Cell) -> list[Cell]:
        """Cut what is left of it without an inner cell into cells, two for each axis."""
        pieces, rest = [], self
        for i in range(len(self.low)):
            pieces.append(rest._with(i, self.low[i], inner.low[i]))
            pieces.append(rest._with(i, inner.high[i], self.high[i]))
            rest = rest._with(i, inner.low[i], inner.high[i])
        return pieces

    def within(self, other: Cell) -> bool:
        """Tell whether it is a part of another cell."""
        return all(a >= b for a, b in zip(self.low, other.low, strict=True)) and all(
            a <= b for a, b in zip(self.high, other.high, strict=True)
        )

    def shared(self, other: Cell) -> Cell | None:
        """Give what it has in common with another cell, if that is a face or more."""
        low, high, flat = [], [], 0
        for a, b, c, d in zip(self.low, self.high, other.low, other.high, strict=True):
            start, end = max(a, c), min(b, d)
            if start >= end:
                flat += 1
                if start > end or flat > 1:
                    return None
            low.append(start)
            high.append(end)
        return Cell(tuple(low), tuple(high))

    def _with(self, i: int, low: float, high: float) -> Cell:
        return Cell((*self.low[:i], low, *self.low[i + 1 :]), (*self.high[:i], high, *self.high[i + 1 :]))


def box(half_widths: tuple[float, ...]) -> Cell:
    """Give the cell |x2_i| <= half_widths_i."""
    return Cell(tuple(-each for each in half_widths), tuple(half_widths))
