"""Our figures against MuJoCo's: where the loop rests, what the contact's compliance explains, and how it moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.oracle.run import RAMP, OracleRest, move_in_mujoco, settle_in_mujoco
from firmtouch.oracle.stiffness import DEFAULT, VERY_STIFF, ContactStiffness
from firmtouch.regulation import ClosedLoop, Equilibrium, closed_loop_equilibrium
from firmtouch.regulation.steady_state import offset_matrices

SMALL: Final = 1e-4
"""Start of a free motion, in rad or m: far above what a very stiff contact gives way, and small enough to be linear."""
SPAN: Final = 5.0
"""How long it is watched, in time constants of the slowest pole."""


@dataclass(frozen=True, slots=True)
class Difference:
    """MuJoCo's minus ours: q (n, rad or m) and lambda_ (m, N or N m)."""

    q: Array
    lambda_: Array

    @property
    def position(self) -> float:
        """Norm of the difference in q."""
        return float(np.linalg.norm(self.q))

    @property
    def constraint_force(self) -> float:
        """Norm of the difference in lambda."""
        return float(np.linalg.norm(self.lambda_))


@dataclass(frozen=True, slots=True)
class Comparison:
    """Steady states of MuJoCo's arm and of ours, and what separates them.

    `rigid` is our exact equilibrium, `moved` the same with the surface moved to where MuJoCo's contact rests, Phi =
    -penetration. `raw` is MuJoCo's minus `rigid`, `explained` what is left of it against `moved`, `predicted` what the
    offset row (31), (32) of the table makes of the penetration, to be held against `raw`. `give` is the penetration
    minus compliance times force: MuJoCo's own account of it.
    """

    rest: OracleRest
    rigid: Equilibrium
    moved: Equilibrium
    raw: Difference
    explained: Difference
    predicted: Difference
    give: Array


@dataclass(frozen=True, slots=True)
class MotionComparison:
    """A small free motion: times (k, seconds), x2 of MuJoCo's arm and of Eq. (38), each k x (n - m)."""

    t: Array
    mujoco: Array
    linear: Array

    @property
    def deviation(self) -> float:
        """The largest distance between the two, relative to the start."""
        apart = np.linalg.norm(self.mujoco - self.linear, axis=1).max()
        return float(apart / np.linalg.norm(self.linear[0]))


def compare_with_mujoco(
    loop: ClosedLoop,
    *,
    stiffness: ContactStiffness = DEFAULT,
    timestep: float = 5e-4,
    duration: float | None = None,
    d: ArrayLike = 0.0,
    ramp: float = RAMP,
) -> Comparison:
    """Compare steady states under controller (17) and a constant disturbance `d` (n), Eq. (21).

    `timestep`, `duration` and `ramp` are in seconds, as in `settle_in_mujoco`, whose errors this raises too.

    Raises
    ------
    NoEquilibriumError
        If our own loop has no rest under the disturbance.
    """
    rigid = closed_loop_equilibrium(loop, d=d)
    rest = settle_in_mujoco(loop, stiffness=stiffness, timestep=timestep, duration=duration, d=d, ramp=ramp)
    moved = closed_loop_equilibrium(loop, d=d, Delta=-rest.penetration)
    position, force = offset_matrices(loop)
    return Comparison(
        rest=rest,
        rigid=rigid,
        moved=moved,
        raw=_difference(rest, rigid),
        explained=_difference(rest, moved),
        predicted=Difference(frozen(-position @ rest.penetration), frozen(-force @ rest.penetration)),
        give=frozen(rest.penetration - rest.compliance * rest.lambda_),
    )


def compare_motion_with_mujoco(
    loop: ClosedLoop, *, stiffness: ContactStiffness = VERY_STIFF, timestep: float = 5e-4
) -> MotionComparison:
    """Compare a small free motion along the surface with M22 x2'' + C22 x2' + K22 x2 = 0, Eq. (38).

    The arm starts at rest, a little beside q_d in each free direction. MuJoCo's integrator is of first order, so the
    deviation falls with `timestep`; with a soft contact it does not, since that lets part of the force through. Errors
    are those of `settle_in_mujoco`.
    """
    from scipy.linalg import expm

    op, split = loop.operating_point, loop.split
    free = op.n - op.m
    duration = SPAN / abs(max(each.real for each in loop.poles.reduced))
    start = SMALL * split.V2.sum(axis=1)
    motion = move_in_mujoco(loop, duration=duration, offset=start, stiffness=stiffness, timestep=timestep)
    M22, C22, K22 = (split.blocks(X).X22 for X in (op.M, loop.gains.C, loop.K))
    A = np.zeros((2 * free, 2 * free))
    A[:free, free:] = np.eye(free)
    A[free:] = np.linalg.solve(M22, np.hstack([-K22, -C22]))
    step, state = expm(A * timestep), np.concatenate([(motion.q[0] - op.q_d) @ split.V2, np.zeros(free)])
    linear = np.zeros((len(motion.t), free))
    for row in linear:
        row[:] = state[:free]
        state = step @ state
    return MotionComparison(motion.t, frozen((motion.q - op.q_d) @ split.V2), frozen(linear))


def _difference(rest: OracleRest, ours: Equilibrium) -> Difference:
    return Difference(frozen(rest.q - ours.q), frozen(rest.lambda_ - ours.lambda_))
