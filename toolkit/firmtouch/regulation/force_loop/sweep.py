"""The poles over the contact's stiffness [T9]: where they are stable, and from where on they are those of (38)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.modelfile.sections.design import DesignSpec
from firmtouch.modelfile.sections.region import RegionSpec
from firmtouch.regulation.closed_loop import ClosedLoop, match_poles
from firmtouch.regulation.force_loop.contact import Complex, Contact, DelayTooLongError, contact_of, contact_poles
from firmtouch.regulation.force_loop.path import ForcePath

SOFTEST: Final = 1e3
STIFFEST: Final = 1e7
PER_DECADE: Final = 10
APART: Final = 0.10
"""How far, relative to itself, the slowest pole may be from the one it tends to, where poles were assigned."""
LEEWAY: Final = 0.01
"""By how much, relatively, an edge of the region may be missed: gains are often chosen right on it."""
_HALVINGS: Final = 20
_STRONGEST: Final = 1e6


@dataclass(frozen=True, slots=True)
class ContactPoles:
    """The poles for one stiffness: all that are computed, the slowest first, and those that belong to (38).

    `stiffness` has an entry for each constraint, in N/m, or N m/rad where the constraint is in rad. `tangent` are the
    2(n - m) poles nearest to those of (38), in the order of these; `kept` says whether they are still what the design
    asks for.
    """

    stiffness: Array
    poles: tuple[complex, ...]
    tangent: tuple[complex, ...]
    kept: bool

    @property
    def stable(self) -> bool:
        """Tell whether all poles have negative real parts."""
        return self.poles[0].real < 0


@dataclass(frozen=True, slots=True)
class Span:
    """Stiffnesses from `low` to `high`; an end of the sweep is told as 0 or as infinity."""

    low: float
    high: float


@dataclass(frozen=True, slots=True)
class StiffnessSweep:
    """Poles over a common stiffness k_e: that many N/m (N m/rad for constraints in rad) for every constraint.

    `rigid` are the poles of (38). `unstable` are the stiffnesses with a pole that is not stable, found on the grid and
    then by bisection: what is narrower than a step of the grid may be missed.

    `kept_from` is the least stiffness from which on, up to the sweep's end, the poles that belong to (38) are what the
    design asks for: within the region (`by_region`; an edge may be missed by 1 %), or the slowest one within 10 % of
    its place. It is infinite if they are not so even at the end.
    """

    rigid: tuple[complex, ...]
    points: tuple[ContactPoles, ...]
    unstable: tuple[Span, ...]
    kept_from: float
    by_region: bool

    @property
    def stiffness(self) -> Array:
        """The common stiffnesses k_e, ascending."""
        return frozen([float(each.stiffness[0]) for each in self.points])


class _Goal:
    """What the design asks of the poles that belong to (38)."""

    def __init__(self, rigid: tuple[complex, ...], region: RegionSpec | None) -> None:
        edges = region and (region.decay, region.damping, region.bandwidth)
        self.rigid, self.region = rigid, region if edges and any(edges) else None

    def kept(self, tangent: tuple[complex, ...]) -> bool:
        if self.region is None:
            slowest = max(range(len(tangent)), key=lambda i: tangent[i].real)
            return abs(tangent[slowest] - self.rigid[slowest]) <= APART * abs(self.rigid[slowest])
        decay, damping, bandwidth = (
            self.region.decay or 0.0,
            self.region.damping or 0.0,
            self.region.bandwidth or np.inf,
        )
        return all(
            -s.real >= (1 - LEEWAY) * max(decay, damping * abs(s)) and abs(s) <= (1 + LEEWAY) * bandwidth
            for s in tangent
        )


def poles_in_contact(
    loop: ClosedLoop, path: ForcePath | None, stiffness: Array, design: DesignSpec | None = None
) -> ContactPoles:
    """Give the poles of a design for one stiffness of each constraint (m), in N/m or N m/rad; no path is L = 1.

    Raises
    ------
    DelayTooLongError
        If the delay is too long beside the contact's motion for the poles to be computed.
    """
    return _at(contact_of(loop), path or ForcePath(), np.asarray(stiffness, dtype=float), _goal(loop, design))


def contact_stiffness_sweep(
    loop: ClosedLoop,
    path: ForcePath | None,
    design: DesignSpec | None = None,
    *,
    softest: float = SOFTEST,
    stiffest: float = STIFFEST,
) -> StiffnessSweep:
    """Sweep a common stiffness of all constraints, 1e3 to 1e7 (N/m, or N m/rad) unless told otherwise.

    Without a path L = 1. `design` says what is asked of the poles; without it, their places are. The sweep ends earlier
    where a long delay would need more states than are computed.
    """
    contact, path, goal = contact_of(loop), path or ForcePath(), _goal(loop, design)
    each = np.ones(loop.operating_point.m)

    def at(k: float) -> ContactPoles:
        return _at(contact, path, k * each, goal)

    count = 1 + int(np.ceil(PER_DECADE * np.log10(stiffest / softest)))
    points = []
    for k in np.geomspace(softest, stiffest, max(count, 2)):
        try:
            points.append(at(float(k)))
        except DelayTooLongError:
            break
    return StiffnessSweep(
        rigid=goal.rigid,
        points=tuple(points),
        unstable=_spans(points, at),
        kept_from=_kept_from(points, at),
        by_region=goal.region is not None,
    )


def critical_feedback(loop: ClosedLoop, path: ForcePath | None, stiffness: Array) -> float:
    """Give the least g > 0 for which G_f = g I puts a pole on the edge of stability [T9].

    The stiffnesses are those of the constraints (m); the loop's own G_f plays no part. Found on a grid of 10 points a
    decade up to 1e6, then by bisection; infinite if there is none, and 0 if the loop is not stable without feedback.

    Raises
    ------
    DelayTooLongError
        If the delay is too long beside the contact's motion for the poles to be computed.
    """
    contact, path, stiffness = contact_of(loop), path or ForcePath(), np.asarray(stiffness, dtype=float)
    eye = np.eye(loop.operating_point.m)

    def stable(g: float) -> bool:
        at = path if g else ForcePath()
        return bool(contact_poles(contact.with_feedback(g * eye), at, stiffness)[0].real < 0)

    if not stable(0.0):
        return 0.0
    last = 0.0
    for g in np.geomspace(1e-3, _STRONGEST, 1 + 9 * PER_DECADE):
        if not stable(float(g)):
            return _bisect(last, float(g), lambda each: not stable(each))
        last = float(g)
    return np.inf


def _goal(loop: ClosedLoop, design: DesignSpec | None) -> _Goal:
    region = design.region if design is not None and design.method == "region" else None
    return _Goal(loop.poles.reduced, region)


def _at(contact: Contact, path: ForcePath, stiffness: Array, goal: _Goal) -> ContactPoles:
    poles = _plain(contact_poles(contact, path, stiffness))
    tangent = match_poles(poles, goal.rigid)
    return ContactPoles(frozen(stiffness), poles, tangent, goal.kept(tangent))


def _plain(poles: Complex) -> tuple[complex, ...]:
    return tuple(complex(each) for each in poles)


def _spans(points: list[ContactPoles], at: Callable[[float], ContactPoles]) -> tuple[Span, ...]:
    """Join neighbouring stiffnesses without stability, and find each end."""
    edges = [0.0] if points and not points[0].stable else []
    for before, after in pairwise(points):
        if before.stable and not after.stable:
            edges.append(_edge(before, after, lambda k: not at(k).stable))
        elif after.stable and not before.stable:
            edges.append(_edge(before, after, lambda k: at(k).stable))
    edges += [np.inf] * (len(edges) % 2)
    return tuple(Span(low, high) for low, high in zip(edges[::2], edges[1::2], strict=True))


def _kept_from(points: list[ContactPoles], at: Callable[[float], ContactPoles]) -> float:
    lost = [i for i, each in enumerate(points) if not each.kept]
    if not points or (lost and lost[-1] == len(points) - 1):
        return np.inf
    if not lost:
        return 0.0
    return _edge(points[lost[-1]], points[lost[-1] + 1], lambda k: at(k).kept)


def _edge(before: ContactPoles, after: ContactPoles, changed: Callable[[float], bool]) -> float:
    low, high = np.log(float(before.stiffness[0])), np.log(float(after.stiffness[0]))
    return float(np.exp(_bisect(low, high, lambda each: changed(float(np.exp(each))))))


def _bisect(low: float, high: float, changed: Callable[[float], bool]) -> float:
    """Find where something changes; it has not at `low`, and has at `high`."""
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        if changed(middle):
            high = middle
        else:
            low = middle
    return high
