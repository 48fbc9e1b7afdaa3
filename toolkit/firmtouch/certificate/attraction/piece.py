"""What is known of the closed loop's potential energy p over one cell of the free coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from flint import arb, arb_mat

from firmtouch.certificate.attraction.chart import Cell
from firmtouch.certificate.attraction.forms import Form, Weights
from firmtouch.certificate.matrices import BallMatrix, exact
from firmtouch.mechanics.balls import Ball

ROUNDING: Final = 2**-50
"""More than what 1/3 and 1/6 lack in binary64."""


@dataclass(frozen=True, slots=True)
class Place:
    """A tube |x1 - start - slope xi - bend(xi, xi)/2| <= radius over a cell, x2 = centre + xi, with one graph in it.

    `bend` are m symmetric matrices. Over the centre the graph is within `off` of `start`.
    """

    cell: Cell
    start: BallMatrix
    slope: BallMatrix
    bend: tuple[BallMatrix, ...]
    radius: list[Ball]
    off: list[Ball]

    def axis(self, x2: tuple[float, ...]) -> BallMatrix:
        """Give the tube's axis over a point of the cell, m."""
        xi = exact(x2) - exact(self.cell.centre)
        bent = [(xi.transpose() * each * xi)[0, 0] / 2 for each in self.bend]
        return self.start + self.slope * xi + arb_mat(len(bent), 1, bent)

    def holds(self, x2: tuple[float, ...], x1: BallMatrix, off: list[Ball]) -> bool:
        """Tell whether all that is within `off` of x1 is in the tube, over a point of the cell."""
        away = (x1 - self.axis(x2)).entries()
        return all(abs(a).upper() + o < r for a, o, r in zip(away, off, self.radius, strict=True))


@dataclass(frozen=True, slots=True)
class Piece:
    """p and p_x over the centre of a cell, and p_xx over all of it.

    The first n - m of the hessian's e_k are xi_k / widths_k, the others are delta / radius.
    """

    place: Place
    value: Ball
    gradient: BallMatrix
    hessian: Form

    def mean_hessian(self, beyond: float = 0.0) -> BallMatrix:
        """Enclose the means of p_xx over segments from near the centre, so that p_x at xi is p_x(centre) + H xi.

        On xi t, 0 <= t <= 1, the means of t and t^2 are 1/2 and 1/3. Where a segment starts `beyond` widths from the
        centre, and not in it, they are larger by that at most.
        """
        return self.hessian.mean(Weights(len(self.place.cell.low), 0.5 + beyond, 1 / 3 + ROUNDING + beyond))

    def level_hessian(self) -> BallMatrix:
        """Enclose the means of p_xx that give p at xi as p(centre) + p_x xi + xi^T H xi / 2.

        They are those with the weights 2 (1 - t); the means of t and t^2 are 1/3 and 1/6.
        """
        return self.hessian.mean(Weights(len(self.place.cell.low), 1 / 3 + ROUNDING, 1 / 6 + ROUNDING))

    def bounds(self, part: Cell | None = None) -> tuple[Ball, Ball]:
        """Bound p over the cell, or over a part of it, from below and from above.

        With x2 = centre + xi, xi = middle + eta, p = value + F xi + xi^T H xi / 2 is a polynomial of eta with
        coefficients in balls; its terms are bounded one by one, each square with its own slope.
        """
        cell = self.place.cell if part is None else part
        w = [arb(each) for each in cell.widths]
        H = self.level_hessian()
        H = (H + H.transpose()) / 2
        middle = exact(cell.centre) - exact(self.place.cell.centre)
        turned = H * middle
        lower = upper = self.value + ((self.gradient + turned / 2).transpose() * middle)[0, 0]
        slopes, rows = (self.gradient + turned).entries(), H.tolist()
        for i, half in enumerate(w):
            steepest = abs(slopes[i]).upper()
            lower += _least(steepest, rows[i][i].lower(), half)
            upper -= _least(steepest, -rows[i][i].upper(), half)
            for j in range(i):
                mixed = abs(rows[i][j]).upper() * half * w[j]
                lower, upper = lower - mixed, upper + mixed
        return lower.lower(), upper.upper()


def _least(slope: Ball, curvature: Ball, half: Ball) -> Ball:
    """Bound -slope |x| + curvature x^2 / 2 on |x| <= half from below; all three exact, slope and half >= 0."""
    if curvature > 0 and slope < curvature * half:
        return -slope * slope / (2 * curvature)
    return arb.min(arb(0), (curvature * half / 2 - slope) * half)
