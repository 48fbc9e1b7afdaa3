"""A landscape z = h(x, y)."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np

from firmtouch.mechanics.arrays import frozen
from firmtouch.mechanics.rigid_bodies import rotation
from firmtouch.mechanics.space import into_frame, length
from firmtouch.mechanics.surfaces.spline import basis, coefficients
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile.sections.surface import HeightField


def distance(field: HeightField, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give f / |grad f| of f = z - h(x, y); beyond the grid, h goes on as the cubics of the outer cells."""
    y = in_frame(field, x, symbols)
    h = Heights(field, y, symbols)
    return (y[2] - h(0, 0)) / length(ca.vertcat(-h(1, 0), -h(0, 1), 1))


def normal(field: HeightField, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give the normal of the landscape under x."""
    h = Heights(field, in_frame(field, x, symbols), symbols)
    upwards = ca.vertcat(-h(1, 0), -h(0, 1), 1)
    return rotation(field.orientation, symbols) @ (upwards / length(upwards))


def in_frame(field: HeightField, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give a point of the world in the field's frame."""
    return into_frame(x, field.position, rotation(field.orientation, symbols), symbols)


class Heights:
    """h and its partial derivatives at a point of the field's frame.

    All derivatives share the products C b^(k) with the coefficients, which are most of the instructions: CasADi's own
    differentiation would write them anew for every direction.
    """

    def __init__(self, field: HeightField, y: ca.SX, symbols: Symbols) -> None:
        heights = np.array(field.heights)
        n = heights.shape
        starts, self._steps, t = [], [], []
        for span, count, at in zip((field.x, field.y), n, (y[0], y[1]), strict=True):
            start, stop = ca.vertsplit(symbols.column(span))
            step = (stop - start) / (count - 1)
            starts.append(start)
            self._steps.append(step)
            t.append((at - start) / step)
        self._C = frozen(coefficients(coefficients(heights).T).T)
        self._along = basis(t[0], n[0])
        self._across = basis(t[1], n[1])
        self._products: dict[int, ca.SX] = {}

    def __call__(self, a: int, b: int) -> ca.SX:
        """Give d^a/dx^a d^b/dy^b h, a and b up to 3."""
        if b not in self._products:
            self._products[b] = ca.mtimes(ca.DM(self._C), self._across[b])
        scale = self._steps[0] ** a * self._steps[1] ** b
        return ca.SX(ca.dot(self._along[a], self._products[b]) / scale)


def expand(field: HeightField, x: ca.SX, symbols: Symbols) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Give the distance, its gradient (3) and its Hessian (3 x 3), from h's cubic Taylor polynomial at x."""
    R = rotation(field.orientation, symbols)
    y = into_frame(x, field.position, R, symbols)
    h = Heights(field, y, symbols)
    orders = [(a, b) for a in range(4) for b in range(4 - a)]
    d, jets = ca.SX.sym("d", 3), ca.SX.sym("h", len(orders) + 1)
    terms = [
        jets[i] * d[0] ** a * d[1] ** b / (math.factorial(a) * math.factorial(b)) for i, (a, b) in enumerate(orders)
    ]
    f = jets[-1] + d[2] - sum(terms, ca.SX(0))
    s = f / length(ca.gradient(f, d))
    hessian, gradient = ca.hessian(s, d)
    values = ca.vertcat(*(h(a, b) for a, b in orders), y[2])
    at_x = ca.Function("jet", [d, jets], [s, gradient, hessian])
    value, gradient, hessian = at_x(ca.SX.zeros(3), values)
    return value, R @ gradient, R @ hessian @ R.T


def within(field: HeightField, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give what is at least zero over the grid: the distance to its nearest side, along its axes."""
    y = in_frame(field, x, symbols)
    rooms = []
    for span, at in ((field.x, y[0]), (field.y, y[1])):
        start, stop = ca.vertsplit(symbols.column(span))
        rooms += [at - start, stop - at]
    return ca.mmin(ca.vertcat(*rooms))
