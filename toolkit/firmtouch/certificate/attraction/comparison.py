"""What simulation finds beside what is proven, for n - m <= 2: data for a picture. Nothing here is a proof."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import casadi as ca
import numpy as np

from firmtouch.certificate.attraction.attraction import Attraction
from firmtouch.certificate.attraction.chart import Chart
from firmtouch.mechanics import Array, Plant
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation import ClosedLoop
from firmtouch.regulation.graph import surface_above
from firmtouch.regulation.lyapunov import potential

WINDOW: Final = 1.8
"""Starts are tried this far out, in sizes of the proven region."""
STARTS: Final = {1: 37, 2: 13}
"""Along each axis."""
RAYS: Final = 72
CURVE: Final = 121
RAY_STEP: Final = 0.04
"""In units of where p would reach the level if it were quadratic."""
EDGE: Final = 0.98
"""The part of the level that is drawn: where it is as good as that of a ridge, the border would be found behind it."""
FARTHEST: Final = 2.5
"""How far a ray is followed, in rad or m."""
HOLD: Final = 20.0
"""Decay rate, 1/s, at which the simulation pulls drift off the surface back to it."""
STEP: Final = 0.04
"""A step of the simulation, in units of 1/|fastest pole|."""
DECAYS: Final = 14.0
"""How long is simulated, in units of 1/|slowest decay rate|."""
ARRIVED: Final = 1e-2
"""The distance from q_d, in rad or m, that counts as converged then."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """Starts at rest (k x (n-m), as x2), which of them `converge`, and p where it was computed.

    For n - m = 1 `line` (two columns) is p over x2, and for n - m = 2 the border of {p < EDGE level}, x2 along rays.
    `proven` are the starts inside that border. `window` are the half-widths of what was looked at.
    """

    starts: Array
    converge: Array
    proven: Array
    line: Array
    level: float
    window: Array


def compare_attraction(loop: ClosedLoop, attraction: Attraction) -> Comparison:
    """Simulate Eq. (15) from a grid of starts at rest on the surface, in the coordinates of the proof.

    Raises
    ------
    ValueError
        If n - m > 2.
    """
    chart, level = attraction.chart, attraction.level
    if chart.free > 2:
        raise ValueError(f"n - m is {chart.free}; pictures have two dimensions")
    border = _border(loop, chart, level)
    window = WINDOW * np.max(np.abs(border), axis=0)
    axes = [np.linspace(-each, each, STARTS[chart.free]) for each in window]
    grid = np.stack([each.ravel() for each in np.meshgrid(*axes, indexing="ij")], axis=1)
    lifted = [_lift(loop.operating_point.plant, chart, each) for each in grid]
    on_surface = np.array([each is not None for each in lifted])
    starts = grid[on_surface]
    q = np.array([each for each in lifted if each is not None])
    if chart.free == 1:
        line = _curve(loop, chart, float(window[0]))
        proven = (starts[:, 0] > border[:, 0].min()) & (starts[:, 0] < border[:, 0].max())
    else:
        line, proven = border, _inside(border, starts)
    return Comparison(
        frozen(starts), frozen(_converges(loop, q)), frozen(proven), frozen(line), level, frozen(window)
    )  # fmt: skip


def _lift(plant: Plant, chart: Chart, x2: Array) -> Array | None:
    """Walk from q_d to the surface's point above x2 in steps; None if the surface turns away before."""
    x1: Array = np.zeros(chart.V1.shape[1])
    q = chart.q_d
    for part in np.linspace(0, 1, 2 + int(20 * np.max(np.abs(x2))))[1:]:
        there = _above(plant, chart, x1, part * x2)
        if there is None:
            return None
        x1, q = there
    return q


def _above(plant: Plant, chart: Chart, x1: Array, x2: Array) -> tuple[Array, Array] | None:
    return surface_above(plant, chart.q_d, chart.V1, chart.V2, x1=x1, x2=x2)


