"""A polytope that contains M(q_d) and N0 for all parameters and all lambda_d that may occur.

The inequalities of the design are affine in (M, N0): gains that fulfil them at each vertex fulfil them everywhere.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from firmtouch.errors import InputError, NoDesignError
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen, symmetric
from firmtouch.modelfile import ModelSpec
from firmtouch.regulation.dependence import Axis, Control, axes_of, controls_of, remainders_of, response_of
from firmtouch.regulation.enlargement import enlargement_of
from firmtouch.regulation.operating_point import OperatingPoint, operating_point_at
from firmtouch.regulation.projection import Projection

MOST_VERTICES: Final = 256


class IndefiniteInertiaError(InputError):
    """M(q_d) is not positive definite for `parameters` (name to value in SI); `smallest` is its least eigenvalue."""

    def __init__(self, parameters: Mapping[str, float], smallest: float) -> None:
        self.parameters, self.smallest = dict(parameters), smallest
        named = ", ".join(f"{name} = {value:g}" for name, value in parameters.items()) or "the nominal parameters"
        super().__init__(
            f"the inertia matrix is not positive definite at {named} (in SI): its smallest eigenvalue is "
            f"{smallest:.3g}; correct the interval, for no mechanism has such an inertia"
        )


@dataclass(frozen=True, slots=True)
class Vertex:
    """One vertex of the polytope: M, N0 (n x n) and g = P_q (n) at q_d.

    `label` has the ends of the intervals that made it (`m3`, `lambda_d.pipe`; SI). Names in `untaken` have a control
    value there instead: no value of that parameter, or no lambda_d in the ball, gives this M and N0.
    """

    label: dict[str, float]
    untaken: tuple[str, ...]
    M: Array
    N0: Array
    g: Array

    def __str__(self) -> str:
        """Write `m3 = 3, c near 0.2 (control point)`, or `nominal`."""
        parts = [
            f"{name} near {value:g} (control point)" if name in self.untaken else f"{name} = {value:g}"
            for name, value in self.label.items()
        ]
        return ", ".join(parts) or "nominal"


@dataclass(frozen=True, slots=True)
class Polytope:
    """Where (M, N0) is: the hull of `vertices`, widened by balls of radius `remainder_M` and `remainder_N0` (2-norm).

    The remainders (and `remainder_g`, the Euclidean norm for g) are zero where parameters enter as polynomials.
    `enlargement` compares the hull with the hull S of the values that do occur: 1 + 2 h / d, with h the distance from
    S of the vertex farthest from it, and d the diameter of S. It is 1 if both are the same, found on a grid if the
    parameters' part of the hull has control points, and sqrt(m) for a ball alone; the remainders are not in it.
    """

    vertices: tuple[Vertex, ...]
    parameters: dict[str, tuple[float, float]]
    lambda_box: dict[str, float] | None
    lambda_ball: float | None
    enlargement: float
    remainder_M: float
    remainder_N0: float
    remainder_g: float


@dataclass(frozen=True, slots=True)
class _Forces:
    """The vertices of lambda_d - its nominal value (k x m), and how much their hull is larger than what occurs."""

    names: tuple[str, ...]
    offsets: Array
    enlargement: float


def uncertainty_polytope(
    op: OperatingPoint,
    *,
    parameters: Mapping[str, tuple[float, float]],
    lambda_box: Mapping[str, float] | None = None,
    lambda_ball: float | None = None,
) -> Polytope:
    """Enclose (M(q_d; p), N0(q_d; p, lambda_d)) for p in intervals (SI) and lambda_d in a box or a ball.

    M, P_qq and P_q are nearly always polynomials of p; over a box they lie in the hull of their Bernstein coefficients,
    which are the values at the corners where p enters multi-affinely. What is no polynomial is interpolated, and the
    remainder bounded by interval arithmetic. lambda_d enters N0 affinely; constraints with Phi_j'' = 0 do not matter.

    `lambda_box` has half widths by constraint, `lambda_ball` is a radius in R^m, both around the nominal lambda_d.

    Raises
    ------
    IndefiniteInertiaError
        If M is not positive definite at a corner.
    InputError
        If both a box and a ball are given.
    NoDesignError
        If there are too many vertices, if a remainder has no bound, or if M is indefinite in the polytope only.
    """
    spec = op.plant.spec
    assert not parameters or parameters.keys() <= spec.parameters.keys()
    assert all(math.isfinite(low) and low <= high < math.inf for low, high in parameters.values())
    forces = _forces(op, lambda_box, lambda_ball)
    response = response_of(op, parameters) if parameters else None
    axes = axes_of(op, response, parameters) if response is not None else ()
    _expect_few(axes, forces)
    controls = controls_of(op, response, axes)
    remainder_M, remainder_N0, remainder_g = remainders_of(axes, op.n) if axes else (0.0, 0.0, 0.0)
    polytope = Polytope(
        vertices=tuple(_vertices(op, controls, forces)),
        parameters=dict(parameters),
        lambda_box=None if lambda_box is None else dict(lambda_box),
        lambda_ball=lambda_ball,
        enlargement=max(enlargement_of(response, axes, controls), forces.enlargement),
        remainder_M=remainder_M,
        remainder_N0=remainder_N0,
        remainder_g=remainder_g,
    )
    _expect_positive(polytope)
    return polytope


def uncertain_parameters(spec: ModelSpec) -> dict[str, tuple[float, float]]:
    """List the parameters that vary, with their intervals in SI: those the file names, or all that have one."""
    region = spec.design.region
    named = region.uncertainty.parameters if region and region.uncertainty else None
    return {
        name: (each.interval[0].value, each.interval[1].value)
        for name, each in spec.parameters.items()
        if each.interval is not None and (named is None or name in named)
    }


def vertex_point(op: OperatingPoint, vertex: Vertex) -> OperatingPoint:
    """Put a vertex in the operating point's place, for analysis; q_d, lambda_d and `P_qq` stay the nominal ones."""
    return replace(op, M=vertex.M, N0=vertex.N0, g=vertex.g)


