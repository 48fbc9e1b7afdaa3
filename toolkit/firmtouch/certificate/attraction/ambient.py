"""The closed loop over cells of all joint coordinates, for [T10] as it is printed.

T(q) = V2 - V1 (J V1)^-1 J V2 spans ker J, with V1 and V2 of the cell's own centre. E_q = J^T nu at an equilibrium,
which makes T^T (E_q - J^T mu) = 0 for any mu: a cell without a common zero of that and of Phi has no equilibrium on
the surface. In a central cell

    A(q) = [[Kbar, -J(q)^T], [Jbar, 0]],   Kbar, Jbar means over the segment from q* of E_qq - sum lambda*_j Phi_j'', J

is nonsingular: A (q - q*, nu - lambda*) = 0 holds at every equilibrium. On the surface p = E - mu^T Phi for any mu.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import casadi as ca
import numpy as np
from flint import arb, arb_mat

from firmtouch.certificate.attraction.attraction import NotProvenError
from firmtouch.certificate.attraction.chart import Cell, box, stiffness_chart
from firmtouch.certificate.attraction.expansion import EXPANSIONS, Expansion, constant, inputs
from firmtouch.certificate.attraction.forms import Form, Weights, arrange, fixed
from firmtouch.certificate.attraction.landscape import Landscape
from firmtouch.certificate.attraction.proof import find_rest
from firmtouch.certificate.attraction.rounding import lower, upper
from firmtouch.certificate.attraction.zeros import is_regular
from firmtouch.certificate.matrices import BallMatrix, blocks, exact, middle
from firmtouch.mechanics import Array
from firmtouch.mechanics.balls import BALLS, Ball
from firmtouch.mechanics.tape import Arithmetic, record
from firmtouch.regulation import ClosedLoop, split_directions

START: Final = 1e-3
"""Half-width, in rad or m, of the small graph on which q* is found; in a cell's widths, how near q_d it must be."""
ROUNDING: Final = 2**-50


_WHERE_DEFINED: Final = Arithmetic(
    BALLS.number,
    {**BALLS.operations, ca.OP_SQ: lambda x: x * x, ca.OP_SQRT: lambda x: x.nonnegative_part().sqrt()},
)
"""Balls for Phi alone: a root is bounded wherever it has a value, even where its slope has no bound."""


