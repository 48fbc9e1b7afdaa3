"""How a resistance is read: its bridge, its own heat, and the noise of what is read.

A thermometer that is fed with a power P (W) on a dissipation constant delta (W/K) warms by some P/delta, and with its R
P changes. What holds it is delta_eff = delta - dP/dT = delta - s alpha_R P, with s = d ln P/d ln R by how it is fed:

- voltage, P = V^2/R: s = -1 and delta_eff = delta + alpha_R P; an NTC can run away.
- current, P = I^2 R: s = 1 and delta_eff = delta - alpha_R P; a metal can run away.
- half-bridge of equal arms, P = V^2 R/(R + R_f)^2: s = (R_f - R)/(R_f + R) = 0 at R_f = R, so delta_eff = delta.

Where delta_eff <= 0 nothing holds it. All of this is local: alpha_R and P are those at the thermometer's own, risen
temperature. With P and alpha_R at the ambient temperature T_a, an NTC at a voltage has left its last steady state at
P |alpha_R|/delta = x^2 e^-x already, where x = T/T_a and T solves (T - T_a) B = T^2 (Semenov's explosion: 1/e for large
B, and 0.405 for B = 3435 K at 25 degrees). `steady_rise` knows this, `self_heating` does not.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import ArrayLike

from firmtouch.errors import NoDesignError
from firmtouch.thermal.arrays import Array, ThermalValueError, require_positive
from firmtouch.thermal.thermometer import Thermometer

BOLTZMANN = 1.380649e-23
"""k_B (J/K), exact in the SI."""
FEEDBACK_LIMIT = 0.05
"""Of P |alpha_R|/delta: a design stays below, so that delta_eff is delta within as much."""


class RunawayError(NoDesignError):
    """A thermometer's own heat grows faster than it is lost: `power` is not below `limit` (W)."""

    def __init__(self, power: float, limit: float) -> None:
        self.power, self.limit = power, limit
        super().__init__(
            f"the thermometer's own heat runs away: {power:.4g} W is not below {limit:.4g} W; feed it less, "
            f"through an equal resistor (a half-bridge), or mount it on a larger dissipation constant"
        )


class Bias(Enum):
    """How a thermometer is fed; its value says what stays as it is when R changes."""

    VOLTAGE = "the voltage across it"
    CURRENT = "the current through it"
    HALF_BRIDGE = "the voltage across it and a resistor of its own resistance"


FOLLOWS = {Bias.VOLTAGE: -1, Bias.CURRENT: 1, Bias.HALF_BRIDGE: 0}
"""s = d ln P/d ln R."""


@dataclass(frozen=True, slots=True)
class SelfHeating:
    """What a thermometer's own heat does at one point of operation.

    `rise` (K) is P/delta_eff, `effective_conductance` delta_eff (W/K), `feedback_ratio` P |alpha_R|/delta whatever the
    bias, and `runaway_power` delta/|alpha_R| (W), infinite where it cannot run away.
    """

    rise: float
    effective_conductance: float
    feedback_ratio: float
    runaway_power: float


def self_heating(power: float, delta: float, *, coefficient: float, bias: Bias) -> SelfHeating:
    """Give the electro-thermal feedback of a power P (W) on delta (W/K), with alpha_R (1/K) at the same temperature.

    delta_eff = delta + alpha_R P for a voltage, delta - alpha_R P for a current, and delta in a half-bridge. With P and
    alpha_R at ambient temperature P/delta_eff is the rise to first order, 0.12 % short of `steady_rise` for an NTC at a
    voltage and the design limit `FEEDBACK_LIMIT`; with those at the risen temperature, delta_eff is exact for what
    changes from there.

    Raises
    ------
    RunawayError
        If delta_eff is not positive.
    ThermalValueError
        If a size is not positive.
    """
    require_positive(power=power, dissipation_constant=delta)
    if not math.isfinite(coefficient):
        raise ThermalValueError("temperature coefficient", coefficient, "a finite number")
    grows = FOLLOWS[bias] * coefficient
    effective = delta - grows * power
    limit = delta / grows if grows > 0 else math.inf
    if effective <= 0:
        raise RunawayError(power, limit)
    return SelfHeating(power / effective, effective, power * abs(coefficient) / delta, limit)


def steady_rise(thermometer: Thermometer, power: float, delta: float, *, ambient: float, bias: Bias) -> float:
    """Give the exact rise theta (K) above `ambient` (K) from P(theta) = delta theta, with `power` (W) at theta = 0.

    It is the first root, at which a thermometer arrives that was switched on at ambient temperature. A half-bridge's
    resistor has the thermometer's resistance at ambient temperature. Where P grows, P/theta falls until theta |alpha_R|
    = 1, the fold: the first root is before it, or there is none.

    Raises
    ------
    RunawayError
        If there is none below twice the ambient temperature; its `limit` is the largest `power` that has one.
    ThermalValueError
        If a size is not positive, or the thermometer has no resistance at a temperature in question.
    """
    from scipy.optimize import brentq

    require_positive(power=power, dissipation_constant=delta, ambient_temperature=ambient)
    cold = float(thermometer.resistance(ambient))

    def excess(rise: float) -> float:
        ratio = float(thermometer.resistance(ambient + rise)) / cold
        return power / delta * _power_ratio(bias, ratio) - rise

    def beyond(rise: float) -> float:
        return rise * abs(float(thermometer.coefficient(ambient + rise))) - 1

    last = power / delta * (1 + 1e-9)  # where P does not change, rounding shall not hide the root
    if FOLLOWS[bias] * float(thermometer.coefficient(ambient)) > 0:
        last = brentq(beyond, 0, ambient, xtol=1e-12 * ambient) if beyond(ambient) > 0 else ambient
        if (over := excess(last)) > 0:
            raise RunawayError(power, power * last / (last + over))
    return float(brentq(excess, 0, last, xtol=1e-14 * power / delta, rtol=1e-14))


