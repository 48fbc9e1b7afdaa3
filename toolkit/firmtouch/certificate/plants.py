"""All plants that a certificate is about, enclosed at a point of the surface: the nominal one, and all vertices.

The polytope is made here once more, from the plant's functions: Bernstein coefficients over the parameters' intervals,
and the vertices of what lambda_d may be. What is no polynomial of a parameter is interpolated, and every vertex
widened by a bound of what that misses; so M and N0 of all plants lie in the hull of these vertices.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import casadi as ca
import numpy as np
from flint import arb, arb_mat

from firmtouch.certificate.matrices import BallMatrix, by_columns, symmetrised
from firmtouch.mechanics.balls import BALLS, Ball
from firmtouch.mechanics.tape import Tape, record
from firmtouch.modelfile.sections.region import LambdaUncertainty
from firmtouch.regulation import OperatingPoint
from firmtouch.regulation.dependence import DEGREE, LEBESGUE, degree_of, nodes_of

NOMINAL: Final = "nominal plant"


@dataclass(frozen=True, slots=True)
class PlantBalls:
    """M and N0 (n x n) of one plant: the nominal one, or a vertex."""

    label: str
    M: BallMatrix
    N0: BallMatrix


def each_once(nominal: PlantBalls, vertices: tuple[PlantBalls, ...]) -> tuple[PlantBalls, ...]:
    """List the nominal plant and all vertices; where nothing varies it is itself the only vertex."""
    return vertices if vertices[0] is nominal else (nominal, *vertices)


@dataclass(frozen=True, slots=True)
class _Axis:
    """How one parameter enters: at these nodes, and the derivative that the interpolation misses (or nothing)."""

    name: str
    nodes: tuple[float, ...]
    missed: Tape | None

    @property
    def degree(self) -> int:
        return len(self.nodes) - 1

    @property
    def width(self) -> Ball:
        return arb(self.nodes[-1]) - arb(self.nodes[0])


class Plants:
    """M, P_qq and Phi_qq of all plants as tapes; `at` encloses them at the precision of the moment."""

    def __init__(
        self,
        op: OperatingPoint,
        intervals: Mapping[str, tuple[float, float]],
        forces: LambdaUncertainty | None,
    ) -> None:
        self._n, self._names = op.n, list(op.plant.spec.constraints)
        self._lambda_d = [arb(each) for each in op.lambda_d.tolist()]
        self._forces = forces
        names = list(op.plant.spec.parameters)
        self._nominal = [float(op.plant.p[names.index(each)]) for each in intervals]
        # Parameters stay symbols, as CasADi would round products of numbers. Zeros are safe, and say what is absent.
        q, uncertain, known = ca.SX.sym("q", op.n), ca.SX.sym("u", len(intervals)), ca.SX.sym("p", op.plant.p.size)
        self._p = [arb(each) for each in op.plant.p.tolist()]
        p = ca.vertcat(*(known[i] if each else ca.SX(0) for i, each in enumerate(op.plant.p.tolist())))
        nominal = ca.SX(p)
        for i, name in enumerate(intervals):
            p[names.index(name)] = uncertain[i]
        functions = op.plant.functions
        values = ca.vertcat(*(ca.vec(functions[name](q, p)) for name in ("M", "P_qq")))
        hessians, gradient = functions["Phi_qq"](q, nominal), functions["P_q"](q, nominal)
        self._values = record(ca.Function("values", [q, uncertain, known], [ca.densify(values)]), BALLS)
        self._hessians = record(ca.Function("hessians", [q, known], [ca.densify(ca.vec(hessians))]), BALLS)
        self._gradient = record(ca.Function("gradient", [q, known], [ca.densify(gradient)]), BALLS)
        stacked = [hessians[:, j * op.n : (j + 1) * op.n] for j in range(op.m)]
        self._curved = [j for j, each in enumerate(stacked) if ca.sparsify(each).nnz()]
        self._box = list(intervals.values())
        self._axes = [
            _axis(name, interval, values, ca.vertcat(q, uncertain, known), uncertain[i])
            for i, (name, interval) in enumerate(intervals.items())
        ]

    @property
    def vary(self) -> bool:
        """Tell whether there is more than the nominal plant."""
        return any(each.degree for each in self._axes) or any(len(each) for each, _ in self._offsets())

    def hessians(self, q: Sequence[Ball]) -> list[BallMatrix]:
        """Enclose Phi_j''(q)."""
        (entries,) = self._hessians(q, self._p)
        size = self._n**2
        return [
            symmetrised(by_columns(entries[j * size : (j + 1) * size], self._n, self._n))
            for j in range(len(self._lambda_d))
        ]

    def gradient(self, q: Sequence[Ball]) -> BallMatrix:
        """Enclose P_q(q) of the nominal plant."""
        (entries,) = self._gradient(q, self._p)
        return by_columns(entries, self._n, 1)

    def at(self, q: Sequence[Ball]) -> tuple[PlantBalls, tuple[PlantBalls, ...]]:
        """Give the nominal plant and all vertices (the nominal plant alone if nothing varies)."""
        hessians = self.hessians(q)
        nominal = self._plant(NOMINAL, self._values(q, [arb(each) for each in self._nominal], self._p)[0], hessians, {})
        if not self.vary:
            return nominal, (nominal,)
        spread = self._spread(q)
        vertices = [
            self._plant(", ".join(filter(None, (label, of_force))), self._widened(values, spread), hessians, offset)
            for label, values in self._controls(q)
            for offset, of_force in self._offsets()
        ]
        return nominal, tuple(vertices)

    def _plant(
        self, label: str, values: Sequence[Ball], hessians: Sequence[BallMatrix], offset: Mapping[int, Ball]
    ) -> PlantBalls:
        size = self._n**2
        M, P_qq = (symmetrised(by_columns(part, self._n, self._n)) for part in (values[:size], values[size:]))
        N0 = P_qq
        for j, hessian in enumerate(hessians):
            N0 = N0 - hessian * (self._lambda_d[j] + offset.get(j, arb(0)))  # of Eq. (14)
        return PlantBalls(label, M, N0)

    def _controls(self, q: Sequence[Ball]) -> Iterator[tuple[str, list[Ball]]]:
        """Give the Bernstein coefficients over the box of the parameters."""
        shape = [axis.degree + 1 for axis in self._axes]
        at_nodes = [
            self._values(q, [arb(each) for each in point], self._p)[0]
            for point in itertools.product(*(axis.nodes for axis in self._axes))
        ]
        table = np.empty((*shape, len(at_nodes[0])), dtype=object)
        table.reshape(len(at_nodes), -1)[:] = at_nodes
        for k, axis in enumerate(self._axes):
            if axis.degree > 1:  # of a line the coefficients are the values at its ends
                table = np.moveaxis(np.tensordot(_to_bernstein(axis), table, axes=(1, k)), 0, k)
        for index in np.ndindex(*shape):
            named = [_label(axis, i) for axis, i in zip(self._axes, index, strict=True) if axis.degree]
            yield ", ".join(named), table[index].tolist()

    def _offsets(self) -> list[tuple[dict[int, Ball], str]]:
        """List the vertices of lambda_d - its nominal value: of a box, or of what holds a ball."""
        if self._forces is None:
            return [({}, "")]
        if self._forces.box is not None:
            radii = {j: arb(self._forces.box[self._names[j]]) for j in self._curved}
        else:
            radii = dict.fromkeys(self._curved, arb(self._forces.ball or 0.0))
        radii = {j: radius for j, radius in radii.items() if not radius.is_zero()}
        if not radii:
            return [({}, "")]
        if self._forces.ball is not None and len(radii) > 2:  # 2 m vertices instead of 2^m
            wide = arb(len(radii)).sqrt()
            moves = [{j: sign * radius * wide} for j, radius in radii.items() for sign in (1, -1)]
        else:
            signs = itertools.product((-1, 1), repeat=len(radii))
            moves = [
                {j: sign * radius for (j, radius), sign in zip(radii.items(), each, strict=True)} for each in signs
            ]
        return [(move, ", ".join(self._force_label(j, each) for j, each in move.items())) for move in moves]

    def _force_label(self, j: int, offset: Ball) -> str:
        return f"lambda_d.{self._names[j]} = {float((self._lambda_d[j] + offset).mid()):g}"

    def _spread(self, q: Sequence[Ball]) -> list[Ball]:
        """Bound, entry by entry, what the interpolation misses: E_1 + L E_2 + L^2 E_3 ..."""
        box = [arb((arb(a) + arb(b)) / 2, ((arb(b) - arb(a)) / 2).upper()) for a, b in self._box]
        spread, factor = [arb(0)] * (2 * self._n**2), arb(1)
        for axis in self._axes:
            if axis.missed is None:
                continue
            scale = factor * (axis.width / 2) ** (DEGREE + 1) / math.factorial(DEGREE + 1) / 2 ** (DEGREE - 1)
            (derivative,) = axis.missed([*q, *box, *self._p])
            spread = [each + scale * abs(more).upper() for each, more in zip(spread, derivative, strict=True)]
            factor *= arb(LEBESGUE)
        return spread

    def _widened(self, values: Sequence[Ball], spread: Sequence[Ball]) -> list[Ball]:
        return [
            each if more.is_zero() else each + arb(0, more.upper()) for each, more in zip(values, spread, strict=True)
        ]


def _axis(name: str, interval: tuple[float, float], values: ca.SX, variables: ca.SX, parameter: ca.SX) -> _Axis:
    """Find out how a parameter enters M and P_qq."""
    (low, high), (degree, derivative) = interval, degree_of(values, parameter)
    if degree == 0 or low == high:
        return _Axis(name, (low,), None)
    inner = nodes_of(degree)[1:-1].tolist()
    nodes = (low, *((1 - t) * low + t * high for t in inner), high)
    missed = None
    if derivative.nnz():
        missed = record(ca.Function("missed", [variables], [ca.densify(derivative)]), BALLS)
    return _Axis(name, nodes, missed)


def _to_bernstein(axis: _Axis) -> np.ndarray:
    """Give the matrix from values at the nodes to Bernstein coefficients, as balls."""
    d = axis.degree
    t = [(arb(node) - arb(axis.nodes[0])) / axis.width for node in axis.nodes]
    values = arb_mat([[math.comb(d, j) * each**j * (1 - each) ** (d - j) for j in range(d + 1)] for each in t])
    return np.array(values.inv().tolist(), dtype=object)


def _label(axis: _Axis, i: int) -> str:
    if i in (0, axis.degree):
        return f"{axis.name} = {axis.nodes[0 if i == 0 else -1]:g}"
    return f"{axis.name}: control point {i} of {axis.degree}"
