"""Fingertips of one or two heat capacities: for hand calculation, and for loops around a discrete thermistor."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from firmtouch.thermal.arrays import Array, Complex, ThermalValueError, require_conductance, require_positive
from firmtouch.thermal.stack import Material

TEN_TO_NINETY = math.log(9)
"""t_r / tau of one pole."""


@dataclass(frozen=True, slots=True)
class OnePole:
    """A capacity C (J/K) on a conductance G (W/K): C T' = P - G T."""

    C: float
    G: float

    def __post_init__(self) -> None:
        require_positive(C=self.C, G=self.G)

    @property
    def time_constant(self) -> float:
        """Give C/G (s)."""
        return self.C / self.G

    @property
    def rise_time(self) -> float:
        """Give the time from 10 % to 90 % of a step, ln(9) C/G (s)."""
        return TEN_TO_NINETY * self.time_constant

    def step(self, t: ArrayLike) -> Array:
        """Give 1 - exp(-G t/C)."""
        return np.asarray(-np.expm1(-np.asarray(t) / self.time_constant))


def required_conductance(C: float, rise_time: float) -> float:
    """Give the conductance ln(9) C / t_r (W/K, or W/m2K for C'') that a capacity needs for a 10-90 % rise time (s)."""
    require_positive(C=C, rise_time=rise_time)
    return TEN_TO_NINETY * C / rise_time


class TwoNodeTransfer(NamedTuple):
    """Temperatures of the heater and the thermistor, per unit of what drives them."""

    heater: Complex
    thermistor: Complex


@dataclass(frozen=True, slots=True)
class TwoNode:
    """A heater (C_h, with G_a to the surroundings), coupled by G_ht to a thermistor (C_t, with G_c to the object).

    C_h T_h' = P - G_a T_h - G_ht (T_h - T_t),  C_t T_t' = G_ht (T_h - T_t) - G_c (T_t - T_o); J/K and W/K.
    """

    C_h: float
    G_a: float
    G_ht: float
    C_t: float
    G_c: float

    def __post_init__(self) -> None:
        require_positive(C_h=self.C_h, G_ht=self.G_ht, C_t=self.C_t)
        for name, value in (("G_a", self.G_a), ("G_c", self.G_c)):
            if not (math.isfinite(value) and value >= 0):
                raise ThermalValueError(name, value, "zero or a positive number")

    @property
    def A(self) -> Array:
        """Give the state matrix of (T_h, T_t)."""
        G_ht = self.G_ht
        return np.array(
            [[-(self.G_a + G_ht) / self.C_h, G_ht / self.C_h], [G_ht / self.C_t, -(G_ht + self.G_c) / self.C_t]]
        )

    @property
    def B(self) -> Array:
        """Give the input matrix for (P, T_o)."""
        return np.array([[1 / self.C_h, 0], [0, self.G_c / self.C_t]])

    def _modes(self) -> tuple[Array, Array, Array]:
        """Give poles, and V and its inverse: A is symmetric in sqrt(C) T, so all poles are real and negative."""
        root = np.sqrt([self.C_h, self.C_t])
        poles, Q = np.linalg.eigh(self.A * root[:, np.newaxis] / root)
        return poles, Q / root[:, np.newaxis], Q.T * root

    @property
    def poles(self) -> Array:
        """Give both poles (1/s), the slower first."""
        return self._modes()[0][::-1]

    def step(self, t: ArrayLike) -> Array:
        """Give the exact step responses of (T_h, T_t) for (P, T_o): shape (len(t), 2, 2), node before input."""
        poles, V, inverse = self._modes()
        risen = np.expm1(np.multiply.outer(np.asarray(t, dtype=np.float64), poles)) / poles
        return np.asarray(np.einsum("ik,...k,kj->...ij", V, risen, inverse @ self.B))

    def power_transfer(self, s: ArrayLike) -> TwoNodeTransfer:
        """Give T_h/P and T_t/P (K/W)."""
        s = np.asarray(s, dtype=np.complex128)
        return self._solve(s, np.full_like(s, self.G_c), power=1, drawn=0)

    def object_transfer(self, s: ArrayLike) -> TwoNodeTransfer:
        """Give T_h/T_o and T_t/T_o."""
        s = np.asarray(s, dtype=np.complex128)
        return self._solve(s, np.full_like(s, self.G_c), power=0, drawn=1)

    def half_space_transfers(
        self, s: ArrayLike, *, material: Material, area: float, conductance: float
    ) -> tuple[TwoNodeTransfer, TwoNodeTransfer]:
        """Give power and object transfer on a half-space: G_c becomes 1 / (1/(h A) + 1/(A e sqrt(s))).

        `area` A (m2), `conductance` h (W/m2K); this network's own G_c is not used.
        """
        require_positive(area=area)
        require_conductance(conductance)
        s = np.asarray(s, dtype=np.complex128)
        G_c: Complex = area / (1 / conductance + 1 / (material.effusivity * np.sqrt(s)))
        return self._solve(s, G_c, power=1, drawn=0), self._solve(s, G_c, power=0, drawn=1)

    def _solve(self, s: Complex, G_c: Complex, *, power: int, drawn: int) -> TwoNodeTransfer:
        h, t = self.C_h * s + self.G_a + self.G_ht, self.C_t * s + self.G_ht + G_c
        determinant = h * t - self.G_ht**2
        into_h, into_t = power, drawn * G_c
        return TwoNodeTransfer(
            heater=np.asarray((t * into_h + self.G_ht * into_t) / determinant),
            thermistor=np.asarray((self.G_ht * into_h + h * into_t) / determinant),
        )


