"""Checks of the energies: M symmetric and positive, K homogeneous, passivity, rotation matrices."""

from __future__ import annotations

import math
from typing import Final

import casadi as ca
import numpy as np

from firmtouch.checks.result import CheckResult, at_least, at_most, largest
from firmtouch.checks.subject import Subject, relative
from firmtouch.mechanics.arrays import call
from firmtouch.mechanics.rigid_bodies import rotation
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile import Expression
from firmtouch.modelfile.sections.mechanism import Bodies

ROUNDING: Final = 1e-10
"""Identities that hold exactly, evaluated in double precision over some hundred operations."""
NEARLY_SINGULAR: Final = 1e-9


def inertia_symmetric(subject: Subject) -> CheckResult:
    """M = M^T."""
    plant = subject.plant
    matrices = [call(plant.functions["M"], q, plant.p) for q, _ in subject.states()]
    error = largest(relative(M - M.T, M) for M in matrices)
    return at_most("M symmetric", error, ROUNDING, f"at {len(matrices)} configurations around q_d")


def inertia_positive(subject: Subject) -> CheckResult:
    """M positive definite at and around q_d."""
    ratios = []
    for q, _ in subject.states():
        M = subject.plant.M(q)
        if not np.all(np.isfinite(M)):
            ratios.append(math.nan)
            break
        values = np.linalg.eigvalsh(M)
        ratios.append(float(values[0] / max(abs(values[-1]), 1e-300)))
    worst = min(ratios) if not any(map(math.isnan, ratios)) else math.nan
    detail = "least over largest eigenvalue, worst of 8 configurations around q_d"
    if not worst >= NEARLY_SINGULAR:
        detail += ": a coordinate without inertia, or a negative mass?"
    return at_least("M positive definite", worst, NEARLY_SINGULAR, detail)


def kinetic_energy_homogeneous(subject: Subject) -> CheckResult:
    """K(q, q') = 1/2 q'^T M q': K is homogeneous of degree two in the velocities."""
    errors = []
    for q, qdot in subject.states():
        for factor in (1.0, -2.0):
            K = subject.plant.K(q, factor * qdot)
            expected = factor**2 * float(qdot @ subject.plant.M(q) @ qdot) / 2
            errors.append(abs(K - expected) / max(abs(K), abs(expected), 1e-9))
    detail = "K(q, s q') against s^2/2 q'^T M q'"
    return at_most("K homogeneous", largest(errors), ROUNDING, detail)


def passive(subject: Subject) -> CheckResult:
    """q'^T M' q' = q'^T d/dq[q'^T M q'] (erratum 6), so that theta does the power q'^T M' q' / 2 + dP/dt."""
    plant = subject.plant
    q, qdot = ca.SX.sym("q", plant.n), ca.SX.sym("qdot", plant.n)
    M = plant.functions["M"](q, plant.p)
    rate = ca.reshape(ca.jtimes(ca.vec(M), q, qdot), plant.n, plant.n)
    quadratic = ca.dot(qdot, M @ qdot)
    sides = ca.vertcat(ca.dot(qdot, rate @ qdot), ca.dot(qdot, ca.gradient(quadratic, q)))
    function = ca.Function("passivity", [q, qdot], [sides])
    errors = []
    for at, velocity in subject.states():
        left, right = np.asarray(function(at, velocity).full()).ravel()
        power = 2 * float(velocity @ (plant.theta(at, velocity) - plant.P_q(at)))
        scale = max(abs(left), float(np.linalg.norm(plant.M(at))), 1e-9)
        errors += [abs(left - right) / scale, abs(power - left) / scale]
    return at_most("passivity", largest(errors), ROUNDING, "power of theta against the change of the kinetic energy")


def orientations_orthonormal(subject: Subject) -> CheckResult:
    """R^T R = I with determinant one, for orientations that are given as matrices."""
    spec, errors = subject.plant.spec, [0.0]
    symbols = Symbols(spec)
    bodies = spec.mechanism.bodies.values() if isinstance(spec.mechanism, Bodies) else ()
    for body in bodies:
        if body.orientation is None or isinstance(body.orientation, Expression):
            continue
        R = rotation(body.orientation, symbols)
        defect = ca.vertcat(ca.vec(R.T @ R - ca.SX.eye(3)), ca.det(R) - 1)
        function = ca.Function("defect", [symbols.q, symbols.p], [ca.densify(defect)])
        errors += [float(np.max(np.abs(call(function, q, subject.plant.p)))) for q, _ in subject.states()]
    return at_most("rotations orthonormal", largest(errors), ROUNDING, "R^T R = I and det R = 1 for bodies in space")
