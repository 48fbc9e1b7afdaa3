"""`simulate`: a scenario and a closed loop -> a trajectory."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.modelfile.vector_units import units_of
from firmtouch.regulation import ClosedLoop, OperatingPoint
from firmtouch.regulation.equilibrium import Equilibrium, NoEquilibriumError, solve_rest
from firmtouch.simulation.continuous import PER_PERIOD, ContinuousRun, Integrator, build_integrator, even_points
from firmtouch.simulation.dae import Dae, Input, derive_dae, input_of, parameters_of
from firmtouch.simulation.ending import beyond_limits, contact_signs, force_scale, lost_contact, ran_away
from firmtouch.simulation.many import with_fast_outputs
from firmtouch.simulation.on_demand import OnDemand
from firmtouch.simulation.samples import Samples
from firmtouch.simulation.scenario import Feedback, Scenario
from firmtouch.simulation.start import consistent_start
from firmtouch.simulation.stepwise import Stepper, build_stepper, run_stepwise
from firmtouch.simulation.trajectory import Outcome, Trajectory
from firmtouch.simulation.world import World

TOLERANCE: Final = 1e-10
ARRIVED: Final = 1e-3
"""Distance from an equilibrium (rad or m), speed (per second) and part of the forces that count as rest there."""
NEAR_LIMIT: Final = 0.98
"""The part of a drive's limit up to which it is certainly not at it: samples are a sixteenth of a period apart."""
AT_REST: Final = 1e-5
"""Distance from q_d (rad or m) of which no word is worth making."""


@dataclass(frozen=True, slots=True)
class Simulator:
    """A closed loop under one feedback, ready to run in any world with this number of swinging disturbances.

    Where `limited` is given, `dae` holds while no drive reaches its limit, and that is the one for all else.
    """

    dae: Dae
    machine: Integrator | Stepper
    limited: OnDemand[Simulator] | None = None


def build_simulator(loop: ClosedLoop, scenario: Scenario, *, tolerance: float = TOLERANCE, runs: int = 1) -> Simulator:
    """Derive the equations of a scenario's feedback, and set up their integrator, for a number of `runs` to come."""
    feedback, sinusoids = scenario.feedback, len(scenario.world.sinusoids)
    if input_of(feedback) is not Input.CONTACT or feedback.limits is None:
        return _build(loop, feedback, sinusoids, tolerance, runs)
    limited = OnDemand(partial(_build, loop, feedback, sinusoids, tolerance, runs))
    free = _build(loop, feedback, sinusoids, tolerance, runs, within_limits=True)
    return replace(free, limited=limited)


def _build(
    loop: ClosedLoop, feedback: Feedback, sinusoids: int, tolerance: float, runs: int, *, within_limits: bool = False
) -> Simulator:
    dae = derive_dae(loop, feedback, sinusoids=sinusoids, within_limits=within_limits)
    if dae.input in (Input.HELD, Input.REMEMBERED):
        return Simulator(dae, build_stepper(dae, tolerance))
    machine = build_integrator(dae, tolerance, even_points(), runs=runs)
    return Simulator(with_fast_outputs(dae, runs), machine)


def simulate(
    loop: ClosedLoop,
    scenario: Scenario,
    *,
    simulator: Simulator | None = None,
    tolerance: float = TOLERANCE,
    per_period: float = PER_PERIOD,
) -> Trajectory:
    """Run a scenario; a `simulator` of the same loop and feedback saves deriving it again.

    Where the end alone matters, fewer instants `per_period` of the fastest pole save time.

    Raises
    ------
    OffSurfaceError
        If the start cannot be put onto the true constraints.
    """
    op, world = loop.operating_point, scenario.world
    simulator = simulator or build_simulator(loop, scenario, tolerance=tolerance)
    dae = simulator.dae
    projection, qdot = consistent_start(op, world, scenario.start)
    x = np.concatenate([projection.q, qdot, op.lambda_d if dae.filtered else []])
    distance = float(np.max(np.abs(projection.q - op.q_d)))
    signs = contact_signs(op)

    def ended(samples: Samples) -> int | None:
        others = [each[0] for each in (ran_away(samples, loop, distance), beyond_limits(samples, op)) if each]
        lost = lost_contact(samples, signs)
        return min(others if lost is None else [lost, *others], default=None)

    samples, failed = _follow(simulator, scenario, x, ended, per_period)
    if simulator.limited is not None and _meets_limits(samples, dae.feedback.limits):
        simulator = simulator.limited()
        samples, failed = _follow(simulator, scenario, x, ended, per_period)
    rest = find_equilibrium(dae, world, float(samples.t[-1]))
    outcome, reason = _ended_early(samples, loop, distance) or _failed(failed) or _at_the_end(samples, op, rest)
    n = op.n
    return Trajectory(
        scenario, frozen(samples.t), frozen(samples.x[:n].T), frozen(samples.x[n : 2 * n].T),
        frozen(samples.lambda_.T), frozen(samples.u.T), frozen(samples.Phi.T),
        outcome, reason, projection.moved, rest,
    )  # fmt: skip


