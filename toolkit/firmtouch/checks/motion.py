"""A check by motion: without controls and friction the energy of the constrained mechanism is kept."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from firmtouch.checks.result import CheckResult, at_most
from firmtouch.checks.subject import Subject
from firmtouch.mechanics import Array, Plant

DURATION: Final = 0.1
TOLERANCE: Final = 1e-9
KEPT: Final = 1e-6
"""Energy error relative to the energy that was exchanged; the integrator is asked for 1e-9 a step."""
MOST_EVALUATIONS: Final = 1000


class _TooManyEvaluations(Exception):  # noqa: N818  # never leaves this file
    pass


def energy_kept(subject: Subject) -> CheckResult:
    """K + P is constant along M q'' + theta = J^T lambda on the constraint, started along a free direction."""
    from scipy.integrate import solve_ivp

    plant, name = subject.plant, "energy kept"
    J = plant.J(subject.q_d)
    if subject.missed is not None or not np.all(np.isfinite(J)):
        return at_most(name, math.nan, KEPT, "not run: the constraints are not met")
    free = np.linalg.svd(J)[2][np.linalg.matrix_rank(J) :]
    start = np.concatenate([subject.q_d, free.sum(axis=0)])
    count = 0

    def rate(_: float, state: Array) -> Array:
        nonlocal count
        count += 1
        if count > MOST_EVALUATIONS:
            raise _TooManyEvaluations
        q, qdot = state[: plant.n], state[plant.n :]
        return np.concatenate([qdot, unforced_acceleration(plant, q, qdot)])

    try:
        run = solve_ivp(rate, (0, DURATION), start, method="DOP853", rtol=TOLERANCE, atol=TOLERANCE)
    except (_TooManyEvaluations, np.linalg.LinAlgError, ValueError) as error:
        reason = "it takes too many steps" if isinstance(error, _TooManyEvaluations) else "it becomes singular"
        return at_most(name, math.nan, KEPT, f"the motion could not be computed: {reason}")
    kinetic = np.array([plant.K(state[: plant.n], state[plant.n :]) for state in run.y.T])
    potential = np.array([plant.P(state[: plant.n]) for state in run.y.T])
    energy, scale = kinetic + potential, max(float(np.max(np.abs(kinetic))), float(np.ptp(potential)), 1e-12)
    drift = float(np.max(np.abs(plant.Phi(run.y[: plant.n, -1]))))
    detail = f"over {DURATION:g} s of unforced motion on the constraint, which drifted by {drift:.2g}"
    return at_most(name, float(np.max(np.abs(energy - energy[0]))) / scale, KEPT, detail)


def unforced_acceleration(plant: Plant, q: Array, qdot: Array) -> Array:
    """Solve (4) with u = 0 and J q'' + J' q' = 0 for q''."""
    J = plant.J(q)
    matrix = np.block([[plant.M(q), -J.T], [J, np.zeros((plant.m, plant.m))]])
    right = -np.concatenate([plant.theta(q, qdot), plant.Jdot_qdot(q, qdot)])
    return np.linalg.solve(matrix, right)[: plant.n]