def _power_ratio(bias: Bias, ratio: float) -> float:
    """Give P by its value at R = R_0, for R/R_0."""
    match bias:
        case Bias.VOLTAGE:
            return 1 / ratio
        case Bias.CURRENT:
            return ratio
        case Bias.HALF_BRIDGE:
            return 4 * ratio / (1 + ratio) ** 2


@dataclass(frozen=True, slots=True)
class Bridge:
    """A half-bridge of equal arms at a voltage (V): the fixed arm has the thermometer's R at the T asked for."""

    thermometer: Thermometer
    voltage: float

    def __post_init__(self) -> None:
        require_positive(bridge_voltage=self.voltage)

    def power(self, T: ArrayLike) -> Array:
        """Give (V/2)^2/R (W), what heats the thermometer at T (K)."""
        return np.asarray((self.voltage / 2) ** 2 / self.thermometer.resistance(T))

    def sensitivity(self, T: ArrayLike) -> Array:
        """Give S = V |alpha_R|/4 (V/K) of the voltage between both arms at T (K)."""
        return np.asarray(self.voltage * np.abs(self.thermometer.coefficient(T)) / 4)

    def source_resistance(self, T: ArrayLike) -> Array:
        """Give R/2 (ohm), both arms in parallel, at T (K)."""
        return np.asarray(self.thermometer.resistance(T) / 2)


@dataclass(frozen=True, slots=True)
class Reading:
    """What follows a bridge: e_n (V/sqrt(Hz)) at the amplifier's input, a noise bandwidth (Hz), a gain, a converter.

    The converter has a number of bits and an input range (V), or is left out with both. Noise is white: neither 1/f nor
    the current noise of the amplifier is in it, and rounding counts as noise where the signal passes many steps.
    """

    amplifier_noise: float
    bandwidth: float
    gain: float = 1.0
    adc_bits: int | None = None
    adc_range: float | None = None

    def __post_init__(self) -> None:
        require_positive(bandwidth=self.bandwidth, gain=self.gain)
        if not (math.isfinite(self.amplifier_noise) and self.amplifier_noise >= 0):
            raise ThermalValueError("amplifier noise", self.amplifier_noise, "zero or a positive number")
        if (self.adc_bits is None) != (self.adc_range is None):
            raise ThermalValueError("number of the converter's bits and range", 1, "two, or none")
        if self.adc_bits is not None and self.adc_range is not None:
            require_positive(adc_bits=self.adc_bits, adc_range=self.adc_range)

    @property
    def step(self) -> float:
        """Give the converter's step by the gain, range/(2^bits G) (V); 0 without a converter."""
        if self.adc_bits is None or self.adc_range is None:
            return 0.0
        return math.ldexp(self.adc_range, -self.adc_bits) / self.gain


@dataclass(frozen=True, slots=True)
class NoiseSources:
    """One value for each source, and `total`, the root of the sum of their squares."""

    johnson: float
    amplifier: float
    quantisation: float

    @property
    def total(self) -> float:
        """Give the standard deviation of all together."""
        return math.hypot(self.johnson, self.amplifier, self.quantisation)


@dataclass(frozen=True, slots=True)
class Noise:
    """Noise of one reading: `voltage` (V rms) at the bridge's output, and `netd`, the same in K: v_n/S."""

    voltage: NoiseSources
    netd: NoiseSources


def noise(bridge: Bridge, reading: Reading, T: float) -> Noise:
    """Give v_n^2 = 4 k_B T (R/2) B + e_n^2 B + (step/G)^2/12 by its parts, at T (K), and each by S.

    Raises
    ------
    ThermalValueError
        If the thermometer has no resistance at T.
    """
    johnson = math.sqrt(4 * BOLTZMANN * T * float(bridge.source_resistance(T)) * reading.bandwidth)
    amplifier = reading.amplifier_noise * math.sqrt(reading.bandwidth)
    voltage = johnson, amplifier, reading.step / math.sqrt(12)
    S = float(bridge.sensitivity(T))
    return Noise(NoiseSources(*voltage), NoiseSources(*(each / S for each in voltage)))


def thermodynamic_floor(T: float, C: float) -> float:
    """Give sqrt(k_B T^2/C) (K): how far the temperature of a capacity C (J/K) itself fluctuates about T (K)."""
    require_positive(temperature=T, C=C)
    return T * math.sqrt(BOLTZMANN / C)