def _follow(
    simulator: Simulator, scenario: Scenario, x: Array, ended: Callable[[Samples], int | None], per_period: float
) -> tuple[Samples, float | None]:
    if isinstance(simulator.machine, Integrator):
        run = ContinuousRun(simulator.dae, simulator.machine, ended, per_period)
        return run.follow(scenario.world, x, scenario.duration)
    return run_stepwise(simulator.dae, simulator.machine, scenario, x, ended)


def _meets_limits(samples: Samples, limits: Array | None) -> bool:
    """Tell whether a drive comes to its limit, or so near to it that it may between two samples."""
    return limits is not None and not np.all(np.abs(samples.u) <= NEAR_LIMIT * limits[:, None])


def find_equilibrium(dae: Dae, world: World, t: float) -> Equilibrium | None:
    """Find where the closed loop rests near the regulation point under what acts just after t, by Newton's method."""
    parameters = parameters_of(dae, world, t=t)

    def balance(q: Array, lambda_: Array) -> tuple[Array, Array]:
        error, slope = (each.full() for each in dae.residual(np.concatenate([q, lambda_]), parameters))
        return error.ravel(), slope

    try:
        return solve_rest(dae.loop.operating_point, balance)
    except NoEquilibriumError:
        return None


def _ended_early(samples: Samples, loop: ClosedLoop, distance: float) -> tuple[Outcome, str] | None:
    """Tell whether the last sample is where the run had to end."""
    op, t = loop.operating_point, float(samples.t[-1])
    if not np.all(np.isfinite(samples.lambda_[:, -1])):
        return _failed(t)
    away = ran_away(samples, loop, distance)
    if away is not None:
        return Outcome.DIVERGED, f"diverged at {t:.4g} s: {away[1]}"
    beyond = beyond_limits(samples.since(-1), op)
    if beyond is not None:
        return Outcome.BEYOND_LIMITS, f"went beyond a limit at {t:.4g} s: {beyond[1]}"
    force = contact_signs(op) * samples.lambda_[:, -1]
    if np.any(force < 0):
        name = list(op.plant.spec.constraints)[int(np.argmin(force))]
        return Outcome.CONTACT_LOST, (
            f"lost contact at {t:.4g} s: from there on `{name}` would have to pull, and it is one-sided"
        )
    return None


def _failed(t: float | None) -> tuple[Outcome, str] | None:
    if t is None:
        return None
    return Outcome.STOPPED, f"could not be followed beyond {t:.4g} s: J or the force loop becomes singular there"


def _at_the_end(samples: Samples, op: OperatingPoint, rest: Equilibrium | None) -> tuple[Outcome, str]:
    """Tell whether the last sample is at rest, and where."""
    t, q, qdot = float(samples.t[-1]), samples.x[: op.n, -1], samples.x[op.n : 2 * op.n, -1]
    unit = units_of(op.plant.spec).coordinate or "rad or m"
    speed, distance = float(np.max(np.abs(qdot))), float(np.max(np.abs(q - op.q_d)))
    where = "at q_d" if distance < AT_REST else f"{distance:.2g} {unit} from q_d"
    if speed > ARRIVED:
        return Outcome.MOVING, f"still moved at {t:.4g} s, at up to {speed:.2g} {unit} per second"
    if rest is not None and np.max(np.abs(q - rest.q)) <= ARRIVED:
        away = float(np.max(np.abs(samples.lambda_[:, -1] - rest.lambda_)))
        if away > ARRIVED * force_scale(op):
            return Outcome.MOVING, f"the contact force still moved at {t:.4g} s, {away:.3g} (in SI) from its rest"
        return Outcome.CONVERGED, f"came to rest {where}"
    return Outcome.ELSEWHERE, f"came to rest at another equilibrium, {where}"
