"""How well a sensor tells objects apart, and grades their effusivity, with what is not known of a touch."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from firmtouch.thermal.arrays import Array
from firmtouch.thermal.discrimination import ENOUGH, Sampling, d_primes
from firmtouch.thermal.sensor import Pulsed, Sensor
from firmtouch.thermal.signals import responses
from firmtouch.thermal.stack import Disc, HalfSpace, Material, Touch, TouchedObject

STEP: Final = 1e-3
"""Of ln h and ln e, in central differences: their error is its square, and an inversion's 1e-10 over it."""
SAMPLES_PER_DECADE: Final = 16
"""Times at which signals are computed; between them, at the samples, they are splines over ln t."""
FEWEST: Final = 12
DENSITY, HEAT_CAPACITY = 2500.0, 1000.0
"""Of the objects by which a range of effusivity is graded [C]: solids have rho c of 1.5 to 4 MJ/m3K."""


@dataclass(frozen=True, slots=True)
class Pair:
    """How well two objects are told apart in contacts of one level: d' at a time (s), and when it is enough (s)."""

    first: str
    second: str
    level: str
    d_prime: float
    time: float
    told_after: float


@dataclass(frozen=True, slots=True)
class Grade:
    """How well an effusivity e (W s^1/2/m2K) is known at a time: the standard deviation of ln e (Cramer and Rao)."""

    effusivity: float
    level: str
    spread: float


@dataclass(frozen=True, slots=True, eq=False)
class Spread:
    """Signals at the samples' times, one row for each touch, and what a standard deviation of each unknown does.

    `spreads` has the shape (unknowns, touches, samples).
    """

    times: Array
    values: Array
    spreads: Array


def spread_signals(sensor: Sensor, touches: Sequence[Touch], until: float, rate: float) -> Spread:
    """Sample the signals of touches until a time (s) at a rate (1/s)."""
    times, unknown = Sampling(1.0, rate).times(until), sensor.unknown
    more = [_harder(each, sign) for sign in (1, -1) for each in touches] if unknown.ln_h else []
    found = _at(sensor, [*touches, *more], times)
    values, n = found[: len(touches)], len(touches)
    spreads: list[Array] = []
    if unknown.ln_h:
        spreads.append(unknown.ln_h * (found[n : 2 * n] - found[2 * n :]) / (2 * STEP))
    if unknown.temperature and (warmer := by_temperature(sensor, touches, times)) is not None:
        spreads.append(unknown.temperature * warmer)
    return Spread(times, values, np.array(spreads).reshape(len(spreads), n, times.size))


def by_temperature(sensor: Sensor, touches: Sequence[Touch], times: Array) -> Array | None:
    """Give d signal/d T_o: what a difference of one kelvin makes; None where T_o does not matter.

    What the air took before does not depend on it.
    """
    if sensor.drive.mode == "two_temperature" or not times.size:
        return None
    here, touches = sensor.temperatures, [replace(each, air=0.0) for each in touches]
    warmer, colder = (replace(sensor, temperatures=replace(here, object=here.object + d)) for d in (0.5, -0.5))
    return _at(warmer, touches, times) - _at(colder, touches, times)


def _harder(touch: Touch, sign: int) -> Touch:
    return replace(touch, conductance=touch.conductance * math.exp(sign * STEP))


def _at(sensor: Sensor, touches: Sequence[Touch], times: Array) -> Array:
    """Give signals at sampled times, by splines over ln t where these are many.

    A pulse that ends is one that does not, less the same since then: each is smooth in the logarithm of its own time.
    """
    from scipy.interpolate import make_interp_spline

    if not times.size:
        return np.zeros((len(touches), 0))
    drive, here = sensor.drive, sensor.temperatures
    if isinstance(drive, Pulsed) and drive.pulse.duration < times[-1]:
        end, drive = drive.pulse.duration, Pulsed(replace(drive.pulse, duration=math.inf))
        found = _at(replace(sensor, drive=drive), touches, times)
        after = times > end * (1 + 1e-9)
        without = replace(sensor, drive=drive, temperatures=replace(here, object=here.face))
        found[:, after] -= _at(without, touches, times[after] - end)
        return found
    decades = math.log10(times[-1] / times[0])
    count = max(FEWEST, math.ceil(SAMPLES_PER_DECADE * decades) + 1)
    if times.size <= count:
        return responses(sensor, touches, times)
    t = np.geomspace(times[0], times[-1], count)
    spline = make_interp_spline(np.log(t), responses(sensor, touches, t), k=3, axis=1)
    return np.asarray(spline(np.log(times)))


