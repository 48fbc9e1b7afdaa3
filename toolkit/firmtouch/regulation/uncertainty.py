"""A polytope that contains M(q_d) and N0 for all parameters and all lambda_d that may occur.

The inequalities of the design are affine in (M, N0): gains that fulfil them at each vertex fulfil them everywhere.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final

import casadi as ca
import numpy as np

from firmtouch.errors import InputError, NoDesignError
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import call_vector, frozen, symmetric
from firmtouch.mechanics.intervals import enclose, has_kinks
from firmtouch.modelfile import ModelSpec
from firmtouch.regulation.operating_point import OperatingPoint, Projection, operating_point_at

DEGREE: Final = 4
"""The highest degree that a parameter may have; what is no polynomial is interpolated with it."""
MOST_VERTICES: Final = 256
LEBESGUE: Final = 1.85
"""Bounds the interpolation's norm at five Chebyshev-Lobatto nodes (Ehlich and Zeller 1966)."""
SAMPLES: Final = 600
"""How many parameter values stand for all of them in `enlargement`."""
CONSTANT: Final = 1e-12
"""What changes by less than this part of itself is constant but for rounding."""


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
class _Axis:
    """One parameter: the nodes at which its polynomial is met, and what the polynomial misses, entry by entry."""

    name: str
    nodes: Array
    error: Array

    @property
    def degree(self) -> int:
        return len(self.nodes) - 1

    def control_value(self, i: int) -> float:
        t = i / self.degree
        return float((1 - t) * self.nodes[0] + t * self.nodes[-1])


@dataclass(frozen=True, slots=True)
class _Forces:
    """The vertices of lambda_d - its nominal value (k x m), and how much their hull is larger than what occurs."""

    names: tuple[str, ...]
    offsets: Array
    enlargement: float