def sample(op: OperatingPoint, polytope: Polytope, rng: np.random.Generator) -> OperatingPoint:
    """Draw parameters and lambda_d from what the polytope encloses, and evaluate the true plant at the same q_d."""
    p, lambda_d = np.array(op.plant.p), np.array(op.lambda_d)
    names = list(op.plant.spec.parameters)
    for name, (low, high) in polytope.parameters.items():
        p[names.index(name)] = rng.uniform(low, high)
    for j, name in enumerate(op.plant.spec.constraints):
        lambda_d[j] += (polytope.lambda_box or {}).get(name, 0.0) * rng.uniform(-1, 1)
    if polytope.lambda_ball is not None:
        direction = rng.normal(size=op.m)
        lambda_d += polytope.lambda_ball * rng.uniform() ** (1 / op.m) * direction / np.linalg.norm(direction)
    projection = Projection(op.q_d, op.residual, op.moved)
    return operating_point_at(op.plant.with_parameters(p), projection, frozen(lambda_d))


def _forces(op: OperatingPoint, box: Mapping[str, float] | None, ball: float | None) -> _Forces:
    """Enclose what lambda_d may be by a box, or a ball of many dimensions by sqrt(m) times its cross-polytope."""
    if box is not None and ball is not None:
        raise InputError("lambda_d is uncertain by a box or by a ball, not by both; give one of them")
    curved = {name: j for j, name in enumerate(op.plant.spec.constraints) if np.any(op.constraint_hessians[j])}
    assert box is None or box.keys() <= set(op.plant.spec.constraints)
    radii = dict(box) if box is not None else dict.fromkeys(curved, ball or 0.0)
    radii = {name: radii[name] for name in curved if radii.get(name, 0.0) > 0}
    names, units = tuple(radii), np.eye(op.m)[[curved[name] for name in radii]]
    if not names:
        return _Forces((), np.zeros((1, op.m)), 1.0)
    sides = np.diag(list(radii.values())) @ units
    enlargement = math.sqrt(len(names)) if ball is not None else 1.0
    if ball is not None and len(names) > 2:  # 2 m vertices instead of 2^m
        return _Forces(names, enlargement * np.vstack([sides, -sides]), enlargement)
    signs = np.array(list(itertools.product((-1, 1), repeat=len(names))))
    return _Forces(names, signs @ sides, enlargement)


def _expect_few(axes: tuple[Axis, ...], forces: _Forces) -> None:
    made = {axis.name: axis.degree + 1 for axis in axes if axis.degree}
    made |= {"lambda_d": len(forces.offsets)} if forces.names else {}
    count = math.prod(made.values())
    if count > MOST_VERTICES:
        raise NoDesignError(
            f"the intervals make {count} vertices, and at most {MOST_VERTICES} are designed for: "
            f"{', '.join(f'`{name}` makes {each}' for name, each in made.items())}; take some of them as known"
        )


def _vertices(op: OperatingPoint, controls: list[Control], forces: _Forces) -> Iterator[Vertex]:
    """Combine each control point of the parameters with each vertex of lambda_d."""
    constraints = list(op.plant.spec.constraints)
    outside = tuple(f"lambda_d.{name}" for name in forces.names) if forces.enlargement > 1 else ()
    for control, offset in itertools.product(controls, forces.offsets):
        lambda_d = op.lambda_d + offset
        label = {f"lambda_d.{name}": float(lambda_d[constraints.index(name)]) for name in forces.names}
        N0 = control.P_qq - np.tensordot(lambda_d, op.constraint_hessians, axes=1)  # of Eq. (14)
        yield Vertex(control.label | label, control.untaken + outside, control.M, symmetric(N0), control.g)


def _expect_positive(polytope: Polytope) -> None:
    """Refuse an M that is not positive definite, first where a plant has it."""
    found = []
    for vertex in polytope.vertices:
        taken = not polytope.parameters.keys() & set(vertex.untaken)
        smallest = float(np.linalg.eigvalsh(vertex.M)[0])
        if taken and smallest <= 0:
            at = {name: value for name, value in vertex.label.items() if name in polytope.parameters}
            raise IndefiniteInertiaError(at, smallest)
        found.append((smallest, str(vertex)))
    smallest, where = min(found)
    if smallest <= polytope.remainder_M:
        raise NoDesignError(
            "the polytope around the uncertain inertia matrix is too large: it contains matrices that are not positive "
            f"definite (smallest eigenvalue {smallest - polytope.remainder_M:.3g}, at {where}); "
            "split or narrow the interval of a parameter that does not enter linearly"
        )
