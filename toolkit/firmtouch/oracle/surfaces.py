"""What MuJoCo can put in a constraint's place: a plane or a round surface at a point, or a sum of joint angles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import casadi as ca
import numpy as np

from firmtouch.mechanics import Array, Plant
from firmtouch.mechanics.arrays import call, call_vector, frozen
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile import Expression
from firmtouch.modelfile.sections.drawing import Surface
from firmtouch.oracle.library import NotExpressibleError
from firmtouch.regulation.operating_point import OperatingPoint

SAME: Final = 1e-9
"""How far phi and the surface's own gap may differ, in metres (or rad) at metre size: rounding stays far below."""
SAMPLES: Final = 60
AROUND: Final = 0.3
"""Each joint is varied by this much (rad or m) around q_d to learn which surface phi is the distance of."""


@dataclass(frozen=True, slots=True)
class Plane:
    """phi = scale * (normal . x - distance), x the contact point; the arm is on the side of `normal` (3)."""

    point: Expression
    scale: float
    normal: Array
    distance: float


@dataclass(frozen=True, slots=True)
class Ball:
    """phi = scale * (|x - centre| - radius), the arm outside; in the plane a disc."""

    point: Expression
    scale: float
    centre: Array
    radius: float
    disc: bool


@dataclass(frozen=True, slots=True)
class JointSum:
    """phi = weights . q + constant: no contact, and held from both sides."""

    weights: Array
    constant: float


Touch = Plane | Ball | JointSum


def find_touches(op: OperatingPoint) -> tuple[Touch, ...]:
    """Find what to put in the place of each constraint, from phi itself.

    The file's drawing says at which point a constraint presses, and where round surfaces are; that phi is the distance
    of that point from the surface, near q_d, is checked at random configurations.

    Raises
    ------
    NotExpressibleError
        If a constraint is none of these, or its contact would have to pull.
    """
    spread = np.random.default_rng(1993).uniform(-AROUND, AROUND, (SAMPLES, op.n))
    samples = [frozen(op.q_d + each) for each in spread]
    return tuple(_find_touch(op, j, name, samples) for j, name in enumerate(op.plant.spec.constraints))


def _find_touch(op: OperatingPoint, j: int, name: str, samples: list[Array]) -> Touch:
    phi = np.array([op.plant.Phi(q)[j] for q in samples])
    drawing = op.plant.spec.drawing
    points = drawing.contacts.get(name, ()) if drawing is not None else ()
    if len(points) == 2:
        raise NotExpressibleError(
            f"constraint `{name}` lets two parts of the mechanism press on each other: that is a closed loop, and no "
            "contact with a surface that could be given to MuJoCo"
        )
    if not points:
        return _joint_sum(op, name, samples, phi)
    if not op.lambda_d[j] > 0:
        raise NotExpressibleError(
            f"constraint `{name}` has lambda_d = {op.lambda_d[j]:.4g}: a contact in MuJoCo pushes and never pulls"
        )
    at = _positions(op.plant, points[0], samples)
    plane, plane_misses = _plane(points[0], at, phi)
    if plane_misses <= SAME:
        return plane
    surfaces = drawing.surfaces.values() if drawing is not None else ()
    balls = [_ball(op, points[0], at, phi, each) for each in surfaces if each.centre is not None]
    ball, ball_misses = min(balls, key=lambda found: found[1], default=(None, np.inf))
    if ball is None or not ball_misses <= SAME:
        raise NotExpressibleError(
            f"constraint `{name}` is neither the distance of its contact point from a plane (it misses by "
            f"{plane_misses:.3g}) nor from a circle or sphere of the drawing ({ball_misses:.3g}), "
            "and MuJoCo is given no other surfaces"
        )
    if ball.scale < 0:
        raise NotExpressibleError(
            f"constraint `{name}` keeps the arm inside a round surface, and MuJoCo's are solid: it has no hollow ones"
        )
    return ball


def _positions(plant: Plant, point: Expression, samples: list[Array]) -> Array:
    """Evaluate a point at the samples, k x 3; what lies in the plane has z = 0."""
    symbols = Symbols(plant.spec)
    function = ca.Function("point", [symbols.q, symbols.p], [ca.densify(symbols.column(point))])
    at = np.zeros((len(samples), 3))
    for row, q in zip(at, samples, strict=True):
        value = call_vector(function, q, plant.p)
        row[: value.size] = value
    return at


def _plane(point: Expression, at: Array, phi: Array) -> tuple[Plane, float]:
    coefficients, misses = _fit(np.column_stack([at, np.ones(len(at))]), phi)
    scale = float(np.linalg.norm(coefficients[:3])) or 1.0
    return Plane(point, scale, frozen(coefficients[:3] / scale), float(-coefficients[3] / scale)), misses


def _ball(op: OperatingPoint, point: Expression, at: Array, phi: Array, surface: Surface) -> tuple[Ball, float]:
    assert surface.centre is not None
    assert surface.radius is not None
    symbols = Symbols(op.plant.spec)
    values = [symbols.column(surface.centre), symbols.scalar(surface.radius)]
    functions = [ca.Function("surface", [symbols.q, symbols.p], [ca.densify(each)]) for each in values]
    given, radius = call_vector(functions[0], op.q_d, op.plant.p), call(functions[1], op.q_d, op.plant.p).item()
    centre = np.zeros(3)
    centre[: given.size] = given
    coefficients, misses = _fit((np.linalg.norm(at - centre, axis=1) - radius)[:, None], phi)
    return Ball(point, float(coefficients[0]), frozen(centre), float(radius), disc=given.size == 2), misses


def _joint_sum(op: OperatingPoint, name: str, samples: list[Array], phi: Array) -> JointSum:
    coefficients, misses = _fit(np.column_stack([samples, np.ones(len(samples))]), phi)
    if not misses <= SAME:
        raise NotExpressibleError(
            f"constraint `{name}` has no contact point in the drawing (`contacts`) and is no sum of joint coordinates "
            f"either (it misses one by {misses:.3g}): there is nothing to put in its place in MuJoCo"
        )
    return JointSum(frozen(coefficients[: op.n]), float(coefficients[op.n]))


def _fit(columns: Array, phi: Array) -> tuple[Array, float]:
    """Fit phi by least squares; the second value is the largest deviation, relative to the largest coefficient."""
    coefficients = np.linalg.lstsq(columns, phi, rcond=1e-12)[0]
    deviation = float(np.abs(columns @ coefficients - phi).max())
    return frozen(coefficients), deviation / (float(np.abs(coefficients).max()) or 1.0)
