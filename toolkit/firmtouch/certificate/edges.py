"""The edges of a region for poles, each as a linear matrix inequality and as a question to Routh and Hurwitz.

    decay rate     Re s < -alpha            L = [2 alpha],    R = [1]
    damping ratio  -Re s / |s| > cos th     L = 0,            R = [[sin th, cos th], [-cos th, sin th]]
    bandwidth      |s| < w                  L = -w I,         R = [[0, 1], [0, 0]]

The LMI region is L + s R + conj(s) R^T < 0 (Chilali and Gahinet 1996). A polynomial has its roots inside an edge if
and only if another one, real as well, has all of its roots in the open left half plane.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from flint import arb, arb_mat, arb_poly

from firmtouch.certificate.matrices import BallMatrix
from firmtouch.mechanics.balls import Ball


class EdgeKind(Enum):
    """What an edge bounds, with the unit of its value."""

    DECAY = "decay rate", "1/s", ">="
    DAMPING = "damping ratio", "", ">="
    BANDWIDTH = "greatest |s|", "rad/s", "<="

    @property
    def words(self) -> str:
        """Name it."""
        return self.value[0]

    @property
    def unit(self) -> str:
        """Give the unit of its value."""
        return self.value[1]

    @property
    def relation(self) -> str:
        """Tell on which side of the value the poles are."""
        return self.value[2]

    def of_pole(self, s: complex) -> float:
        """Give for one pole what the edge bounds."""
        match self:
            case EdgeKind.DECAY:
                return -s.real
            case EdgeKind.DAMPING:
                return -s.real / abs(s) if s else 0.0
            case EdgeKind.BANDWIDTH:
                return abs(s)


@dataclass(frozen=True, slots=True)
class Edge:
    """One edge of the region."""

    kind: EdgeKind
    value: float

    def lmi(self, unit: float) -> tuple[BallMatrix, BallMatrix]:
        """Give L and R, with time counted in 1/unit."""
        value = arb(self.value)
        match self.kind:
            case EdgeKind.DECAY:
                return arb_mat([[2 * value / arb(unit)]]), arb_mat([[1]])
            case EdgeKind.DAMPING:
                sine = (1 - value * value).sqrt()
                return arb_mat([[0, 0], [0, 0]]), arb_mat([[sine, value], [-value, sine]])
            case EdgeKind.BANDWIDTH:
                bound = value / arb(unit)
                return arb_mat([[-bound, 0], [0, -bound]]), arb_mat([[0, 1], [0, 0]])

    def moved(self, p: Sequence[Ball], unit: float) -> list[Ball]:
        """Give the real polynomial that is Hurwitz if and only if the roots of p are inside the edge.

        `p` are real coefficients from the constant one on, its roots counted in `unit`. For the sector it is
        p(s e^(i phi)) p(s e^(-i phi)) with phi = pi/2 - th, for the disc (1 - z)^d p(w (1 + z) / (1 - z)).
        """
        value, d = arb(self.value), len(p) - 1
        match self.kind:
            case EdgeKind.DECAY:
                return _padded(arb_poly(p)(arb_poly([-value / arb(unit), 1])), d)
            case EdgeKind.DAMPING:
                # cos(phi) = sin th and sin(phi) = cos th; powers of e^(i phi), one after the other
                real, imaginary, turned = arb(1), arb(0), []
                sine = (1 - value * value).sqrt()
                for each in p:
                    turned.append((each * real, each * imaginary))
                    real, imaginary = real * sine - imaginary * value, real * value + imaginary * sine
                a, b = (arb_poly([each[k] for each in turned]) for k in (0, 1))
                return _padded(a * a + b * b, 2 * d)
            case EdgeKind.BANDWIDTH:
                w, plus, minus = value / arb(unit), arb_poly([1, 1]), arb_poly([1, -1])
                moved = arb_poly([0])
                for k, each in enumerate(p):
                    moved += plus**k * minus ** (d - k) * (each * w**k)
                return _padded(moved, d)


def _padded(p: arb_poly, degree: int) -> list[Ball]:
    """List degree + 1 coefficients, also where the last ones are exactly zero."""
    coefficients: list[Ball] = p.coeffs()
    return coefficients + [arb(0)] * (degree + 1 - len(coefficients))


def is_hurwitz(p: Sequence[Ball]) -> bool | None:
    """Tell whether all roots of a real polynomial lie in the open left half plane, by Routh's scheme.

    All entries of its first column have one sign if and only if they do; None if the balls do not tell. Coefficients
    count from the constant one on; the last one may be zero, which stands for a root at infinity and is never proven.
    """
    top, below = list(p[::-1][0::2]), list(p[::-1][1::2])
    if top[0] < 0:
        top, below = [-each for each in top], [-each for each in below]
    if not top[0] > 0:
        return None
    for _ in range(len(p) - 1):
        if not below or not below[0] > 0:
            return False if not below or below[0] <= 0 else None
        ratio = top[0] / below[0]
        rest = [*below[1:], arb(0)]
        top, below = below, [a - ratio * b for a, b in zip(top[1:], rest, strict=False)]
    return True
