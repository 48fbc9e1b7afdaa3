"""What the linear theory of Eqs. (37) and (38) says of a scenario, to be drawn behind what the simulation finds."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation import ClosedLoop, close_loop
from firmtouch.regulation.controllers import energy_hessian
from firmtouch.simulation.scenario import Feedback, Scenario
from firmtouch.simulation.world import Disturbance

POINTS: Final = 300
"""Instants of each stretch between two changes."""


@dataclass(frozen=True, slots=True)
class Prediction:
    """k instants t (k) of the linear motion: q (k x n) and lambda (k x m)."""

    t: Array
    q: Array
    lambda_: Array


def predict(loop: ClosedLoop, scenario: Scenario) -> Prediction:
    """Solve the linearised loop of a scenario's controller exactly, by matrix exponentials, for an ideal force path.

        M22 x2'' + C22 x2' + K22 x2 = V2^T d - K21 x1,   x1 = S^-1 U^T Delta
        S U^T (I + G_f) dlambda = M12 x2'' + C12 x2' + K12 x2 + K11 x1 - V1^T d

    d is all that acts as a force: the disturbances, a tilt as E^T lambda_d, a rotation as J^T (R^T - I) lambda_d, wrong
    gravity. Drives without limits, and true parameters in gravity alone.
    """
    loop = _linearised(loop, scenario.feedback)
    op, split = loop.operating_point, loop.split
    M, C, K = (split.blocks(X) for X in (op.M, loop.gains.C, loop.K))
    free, world = op.n - op.m, scenario.world
    x1 = np.diag(1 / split.S) @ split.U.T @ world.Delta
    start = np.concatenate([split.V2.T @ (scenario.start.q - op.q_d), split.V2.T @ scenario.start.qdot])
    A = np.block([[np.zeros((free, free)), np.eye(free)], [np.linalg.solve(M.X22, np.hstack([-K.X22, -C.X22]))]])
    times, states, forces = _respond(loop, scenario, A, start, -np.linalg.solve(M.X22, K.X12.T @ x1))
    x2, x2dot = states[:, :free], states[:, free:]
    x2ddot = states @ A[free:].T + (forces @ split.V2 - K.X12.T @ x1) @ np.linalg.inv(M.X22)
    normal = x2ddot @ M.X12.T + x2dot @ C.X12.T + x2 @ K.X12.T + K.X11 @ x1 - forces @ split.V1
    dlambda = normal @ np.linalg.inv(np.diag(split.S) @ split.U.T @ (np.eye(op.m) + loop.gains.G_f)).T
    q = op.q_d + x2 @ split.V2.T + split.V1 @ x1
    return Prediction(frozen(times), frozen(q), frozen(op.lambda_d + dlambda))


def _linearised(loop: ClosedLoop, feedback: Feedback) -> ClosedLoop:
    """Give the loop of a controller: without force feedback for (5) and (15), with the stiffness of a given P_d."""
    op, gains = loop.operating_point, loop.gains
    if not feedback.controller.feels_force:
        gains = replace(gains, G_f=frozen(np.zeros((op.m, op.m))))
    if feedback.P_d is not None:
        gains = replace(gains, W=frozen(energy_hessian(op, feedback.P_d) - op.P_qq))
    return close_loop(op, gains)


def _respond(
    loop: ClosedLoop, scenario: Scenario, A: Array, state: Array, constant: Array
) -> tuple[Array, Array, Array]:
    """Give instants, the states (x2, x2') there and the forces d (k x n), stretch by stretch."""
    from scipy.linalg import expm

    op, split, world = loop.operating_point, loop.split, scenario.world
    free = op.n - op.m
    push = np.linalg.solve(split.V2.T @ op.M @ split.V2, split.V2.T)
    always = _standing_forces(loop, scenario)
    borders = [0.0, *(each for each in world.changes if each < scenario.duration), scenario.duration]
    found: list[tuple[Array, Array, Array]] = []
    for begin, end in itertools.pairwise(borders):
        swings = [each for each in world.sinusoids if each.acts(begin)]
        d = always + world.steady_force(begin)
        size = 2 * free
        whole = np.zeros((size + 1 + 2 * len(swings),) * 2)  # (x2, x2', 1, then sin and cos of each swing)
        whole[:size, :size] = A
        whole[free:size, size] = push @ d + constant
        outputs = np.zeros((op.n, whole.shape[0]))
        outputs[:, size] = d
        extended = [*state, 1.0]
        for k, each in enumerate(swings):
            i = size + 1 + 2 * k
            whole[free:size, i] = push @ each.d
            whole[i, i + 1], whole[i + 1, i] = each.omega, -each.omega
            outputs[:, i] = each.d
            extended += _phase(each, begin)
        step = expm(whole * (end - begin) / (POINTS - 1))
        rows = [np.array(extended)]
        for _ in range(POINTS - 1):
            rows.append(step @ rows[-1])
        all_states = np.array(rows)
        state = all_states[-1, :size]
        found.append((np.linspace(begin, end, POINTS), all_states[:, :size], all_states @ outputs.T))
    return tuple(np.concatenate(each) for each in zip(*found, strict=True))  # type: ignore[return-value]  # three of them


def _phase(swing: Disturbance, t: float) -> list[float]:
    angle = swing.omega * (t - swing.start) + swing.phase
    return [float(np.sin(angle)), float(np.cos(angle))]


def _standing_forces(loop: ClosedLoop, scenario: Scenario) -> Array:
    """Add up what the world's constant errors do as forces, n."""
    op, world = loop.operating_point, scenario.world
    turned = op.J.T @ (world.R.T - np.eye(op.m)) @ op.lambda_d
    gravity = op.g - op.plant.with_parameters(world.p).P_q(op.q_d)
    return frozen(world.E.T @ op.lambda_d + turned + world.bias_error + gravity)
