"""A rational model of the constant-temperature loop: both ways to the sensor reduced, and the loop closed exactly.

Real poles alone follow the complex ones of a closed loop poorly. So what is fitted is what diffusion makes, the
sensed plane's temperature for an object and for the heater, which real poles do to 1e-4; controller and lag are exact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from firmtouch.thermal.arrays import Array, Complex, ThermalValueError
from firmtouch.thermal.inversion import euler, step
from firmtouch.thermal.loop import Loop, power_after_dead_time, temperature_transfer
from firmtouch.thermal.quadrupole import contact_transfer, heater_transfer
from firmtouch.thermal.reduction import CHECKS_PER_DECADE, Reduction, reduce_step
from firmtouch.thermal.stack import Stack, Touch

if TYPE_CHECKING:
    import control


@dataclass(frozen=True, slots=True, eq=False)
class LoopReduction:
    """x' = A x + B dV, y = C x of a closed loop; y is the heater's p'' (W/m2), or the sensed temperature (K).

    `contact` and `heater` are the open channels, theta/dV and theta/P'' (m2K/W). `error` is the largest difference of
    the unit step responses from `earliest` to `window` (s), and `relative_error` that of the largest value there.
    """

    contact: Reduction
    heater: Reduction
    A: Array
    B: Array
    C: Array
    earliest: float
    window: float
    error: float
    relative_error: float

    @property
    def poles(self) -> Complex:
        """Give the closed loop's poles (1/s), those of the contact's channel among them."""
        return np.linalg.eigvals(self.A).astype(np.complex128)

    def transfer(self, s: ArrayLike) -> Complex:
        """Give H(s)."""
        s = np.asarray(s, dtype=np.complex128)
        system = s[..., np.newaxis, np.newaxis] * np.eye(len(self.A)) - self.A
        return np.asarray(np.linalg.solve(system, self.B[:, np.newaxis])[..., 0] @ self.C)

    def step(self, t: ArrayLike) -> Array:
        """Give the unit step response."""
        return _step(self.A, self.B, self.C, np.asarray(t, dtype=np.float64))

    def state_space(self) -> control.StateSpace:
        """Hand it to python-control."""
        import control

        return control.ss(self.A, self.B[:, np.newaxis], self.C[np.newaxis], [[0.0]])


def reduce_loop(
    stack: Stack, touch: Touch, loop: Loop, *, earliest: float, window: float, reads_power: bool = True
) -> LoopReduction:
    """Reduce a loop from `earliest` to `window` (s) after the touch.

    Raises
    ------
    ThermalValueError
        If the times do not span anything, or the loop has a dead time, which no rational function has.
    """
    if loop.dead_time:
        raise ThermalValueError("dead time", loop.dead_time, "zero: no rational function has one")

    def contact(t: Array) -> Array:
        return step(lambda s: contact_transfer(stack, touch, s).sensed, t)

    def heater(t: Array) -> Array:
        return step(lambda s: heater_transfer(stack, touch, s, heater=loop.heater), t)

    def exact(t: Array) -> Array:
        transfer = power_after_dead_time if reads_power else temperature_transfer
        return euler(lambda s: transfer(stack, touch, loop, s) / s, t)

    object_way, heater_way = (reduce_step(of, earliest=earliest, window=window) for of in (contact, heater))
    A, B, C = _closed(object_way, heater_way, loop, reads_power=reads_power)
    count = math.ceil(CHECKS_PER_DECADE * math.log10(window / earliest)) + 1
    t = np.geomspace(earliest, window, count)
    values = exact(t)
    error, largest = float(np.abs(_step(A, B, C, t) - values).max()), float(np.abs(values).max())
    relative = error / largest if largest else math.inf
    return LoopReduction(object_way, heater_way, A, B, C, earliest, window, error, relative)


def _closed(contact: Reduction, heater: Reduction, loop: Loop, *, reads_power: bool) -> tuple[Array, Array, Array]:
    """Join both channels, the lag and the controller: states x_c, x_h, the reading f and its integral z.

    x_c' = P_c x_c + dV, x_h' = P_h x_h + p, theta = r_c x_c + r_h x_h, tau_s f' = theta - f, z' = f, p = -K f - K_i z;
    without a lag f is theta.
    """
    m, n = contact.poles.size, heater.poles.size
    theta = np.concatenate([contact.residues, heater.residues, np.zeros(2)])
    A = np.zeros((m + n + 2, m + n + 2))
    A[range(m), range(m)] = contact.poles
    A[range(m, m + n), range(m, m + n)] = heater.poles
    f, z = m + n, m + n + 1
    reading = np.eye(m + n + 2)[f] if loop.sensor_lag else theta
    power = -loop.gain * reading
    power[z] -= loop.integral_gain
    A[m : m + n] += power
    A[f] = (theta - np.eye(m + n + 2)[f]) / loop.sensor_lag if loop.sensor_lag else -np.eye(m + n + 2)[f]
    A[z] = reading if loop.integral_gain else -np.eye(m + n + 2)[z]
    B = np.concatenate([np.ones(m), np.zeros(n + 2)])
    kept = [*range(m + n), *([f] if loop.sensor_lag else []), *([z] if loop.integral_gain else [])]
    C = power if reads_power else theta
    return A[np.ix_(kept, kept)], B[kept], C[kept]


def _step(A: Array, B: Array, C: Array, t: Array) -> Array:
    """Give C A^-1 (e^{A t} - 1) B by the eigenvectors of A."""
    poles, V = np.linalg.eig(A)
    weights = (C @ V) * np.linalg.solve(V, B.astype(np.complex128)) / poles
    return np.asarray((np.expm1(np.multiply.outer(t, poles)) @ weights).real)
