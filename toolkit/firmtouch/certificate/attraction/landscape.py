"""The closed loop's potential energy on the surface, enclosed over cells of the free coordinates.

Controllers (15) and (11) with any symmetric G_f >= 0 leave the mechanism the potential energy

    E(q) = P(q) - bias^T (q - q_d) + (q - q_d)^T W (q - q_d) / 2        up to a constant P_cd of Eq. (9) where Phi = 0

with W and `bias` the controller's own binary64 numbers, so that no rounding of g - f_d is left out. With J(q) V1
nonsingular, Phi = 0 is a graph x1 = s(x2) over a cell of the chart q = q_d + V1 x1 + V2 x2, and E a function p of x2:

    T = V2 + V1 s',  s' = -(J V1)^-1 J V2                       the graph's directions, J T = 0
    mu = (J V1)^-T V1^T E_q                                     Lagrange's multiplier
    p_x = T^T E_q,  p_xx = T^T (E_qq - sum_j mu_j Phi_j'') T

Equilibria of the closed loop are the critical points of p: E_q = J^T mu says the same as T^T E_q = 0.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import casadi as ca
import numpy as np
from flint import arb, arb_mat

from firmtouch.certificate.attraction.chart import Cell, Chart
from firmtouch.certificate.attraction.expansion import EXPANSIONS, Expansion, constant, inputs
from firmtouch.certificate.attraction.forms import arrange, fixed
from firmtouch.certificate.attraction.piece import Piece, Place
from firmtouch.certificate.matrices import BallMatrix, by_columns, exact, identity, middle
from firmtouch.mechanics.balls import BALLS, Ball
from firmtouch.mechanics.tape import Arithmetic, Tape, record
from firmtouch.regulation import Gains, OperatingPoint

NEWTON_STEPS: Final = 8
CLOSE: Final = 1e-13
"""Newton's method on the surface stops at steps below this, in rad or m: what is left is enclosed, not forgotten."""
ROOM: Final = 1.5
"""The tube that is tried around a graph, in sizes of the image of the tube before."""
TUBES: Final = 4
TINY: Final = 1e-9
"""A ball of this radius, in rad or m, is where a single point of the surface is looked for."""


@dataclass(frozen=True, slots=True)
class Point:
    """E, E_q (n), Phi (m) and J (m x n) at a point."""

    E: Ball
    E_q: BallMatrix
    Phi: BallMatrix
    J: BallMatrix


