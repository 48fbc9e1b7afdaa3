"""Which objects a fingertip can tell apart, and how well it knows an effusivity: d' and Fisher's bound.

Samples at k/rate, k >= 1, carry white noise of standard deviation `noise`. What is not known of the touch is a
nuisance: ln h has a prior of some spread, and with g = d theta/d ln h the noise's covariance grows by spread^2 g g^T;
a second one, such as the object's temperature, adds its own. Everything else is known, so that no detector can do
better.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

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


def d_primes(difference: Array, spreads: Array, noise: float) -> Array:
    """Give d' after each of n samples: d'^2 = D^T (noise^2 I + G^T G)^-1 D, by Woodbury's formula.

    `difference` D (n) is that of two responses, and each row of `spreads` G (k x n) what a standard deviation of one
    nuisance does to the samples.
    """
    D, G = difference / noise, spreads / noise
    squared = np.cumsum(D**2)
    if G.size:
        shared = np.cumsum(G * D, axis=1).T[..., np.newaxis]
        known = np.cumsum(G[:, np.newaxis] * G, axis=2).transpose(2, 0, 1) + np.eye(len(G))
        squared = squared - (shared * np.linalg.solve(known, shared)).sum(axis=(1, 2))
    return np.asarray(np.sqrt(np.maximum(0, squared)))


def _told_apart(
    first: Response, second: Response, times: Array, sampling: Sampling, nuisances: Sequence[Nuisance]
) -> Array:
    spreads = np.array([each.spread * each.sensitivity(times) for each in nuisances if each.spread])
    return d_primes(first(times) - second(times), spreads, sampling.noise)


def discriminability(
    first: Response, second: Response, until: float, sampling: Sampling, *, nuisances: Sequence[Nuisance] = ()
) -> float:
    """Give d' of two responses that are seen until a time (s), whatever the nuisances are."""
    times = sampling.times(until)
    if not times.size:
        return 0.0
    return float(_told_apart(first, second, times, sampling, nuisances)[-1])


def time_to_discriminate(
    first: Response,
    second: Response,
    window: float,
    sampling: Sampling,
    *,
    nuisances: Sequence[Nuisance] = (),
    enough: float = ENOUGH,
) -> float:
    """Give the first sample's time (s) at which d' >= `enough`; `inf` if there is none within the window (s)."""
    require_positive(enough=enough)
    times = sampling.times(window)
    told = _told_apart(first, second, times, sampling, nuisances) >= enough if times.size else times
    return float(times[np.argmax(told)]) if told.any() else math.inf


def _by_contact(event: ContactEvent, s: Complex) -> Complex:
    """Give what a source in the contact does to the sensed plane; a change of 1/h or Z_o is one, times the flux."""
    return contact_transfer(event.stack, replace(event.touch, air=0.0), s).sensed


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
            return -_by_contact(event, s) * contact_transfer(event.stack, event.touch, s).object_face

        return event.difference * step(transfer, t)

    return of


def conductance_sensitivity(event: ContactEvent) -> Response:
    """Give d theta/d ln h (K) of the sensed plane: theta (1/h)/(Z_s + 1/h + Z_o)."""

    def of(t: Array) -> Array:
        def transfer(s: Complex) -> Complex:
            flux = contact_transfer(event.stack, event.touch, s).flux
            return _by_contact(event, s) * flux / event.touch.conductance

        return event.difference * step(transfer, t)

    return of


def effusivity_spread(
    event: ContactEvent, until: float, sampling: Sampling, *, conductance_spread: float = 0.0
) -> float:
    """Give the least standard deviation of ln e_o that samples until a time (s) allow (Cramer and Rao).

    `conductance_spread` is the prior's standard deviation of ln h: 0.3 for a contact known to 30 %, 0 for a known one.
    """
    nuisance = Nuisance(conductance_sensitivity(event), conductance_spread)
    found = discriminability(effusivity_sensitivity(event), np.zeros_like, until, sampling, nuisances=[nuisance])
    return 1 / found if found else math.inf
