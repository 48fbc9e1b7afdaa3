"""The constant-temperature loop on a whole stack: a heater in one plane, driven by what another plane's sensor reads.

L = K(s) Z_p(s) F(s), with Z_p from heater to sensor, F = e^{-s T_d} / (tau_s s + 1) and K(s) = K + K_i/s (W/m2K). The
object disturbs the sensed plane by T_c(s) dV, so the heater gives p = -K F T_c / (1 + L) dV, which is the signal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from firmtouch.errors import NoDesignError
from firmtouch.thermal.arrays import Array, Complex, ThermalValueError, Transfer, require_positive, require_times
from firmtouch.thermal.inversion import Inversion, invert
from firmtouch.thermal.quadrupole import contact_transfer, heater_transfer
from firmtouch.thermal.stack import Front, Stack, Touch

ACCURATE, ACCURATE_WITH_DEAD_TIME = 1e-6, 1e-4
"""What two orders of Euler's method may differ by, of the largest value; a dead time makes corners, which it rounds."""
FOLLOWED = 30.0
"""The omega t up to which Euler's method follows an oscillation; beyond, its orders agree and are both wrong."""
DIP, CONVERGED = 0.95, 1e-9
"""Of |1 + L|: what rings has it well below 1; and of Newton's last step, of the pole."""


class LoopRingsError(NoDesignError):
    """A loop still rings where no inversion can follow; `pole` (1/s) is the one that does."""

    def __init__(self, pole: complex, t: float) -> None:
        self.pole, self.t = pole, t
        super().__init__(
            f"the loop still rings at {t:g} s, {pole.imag * t / 6.2832:.0f} turns after contact (its pole is at "
            f"{pole.real:.4g} +- {pole.imag:.4g}i 1/s): lower its gain, or ask for shorter times"
        )


class LoopUnstableError(NoDesignError):
    """A closed loop grows: `poles` tells how many of its poles have a positive real part."""

    def __init__(self, poles: int) -> None:
        self.poles = poles
        super().__init__(
            f"the constant-temperature loop is unstable: {poles} poles have positive real parts; lower its gain, "
            f"or shorten the sensor's lag and dead time"
        )


