"""How a sensor's temperature is read, and what noise its signal has for that."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from firmtouch.thermal.arrays import require_positive
from firmtouch.thermal.electronics import Bias, Bridge, Noise, SelfHeating, self_heating
from firmtouch.thermal.loop import loop_transfer
from firmtouch.thermal.quadrupole import heater_transfer
from firmtouch.thermal.stack import Air, Front, Stack

if TYPE_CHECKING:
    from firmtouch.thermal.sensor import Sensor

FREQUENCIES: Final = 120
"""Over which a loop's noise is added up, from a thousandth of the bandwidth on."""


@dataclass(frozen=True, slots=True)
class Readout:
    """Samples of the sensed temperature: their rate (1/s), and the noise (K rms) of one in a bandwidth (Hz).

    Where a bridge reads it, `bridge` and `sources` tell where the noise is from, and `area` (m2) is that of the film
    or part which the bridge warms, where it is known.
    """

    rate: float
    noise: float
    bandwidth: float
    bridge: Bridge | None = None
    sources: Noise | None = None
    area: float | None = None

    def __post_init__(self) -> None:
        require_positive(sampling_rate=self.rate, noise=self.noise, bandwidth=self.bandwidth)


def signal_noise(sensor: Sensor) -> float | None:
    """Give the noise of one sample of the signal (K or W/m2); None without a readout.

    Two pads have sqrt(2) times the noise of one. A loop makes power of it: sigma_p^2 is the mean of |K/(1 + L)|^2 over
    the bandwidth, times sigma^2, with the object that makes most of it; the noise is that of what is read, so it does
    not pass the lag F of the sensor before it reaches the controller. That of the power is least at low frequencies,
    and is taken as white here, which promises too little rather than too much.
    """
    from firmtouch.thermal.sensor import HeldTemperature, TwoFaces

    readout = sensor.readout
    if readout is None:
        return None
    match sensor.drive:
        case TwoFaces():
            return math.sqrt(2) * readout.noise
        case HeldTemperature(loop=loop, reads_power=True):
            f = readout.bandwidth * np.concatenate([[0.0], np.geomspace(1e-3, 1, FREQUENCIES)])
            s = 2j * np.pi * np.where(f == 0, 1e-6 * readout.bandwidth, f)
            fronts: list[Front] = [sensor.front, *sensor.touches]
            density = np.abs(loop.controller(s) / (1 + loop_transfer(sensor.stack, fronts, loop, s))) ** 2
            mean = np.trapezoid(density, f, axis=1) / readout.bandwidth
            return float(readout.noise * np.sqrt(mean.max()))
        case _:
            return readout.noise


def reading_power(readout: Readout | None, T: float) -> float:
    """Give the power of the bridge's current at T (K) by area (W/m2); 0 without one, or where its size is not known."""
    if readout is None or readout.bridge is None or readout.area is None:
        return 0.0
    return float(readout.bridge.power(T)) / readout.area


def own_heat(stack: Stack, front: Air, readout: Readout, T: float) -> SelfHeating | None:
    """Give what the bridge's current does to the sensed film at T (K), untouched; None where its size is not known.

    The dissipation constant delta is what the stack gives to its surroundings at rest, 1/Z, times the film's area.
    """
    if readout.bridge is None or readout.area is None:
        return None
    with np.errstate(invalid="ignore"):
        Z = float(heater_transfer(stack, front, np.zeros(1))[0].real)
    return self_heating(
        float(readout.bridge.power(T)),
        readout.area / Z,
        coefficient=float(readout.bridge.thermometer.coefficient(T)),
        bias=Bias.HALF_BRIDGE,
    )
