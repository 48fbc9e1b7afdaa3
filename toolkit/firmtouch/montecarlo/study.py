"""A study: everything that one of its runs is made of, so that any process can run any of them by its label."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.montecarlo.draw import draw, generator
from firmtouch.montecarlo.proven import Region, start_inside
from firmtouch.montecarlo.record import OFF, Label, Record, record_of
from firmtouch.montecarlo.sets import Sets
from firmtouch.regulation import ClosedLoop
from firmtouch.regulation.controllers import Controller
from firmtouch.regulation.projection import OffSurfaceError
from firmtouch.simulation.from_file import drive_limits, usual_duration
from firmtouch.simulation.run import Simulator, build_simulator, simulate
from firmtouch.simulation.scenario import Feedback, Scenario, Start
from firmtouch.simulation.trajectory import Outcome, Trajectory
from firmtouch.simulation.world import nominal_world

PROVEN: Final = (Controller.AFFINE, Controller.ENERGY_WITH_FORCE)
"""The controllers (15) and (11) that [T10] is about."""
MOST_STRETCHES: Final = 20
"""How many times the usual duration a start inside a proven region is followed at most: near another equilibrium a
motion lingers."""


@dataclass(frozen=True, slots=True)
class Study:
    """A scenario, what is drawn around it, and the regions that starts inside the proof are drawn from.

    `bilateral` is the loop with contacts that may pull, as the proof has them; `insiders` are the simulators of
    controllers (15) and (11).
    """

    loop: ClosedLoop
    base: Scenario
    sets: Sets
    seed: int
    regions: tuple[Region, ...]
    bilateral: ClosedLoop = field(repr=False)
    simulator: Simulator = field(repr=False)
    insiders: tuple[Simulator, ...] = field(repr=False)


def nominal_scenario(loop: ClosedLoop) -> Scenario:
    """Give the scenario of a study without a file: controller (17), the model with its drives, at rest at q_d."""
    op = loop.operating_point
    start = Start(op.q_d, frozen(np.zeros(op.n)))
    return Scenario(
        "nominal", "the model itself", Feedback(limits=drive_limits(op)), start, nominal_world(op), usual_duration(loop)
    )


def build_study(
    loop: ClosedLoop, base: Scenario, sets: Sets, *, seed: int, regions: tuple[Region, ...] = (), runs: int = 1
) -> Study:
    """Derive the equations of all runs, once; for many `runs` around the scenario they are worth compiling."""
    bilateral = _bilateral(loop)
    insiders = tuple(build_simulator(bilateral, _inside(bilateral, each)) for each in PROVEN) if regions else ()
    return Study(loop, base, sets, seed, regions, bilateral, build_simulator(loop, base, runs=runs), insiders)


def run_labelled(study: Study, label: Label) -> tuple[Record, Trajectory | None]:
    """Run one of a study's runs; no trajectory if its start cannot be put onto the true surface."""
    rng, op = generator(study.seed, label), study.loop.operating_point
    if label.proven:
        return _run_inside(study, label, rng)
    scenario = draw(op, study.base, study.sets, rng)
    try:
        trajectory = simulate(study.loop, scenario, simulator=study.simulator)
    except OffSurfaceError as error:
        return Record(label, OFF, str(error)), None
    return record_of(label, trajectory, op, scenario.feedback.limits), trajectory


def _run_inside(study: Study, label: Label, rng: np.random.Generator) -> tuple[Record, Trajectory]:
    """Start inside a proven region, regions and controllers in turn, and follow until it rests, or for long."""
    turn, which = divmod(label.number - 1, len(study.regions))
    region, controller = study.regions[which], turn % len(PROVEN)
    start, V = start_inside(study.loop, region, rng)
    scenario = replace(_inside(study.bilateral, PROVEN[controller]), start=start)
    trajectory = _follow(study.bilateral, scenario, study.insiders[controller])
    record = record_of(label, trajectory, study.loop.operating_point, None)
    return record.with_energy(V, region.level), trajectory


def _follow(loop: ClosedLoop, scenario: Scenario, simulator: Simulator) -> Trajectory:
    """Follow a motion in stretches until it has converged.

    What a stretch calls diverged or elsewhere may be a long way round within the region, or slow: only what has not
    converged after all stretches has not.
    """
    parts = [simulate(loop, scenario, simulator=simulator)]
    while parts[-1].outcome not in (Outcome.CONVERGED, Outcome.STOPPED) and len(parts) < MOST_STRETCHES:
        last = parts[-1]
        if not np.all(np.isfinite([*last.q[-1], *last.qdot[-1]])):
            break
        parts.append(simulate(loop, replace(scenario, start=Start(last.q[-1], last.qdot[-1])), simulator=simulator))
    return _joined(parts, scenario)


def _joined(parts: list[Trajectory], scenario: Scenario) -> Trajectory:
    if len(parts) == 1:
        return parts[0]
    ends = np.cumsum([0.0, *(float(each.t[-1]) for each in parts)])

    def column(name: str) -> Array:
        return frozen(np.concatenate([getattr(each, name) for each in parts]))

    return replace(
        parts[-1],
        scenario=scenario,
        t=frozen(np.concatenate([each.t + begin for each, begin in zip(parts, ends[:-1], strict=True)])),
        q=column("q"),
        qdot=column("qdot"),
        lambda_=column("lambda_"),
        u=column("u"),
        Phi=column("Phi"),
        moved=parts[0].moved,
    )


def _inside(loop: ClosedLoop, controller: Controller) -> Scenario:
    """Give what the proof is about: the model itself, undisturbed, drives without limits, an ideal force path."""
    title = f"inside the proven region, controller ({controller.value})"
    return replace(nominal_scenario(loop), name="inside", title=title, feedback=Feedback(controller))


def _bilateral(loop: ClosedLoop) -> ClosedLoop:
    """Let every contact pull as well as push."""
    op = loop.operating_point
    spec = op.plant.spec
    if not any(each.one_sided for each in spec.constraints.values()):
        return loop
    plant = replace(op.plant, spec=spec.all_two_sided())
    return replace(loop, operating_point=replace(op, plant=plant))