def _curve(loop: ClosedLoop, chart: Chart, window: float) -> Array:
    """Give (x2, P_cd above it) along the only free direction, walking outwards; no number behind the surface's end."""
    plant = loop.operating_point.plant
    found = {0.0: 0.0}
    for end in (-window, window):
        there: tuple[Array, Array] | None = (np.zeros(chart.V1.shape[1]), chart.q_d)
        for x2 in np.linspace(0, end, CURVE // 2 + 1)[1:]:
            there = there and _above(plant, chart, there[0], np.array([x2]))
            found[float(x2)] = np.nan if there is None else potential(loop, there[1])
    return np.array(sorted(found.items()))


def _border(loop: ClosedLoop, chart: Chart, level: float) -> Array:
    """Follow rays from q_d until p reaches the level, in small steps: a ridge just above it is not to be missed."""
    plant = loop.operating_point.plant
    stiffness = np.diag(chart.V2.T @ loop.K @ chart.V2)
    angles = np.linspace(0, 2 * np.pi, RAYS, endpoint=False)
    round_about = [[np.cos(a), np.sin(a)] for a in angles]
    rays = np.array([[-1.0], [1.0]] if chart.free == 1 else round_about) * np.sqrt(2 * EDGE * level / stiffness)
    found = []
    for ray in rays:
        x1: Array = np.zeros(chart.V1.shape[1])
        reached, size = 0.0, RAY_STEP
        while size > RAY_STEP / 64 and reached * np.max(np.abs(ray)) < FARTHEST:
            there = _above(plant, chart, x1, (reached + size) * ray)
            if there is None or potential(loop, there[1]) >= EDGE * level:
                size /= 2
            else:
                reached, x1 = reached + size, there[0]
        found.append(reached * ray)
    return np.array(found)


def _inside(border: Array, points: Array) -> Array:
    """Tell which points are inside a polygon around zero, whose corners go around once."""
    inside = np.zeros(len(points), dtype=bool)
    for a, b in zip(border, np.roll(border, -1, axis=0), strict=True):
        weights = np.linalg.solve(np.column_stack([a, b]), points.T)
        inside |= np.all(weights >= 0, axis=0) & (weights.sum(axis=0) < 1)
    return inside


def _converges(loop: ClosedLoop, q: Array) -> Array:
    """Integrate Eq. (15) for all starts at once, by the classical Runge-Kutta method of fourth order."""
    poles = np.array(loop.poles.reduced)
    h, duration = STEP / np.max(np.abs(poles)), DECAYS / np.min(-poles.real)
    step = _step(loop, h).map(len(q))
    state = np.vstack([q.T, np.zeros_like(q.T)])
    for _ in range(int(np.ceil(duration / h))):
        state = step(state).full()
    far = np.max(np.abs(state[: q.shape[1]] - loop.operating_point.q_d[:, None]), axis=0)
    return np.asarray(far < ARRIVED)


def _step(loop: ClosedLoop, h: float) -> ca.Function:
    op, n = loop.operating_point, loop.operating_point.n
    state = ca.SX.sym("state", 2 * n)
    rate = _rate(loop)
    k1 = rate(state)
    k2 = rate(state + h / 2 * k1)
    k3 = rate(state + h / 2 * k2)
    k4 = rate(state + h * k3)
    return ca.Function(f"step{op.m}", [state], [state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])


def _rate(loop: ClosedLoop) -> ca.Function:
    """Give the motion of Eqs. (4) and (15), with Phi'' = -2 HOLD Phi' - HOLD^2 Phi for Phi'' = 0."""
    op, gains, functions = loop.operating_point, loop.gains, loop.operating_point.plant.functions
    q, v, p = ca.SX.sym("q", op.n), ca.SX.sym("v", op.n), ca.DM(op.plant.p)
    u = ca.DM(gains.bias) - ca.DM(gains.W) @ (q - ca.DM(op.q_d)) - ca.DM(gains.C) @ v
    J = functions["J"](q, p)
    left = ca.vertcat(ca.horzcat(functions["M"](q, p), -J.T), ca.horzcat(J, ca.SX.zeros(op.m, op.m)))
    drift = functions["Jdot_qdot"](q, v, p) + 2 * HOLD * (J @ v) + HOLD**2 * functions["Phi"](q, p)
    motion = ca.solve(left, ca.vertcat(u - functions["theta"](q, v, p), -drift))
    return ca.Function("rate", [ca.vertcat(q, v)], [ca.vertcat(v, motion[: op.n])])