@dataclass(frozen=True, slots=True)
class ConstantTemperature:
    """A film (C, J/K; G, W/K) whose heater gives -K (W/K) times what a sensor of lag tau_s (s) reads.

    C T' = -G T - K y + w,  tau_s y' = T - y, where w is what the object does; the heater's power is the signal.
    """

    C: float
    G: float
    K: float
    sensor_lag: float = 0.0

    def __post_init__(self) -> None:
        require_positive(C=self.C, G=self.G)
        for name, value in (("loop gain K", self.K), ("sensor lag", self.sensor_lag)):
            if not (math.isfinite(value) and value >= 0):
                raise ThermalValueError(name, value, "zero or a positive number")

    @property
    def poles(self) -> Complex:
        """Give the poles of (C s + G)(tau_s s + 1) + K."""
        C, G, lag = self.C, self.G, self.sensor_lag
        quadratic = [C * lag, C + G * lag, G + self.K] if lag else [C, G + self.K]
        return np.sort_complex(np.roots(quadratic).astype(np.complex128))

    @property
    def damping(self) -> float:
        """Give zeta; without a lag there is one pole and zeta is infinite."""
        if not self.sensor_lag:
            return math.inf
        tau, lag = self.C / self.G, self.sensor_lag
        return (1 / lag + 1 / tau) / (2 * math.sqrt((1 + self.K / self.G) / (lag * tau)))

    def temperature_transfer(self, s: ArrayLike) -> Complex:
        """Give T/w (K/W)."""
        s = np.asarray(s, dtype=np.complex128)
        lag = self.sensor_lag * s + 1
        return np.asarray(lag / ((self.C * s + self.G) * lag + self.K))

    def power_transfer(self, s: ArrayLike) -> Complex:
        """Give P/w: 0 at a gain of zero, nearly -1 at a high one."""
        s = np.asarray(s, dtype=np.complex128)
        return np.asarray(-self.K / ((self.C * s + self.G) * (self.sensor_lag * s + 1) + self.K))

    def temperature_step(self, t: ArrayLike) -> Array:
        """Give T (K) after w steps by 1 W, exactly."""
        return self._step(t, zero=self.sensor_lag)

    def response(self, t: ArrayLike) -> Array:
        """Give what the heater's power does after a step of w, of its final change: it goes from 0 to 1."""
        return self._step(t, zero=0.0) * (self.G + self.K)

    def _step(self, t: ArrayLike, *, zero: float) -> Array:
        """Invert (1 + zero s) / (s ((C s + G)(tau_s s + 1) + K)); two poles that meet take the limit's form."""
        t = np.asarray(t, dtype=np.float64)
        final = 1 / (self.G + self.K)
        if not self.sensor_lag:
            return np.asarray(-np.expm1(-t * (self.G + self.K) / self.C) * final)
        middle = -(1 / self.sensor_lag + self.G / self.C) / 2
        root = np.sqrt(np.asarray(middle**2 - (self.G + self.K) / (self.C * self.sensor_lag), dtype=np.complex128))
        # The transient is e^{middle t} (cosh(root t) a + sinh(root t)/root b) with the values that f(0) and f'(0) need.
        decayed = [np.exp((middle + sign * root) * t) for sign in (1, -1)]
        cosh = (decayed[0] + decayed[1]) / 2
        apart = abs(root) > 1e-7 * abs(middle)
        sinh = (decayed[0] - decayed[1]) / (2 * root) if apart else t * np.exp(middle * t)
        slope = zero / (self.C * self.sensor_lag)
        return np.asarray((final - final * cosh + (slope + middle * final) * sinh).real)


def gain_for_damping(C: float, G: float, sensor_lag: float, zeta: float = math.sqrt(0.5)) -> float:
    """Give K (W/K) that makes the closed loop's damping zeta: K/G + 1 = (1 + tau_s/tau)^2 tau / (4 zeta^2 tau_s).

    Raises
    ------
    ThermalValueError
        If a size is not positive, or the loop is less damped already without any gain.
    """
    require_positive(C=C, G=G, sensor_lag=sensor_lag, zeta=zeta)
    tau = C / G
    K = G * ((1 + sensor_lag / tau) ** 2 * tau / (4 * zeta**2 * sensor_lag) - 1)
    if K < 0:
        least = (1 + sensor_lag / tau) / 2 * math.sqrt(tau / sensor_lag)
        raise ThermalValueError("zeta", zeta, f"at most {least:.4g}, which the film and its sensor have without a loop")
    return K