class Landscape:
    """E and the surface over one chart; every ball is computed at the precision of the moment."""

    def __init__(self, op: OperatingPoint, gains: Gains, chart: Chart) -> None:
        plant = op.plant
        self.n, self.m, self.chart = plant.n, plant.m, chart
        self._p = [arb(each) for each in plant.p.tolist()]
        self._constants = [constant(each) for each in self._p]
        self.q_d, self.V1, self.V2 = exact(chart.q_d), exact(chart.V1), exact(chart.V2)
        self._W, self._bias = exact(gains.W), exact(gains.bias)
        self._point = _tape(op, ("P", "P_q", "Phi", "J"), BALLS)
        self._surface = _tape(op, ("Phi", "J"), BALLS)
        self._bends = _tape(op, ("Phi_qq",), BALLS)
        self._inertia = _tape(op, ("M",), BALLS)
        self._sheet = _tape(op, ("Phi", "J"), EXPANSIONS)
        self._terms = _tape(op, ("J", "P_q", "P_qq", "Phi_qq"), EXPANSIONS)
        self.ground = arb(0)  # P(q_d), from which E is counted
        self.ground = self.point(self.q_d).E

    def q_of(self, x1: BallMatrix, x2: BallMatrix) -> BallMatrix:
        """Give q = q_d + V1 x1 + V2 x2."""
        return self.q_d + self.V1 * x1 + self.V2 * x2

    def hull(self, place: Place, part: Cell) -> list[Ball]:
        """Enclose the graph's q over a part of a cell."""
        centre = exact(part.centre)
        away = centre - exact(place.cell.centre)
        xi = symmetric_balls([arb(each) for each in part.widths])
        turned = [each * away for each in place.bend]
        slope = self.V2 + self.V1 * (place.slope + arb_mat([each.transpose().entries() for each in turned]))
        bent = arb_mat(self.m, 1, [dot(xi, each * xi) / 2 for each in place.bend])
        middle_q = self.q_of(place.axis(part.centre), centre)
        entries: list[Ball] = (middle_q + slope * xi + self.V1 * (bent + symmetric_balls(place.radius))).entries()
        return entries

    def M(self, q: list[Ball]) -> BallMatrix:
        """Enclose M(q), n x n."""
        return by_columns(self._inertia(q, self._p)[0], self.n, self.n)

    def point_jacobian(self, q: list[Ball]) -> BallMatrix:
        """Enclose J(q), m x n."""
        return by_columns(self._surface(q, self._p)[1], self.m, self.n)

    def point(self, q: BallMatrix) -> Point:
        """Evaluate at a point, with E counted from E(q_d)."""
        P, P_q, Phi, J = self._point(q.entries(), self._p)
        dq = q - self.q_d
        pull = self._W * dq
        E = P[0] - dot(self._bias, dq) + dot(dq, pull) / 2 - self.ground
        E_q = by_columns(P_q, self.n, 1) - self._bias + pull
        return Point(E, E_q, by_columns(Phi, self.m, 1), by_columns(J, self.m, self.n))

    def piece(self, cell: Cell, guess: BallMatrix | None = None) -> Piece | None:
        """Prove that over a cell, in a tube, the surface is one graph, and enclose p on it; None if that fails.

        With x1 = start + slope xi + bend(xi, xi)/2 + delta, the tube's axis follows the surface to second order. With
        R an approximate inverse of J V1, Krawczyk's operator

            -R Phi(axis) + (I - R J(tube) V1) delta

        maps the tube into its interior for all xi: so there is exactly one delta for each, and J V1 is nonsingular in
        all of the tube, which gives J its full row rank and s its derivative.
        """
        try:
            return self._piece(cell, arb_mat(self.m, 1) if guess is None else guess.mid())
        except (ZeroDivisionError, np.linalg.LinAlgError):
            return None

    def _piece(self, cell: Cell, guess: BallMatrix) -> Piece | None:
        x2 = exact(cell.centre)
        start = self._start(x2, guess)
        if start is None:
            return None
        at = self.point(self.q_of(start, x2))
        place = self._axis(cell, start, at)
        R = exact(np.linalg.inv(middle(at.J * self.V1)))
        radius = [arb(0)] * self.m
        for _ in range(TUBES):
            place = replace(place, radius=radius)
            Phi_x, J_x = self._sheet(self._inputs(place), self._constants)
            Phi, J = arrange(Phi_x, self.m, 1, self.n), arrange(J_x, self.m, self.n, self.n)
            contraction = identity(self.m) - R * J.whole * self.V1
            image = contraction * symmetric_balls(radius) - R * Phi.without(len(cell.low))
            sizes = [abs(each).upper() for each in image.entries()]
            if not all(each.is_finite() for each in sizes):
                return None
            if all(new < old for new, old in zip(sizes, radius, strict=True)):
                break
            radius = [(ROOM * each + CLOSE).upper() for each in sizes]
        else:
            return None
        off = solution_bound(contraction, R * at.Phi)
        if off is None or not all(o < r for o, r in zip(off, radius, strict=True)):
            return None  # the start is to lie in the tube, so that `off` is about the graph
        return self._expand(replace(place, off=off), at)

    def _axis(self, cell: Cell, start: BallMatrix, at: Point) -> Place:
        """Follow the surface to second order: J V1 s'' + T^T Phi'' T = 0. What comes out are numbers to start from."""
        JV1 = middle(at.J * self.V1)
        slope = exact(-np.linalg.solve(JV1, middle(at.J * self.V2)))
        T = self.V2 + self.V1 * slope
        (Phi_qq,) = self._bends(self.q_of(start, exact(cell.centre)).entries(), self._p)
        n, free = self.n, len(cell.low)
        blocks = [by_columns(Phi_qq[j * n * n : (j + 1) * n * n], n, n) for j in range(self.m)]
        bent = np.array([middle(T.transpose() * each * T) for each in blocks]).reshape(self.m, -1)
        bend = -np.linalg.solve(JV1, bent).reshape(self.m, free, free)
        zero = [arb(0)] * self.m
        return Place(cell, start, slope, tuple(exact((each + each.T) / 2) for each in bend), zero, zero)

    def _inputs(self, place: Place) -> list[Expansion]:
        """Give q over a tube: the e are xi / widths and delta / radius."""
        n, free = self.n, len(place.cell.low)
        sizes = [*map(arb, place.cell.widths), *place.radius]
        columns = [*(self.V2 + self.V1 * place.slope).transpose().tolist(), *self.V1.transpose().tolist()]
        moves = arb_mat(n, n, [columns[k][i] * sizes[k] for i in range(n) for k in range(n)])
        bends = []
        for row in self.V1.tolist():
            Q = arb_mat(n, n)
            for factor, bend in zip(row, place.bend, strict=True):
                for i in range(free):
                    for j in range(free):
                        Q[i, j] += factor * bend[i, j] * sizes[i] * sizes[j] / 2
            bends.append(Q)
        return inputs(self.q_of(place.start, exact(place.cell.centre)).entries(), moves, bends)

    def _start(self, x2: BallMatrix, x1: BallMatrix) -> BallMatrix | None:
        """Walk to the surface by Newton's method with x2 fixed; what comes out is a guess, and proven elsewhere."""
        for _ in range(NEWTON_STEPS):
            Phi, J = self._surface(self.q_of(x1, x2).entries(), self._p)
            JV1 = by_columns(J, self.m, self.n) * self.V1
            step = np.linalg.solve(middle(JV1), middle(by_columns(Phi, self.m, 1)))
            if not np.all(np.isfinite(step)):
                return None
            x1 = (x1 - exact(step)).mid()
            if np.max(np.abs(step)) < CLOSE:
                return x1
        return None

    def root(self, x2: tuple[float, ...], guess: BallMatrix) -> tuple[BallMatrix, list[Ball]] | None:
        """Prove that above a point there is an x1 with Phi = 0 near a guess; gives x1, and how far it may be off."""
        column = exact(x2)
        try:
            start = self._start(column, guess.mid())
            if start is None:
                return None
            Phi, J = self._surface(self.q_of(start, column).entries(), self._p)
            R = exact(np.linalg.inv(middle(by_columns(J, self.m, self.n) * self.V1)))
        except (ZeroDivisionError, np.linalg.LinAlgError):
            return None
        around = start + symmetric_balls([arb(TINY)] * self.m)
        slope = by_columns(self._surface(self.q_of(around, column).entries(), self._p)[1], self.m, self.n)
        off = solution_bound(identity(self.m) - R * slope * self.V1, R * by_columns(Phi, self.m, 1))
        return (start, off) if off is not None and all(each < TINY for each in off) else None

    def _expand(self, place: Place, at: Point) -> Piece:
        """Enclose p and p_x at the centre and expand p_xx over the cell."""
        n, V1, V2 = self.n, self.V1, self.V2
        q = self._inputs(place)
        J_q, P_q, P_qq, Phi_qq = self._terms(q, self._constants)
        J, curvature = arrange(J_q, self.m, n, n), arrange(P_qq, n, n, n) + fixed(self._W, n)
        bends = [arrange(Phi_qq[j * n * n : (j + 1) * n * n], n, n, n) for j in range(self.m)]
        moved = arrange(q, n, 1, n) - fixed(self.q_d, n)
        E_q = arrange(P_q, n, 1, n) - fixed(self._bias, n) + moved.after(self._W)
        mu = exact(np.linalg.solve(middle(at.J * V1).T, middle(V1.transpose() * at.E_q)))
        for multiplier, each in zip(mu.entries(), bends, strict=True):
            curvature -= each.times(multiplier)
        T_c = V2 + V1 * place.slope
        inverse = J.by(V1).inverse()
        turn = (inverse * J.by(T_c)).each(lambda X: -X)  # T = T_c + V1 turn
        # where the graph stands over the centre
        reach = V1 * symmetric_balls(place.off)
        pull = at.E_q - at.J.transpose() * mu + curvature.whole * reach
        gradient = T_c.transpose() * pull + turn.whole.transpose() * (V1.transpose() * pull)
        value = at.E - dot(mu, at.Phi) + dot(pull, reach)
        # mu over the cell less mu
        shifts = inverse.turned() * (E_q - J.turned().by(mu)).after(V1.transpose())
        for j, each in enumerate(bends):
            curvature -= each.scaled(shifts, j)
        across = curvature.after(V1.transpose())
        mixed = turn.turned() * across.by(T_c)
        hessian = curvature.by(T_c).after(T_c.transpose()) + mixed + mixed.turned()
        return Piece(place, value, gradient, hessian + turn.turned() * across.by(V1) * turn)


def _tape(op: OperatingPoint, names: tuple[str, ...], arithmetic: Arithmetic) -> Tape:
    plant = op.plant
    q, p = ca.SX.sym("q", plant.n), ca.SX.sym("p", plant.p.size)
    outputs = ca.cse([ca.densify(plant.functions[name](q, p)) for name in names])
    return record(ca.Function("tape", [q, p], outputs), arithmetic)


def dot(a: BallMatrix, b: BallMatrix) -> Ball:
    """Give a^T b of columns."""
    return (a.transpose() * b)[0, 0]


def symmetric_balls(sizes: list[Ball]) -> BallMatrix:
    """Give a column of balls around zero."""
    return arb_mat(len(sizes), 1, [arb(0, each) for each in sizes])


def solution_bound(contraction: BallMatrix, image: BallMatrix) -> list[Ball] | None:
    """Bound |delta| for delta = A delta - image with A in a ball of row sums below 1; None if they are not."""
    size = largest = arb(0)
    for row in contraction.tolist():
        size = arb.max(size, sum((abs(each).upper() for each in row), arb(0)).upper())
    for each in image.entries():
        largest = arb.max(largest, abs(each).upper())
    return [(largest / (1 - size)).upper()] * image.nrows() if size < 1 else None
