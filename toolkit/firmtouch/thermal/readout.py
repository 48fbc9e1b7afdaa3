"""How a sensor's temperature is read, and what the reading's own current does."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from firmtouch.thermal.arrays import require_positive
from firmtouch.thermal.electronics import Bias, Bridge, Noise, SelfHeating, self_heating
from firmtouch.thermal.quadrupole import heater_transfer
from firmtouch.thermal.stack import Air, Stack


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
