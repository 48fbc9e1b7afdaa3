"""Cubic splines on a uniform grid as SX: not-a-knot, C^2, and enclosed tightly by balls at the knots too.

With s = t - i, the basis function of knot i has |s| < 2 as its support and is there

    6 B_i = 4 - 6 s^2 + 3 sign(s) s^3 + 4 [s > 1] (1 - s)^3 + 4 [s < -1] (1 + s)^3.

Every comparison is a factor of a cube (or, at |s| = 2, of what has become one) that vanishes where it switches, so its
derivatives of order 0, 1, 2 are continuous, and what a ball around a knot does not decide is multiplied by something
small. That holds for the derivatives as they are written here; those that CasADi makes of the value are enclosed too,
but not tightly at a knot, as its rules multiply [|s| < 2] out. Numbers stay of size one: sums of all truncated powers
over the grid would cancel, in balls without bound. At the grid's ends, beyond which the cubics of the outer cells go
on, comparisons do not switch.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from firmtouch.mechanics.arrays import Array, frozen


def coefficients(values: Array) -> Array:
    """Give c with sum c_i B_{i-1} through values at the knots 0..n-1 (along the first axis), n >= 4; n + 2 rows.

    Not-a-knot: the third derivative does not jump at the second and the second last knot, so cubics are met exactly.
    """
    n = len(values)
    A = np.zeros((n + 2, n + 2))
    for i in range(n):
        A[i, i : i + 3] = np.array([1, 4, 1]) / 6
    A[n, :5] = A[n + 1, -5:] = (1, -4, 6, -4, 1)
    return frozen(np.linalg.solve(A, np.concatenate([values, np.zeros((2, *values.shape[1:]))])))


def basis(t: ca.SX, n: int) -> tuple[ca.SX, ...]:
    """Give the n + 2 basis functions at t, which counts cells, and their first three derivatives by t: columns."""
    beyond = {k: ca.SX(k < t) if 0 < k < n - 1 else ca.SX(int(k <= 0)) for k in range(-3, n + 3)}
    rows = [
        _bump(t - i, beyond[i], beyond[i + 1], 1 - beyond[i - 1], beyond[i - 2] * (1 - beyond[i + 2]))
        for i in range(-1, n + 1)
    ]
    return tuple(ca.vertcat(*column) for column in zip(*rows, strict=True))


def _bump(s: ca.SX, positive: ca.SX, right: ca.SX, left: ca.SX, inside: ca.SX) -> Sequence[ca.SX]:
    """Give B and its derivatives; the comparisons are s > 0, s > 1, s < -1 and |s| < 2."""
    sign, ahead, behind = 2 * positive - 1, right * (1 - s), left * (1 + s)
    return (
        inside * (4 - 6 * s**2 + 3 * sign * s**3 + 4 * (ahead * (1 - s) ** 2 + behind * (1 + s) ** 2)) / 6,
        inside * (-4 * s + 3 * sign * s**2 - 4 * (ahead * (1 - s) - behind * (1 + s))) / 2,
        inside * (-2 + 3 * sign * s + 4 * (ahead + behind)),
        inside * (3 * sign - 4 * (right - left)),
    )
