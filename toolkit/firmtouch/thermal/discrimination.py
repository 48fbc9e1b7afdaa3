"""Which objects a fingertip can tell apart, and how well it knows an effusivity: d' and Fisher's bound.

Samples at k/rate, k >= 1, carry white noise of standard deviation `noise`. What is not known of the contact is a
nuisance: ln h has a prior of some spread, and with g = d theta/d ln h the noise's covariance grows by spread^2 g g^T.
Everything else is known, so that no detector can do better.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from firmtouch.thermal.arrays import Array, Complex, Response, ThermalValueError, require_positive
from firmtouch.thermal.contact_event import ContactEvent
from firmtouch.thermal.inversion import step
from firmtouch.thermal.quadrupole import contact_transfer
from firmtouch.thermal.stack import HalfSpace

ENOUGH = 5.0
"""The d' at which two objects count as told apart."""


@dataclass(frozen=True, slots=True)
class Sampling:
    """White noise of one sample (standard deviation, in the response's unit) and the rate of samples (1/s)."""

    noise: float
    rate: float

    def __post_init__(self) -> None:
        require_positive(noise=self.noise, sampling_rate=self.rate)

    def times(self, until: float) -> Array:
        """Give the samples' times up to one (s); none if it is before the first."""
        require_positive(observation_time=until)
        return np.arange(1, math.floor(until * self.rate * (1 + 1e-12)) + 1) / self.rate


@dataclass(frozen=True, slots=True, eq=False)
class Nuisance:
    """What is not known: how the response changes with it, and its prior's standard deviation."""

    sensitivity: Response
    spread: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.spread) and self.spread >= 0):
            raise ThermalValueError("nuisance's spread", self.spread, "zero or a positive number")


def _d_primes(difference: Array, sampling: Sampling, times: Array, nuisance: Nuisance | None) -> Array:
    """Give d' after each sample: d'^2 = D^T (noise^2 I + spread^2 g g^T)^-1 D, by Sherman and Morrison's formula."""
    variance = sampling.noise**2
    squared = np.cumsum(difference**2) / variance
    if nuisance is not None and nuisance.spread:
        g = nuisance.sensitivity(times)
        shared = np.cumsum(difference * g) / variance
        squared = squared - shared**2 / (1 / nuisance.spread**2 + np.cumsum(g**2) / variance)
    return np.asarray(np.sqrt(np.maximum(0, squared)))


def discriminability(
    first: Response, second: Response, until: float, sampling: Sampling, *, nuisance: Nuisance | None = None
) -> float:
    """Give d' of two responses that are seen until a time (s)."""
    times = sampling.times(until)
    if not times.size:
        return 0.0
    return float(_d_primes(first(times) - second(times), sampling, times, nuisance)[-1])


def time_to_discriminate(
    first: Response,
    second: Response,
    window: float,
    sampling: Sampling,
    *,
    nuisance: Nuisance | None = None,
    enough: float = ENOUGH,
) -> float:
    """Give the first sample's time (s) at which d' >= `enough`; `inf` if there is none within the window (s)."""
    require_positive(enough=enough)
    times = sampling.times(window)
    told = _d_primes(first(times) - second(times), sampling, times, nuisance) >= enough if times.size else times
    return float(times[np.argmax(told)]) if told.any() else math.inf


def effusivity_sensitivity(event: ContactEvent) -> Response:
    """Give d theta/d ln e_o (K) of the sensed plane, for an object that is a half-space: theta Z_o/(Z_s + 1/h + Z_o).

    Raises
    ------
    ThermalValueError
        If the object has no one effusivity that tells all of it.
    """
    if not isinstance(event.touch.object, HalfSpace):
        raise ThermalValueError("effusivity", math.nan, "a half-space's: slabs and discs have sizes besides")

    def of(t: Array) -> Array:
        def transfer(s: Complex) -> Complex:
            found = contact_transfer(event.stack, event.touch, s)
            return -found.sensed * found.object_face

        return event.difference * step(transfer, t)

    return of


def conductance_sensitivity(event: ContactEvent) -> Response:
    """Give d theta/d ln h (K) of the sensed plane: theta (1/h)/(Z_s + 1/h + Z_o)."""

    def of(t: Array) -> Array:
        def transfer(s: Complex) -> Complex:
            found = contact_transfer(event.stack, event.touch, s)
            return found.sensed * found.flux / event.touch.conductance

        return event.difference * step(transfer, t)

    return of


def effusivity_spread(
    event: ContactEvent, until: float, sampling: Sampling, *, conductance_spread: float = 0.0
) -> float:
    """Give the least standard deviation of ln e_o that samples until a time (s) allow (Cramer and Rao).

    `conductance_spread` is the prior's standard deviation of ln h: 0.3 for a contact known to 30 %, 0 for a known one.
    """
    nuisance = Nuisance(conductance_sensitivity(event), conductance_spread)
    found = discriminability(effusivity_sensitivity(event), np.zeros_like, until, sampling, nuisance=nuisance)
    return 1 / found if found else math.inf