class Ambient:
    """The closed loop over cells of q - q_d."""

    def __init__(self, loop: ClosedLoop) -> None:
        op = loop.operating_point
        self._landscape = Landscape(op, loop.gains, stiffness_chart(loop))
        self.n, self.m = op.n, op.m
        self._q_d, self._W, self._bias = exact(op.q_d), exact(loop.gains.W), exact(loop.gains.bias)
        self._constants = [constant(arb(each)) for each in op.plant.p.tolist()]
        q, p = ca.SX.sym("q", op.n), ca.SX.sym("p", op.plant.p.size)
        names = (("P", "P_q", "Phi", "J"), ("J", "P_qq", "Phi_qq"))
        outputs = [ca.cse([ca.densify(op.plant.functions[name](q, p)) for name in each]) for each in names]
        self._values, self._slopes = (record(ca.Function("tape", [q, p], each), EXPANSIONS) for each in outputs)
        self._ground = self._landscape.ground
        Phi = ca.densify(op.plant.functions["Phi"](q, p))
        self._Phi = record(ca.Function("Phi", [q, p], [Phi]), _WHERE_DEFINED)
        self._p = [arb(each) for each in op.plant.p.tolist()]
        found = find_rest(self._landscape, box((START,) * self._landscape.chart.free))
        if found is None:
            raise NotProvenError("no equilibrium near q_d is proven")
        self._rest, self.bottom = found[0].q, found[0].value

    def has_none(self, cell: Cell) -> bool:
        """Prove that no equilibrium is in a cell."""
        there = self._there(cell)
        if there is None:
            return True
        V1, V2 = exact(there.V1), exact(there.V2)
        try:
            inverse = there.J.by(V1).inverse()
        except ZeroDivisionError:
            return False
        turn = inverse * there.J.by(V2)
        force = there.E_q - there.J.turned().by(there.mu)
        F = force.after(V2.transpose()) - turn.turned() * force.after(V1.transpose())
        slopes = np.vstack([np.hstack([middle(a) for a in each.A]) for each in (F, there.Phi)])
        try:
            Y = np.vstack([np.linalg.inv(slopes), np.eye(self.n)])
        except np.linalg.LinAlgError:
            Y = np.eye(self.n)
        if not np.all(np.isfinite(Y)):
            return False
        k = self.n - self.m
        tests = F.after(exact(Y[:, :k])) + there.Phi.after(exact(Y[:, k:]))
        return any(each > 0 or each < 0 for each in tests.whole.entries())

    def has_one(self, cell: Cell) -> bool:
        """Prove that q* is the only equilibrium in a cell around q_d, by A(q) of [T10]."""
        n, m = self.n, self.m
        if not all(
            abs(a - b).upper() < START * w for a, b, w in zip(self._rest, self._q_d.entries(), cell.widths, strict=True)
        ):
            return False
        J_x, P_qq, Phi_qq = self._slopes(self._inputs(cell), self._constants)
        weights = Weights(n, 0.5 + START, 1 / 3 + ROUNDING + START)
        at = self._landscape.point(arb_mat(n, 1, self._rest))
        V1 = self._landscape.V1
        try:
            mu = (at.J * V1).transpose().solve(V1.transpose() * at.E_q)
        except ZeroDivisionError:
            return False
        K = arrange(P_qq, n, n, n) + fixed(self._W, n)
        for j, multiplier in enumerate(mu.entries()):
            K -= arrange(Phi_qq[j * n * n : (j + 1) * n * n], n, n, n).times(multiplier)
        J = arrange(J_x, m, n, n)
        return is_regular(blocks([[K.mean(weights), -J.whole.transpose()], [J.mean(weights), arb_mat(m, m)]]))

    def bounds(self, cell: Cell) -> tuple[float, float] | None:
        """Bound p from below on the surface in a cell, and from above at its centre; None if no surface is there."""
        there = self._there(cell)
        if there is None:
            return None
        if not there.E.whole[0, 0].is_finite():
            return -np.inf, np.inf
        p = there.E - there.Phi.after(there.mu.transpose())
        return lower(p.whole[0, 0]), upper(p.C[0, 0])

    def _there(self, cell: Cell) -> There | None:
        """Expand the closed loop over a cell; None if the surface is certainly not in it."""
        n, m, q = self.n, self.m, self._inputs(cell)
        hull = (self._q_d + exact(cell.centre)).entries()
        values = self._Phi([x + arb(0, w) for x, w in zip(hull, cell.widths, strict=True)], self._p)[0]
        if not _may_vanish(values):
            return None
        P, P_q, Phi, J = self._values(q, self._constants)
        dq = arrange(q, n, 1, n) - fixed(self._q_d, n)
        pull = dq.after(self._W)
        half = (dq.turned() * pull).times(arb(1) / 2)
        E = arrange(P, 1, 1, n) - fixed(arb_mat([[self._ground]]), n) - dq.after(self._bias.transpose()) + half
        E_q = arrange(P_q, n, 1, n) - fixed(self._bias, n) + pull
        Phi_form, J_form = arrange(Phi, m, 1, n), arrange(J, m, n, n)
        if not _may_vanish(Phi_form.whole.entries()):
            return None
        if not np.all(np.isfinite(middle(J_form.C))):
            split = split_directions(np.eye(m, n))
            return There(E, E_q, Phi_form, J_form, arb_mat(m, 1), split.V1, split.V2)
        split = split_directions(middle(J_form.C))
        mu = exact(np.linalg.lstsq(middle(J_form.C).T, middle(E_q.C)[:, 0], rcond=None)[0])
        return There(E, E_q, Phi_form, J_form, mu, split.V1, split.V2)

    def _inputs(self, cell: Cell) -> list[Expansion]:
        """Give q over a cell; e_i is (q_i - its centre) / widths_i."""
        n, centre = self.n, self._q_d + exact(cell.centre)
        moves = arb_mat(n, n, [arb(cell.widths[i]) if i == j else arb(0) for i in range(n) for j in range(n)])
        return inputs(centre.entries(), moves, [arb_mat(n, n)] * n)


@dataclass(frozen=True, slots=True)
class There:
    """E (1 x 1), E_q (n x 1), Phi (m x 1) and J (m x n) over a cell; a multiplier and directions for its centre."""

    E: Form
    E_q: Form
    Phi: Form
    J: Form
    mu: BallMatrix
    V1: Array
    V2: Array


def _may_vanish(values: list[Ball]) -> bool:
    return all(each.contains(0) or not each.is_finite() for each in values)
