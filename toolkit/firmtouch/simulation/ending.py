"""Where a run must end before its time: contact that is lost, joints beyond their limits, motion that runs away."""

from __future__ import annotations

from typing import Final

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.modelfile.vector_units import units_of
from firmtouch.regulation import ClosedLoop, OperatingPoint
from firmtouch.simulation.samples import Samples

FAR: Final = 1.0
"""A motion this far from q_d (rad or m), and FURTHER times as far as it began, has run away."""
FURTHER: Final = 3.0
STRONG: Final = 1e3
"""A contact force this many times what the operating point knows of has run away."""


def force_scale(op: OperatingPoint) -> float:
    """Give the size of the forces that the operating point knows of, in SI: 1 + max |lambda_d| + max |g|."""
    return 1 + float(np.max(np.abs(op.lambda_d))) + float(np.max(np.abs(op.g)))


def contact_signs(op: OperatingPoint) -> Array:
    """Give for each constraint the sign that lambda must keep, m: that of lambda_d (+ for zero), or 0 for any."""
    one_sided = np.array([each.one_sided for each in op.plant.spec.constraints.values()])
    return np.where(one_sided, np.where(op.lambda_d < 0, -1.0, 1.0), 0.0)


def lost_contact(samples: Samples, signs: Array) -> int | None:
    """Find the first instant from which the force of a one-sided contact pulls, or would before the next instant.

    Between evenly spaced instants lambda is taken as the parabola through three of them, so that a short dip is not
    missed; elsewhere it may jump.
    """
    force = signs[:, None] * np.where(np.isfinite(samples.lambda_), samples.lambda_, 0.0)  # `ran_away` has the others
    steps = np.diff(samples.t)
    even = np.isclose(steps[1:], steps[:-1], rtol=1e-3, atol=0.0)
    pulls = np.any(force < 0, axis=0)
    before, here, after = force[:, :-2], force[:, 1:-1], force[:, 2:]
    bend, slope = (before - 2 * here + after) / 2, (after - before) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        lowest = here - slope**2 / (4 * bend)
        dips = (bend > 0) & (np.abs(slope) < 2 * bend) & (lowest < 0)
    pulls[1:-1] |= np.any(dips, axis=0) & even
    return int(np.argmax(pulls)) if np.any(pulls) else None


def beyond_limits(samples: Samples, op: OperatingPoint) -> tuple[int, str] | None:
    """Find the first instant at which a joint is beyond its position limits or faster than it can be, and say which."""
    n, coordinates = op.n, op.plant.spec.coordinates
    lower, upper, fastest = (
        np.array(each)[:, None]
        for each in zip(*((c.lower, c.upper, c.fastest) for c in coordinates.values()), strict=True)
    )
    q, qdot = samples.x[:n], samples.x[n : 2 * n]
    wrong = (q < lower) | (q > upper) | (np.abs(qdot) > fastest)
    ended = np.any(wrong, axis=0)
    if not np.any(ended):
        return None
    i = int(np.argmax(ended))
    j = int(np.argmax(wrong[:, i]))
    name, each = list(coordinates.items())[j]
    if abs(qdot[j, i]) > fastest[j, 0]:
        return i, f"`{name}` moved at {abs(qdot[j, i]):.3g} {each.unit}/s, and {each.fastest:.3g} is its limit"
    return i, f"`{name}` was at {q[j, i]:.4g} {each.unit}, and its limits are {each.lower:.4g} to {each.upper:.4g}"


def ran_away(samples: Samples, loop: ClosedLoop, distance: float) -> tuple[int, str] | None:
    """Find the first instant at which the motion or the force has run away, and say which; `distance` is the start's.

    Numbers that are not finite have run away too.
    """
    op = loop.operating_point
    with np.errstate(invalid="ignore"):
        far = np.max(np.abs(samples.x[: op.n] - op.q_d[:, None]), axis=0)
        near = far <= max(FAR, FURTHER * distance)
        weak = np.max(np.abs(samples.lambda_), axis=0) <= STRONG * force_scale(op)
    ended = ~(near & weak)
    if not np.any(ended):
        return None
    i = int(np.argmax(ended))
    if not near[i]:
        return i, f"it was {far[i]:.3g} {units_of(op.plant.spec).coordinate or 'rad or m'} from q_d"
    return i, f"the contact force had grown to {np.max(np.abs(samples.lambda_[:, i])):.3g} (in SI)"
