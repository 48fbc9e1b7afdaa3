"""The signals of all scenarios on one grid of times, from which rise times and powers are read off."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from firmtouch.thermal.arrays import Array
from firmtouch.thermal.inversion import EULER_ORDER
from firmtouch.thermal.loop import Loop, loop_transfer, unstable_poles
from firmtouch.thermal.metrics import Metric, Rises, rises
from firmtouch.thermal.sensor import HeldTemperature, Sensor
from firmtouch.thermal.signals import responses
from firmtouch.thermal.stack import Front, Stack

ZOOMS, ZOOMED = 2, 21
"""How often, and with how many frequencies, the least distance of a loop from its limit is looked at closer."""


@dataclass(frozen=True, slots=True)
class Grid:
    """How finely signals are computed: times a decade, decades, order of Euler's method, knots of a touch's flux."""

    per_decade: int
    decades: float
    order: int
    knots: int

    def times(self, window: float, asked: float = math.inf) -> Array:
        """Give the times (s) up to the end of a window, from a hundredth of an `asked` rise time (s) on at least."""
        decades = max(self.decades, 2 + math.log10(window) - math.log10(asked))
        return np.asarray(window * np.logspace(-decades, 0, math.ceil(self.per_decade * decades) + 1))


COARSE = Grid(per_decade=12, decades=5.0, order=10, knots=41)
FINE = Grid(per_decade=50, decades=8.0, order=EULER_ORDER, knots=81)
"""Rise times are within 1e-3 by the coarse grid, which a search uses, and within 2e-5 by the fine one."""


@dataclass(frozen=True, slots=True, eq=False)
class Felt:
    """A sensor's signals (K or W/m2): `values` has a row for each scenario, at the times t (s) after the touch."""

    sensor: Sensor
    grid: Grid
    t: Array
    values: Array

    @property
    def window(self) -> float:
        """Give the last time (s)."""
        return float(self.t[-1])

    def rises(self, metric: Metric) -> Rises:
        """Measure the signals."""
        return rises(self.t, self.values, metric)


def feel(sensor: Sensor, window: float, grid: Grid = FINE, *, asked: float = math.inf) -> Felt:
    """Compute a sensor's signals in a window (s), unchecked, and so early that an `asked` rise time (s) is seen."""
    t = grid.times(window, asked)
    return Felt(sensor, grid, t, responses(sensor, sensor.touches, t, order=grid.order))


def loop_margin(sensor: Sensor) -> float:
    """Give the loop's modulus margin, the least |1 + L(j omega)|, untouched and in all scenarios; 1 without a loop.

    It is the inverse of the largest sensitivity M_s; 0.5 goes with a gain margin of 2 and a phase margin of 29 degrees.
    A loop that grows has none, 0, however far from -1 its L goes round.
    """
    if not isinstance(sensor.drive, HeldTemperature):
        return 1.0
    loop = sensor.drive.loop
    if _grows(sensor, loop):
        return 0.0
    omega = np.geomspace(1e-1, 1e6, 211)
    fronts: list[Front] = [sensor.front, *sensor.touches]
    distance = np.abs(1 + loop_transfer(sensor.stack, fronts, loop, 1j * omega))
    worst, _ = np.unravel_index(int(distance.argmin()), distance.shape)
    return least_distance(sensor.stack, fronts[int(worst)], loop, omega, distance[int(worst)])


def least_distance(stack: Stack, front: Front, loop: Loop, omega: Array, distance: Array) -> float:
    """Give the least |1 + L| of one front, at most 1, from its values at some omega, and more about the least of them.

    A loop near its limit passes -1 within a few percent of a frequency.
    """
    i, least = int(distance.argmin()), float(distance.min())
    low, high = float(omega[max(i - 1, 0)]), float(omega[min(i + 1, omega.size - 1)])
    for _ in range(ZOOMS):
        w = np.geomspace(low, high, ZOOMED)
        closer = np.abs(1 + loop_transfer(stack, front, loop, 1j * w))
        i, least = int(closer.argmin()), min(least, float(closer.min()))
        low, high = float(w[max(i - 1, 0)]), float(w[min(i + 1, ZOOMED - 1)])
    return min(1.0, least)


def _grows(sensor: Sensor, loop: Loop) -> bool:
    """Tell whether a loop is unstable, untouched or in a scenario.

    Where heater and sensor are in one plane, Z_p is passive and turns by less than 90 degrees; with a lag or an
    integral, but not both, L stays short of -180 degrees.
    """
    if loop.heater == sensor.stack.sensed and not loop.dead_time and not (loop.integral_gain and loop.sensor_lag):
        return False
    return any(unstable_poles(sensor.stack, each, loop) for each in (sensor.front, *sensor.touches))