@dataclass(frozen=True, slots=True)
class Loop:
    """A controller and its sensor: K (W/m2K), K_i (W/m2Ks), lag tau_s (s), dead time T_d (s); `heater` is its plane."""

    gain: float
    heater: int
    integral_gain: float = 0.0
    sensor_lag: float = 0.0
    dead_time: float = 0.0

    def __post_init__(self) -> None:
        require_positive(loop_gain=self.gain)
        for name in ("integral_gain", "sensor_lag", "dead_time"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise ThermalValueError(name.replace("_", " "), value, "zero or a positive number")

    def controller(self, s: Complex) -> Complex:
        """Give K(s) (W/m2K)."""
        return np.asarray(self.gain + self.integral_gain / s)

    def sensor(self, s: Complex) -> Complex:
        """Give F(s)."""
        return np.asarray(np.exp(-s * self.dead_time) * self.lag(s))

    def lag(self, s: Complex) -> Complex:
        """Give F(s) without the dead time, 1/(tau_s s + 1)."""
        return np.asarray(1 / (1 + self.sensor_lag * s))


def loop_transfer(stack: Stack, front: Front | Sequence[Front], loop: Loop, s: ArrayLike) -> Complex:
    """Give L(s) = K Z_p F, with an object before the fingertip or without."""
    s = np.asarray(s, dtype=np.complex128)
    return loop.controller(s) * heater_transfer(stack, front, s, heater=loop.heater) * loop.sensor(s)


def power_transfer(stack: Stack, touch: Touch | Sequence[Touch], loop: Loop, s: ArrayLike) -> Complex:
    """Give the heater's p''/dV (W/m2K), times 1/s for the step at contact."""
    return np.asarray(power_after_dead_time(stack, touch, loop, s) * np.exp(-np.asarray(s) * loop.dead_time))


def power_after_dead_time(stack: Stack, touch: Touch | Sequence[Touch], loop: Loop, s: ArrayLike) -> Complex:
    """Give p''/dV times e^{s T_d}, of the time since the dead time has passed; it has no factor that overflows."""
    s = np.asarray(s, dtype=np.complex128)
    driven = loop.controller(s) * loop.lag(s) * contact_transfer(stack, touch, s).sensed
    return np.asarray(-driven / (1 + loop_transfer(stack, touch, loop, s)))


def temperature_transfer(stack: Stack, touch: Touch | Sequence[Touch], loop: Loop, s: ArrayLike) -> Complex:
    """Give theta/dV of the sensed plane in closed loop: T_c / (1 + L)."""
    s = np.asarray(s, dtype=np.complex128)
    return np.asarray(contact_transfer(stack, touch, s).sensed / (1 + loop_transfer(stack, touch, loop, s)))


@lru_cache(maxsize=256)  # rise times ask for one loop again and again
def unstable_poles(stack: Stack, front: Front, loop: Loop) -> int:
    """Count the closed loop's poles of positive real part: the turns of 1 + L about 0 (Nyquist), L being stable.

    The way goes from the real axis along a quarter circle about 0, where an integral or a half-space has its branch
    point, and up the imaginary axis until L has died away. Points are added until no step turns by a radian.
    """
    low, high = 1e-6, 1e9
    quarter = low * np.exp(0.5j * np.pi * np.linspace(0, 1, 65))
    way = np.concatenate([quarter, 1j * np.geomspace(low, high, 1500)[1:]])
    for _ in range(12):
        curve = 1 + loop_transfer(stack, front, loop, way)
        steps = np.angle(curve[1:] / curve[:-1])
        coarse = np.abs(steps) > 1
        if not coarse.any():
            break
        way = np.insert(way, np.flatnonzero(coarse) + 1, (way[1:][coarse] + way[:-1][coarse]) / 2)
    return round(-float(steps.sum()) / np.pi)


def require_stable(stack: Stack, front: Front, loop: Loop) -> None:
    """Refuse a loop that grows.

    Raises
    ------
    LoopUnstableError
        If a closed-loop pole has a positive real part.
    """
    if poles := unstable_poles(stack, front, loop):
        raise LoopUnstableError(poles)


@lru_cache(maxsize=256)
def oscillating_poles(stack: Stack, front: Front, loop: Loop) -> tuple[complex, ...]:
    """Give the closed loop's poles near the imaginary axis, those with Im > 0, the least damped first.

    They are Newton's method on 1 + L from the minima of |1 + L| along the axis; a well damped loop has none.
    """

    def characteristic(s: Complex) -> Complex:
        return np.asarray(1 + loop_transfer(stack, front, loop, s))

    axis = 1j * np.geomspace(1e-2, 1e8, 1501)
    size = np.abs(characteristic(axis))
    dips = (size[1:-1] < size[:-2]) & (size[1:-1] < size[2:]) & (size[1:-1] < DIP)
    least = np.flatnonzero(dips) + 1
    p = axis[least]
    for _ in range(12):
        h = 1e-5 * np.abs(p)
        move = 2 * h * characteristic(p) / (characteristic(p + h) - characteristic(p - h))
        p = p - move
        left = (p.real < -np.abs(p.imag)) | (p.imag <= 0) | (-p.real * loop.dead_time > 50)  # e^50: gone at once
        p = np.where(left, axis[least], p)
    found = p[np.abs(move) < CONVERGED * np.abs(p)]
    return tuple(complex(each) for each in found[np.argsort(-found.real / np.abs(found))])


def require_followable(stack: Stack, touch: Touch, loop: Loop, t: Array) -> None:
    """Refuse a loop that grows, or that still rings where Euler's method cannot follow it any more.

    Raises
    ------
    LoopUnstableError
        If the loop with the object is unstable.
    LoopRingsError
        If it oscillates longer than Euler's method can follow.
    """
    require_stable(stack, touch, loop)
    for pole in oscillating_poles(stack, touch, loop):
        rings = (pole.imag * t > FOLLOWED) & (np.exp(np.minimum(0, pole.real * t)) > ACCURATE_WITH_DEAD_TIME)
        if rings.any():
            raise LoopRingsError(pole, float(t[rings].min()))


def _invert_loop(stack: Stack, touch: Touch, loop: Loop, transform: Transfer, t: Array) -> Array:
    """Invert by Euler's method, after all refusals."""
    require_followable(stack, touch, loop, t)
    tolerance = ACCURATE_WITH_DEAD_TIME if loop.dead_time else ACCURATE
    return invert(transform, t, method=Inversion.EULER, tolerance=tolerance)


def power_response(stack: Stack, touch: Touch, loop: Loop, t: ArrayLike) -> Array:
    """Give the heater's p'' (W/m2) per kelvin of T_o - T_s at the times t (s) after contact, by Euler's method.

    Until the dead time has passed it is zero, and only what follows is inverted.

    Raises
    ------
    LoopUnstableError
        If the loop with the object is unstable.
    LoopRingsError, InversionError
        If it oscillates longer than Euler's method can follow.
    """
    times = require_times(t)
    found = np.zeros_like(times)
    after = times > loop.dead_time

    def transform(s: Complex) -> Complex:
        return np.asarray(power_after_dead_time(stack, touch, loop, s) / s)

    if after.any():
        found[after] = _invert_loop(stack, touch, loop, transform, times[after] - loop.dead_time)
    return found


def temperature_response(stack: Stack, touch: Touch, loop: Loop, t: ArrayLike) -> Array:
    """Give the sensed plane's temperature in closed loop, per kelvin of T_o - T_s.

    Raises
    ------
    LoopUnstableError
        If the loop with the object is unstable.
    LoopRingsError, InversionError
        If it oscillates longer than Euler's method can follow.
    """

    def transform(s: Complex) -> Complex:
        return np.asarray(temperature_transfer(stack, touch, loop, s) / s)

    return _invert_loop(stack, touch, loop, transform, require_times(t))
