"""A rational transfer function for a response: fixed real poles, fitted to the step, with its error stated.

The poles are spaced evenly in the logarithm of time and their residues are least squares on the exact step response.
Being real, negative and given, they are stable by construction, which fits on the imaginary axis are not; 2 poles a
decade reach some 1e-3 of a unit step and 3 reach 1e-4 to 1e-5. The model holds for times within the window only.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from firmtouch.thermal.arrays import Array, Complex, Response, ThermalValueError, require_positive

if TYPE_CHECKING:
    import control

PER_DECADE = 3.0
FASTEST = 0.3
"""Of the earliest time: what rose before it needs a pole too, or the first times err ten times as much."""
SAMPLES_PER_DECADE, CHECKS_PER_DECADE = 40, 61
"""Fitted times, and those between them at which the error is measured."""


@dataclass(frozen=True, slots=True, eq=False)
class Reduction:
    """H(s) = D + sum_i r_i / (s - p_i), with poles p_i < 0 (1/s) and residues r_i.

    `error` is the largest difference of the step responses from `earliest` to `window` (s), in the response's unit, and
    `relative_error` that of the largest value there.
    """

    poles: Array
    residues: Array
    D: float
    earliest: float
    window: float
    error: float
    relative_error: float

    def transfer(self, s: ArrayLike) -> Complex:
        """Give H(s)."""
        s = np.asarray(s, dtype=np.complex128)
        return np.asarray((self.residues / (s[..., np.newaxis] - self.poles)).sum(axis=-1) + self.D)

    def step(self, t: ArrayLike) -> Array:
        """Give the unit step response D + sum_i r_i (e^{p_i t} - 1) / p_i."""
        return _basis(np.asarray(t, dtype=np.float64), self.poles) @ (-self.residues / self.poles) + self.D

    def state_space(self) -> control.StateSpace:
        """Hand it to python-control, in modal form; every input and output scale is the square root of a residue."""
        import control

        root = np.sqrt(np.abs(self.residues))
        B = root[:, np.newaxis]
        C = (np.sign(self.residues) * root)[np.newaxis, :]
        return control.ss(np.diag(self.poles), B, C, [[self.D]])

    def transfer_function(self) -> control.TransferFunction:
        """Hand it to python-control as zeros, poles and gain; the state space is the better conditioned of the two."""
        import control

        return control.ss2tf(self.state_space())


def _basis(t: Array, poles: Array) -> Array:
    return np.asarray(-np.expm1(np.multiply.outer(t, poles)))


def _times(earliest: float, window: float, per_decade: int) -> Array:
    return np.geomspace(earliest, window, math.ceil(per_decade * math.log10(window / earliest)) + 1)


def reduce_step(
    step: Response, *, earliest: float, window: float, per_decade: float = PER_DECADE, feedthrough: bool = False
) -> Reduction:
    """Fit a step response from `earliest` to `window` (s); D is fitted too if it has `feedthrough`, a jump at t = 0.

    Raises
    ------
    ThermalValueError
        If the times do not span anything, or there is less than a pole a decade.
    """
    require_positive(earliest=earliest, window=window, poles_per_decade=per_decade)
    if window <= earliest:
        raise ThermalValueError("window", window, f"after the earliest time, {earliest:g}")
    if per_decade < 1:
        raise ThermalValueError("poles per decade", per_decade, "at least 1")
    fastest = FASTEST * earliest
    count = math.ceil(per_decade * math.log10(window / fastest)) + 1
    poles = -1 / np.geomspace(window, fastest, count)
    t = _times(earliest, window, SAMPLES_PER_DECADE)
    columns, values = _basis(t, poles), step(t)
    if feedthrough:
        columns = np.column_stack([columns, np.ones_like(t)])
    weights = np.linalg.lstsq(columns, values)[0]
    D = float(weights[count]) if feedthrough else 0.0
    checks = _times(earliest, window, CHECKS_PER_DECADE)
    exact = step(checks)
    error = float(np.abs(_basis(checks, poles) @ weights[:count] + D - exact).max())
    largest = float(np.abs(exact).max())
    return Reduction(
        poles=poles,
        residues=-weights[:count] * poles,
        D=D,
        earliest=earliest,
        window=window,
        error=error,
        relative_error=error / largest if largest else math.inf,
    )
