"""How the plant at q_d depends on parameters: Bernstein coefficients over their box, and what those miss.

M, P_qq and P_q are nearly always polynomials of a parameter; what is none is interpolated, and the error bounded.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import casadi as ca
import numpy as np

from firmtouch.errors import NoDesignError
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import call_vector, frozen, symmetric
from firmtouch.mechanics.intervals import enclose, has_kinks
from firmtouch.regulation.operating_point import OperatingPoint

DEGREE: Final = 4
"""The highest degree that a parameter may have; what is no polynomial is interpolated with it."""
LEBESGUE: Final = 1.85
"""Bounds the interpolation's norm at five Chebyshev-Lobatto nodes (Ehlich and Zeller 1966)."""


@dataclass(frozen=True, slots=True)
class Axis:
    """One parameter: the nodes at which its polynomial is met, and what the polynomial misses, entry by entry."""

    name: str
    nodes: Array
    error: Array

    @property
    def degree(self) -> int:
        """The degree of the polynomial."""
        return len(self.nodes) - 1

    def control_value(self, i: int) -> float:
        """Give the parameter's value that belongs to a control point."""
        t = i / self.degree
        return float((1 - t) * self.nodes[0] + t * self.nodes[-1])


@dataclass(frozen=True, slots=True)
class Control:
    """One Bernstein control point (M, P_qq, P_q) of the parameters' part."""

    label: dict[str, float]
    untaken: tuple[str, ...]
    M: Array
    P_qq: Array
    g: Array


def response_of(op: OperatingPoint, parameters: Mapping[str, tuple[float, float]]) -> ca.Function:
    """Give (M, P_qq, P_q) at q_d, stacked, as a function of the uncertain parameters alone."""
    functions, names = op.plant.functions, list(op.plant.spec.parameters)
    uncertain, p = ca.SX.sym("p", len(parameters)), ca.SX(op.plant.p)
    for i, name in enumerate(parameters):
        p[names.index(name)] = uncertain[i]
    q = ca.SX.sym("q", op.n)
    assert ca.jacobian(functions["Phi"](q, p), uncertain).nnz() == 0, "q_d would move with these parameters"
    values = [ca.vec(functions[name](ca.SX(op.q_d), p)) for name in ("M", "P_qq", "P_q")]
    return ca.Function("response", [uncertain], [ca.densify(ca.vertcat(*values))])


def split_values(values: Array, n: int) -> tuple[Array, Array, Array]:
    """Undo the stacking of `_response`."""
    M, P_qq, g = np.split(values, (n * n, 2 * n * n))
    return symmetric(M.reshape(n, n)), symmetric(P_qq.reshape(n, n)), frozen(g)


def axes_of(
    op: OperatingPoint, response: ca.Function, parameters: Mapping[str, tuple[float, float]]
) -> tuple[Axis, ...]:
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
            axes.append(Axis(name, frozen([low if low == high else nominal[name]]), np.zeros(values.numel())))
            continue
        t = nodes_of(degree)
        error: Array = np.zeros(values.numel())
        if derivative.nnz():
            fifth = ca.Function("fifth", [p], [ca.densify(derivative)])
            error = interpolation_error(enclose(fifth, box, f"the dependence on `{name}`"), high - low)
        axes.append(Axis(name, frozen((1 - t) * low + t * high), error))
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


def interpolation_error(fifth: Array, width: float) -> Array:
    """Bound |f - f_4| by max |f^(5)| / 5! max |product of (p - p_i)|; the product is at most (width/2)^5 / 8."""
    return frozen(fifth / math.factorial(DEGREE + 1) * (width / 2) ** (DEGREE + 1) / 2 ** (DEGREE - 1))


def remainders_of(axes: tuple[Axis, ...], n: int) -> tuple[float, float, float]:
    """Add up the errors of interpolating in one parameter after the other, E_1 + L E_2 + L^2 E_3 + ..., in norms."""
    errors = sorted((axis.error for axis in axes), key=lambda error: -float(np.max(error)))
    M, P_qq, g = split_values(LEBESGUE ** np.arange(len(errors)) @ np.array(errors), n)
    return float(np.linalg.norm(M, 2)), float(np.linalg.norm(P_qq, 2)), float(np.linalg.norm(g))


def controls_of(op: OperatingPoint, response: ca.Function | None, axes: tuple[Axis, ...]) -> list[Control]:
    """Give the Bernstein coefficients of (M, P_qq, P_q) over the box."""
    if response is None:
        return [Control({}, (), op.M, op.P_qq, op.g)]
    shape = [axis.degree + 1 for axis in axes]
    coefficients: Array = evaluate(response, [axis.nodes for axis in axes]).reshape(*shape, -1)
    for k, axis in enumerate(axes):
        solve = np.linalg.inv(_bernstein(axis.degree))
        coefficients = np.moveaxis(np.tensordot(solve, coefficients, axes=(1, k)), 0, k)
    return [_control(axes, index, coefficients[index], op.n) for index in np.ndindex(*shape)]


def _control(axes: tuple[Axis, ...], index: tuple[int, ...], values: Array, n: int) -> Control:
    at = {axis.name: (axis, i) for axis, i in zip(axes, index, strict=True) if axis.degree}
    label = {name: axis.control_value(i) for name, (axis, i) in at.items()}
    untaken = tuple(name for name, (axis, i) in at.items() if 0 < i < axis.degree)
    return Control(label, untaken, *split_values(values, n))


def evaluate(response: ca.Function, points: list[Array]) -> Array:
    """Evaluate at all combinations of parameter values, one row each.

    Raises
    ------
    NoDesignError
        If it is not defined there.
    """
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
