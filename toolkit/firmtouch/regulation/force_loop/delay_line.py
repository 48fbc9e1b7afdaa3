"""A pure delay as a line of states, and Newton's method from there on the equation that it stands for."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from firmtouch.mechanics import Array
from firmtouch.regulation.force_loop.path import ForcePath

Complex = NDArray[np.complex128]

SPARE: Final = 14
"""Points beyond the least number that resolves an oscillation: Chebyshev series fall faster than geometrically then."""
STEPS: Final = 6
NEAR: Final = 1e-3
"""What Newton's method moves farther than this, relatively, was no root but a trace of the discretisation."""


def order_for(angle: float) -> int:
    """Give the number of states for |s| delay up to `angle`: a polynomial needs half of that, and some to spare."""
    return int(np.ceil(0.65 * angle)) + SPARE if angle else 0


def delay_line(delay: float, order: int) -> Array:
    """Give D (order + 1 square): v(x), x in [-delay, 0], at Chebyshev points from 0 on; D @ v is v' there.

    v(t + x) moves along the line as dv/dt = v'; v(0) is what goes in and v(-delay) what comes out (Trefethen 2000,
    cheb.m; Breda, Maset and Vermiglio 2005 for what its eigenvalues are).
    """
    i = np.arange(order + 1)
    x = np.cos(np.pi * i / order)
    c = np.where((i == 0) | (i == order), 2.0, 1.0) * (-1.0) ** i
    # x_i - x_j as a product of sines keeps its digits
    apart = (
        2 * np.sin(np.pi * np.add.outer(i, i) / (2 * order)) * np.sin(-np.pi * np.subtract.outer(i, i) / (2 * order))
    )
    D = np.outer(c, 1 / c) / (apart + np.eye(order + 1))
    np.fill_diagonal(D, 0.0)
    np.fill_diagonal(D, -D.sum(axis=1))
    assert x[0] == 1
    return np.asarray(D * 2 / delay)


def refined(C: Array, held: Array, fed_back: Array, path: ForcePath, poles: Complex) -> Complex:
    """Move eigenvalues of the line to roots of det(s^2 I + s C + held + L(s) fed_back), and drop those that are none.

    Newton's method on the determinant: s - 1 / trace(T^-1 T'), for all poles at once.
    """
    s, eye, step = poles, np.eye(len(C)), np.zeros_like(poles)
    for _ in range(STEPS):
        L = np.exp(-s * path.delay) / (1 + s * path.lag)
        slope = -L * (path.delay + path.lag / (1 + s * path.lag))
        col = s[:, None, None]
        T = col**2 * eye + col * C + held + L[:, None, None] * fed_back
        dT = 2 * col * eye + C + slope[:, None, None] * fed_back
        step = _newton(T, dT)
        s = s - np.where(np.abs(step) <= NEAR * (np.abs(s) + 1 / path.delay), step, 0)
    near = np.abs(s - poles) <= NEAR * (np.abs(poles) + 1 / path.delay)
    return np.asarray(s[near & (np.abs(step) <= NEAR * (np.abs(s) + 1 / path.delay))])


def _newton(T: Complex, dT: Complex) -> Complex:
    """Give 1 / trace(T^-1 T'); none where T is singular to the last digit, that is, at a root."""
    try:
        trace = np.trace(np.linalg.solve(T, dT), axis1=1, axis2=2)
    except np.linalg.LinAlgError:
        return np.zeros(len(T), dtype=np.complex128)
    return np.asarray(np.divide(1, trace, out=np.zeros_like(trace), where=np.isfinite(trace) & (trace != 0)))
