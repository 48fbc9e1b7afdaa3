"""The closed loop as equations that an integrator takes: Eqs. (1), (4) and a controller, of index one.

Phi = 0 is differentiated twice (`Motion`); q'' and lambda are then the solution of linear equations, the algebraic loop
of the force feedback included, written out once.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from typing import Final

import casadi as ca
import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation import ClosedLoop
from firmtouch.regulation.controllers import control_law
from firmtouch.simulation.layout import Layout
from firmtouch.simulation.motion import Motion
from firmtouch.simulation.scenario import Feedback
from firmtouch.simulation.world import World

UNLIMITED: Final = 1e30
NODES: Final = 8
"""Points at which lambda is remembered over a step, so that it can be given back later: a polynomial of degree 7."""


class Input(Enum):
    """What the controller's output depends on at an instant."""

    CONTACT = "the contact force of the same instant: an algebraic loop"
    FILTERED = "the filtered contact force, a state"
    REMEMBERED = "the contact force of an earlier step, or that filtered"
    HELD = "nothing: it is held since the last sample"


@dataclass(frozen=True, slots=True)
class Dae:
    """q, q' (and the filtered force y) as the state x (a column), driven by `parameters` (one column).

    `rate` gives x' at (t, x, parameters), and `outputs` lambda, u and the true constraints' residual there; u is what
    the drives do, limits included. `law` is u(q, q', y) before the limits, `residual` the static equations at (q,
    lambda, parameters). `layout` says where each parameter stands.
    """

    loop: ClosedLoop
    feedback: Feedback
    input: Input
    filtered: bool
    sinusoids: int
    layout: Layout
    rate: ca.Function
    outputs: ca.Function
    law: ca.Function
    residual: ca.Function

    @property
    def states(self) -> int:
        """The number of states."""
        op = self.loop.operating_point
        return 2 * op.n + (op.m if self.filtered else 0)


def input_of(feedback: Feedback) -> Input:
    """Tell on what the controller's output depends."""
    path = feedback.path
    if path.sample:
        return Input.HELD
    if path.delay:
        return Input.REMEMBERED
    return Input.FILTERED if path.lag else Input.CONTACT


def derive_dae(loop: ClosedLoop, feedback: Feedback, *, sinusoids: int = 0, within_limits: bool = False) -> Dae:
    """Write out the closed loop for a feedback and a number of disturbances that swing; any world can be put in.

    Drives' limits inside an algebraic loop take ten times the operations of all else. Equations that hold
    `within_limits` leave them out; u tells whether they do.
    """
    op, source = loop.operating_point, input_of(feedback)
    n, m, filtered = op.n, op.m, feedback.path.lag > 0
    layout = _layout(n, m, len(op.plant.p), sinusoids, source)
    column, given = layout.symbols()
    t, q, qdot, y = ca.SX.sym("t"), ca.SX.sym("q", n), ca.SX.sym("qdot", n), ca.SX.sym("y", m if filtered else 0)
    law = control_law(op, loop.gains, feedback.controller, P_d=feedback.P_d)
    drives = replace(feedback, limits=None) if within_limits else feedback
    motion = Motion(loop, drives, given, q=q, qdot=qdot, d=_force(given, t, sinusoids))
    past = _remembered(given, t, m) if source is Input.REMEMBERED else y
    if source is Input.HELD:
        u = given["held"]
        lambda_ = motion.multipliers(u)
    elif source is Input.CONTACT:
        u, lambda_ = motion.close(law)
    else:
        u = motion.limited(law(q, qdot, y if filtered else past) + given["bias_error"])
        lambda_ = motion.multipliers(u)
    ydot = (past - y if source is Input.REMEMBERED else lambda_ - y) / feedback.path.lag if filtered else ca.SX(0, 1)
    x = ca.vertcat(q, qdot, y)
    xdot = ca.vertcat(qdot, motion.acceleration(u, lambda_), ydot)
    return Dae(
        loop, feedback, source, filtered, sinusoids, layout,
        rate=ca.Function("rate", [t, x, column], ca.cse([ca.densify(xdot)])),
        outputs=ca.Function("outputs", [t, x, column], ca.cse([ca.densify(each) for each in (lambda_, u, motion.Phi)])),
        law=law,
        residual=_static(loop, feedback, law, column, given),
    )  # fmt: skip


