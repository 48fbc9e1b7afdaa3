"""The constant-temperature loop on a whole stack: a heater in one plane, driven by what another plane's sensor reads.

L = K(s) Z_p(s) F(s), with Z_p from heater to sensor, F = e^{-s T_d} / (tau_s s + 1) and K(s) = K + K_i/s (W/m2K). The
object disturbs the sensed plane by T_c(s) dV, so the heater gives p = -K F T_c / (1 + L) dV, which is the signal.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from firmtouch.errors import NoDesignError
from firmtouch.thermal.arrays import Array, Complex, ThermalValueError, require_positive
from firmtouch.thermal.inversion import Inversion, invert
from firmtouch.thermal.quadrupole import contact_transfer, heater_transfer
from firmtouch.thermal.stack import Front, Stack, Touch

ACCURATE = 1e-6
"""What two orders of Euler's method may differ by, of the largest value."""


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
        return np.asarray(np.exp(-s * self.dead_time) / (1 + self.sensor_lag * s))


def loop_transfer(stack: Stack, front: Front, loop: Loop, s: ArrayLike) -> Complex:
    """Give L(s) = K Z_p F, with an object before the fingertip or without."""
    s = np.asarray(s, dtype=np.complex128)
    return loop.controller(s) * heater_transfer(stack, front, s, heater=loop.heater) * loop.sensor(s)


def power_transfer(stack: Stack, touch: Touch, loop: Loop, s: ArrayLike) -> Complex:
    """Give the heater's p''/dV (W/m2K), times 1/s for the step at contact."""
    s = np.asarray(s, dtype=np.complex128)
    driven = loop.controller(s) * loop.sensor(s)
    passage = heater_transfer(stack, touch, s, heater=loop.heater)
    return np.asarray(-driven * contact_transfer(stack, touch, s).sensed / (1 + driven * passage))


def temperature_transfer(stack: Stack, touch: Touch, loop: Loop, s: ArrayLike) -> Complex:
    """Give theta/dV of the sensed plane in closed loop: T_c / (1 + L)."""
    s = np.asarray(s, dtype=np.complex128)
    return np.asarray(contact_transfer(stack, touch, s).sensed / (1 + loop_transfer(stack, touch, loop, s)))


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


def power_response(stack: Stack, touch: Touch, loop: Loop, t: ArrayLike) -> Array:
    """Give the heater's p'' (W/m2) per kelvin of T_o - T_s at the times t (s) after contact, by Euler's method.

    Raises
    ------
    LoopUnstableError
        If the loop with the object is unstable.
    InversionError
        If it oscillates longer than Euler's method can follow.
    """
    require_stable(stack, touch, loop)
    return invert(lambda s: power_transfer(stack, touch, loop, s) / s, t, method=Inversion.EULER, tolerance=ACCURATE)


def temperature_response(stack: Stack, touch: Touch, loop: Loop, t: ArrayLike) -> Array:
    """Give the sensed plane's temperature in closed loop, per kelvin of T_o - T_s.

    Raises
    ------
    LoopUnstableError
        If the loop with the object is unstable.
    InversionError
        If it oscillates longer than Euler's method can follow.
    """
    require_stable(stack, touch, loop)
    return invert(
        lambda s: temperature_transfer(stack, touch, loop, s) / s, t, method=Inversion.EULER, tolerance=ACCURATE
    )