@dataclass(frozen=True, slots=True)
class _Control:
    """One Bernstein control point (M, P_qq, P_q) of the parameters' part."""

    label: dict[str, float]
    untaken: tuple[str, ...]
    M: Array
    P_qq: Array
    g: Array


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
    response = _response(op, parameters) if parameters else None
    axes = _axes(op, response, parameters) if response is not None else ()
    _expect_few(axes, forces)
    controls = _controls(op, response, axes)
    remainder_M, remainder_N0, remainder_g = _remainders(axes, op.n) if axes else (0.0, 0.0, 0.0)
    polytope = Polytope(
        vertices=tuple(_vertices(op, controls, forces)),
        parameters=dict(parameters),
        lambda_box=None if lambda_box is None else dict(lambda_box),
        lambda_ball=lambda_ball,
        enlargement=max(_enlargement(response, axes, controls), forces.enlargement),
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


def _response(op: OperatingPoint, parameters: Mapping[str, tuple[float, float]]) -> ca.Function:
    """Give (M, P_qq, P_q) at q_d, stacked, as a function of the uncertain parameters alone."""
    functions, names = op.plant.functions, list(op.plant.spec.parameters)
    uncertain, p = ca.SX.sym("p", len(parameters)), ca.SX(op.plant.p)
    for i, name in enumerate(parameters):
        p[names.index(name)] = uncertain[i]
    q = ca.SX.sym("q", op.n)
    assert ca.jacobian(functions["Phi"](q, p), uncertain).nnz() == 0, "q_d would move with these parameters"
    values = [ca.vec(functions[name](ca.SX(op.q_d), p)) for name in ("M", "P_qq", "P_q")]
    return ca.Function("response", [uncertain], [ca.densify(ca.vertcat(*values))])


def _split(values: Array, n: int) -> tuple[Array, Array, Array]:
    """Undo the stacking of `_response`."""
    M, P_qq, g = np.split(values, (n * n, 2 * n * n))
    return symmetric(M.reshape(n, n)), symmetric(P_qq.reshape(n, n)), frozen(g)


def _axes(
    op: OperatingPoint, response: ca.Function, parameters: Mapping[str, tuple[float, float]]
) -> tuple[_Axis, ...]:
    """Find out how each parameter enters, and bound what a polynomial misses."""
    p = ca.SX.sym("p", len(parameters))
    values, box = response(p), list(parameters.values())
    if has_kinks(response):
        enclose(response, box, "the plant")
    nominal = dict(zip(op.plant.spec.parameters, op.plant.p, strict=True))
    axes = []
    for i, (name, (low, high)) in enumerate(parameters.items()):
        degree, derivative = degree_of(values, p[i])
        if degree == 0 or low == high:
            axes.append(_Axis(name, frozen([low if low == high else nominal[name]]), np.zeros(values.numel())))
            continue
        t = nodes_of(degree)
        error: Array = np.zeros(values.numel())
        if derivative.nnz():
            fifth = ca.Function("fifth", [p], [ca.densify(derivative)])
            error = _interpolation_error(enclose(fifth, box, f"the dependence on `{name}`"), high - low)
        axes.append(_Axis(name, frozen((1 - t) * low + t * high), error))
    return tuple(axes)


def degree_of(values: ca.SX, parameter: ca.SX) -> tuple[int, ca.SX]:
    """Differentiate until nothing is left: the degree, and the derivative after it (zero for polynomials)."""
    for degree in range(DEGREE + 1):
        values = ca.sparsify(ca.jacobian(values, parameter))
        if values.nnz() == 0:
            return degree, values
    return DEGREE, values


def nodes_of(degree: int) -> Array:
    """Give the Chebyshev-Lobatto nodes in [0, 1], both ends among them."""
    return frozen((1 - np.cos(np.pi * np.arange(degree + 1) / degree)) / 2)


def _interpolation_error(fifth: Array, width: float) -> Array:
    """Bound |f - f_4| by max |f^(5)| / 5! max |product of (p - p_i)|; the product is at most (width/2)^5 / 8."""
    return frozen(fifth / math.factorial(DEGREE + 1) * (width / 2) ** (DEGREE + 1) / 2 ** (DEGREE - 1))


def _remainders(axes: tuple[_Axis, ...], n: int) -> tuple[float, float, float]:
    """Add up the errors of interpolating in one parameter after the other, E_1 + L E_2 + L^2 E_3 + ..., in norms."""
    errors = sorted((axis.error for axis in axes), key=lambda error: -float(np.max(error)))
    M, P_qq, g = _split(LEBESGUE ** np.arange(len(errors)) @ np.array(errors), n)
    return float(np.linalg.norm(M, 2)), float(np.linalg.norm(P_qq, 2)), float(np.linalg.norm(g))


def _expect_few(axes: tuple[_Axis, ...], forces: _Forces) -> None:
    made = {axis.name: axis.degree + 1 for axis in axes if axis.degree}
    made |= {"lambda_d": len(forces.offsets)} if forces.names else {}
    count = math.prod(made.values())
    if count > MOST_VERTICES:
        raise NoDesignError(
            f"the intervals make {count} vertices, and at most {MOST_VERTICES} are designed for: "
            f"{', '.join(f'`{name}` makes {each}' for name, each in made.items())}; take some of them as known"
        )


def _controls(op: OperatingPoint, response: ca.Function | None, axes: tuple[_Axis, ...]) -> list[_Control]:
    """Give the Bernstein coefficients of (M, P_qq, P_q) over the box."""
    if response is None:
        return [_Control({}, (), op.M, op.P_qq, op.g)]
    shape = [axis.degree + 1 for axis in axes]
    coefficients: Array = _evaluate(response, [axis.nodes for axis in axes]).reshape(*shape, -1)
    for k, axis in enumerate(axes):
        solve = np.linalg.inv(_bernstein(axis.degree))
        coefficients = np.moveaxis(np.tensordot(solve, coefficients, axes=(1, k)), 0, k)
    return [_control(axes, index, coefficients[index], op.n) for index in np.ndindex(*shape)]


def _control(axes: tuple[_Axis, ...], index: tuple[int, ...], values: Array, n: int) -> _Control:
    at = {axis.name: (axis, i) for axis, i in zip(axes, index, strict=True) if axis.degree}
    label = {name: axis.control_value(i) for name, (axis, i) in at.items()}
    return _Control(label, tuple(name for name, (axis, i) in at.items() if 0 < i < axis.degree), *_split(values, n))


def _evaluate(response: ca.Function, points: list[Array]) -> Array:
    values = np.array([call_vector(response, point) for point in itertools.product(*points)])
    if not np.all(np.isfinite(values)):
        raise NoDesignError("the plant is not defined everywhere in the parameters' intervals; narrow them")
    return values


def _bernstein(degree: int) -> Array:
    """Give the values of the Bernstein polynomials (columns) at the nodes (rows)."""
    if degree == 0:
        return np.ones((1, 1))
    t, j = nodes_of(degree)[:, None], np.arange(degree + 1)
    return frozen([math.comb(degree, each) for each in j] * t**j * (1 - t) ** (degree - j))


def _vertices(op: OperatingPoint, controls: list[_Control], forces: _Forces) -> Iterator[Vertex]:
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


def _enlargement(response: ca.Function | None, axes: tuple[_Axis, ...], controls: list[_Control]) -> float:
    """Measure the parameters' part: 1 + 2 (farthest distance of a control point) / (diameter of what occurs)."""
    from scipy.spatial.distance import pdist

    beyond = [control for control in controls if control.untaken]
    if response is None or not beyond:
        return 1.0
    size = controls[0].M.size
    occurring = _evaluate(response, _grid(axes))[:, : 2 * size]
    points = np.array([np.concatenate([control.M.ravel(), control.P_qq.ravel()]) for control in beyond])
    occurring, points = _scaled(occurring, points, size)
    diameter = float(np.max(pdist(occurring), initial=0.0))
    if diameter == 0:
        return 1.0
    return 1 + 2 * max(_distance(point, occurring) for point in points) / diameter


def _grid(axes: tuple[_Axis, ...]) -> list[Array]:
    """Sample the parameters: the ends where the hull is that of the ends, and a grid where there are curves."""
    curves = sum(axis.degree > 1 for axis in axes)
    corners = math.prod(len(axis.nodes) for axis in axes if axis.degree == 1)
    count = max(3, int((SAMPLES / corners) ** (1 / curves)))
    return [np.linspace(axis.nodes[0], axis.nodes[-1], count) if axis.degree > 1 else axis.nodes for axis in axes]


def _scaled(occurring: Array, points: Array, size: int) -> tuple[Array, Array]:
    """Measure M and P_qq each by its own range, in coordinates of as few directions as they need."""
    scale = np.zeros(2 * size)
    for part in (slice(0, size), slice(size, 2 * size)):
        reach = float(np.linalg.norm(np.ptp(occurring[:, part], axis=0)))
        if reach > CONSTANT * float(np.max(np.abs(occurring[:, part]))):
            scale[part] = 1 / reach
    both = (np.vstack([occurring, points]) - occurring[0]) * scale
    _, values, directions = np.linalg.svd(both, full_matrices=False)
    both = both @ directions[values > CONSTANT * values[0]].T
    return both[: len(occurring)], both[len(occurring) :]


def _distance(point: Array, cloud: Array) -> float:
    """Give the distance of a point from the convex hull of others (of size one)."""
    from scipy.optimize import nnls

    weights, _ = nnls(np.vstack([cloud.T, np.full(len(cloud), 100.0)]), np.append(point, 100.0))
    return float(np.linalg.norm(cloud.T @ weights / np.sum(weights) - point))
