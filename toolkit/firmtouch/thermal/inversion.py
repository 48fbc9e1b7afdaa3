"""From the Laplace domain to time, numerically.

`talbot` is for open networks of resistances, capacities and diffusion: their singularities lie on the negative real
axis, and 24 points give 12 digits over any span of time. Poles far from that axis fall outside of its contour.
`euler` is for closed loops: it sums along a vertical line and needs only that all singularities are left of it; 16
terms give some 10 digits. It averages an alternating series, so it loses them where the response has turned round more
than some 5 times (omega t > 30), and it rounds the corners that a dead time makes. What turns faster than 100/t lies
beyond its last term, so that no order of it can see it.

Both are unchecked and fast. `invert` checks the chosen one against itself at another order and refuses what it cannot.
"""

from __future__ import annotations

from enum import Enum
from functools import cache
from math import comb

import numpy as np
from numpy.typing import ArrayLike

from firmtouch.errors import InputError
from firmtouch.thermal.arrays import Array, Complex, Transfer, require_times

TALBOT_ORDER = 24
EULER_ORDER = 16
NEGLIGIBLE = 1e-19
"""Of the largest weight: below rounding even where F grows by three decades towards the axis."""
CHECKED = 12
"""Times that `invert` computes twice."""


class InversionError(InputError):
    """A method does not reach what was asked of it; `error` tells how far two orders differ, of the largest value."""

    def __init__(self, method: Inversion, error: float, tolerance: float) -> None:
        self.method, self.error, self.tolerance = method, error, tolerance
        super().__init__(
            f"two orders of {method.name.title()}'s method differ by {error:.1e} of the largest value, "
            f"and {tolerance:.1e} was asked for: {method.value}"
        )


class Inversion(Enum):
    """A method, and what to do where it fails."""

    TALBOT = "a network that oscillates or has a dead time needs Inversion.EULER"
    EULER = "ask for shorter times, fewer oscillations, or more damping"


@cache
def _talbot_nodes(order: int) -> tuple[Complex, Complex]:
    """Give s t and weights/t of the fixed Talbot contour (Abate and Valko, Int. J. Numer. Meth. Engng 60 (2004))."""
    angle = np.arange(1, order) * np.pi / order
    cot = 1 / np.tan(angle)
    r = 2 * order / 5
    nodes = np.concatenate([[r], r * angle * (cot + 1j)])
    slopes = np.concatenate([[0.5], 1 + 1j * (angle + (angle * cot - 1) * cot)])
    weights = r / order * np.exp(nodes) * slopes
    kept = np.abs(weights) > NEGLIGIBLE * np.abs(weights).max()
    return nodes[kept], weights[kept]


@cache
def _euler_nodes(order: int) -> tuple[Complex, Complex]:
    """Give s t and weights/t of Euler's summation (Abate and Whitt, INFORMS J. Computing 18 (2006))."""
    k = np.arange(2 * order + 1)
    xi = np.ones(2 * order + 1)
    xi[0] = 0.5
    tail = np.cumsum([comb(order, i) for i in range(order)]) * 0.5**order
    xi[order + 1 :] = tail[::-1]
    return order * np.log(10) / 3 + 1j * np.pi * k, (10 ** (order / 3) * (-1.0) ** k * xi).astype(np.complex128)


def _sum(F: Transfer, t: ArrayLike, rule: tuple[Complex, Complex]) -> Array:
    times = require_times(t)
    nodes, weights = rule
    return np.asarray((F(nodes / times[..., np.newaxis]) @ weights).real / times)


def talbot(F: Transfer, t: ArrayLike, *, order: int = TALBOT_ORDER) -> Array:
    """Invert F at the times t > 0 (s, any shape) by the fixed Talbot method.

    Raises
    ------
    ThermalValueError
        If a time is not positive.
    """
    return _sum(F, t, _talbot_nodes(order))


def euler(F: Transfer, t: ArrayLike, *, order: int = EULER_ORDER) -> Array:
    """Invert F at the times t > 0 (s, any shape) by Euler's summation.

    Raises
    ------
    ThermalValueError
        If a time is not positive.
    """
    return _sum(F, t, _euler_nodes(order))


def invert(F: Transfer, t: ArrayLike, *, method: Inversion = Inversion.TALBOT, tolerance: float = 1e-6) -> Array:
    """Invert F at the times t > 0, and compute some of them again at a higher order.

    Raises
    ------
    InversionError
        If both orders differ by more than `tolerance` times the largest value of those asked for.
    ThermalValueError
        If a time is not positive.
    """
    way, order = (talbot, TALBOT_ORDER) if method is Inversion.TALBOT else (euler, EULER_ORDER)
    found = way(F, t)
    if not found.size:
        return found
    chosen = np.unique(np.linspace(0, found.size - 1, CHECKED).astype(int))
    again = way(F, require_times(t).ravel()[chosen], order=order + 4)
    error = float(np.abs(found.ravel()[chosen] - again).max() / max(np.abs(found).max(), np.finfo(float).tiny))
    if not error <= tolerance:
        raise InversionError(method, error, tolerance)
    return found


def step(transfer: Transfer, t: ArrayLike) -> Array:
    """Give the unit step response of an open network: `talbot` of transfer/s."""
    return talbot(lambda s: transfer(s) / s, t)
