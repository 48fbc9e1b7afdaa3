"""The table of steady-state errors, held against the nonlinear closed loop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation import ClosedLoop, SteadyState, SteadyStateError
from firmtouch.regulation.steady_state import WorstCase
from firmtouch.simulation.run import Simulator, build_simulator, simulate
from firmtouch.simulation.scenario import Feedback, Scenario, Start
from firmtouch.simulation.trajectory import Outcome
from firmtouch.simulation.usual import SMALL
from firmtouch.simulation.world import Disturbance, World, nominal_world, tilted

FEW: Final = 1.0
"""Instants that are kept of each period of the fastest pole: it is the end that counts."""
HALVINGS: Final = 2
REST: Final = 24.0
"""How long is simulated, in units of 1/|slowest decay rate|: what is left then is 4e-11 of the error."""
LONGEST: Final = 600.0
EXACT: Final = 1e-7
"""Relative deviations below this are the integrator's, and have no order."""
TURNED: Final = 0.9
"""The cosine between two deviations of one order: they point the same way."""


@dataclass(frozen=True, slots=True)
class SimulatedError:
    """One effect of one worst cause, simulated for the cause and for it halved, and halved again.

    `parts` are those of the table's worst cause (1, 1/2, 1/4; less where the file bounds none), `effects` (3 x n or m)
    what the loop came to rest with, `deviations` how far each is from the first-order prediction, relative to that.
    `order` is that of the relative deviation at the last halving: 1 where the prediction is exact in first order. It is
    NaN where nothing deviates, where the deviation changes its direction (it is not yet of one order),
    and where the loop did not come to rest there, which `outcome` tells.
    """

    parts: Array
    effects: Array
    deviations: Array
    order: float
    outcome: Outcome


@dataclass(frozen=True, slots=True)
class SimulatedSteadyState:
    """The table: `force`, `offset`, `rotation`, `tilt`, each the position's and the constraint force's worst case.

    An entry is None where there is no such effect.
    """

    force: tuple[SimulatedError | None, SimulatedError | None]
    offset: tuple[SimulatedError | None, SimulatedError | None]
    rotation: tuple[SimulatedError | None, SimulatedError | None]
    tilt: tuple[SimulatedError | None, SimulatedError | None]


def simulate_steady_state(
    loop: ClosedLoop, errors: SteadyState, simulator: Simulator | None = None
) -> SimulatedSteadyState:
    """Let every worst case of the table come to rest on the nonlinear plant, with controller (17).

    A `simulator` of that controller saves deriving it; its drives may be limited. Without one they are not.
    """
    op = loop.operating_point
    nominal = nominal_world(op)
    slowest = min(abs(each.real) for each in loop.poles.reduced)
    still = Start(op.q_d, frozen(np.zeros(op.n)))
    feedback = Feedback() if simulator is None else simulator.dae.feedback
    scenario = Scenario("rest", "", feedback, still, nominal, min(LONGEST, REST / max(slowest, 1e-6)))
    bench = _Bench(loop, scenario, simulator or build_simulator(loop, scenario))
    worlds: dict[str, Callable[[Array], World]] = {
        "force": lambda d: replace(nominal, disturbances=(Disturbance(d),)),
        "offset": lambda Delta: replace(nominal, Delta=frozen(Delta)),
        "rotation": lambda cause: replace(nominal, R=_rotation(op.lambda_d, cause)),
        "tilt": lambda d: tilted(op, nominal, d),
    }
    found = {name: bench.row(name, getattr(errors, name), world) for name, world in worlds.items()}
    return SimulatedSteadyState(**found)


@dataclass(frozen=True, slots=True)
class _Bench:
    """A loop that comes to rest in one world after the other."""

    loop: ClosedLoop
    scenario: Scenario
    simulator: Simulator

    def row(
        self, name: str, error: SteadyStateError, world: Callable[[Array], World]
    ) -> tuple[SimulatedError | None, SimulatedError | None]:
        size = 1.0 if error.given else SMALL.get(name, SMALL["tilt"])
        position = self._effect(error.worst_position, size, world, position=True)
        return position, self._effect(error.worst_constraint_force, size, world, position=False)

    def _effect(
        self, worst: WorstCase, size: float, world: Callable[[Array], World], *, position: bool
    ) -> SimulatedError | None:
        if not worst.value:
            return None
        parts = 0.5 ** np.arange(HALVINGS + 1)
        effects, outcome = [], Outcome.CONVERGED
        for part in parts:
            scenario = replace(self.scenario, world=world(frozen(part * size * worst.cause)))
            end = simulate(self.loop, scenario, simulator=self.simulator, per_period=FEW)
            op = self.loop.operating_point
            effects.append(end.q[-1] - op.q_d if position else end.lambda_[-1] - op.lambda_d)
            outcome = outcome if end.outcome is Outcome.CONVERGED else end.outcome
        predicted = parts[:, None] * size * worst.effect
        off = np.array(effects) - predicted
        deviations = np.linalg.norm(off, axis=1) / np.linalg.norm(predicted, axis=1)
        directions = off / np.maximum(np.linalg.norm(off, axis=1), np.finfo(float).tiny)[:, None]
        same_way = bool(np.all(np.sum(directions[1:] * directions[:-1], axis=1) > TURNED))
        measurable = outcome is Outcome.CONVERGED and deviations[-1] > EXACT and same_way
        order = float(np.log2(deviations[-2] / deviations[-1])) if measurable else np.nan
        return SimulatedError(frozen(size * parts), frozen(effects), frozen(deviations), order, outcome)


def _rotation(lambda_d: Array, cause: Array) -> Array:
    """Give the rotation R in the plane of lambda_d and the cause with (R^T - I) lambda_d = cause in first order."""
    m, size = lambda_d.size, float(np.linalg.norm(lambda_d))
    length = float(np.linalg.norm(cause))
    along, across = lambda_d / size, cause / length
    angle = length / size
    plane = np.column_stack([along, across])
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return frozen(np.eye(m) + plane @ (turn - np.eye(2)) @ plane.T)
