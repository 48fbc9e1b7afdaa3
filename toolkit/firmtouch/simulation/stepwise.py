"""A run under a controller that does not act on the contact force of the same instant: sampled, or delayed.

Time goes in equal steps. Sampled: the law is evaluated at the beginning of each, from what is measured there, and held.
Delayed (the method of steps): the contact force of each step is remembered at Chebyshev's points, and given back where
the delay is over. Disturbances begin and end with the step that is nearest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Final

import casadi as ca
import numpy as np

from firmtouch.mechanics import Array
from firmtouch.simulation.continuous import build_integrator
from firmtouch.simulation.dae import NODES, Dae, Input, nodes, parameters_of
from firmtouch.simulation.samples import Samples, joined, observed
from firmtouch.simulation.scenario import Scenario

CHUNK: Final = 64
"""Steps between two looks at whether the run is over."""
FINE: Final = 0.5
"""The longest step of a delayed loop, in time constants of its fastest part: for a polynomial of degree 7."""
ROUNDING: Final = 1e-9


@dataclass(frozen=True, slots=True)
class Stepper:
    """Maps of one step and of CHUNK of them: (carried, t, noise, parameters) -> (carried, x, lambda, u, Phi).

    `carried` is the state with what is kept of the past. The other outputs have two columns for each step: just after
    its beginning, and just before its end. `step` is in s; a force is given back `kept` steps later.
    """

    step: float
    kept: int
    one: ca.Function
    many: ca.Function


def build_stepper(dae: Dae, tolerance: float) -> Stepper:
    """Set up the map of one step."""
    path = dae.feedback.path
    if dae.input is Input.HELD:
        step, kept = path.sample, path.steps
        one = _sampled_step(dae, tolerance, step, kept)
    else:
        fastest = max(abs(each) for each in dae.loop.poles.reduced)
        longest = min(path.delay, FINE / fastest, path.lag or math.inf)
        kept = math.ceil(path.delay / longest - ROUNDING)
        step = path.delay / kept
        one = _delayed_step(dae, tolerance, step, kept)
    return Stepper(step, kept, one, one.mapaccum("many", CHUNK))


def run_stepwise(
    dae: Dae, stepper: Stepper, scenario: Scenario, x: Array, ended: Callable[[Samples], int | None]
) -> tuple[Samples, float | None]:
    """Go in steps from x at t = 0; gives the samples, and when a step failed, if one did."""
    world, h = scenario.world, stepper.step
    count = max(1, round(scenario.duration / h))
    changes = (round(each / h) for each in world.changes)
    borders = sorted({0, count, *(each for each in changes if 0 < each < count)})
    carried, noise = _first(dae, stepper, x), _noise(dae, scenario, count)
    parts: list[Samples] = []
    k, cautious = 0, False
    while k < count:
        border = next(each for each in borders if each > k)
        size = CHUNK if k + CHUNK <= border and not cautious else 1
        parameters = parameters_of(dae, world, t=(k + 0.5) * h)
        found = _advance(stepper, carried, h * np.arange(k, k + size), noise[:, k : k + size], parameters)
        if found is None:
            if size == 1:
                return joined(parts) if parts else observed_start(dae, x, parameters), k * h
            cautious = True
            continue
        carried, samples = found
        stop = ended(samples)
        parts.append(samples if stop is None else samples.upto(stop + 1))
        if stop is not None:
            break
        k += size
    return joined(parts), None


def observed_start(dae: Dae, x: Array, parameters: Array) -> Samples:
    """Give the start alone."""
    return observed(dae, np.zeros(1), x[:, None], parameters)


def _advance(
    stepper: Stepper, carried: Array, t: Array, noise: Array, parameters: Array
) -> tuple[Array, Samples] | None:
    """Make one or CHUNK steps; None where they fail."""
    run = stepper.one if t.size == 1 else stepper.many
    try:
        found = [each.full() for each in run(carried, t[None, :], noise, np.tile(parameters[:, None], t.size))]
    except RuntimeError:
        return None
    if not all(np.all(np.isfinite(each)) for each in found):
        return None
    last, x, lambda_, u, Phi = found
    instants = np.column_stack([t, t + stepper.step]).ravel()
    return last[:, -1], Samples(instants, x, lambda_, u, Phi)


def _sampled_step(dae: Dae, tolerance: float, step: float, kept: int) -> ca.Function:
    """Evaluate the law on what is measured now, and hold its output; lambda is that under the output before."""
    op, limits = dae.loop.operating_point, dae.feedback.limits
    n, m, states = op.n, op.m, dae.states
    carried = ca.MX.sym("carried", states + m * (kept + 1))
    t, noise, parameters = ca.MX.sym("t"), ca.MX.sym("noise", 2 * n + m), ca.MX.sym("p", dae.layout.size)
    x, recent, oldest = ca.vertsplit(carried, [0, states, states + m * kept, states + m * (kept + 1)])
    measured = noise + ca.vertcat(x[: 2 * n], oldest)
    u = dae.law(measured[:n], measured[n : 2 * n], measured[2 * n :]) + dae.layout.part(parameters, "bias_error")
    u = u if limits is None else ca.fmin(ca.fmax(u, -limits), limits)
    held = dae.layout.with_part(parameters, "held", u)
    end = build_integrator(dae, tolerance, np.ones(1)).function(x0=x, p=ca.vertcat(held, t, step))["xf"]
    begin, later = dae.outputs(t, x, held), dae.outputs(t + step, end, held)
    newest = end[2 * n :] if dae.filtered else later[0]
    after = ca.vertcat(end, newest, recent)  # the newest force first
    return ca.Function("step", [carried, t, noise, parameters], [after, *_pairs((x, *begin), (end, *later))])


def _delayed_step(dae: Dae, tolerance: float, step: float, kept: int) -> ca.Function:
    """Give the force of `kept` steps ago back, and remember that of this one."""
    op = dae.loop.operating_point
    m, states, block = op.m, dae.states, op.m * NODES
    carried = ca.MX.sym("carried", states + kept * block)
    t, noise, parameters = ca.MX.sym("t"), ca.MX.sym("noise", 2 * op.n + m), ca.MX.sym("p", dae.layout.size)
    x, oldest, recent = ca.vertsplit(carried, [0, states, states + block, states + kept * block])
    given = dae.layout.with_part(parameters, "memory", oldest)
    given = dae.layout.with_part(given, "span", ca.vertcat(t, step))
    parts = nodes()
    found = build_integrator(dae, tolerance, parts[1:]).function(x0=x, p=ca.vertcat(given, t, step))["xf"]
    at = [x, *(found[:, i] for i in range(NODES - 1))]
    outputs = [dae.outputs(t + step * part, each, given) for part, each in zip(parts, at, strict=True)]
    after = ca.vertcat(at[-1], recent, *(each[0] for each in outputs))  # the oldest force first
    pairs = _pairs((x, *outputs[0]), (at[-1], *outputs[-1]))
    return ca.Function("step", [carried, t, noise, parameters], [after, *pairs])


def _pairs(begin: Iterable[ca.MX], end: Iterable[ca.MX]) -> list[ca.MX]:
    """Put what a step begins and ends with side by side: x, lambda, u, Phi."""
    return [ca.horzcat(a, b) for a, b in zip(begin, end, strict=True)]


def _first(dae: Dae, stepper: Stepper, x: Array) -> Array:
    """Begin with a past in which the contact force was lambda_d."""
    lambda_d = dae.loop.operating_point.lambda_d
    values = stepper.kept + 1 if dae.input is Input.HELD else stepper.kept * NODES
    return np.concatenate([x, np.tile(lambda_d, values)])


def _noise(dae: Dae, scenario: Scenario, count: int) -> Array:
    """Draw what the sensors add at each sample, (2 n + m) x count."""
    op, noise = dae.loop.operating_point, scenario.feedback.noise
    if noise is None:
        return np.zeros((2 * op.n + op.m, count))
    sigma = np.concatenate([noise.position, noise.velocity, noise.force])
    return sigma[:, None] * np.random.default_rng(noise.seed).normal(size=(sigma.size, count))