def tell_pairs(
    sensor: Sensor,
    pairs: Sequence[tuple[str, str]],
    sampling: Sampling,
    *,
    at: float,
    until: float | None = None,
    enough: float = ENOUGH,
) -> tuple[Pair, ...]:
    """Tell the objects of pairs apart, each in all contacts: d' at a time (s), and the first time until another (s).

    Each of both objects has its own covariance S of the samples, noise and what is unknown of its touch, and d'^2 = D^T
    ((S_1 + S_2)/2)^-1 D is the distance by their mean (Mahalanobis), the most that linear detectors separate (Fisher).
    If S_1 = S_2, no detector errs less often than Phi(-d'/2); otherwise the best one errs in at most exp(-d'^2/8)/2 of
    the touches (Bhattacharyya), and by simulation within 6 % of Phi(-d'/2) at d' of 1 to 4.5. All of that is to first
    order in ln h. Where h is drawn in full, the best detector errs more often: with a spread of 0.3 and d' = 4.3, of
    steel and glass, in 2.2 % of the touches instead of 1.5 %.
    """
    until = at if until is None else max(at, until)
    named = {name for pair in pairs for name in pair}
    places = [i for i, each in enumerate(sensor.scenarios) if each.object in named]
    seen = spread_signals(sensor, [sensor.scenarios[i].touch for i in places], until, sampling.rate)
    row = {(sensor.scenarios[i].object, sensor.scenarios[i].level): k for k, i in enumerate(places)}
    count = Sampling(1.0, sampling.rate).times(at).size
    found = []
    for first, second in pairs:
        for level in dict.fromkeys(sensor.scenarios[i].level for i in places):
            a, b = row[first, level], row[second, level]
            spreads = np.concatenate([seen.spreads[:, a], seen.spreads[:, b]]) / math.sqrt(2)
            d = d_primes(seen.values[a] - seen.values[b], spreads, sampling.noise)
            told = d >= enough
            after = float(seen.times[told.argmax()]) if told.any() else math.inf
            found.append(Pair(first, second, level, float(d[count - 1]) if count else 0.0, at, after))
    return tuple(found)


def grade(sensor: Sensor, effusivities: Sequence[float], sampling: Sampling, *, at: float) -> tuple[Grade, ...]:
    """Grade effusivities at a time (s), in all contacts that the sensor's first object has; rho c being known."""
    contacts = [each for each in sensor.scenarios if each.object == sensor.scenarios[0].object]
    cases = [(e, each.level, each.touch) for e in effusivities for each in contacts]
    touches, more = [], []
    for e, _, touch in cases:
        touches.append(replace(touch, object=_of_effusivity(sensor, e)))
        more += [replace(touch, object=_of_effusivity(sensor, e * math.exp(sign * STEP))) for sign in (1, -1)]
    seen = spread_signals(sensor, touches, at, sampling.rate)
    changed = _at(sensor, more, seen.times)
    slopes = (changed[0::2] - changed[1::2]) / (2 * STEP)
    found = []
    for i, (e, level, _) in enumerate(cases):
        d = d_primes(slopes[i], seen.spreads[:, i], sampling.noise)
        found.append(Grade(e, level, 1 / float(d[-1]) if d.size and d[-1] else math.inf))
    return tuple(found)


def _of_effusivity(sensor: Sensor, e: float) -> TouchedObject:
    """Make an object of an effusivity, with a usual rho c."""
    material = Material("object", e**2 / (DENSITY * HEAT_CAPACITY), DENSITY, HEAT_CAPACITY)
    return HalfSpace(material) if sensor.pad is None else Disc(material, sensor.pad.radius)
