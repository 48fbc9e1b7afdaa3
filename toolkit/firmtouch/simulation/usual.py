"""The scenarios that every design is put through: a start error, a force step, an offset and a tilt.

The force signal is ideal in them; where the file has a force path, the start error comes once more, through that.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation import ClosedLoop, SteadyState
from firmtouch.regulation.force_loop import force_path_of
from firmtouch.simulation.from_file import drive_limits, usual_duration
from firmtouch.simulation.scenario import Feedback, Scenario, Start
from firmtouch.simulation.world import Disturbance, World, nominal_world, tilted

START_ERROR: Final = 0.1
"""The start's largest distance from q_d in one coordinate, rad or m."""
STEP_AT: Final = 0.1
"""When the force begins, as a part of the run."""
SMALL: Final = {"force": 1.0, "offset": 1e-3, "tilt": np.deg2rad(1.0)}
"""Causes in SI where the file bounds none: 1 N m or N, 1 mm or 1 mrad, 1 degree."""


def usual_scenarios(loop: ClosedLoop, errors: SteadyState) -> tuple[Scenario, ...]:
    """Make them; the causes are the worst ones within the file's bounds, those for the position first."""
    op = loop.operating_point
    duration, feedback = usual_duration(loop), Feedback(limits=drive_limits(op))
    still, nominal = Start(op.q_d, frozen(np.zeros(op.n))), nominal_world(op)

    def scenario(name: str, title: str, world: World, start: Start = still) -> Scenario:
        return Scenario(name, title, feedback, start, world, duration)

    beside = Start(frozen(op.q_d + _aside(loop)), still.qdot)
    causes = causes_of(errors)
    push = Disturbance(causes["force"], start=STEP_AT * duration)
    found = [
        scenario("start_error", "Let go beside q_d", nominal, beside),
        scenario("force_step", "A constant force begins", replace(nominal, disturbances=(push,))),
        scenario("offset", "The surface is off", replace(nominal, Delta=causes["offset"])),
    ]
    if np.any(op.lambda_d):
        found.append(scenario("tilt", "The surface is tilted", tilted(op, nominal, causes["tilt"])))
    path = force_path_of(op.plant.spec)
    if path is not None:
        again = scenario("force_path", "Let go beside q_d, the force signal through its path", nominal, beside)
        found.append(replace(again, feedback=replace(feedback, path=path)))
    return tuple(found)


def causes_of(errors: SteadyState) -> dict[str, Array]:
    """Give the worst causes for the position (for the offset: the contact force), within the bounds or small ones."""
    chosen = {
        "force": errors.force.worst_position,
        "offset": errors.offset.worst_constraint_force,
        "tilt": errors.tilt.worst_position,
    }
    sizes = {name: 1.0 if getattr(errors, name).given else SMALL[name] for name in chosen}
    return {name: frozen(sizes[name] * worst.cause) for name, worst in chosen.items()}


def _aside(loop: ClosedLoop) -> Array:
    """Give a displacement along the free directions, all of them alike, whose largest entry is START_ERROR."""
    direction = loop.split.V2.sum(axis=1)
    return frozen(START_ERROR * direction / np.max(np.abs(direction)))