def parameters_of(dae: Dae, world: World, *, t: float) -> Array:
    """Put a world into the parameters, with the disturbances that act just after t.

    What a step holds or remembers is zero here; it is put in its place when the step is made.
    """
    op, limits = dae.loop.operating_point, dae.feedback.limits
    swinging = world.sinusoids
    assert len(swinging) == dae.sinusoids
    values: dict[str, Array | float] = {
        "p": world.p,
        "Delta": world.Delta,
        "R": world.R,
        "E": world.E,
        "bias_error": world.bias_error,
        "limits": np.full(op.n, UNLIMITED) if limits is None else np.minimum(limits, UNLIMITED),
        "d": world.steady_force(t),
    }
    for k, each in enumerate(swinging):
        amplitude = each.d if each.acts(t) else 0 * each.d
        values[f"swing{k}"] = np.concatenate([amplitude, [each.omega, each.phase - each.omega * each.start]])
    if dae.input is Input.HELD:
        values["held"] = np.zeros(op.n)
    if dae.input is Input.REMEMBERED:
        values |= {"memory": np.zeros((op.m, NODES)), "span": np.array([0.0, 1.0])}
    return dae.layout.pack(values)


def nodes() -> Array:
    """Give the points of a step, in parts of it, at which lambda is remembered: Chebyshev's, both ends included."""
    return frozen((1 - np.cos(np.pi * np.arange(NODES) / (NODES - 1))) / 2)


def _layout(n: int, m: int, p: int, sinusoids: int, source: Input) -> Layout:
    sizes = [("p", p), ("Delta", m), ("R", m * m), ("E", m * n), ("bias_error", n), ("limits", n), ("d", n)]
    sizes += [(f"swing{k}", n + 2) for k in range(sinusoids)]
    if source is Input.HELD:
        sizes.append(("held", n))
    if source is Input.REMEMBERED:
        sizes += [("memory", m * NODES), ("span", 2)]
    return Layout(tuple(sizes))


def _force(given: dict[str, ca.SX], t: ca.SX, sinusoids: int) -> ca.SX:
    """Add up all disturbance forces at t."""
    total = given["d"]
    n = total.numel()
    for k in range(sinusoids):
        swing = given[f"swing{k}"]
        total = total + swing[:n] * ca.sin(swing[n] * t + swing[n + 1])
    return total


def _remembered(given: dict[str, ca.SX], t: ca.SX, m: int) -> ca.SX:
    """Give back the remembered force at t by Lagrange's polynomial through the nodes."""
    s = (t - given["span"][0]) / given["span"][1]
    at, values = nodes(), ca.reshape(given["memory"], m, NODES)
    total = ca.SX.zeros(m)
    for i in range(NODES):
        others = np.delete(at, i)
        basis = ca.SX(1)
        for other in others:
            basis *= (s - other) / (at[i] - other)
        total += values[:, i] * basis
    return total


def _static(
    loop: ClosedLoop, feedback: Feedback, law: ca.Function, column: ca.SX, given: dict[str, ca.SX]
) -> ca.Function:
    """Give (u + d - theta + J^T lambda, Phi) at rest and its Jacobian in (q, lambda): zero at an equilibrium."""
    n, m = loop.operating_point.n, loop.operating_point.m
    q, lambda_, still = ca.SX.sym("q", n), ca.SX.sym("lambda", m), ca.SX.zeros(n)
    motion = Motion(loop, feedback, given, q=q, qdot=still, d=given["d"])
    u = motion.limited(law(q, still, lambda_) + given["bias_error"])
    balance = ca.vertcat(u + motion.forces + motion.J.T @ lambda_, motion.Phi)
    unknown = ca.vertcat(q, lambda_)
    outputs = [ca.densify(balance), ca.densify(ca.jacobian(balance, unknown))]
    return ca.Function("residual", [unknown, column], outputs)
