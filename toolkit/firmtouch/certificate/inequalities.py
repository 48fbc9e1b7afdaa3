"""The matrix inequalities that keep the poles of a whole polytope inside an edge: [T4], and Finsler's lemma.

Both are affine in (M22, C22, K22): what holds at every vertex holds for all plants between them.
"""

from __future__ import annotations

from flint import arb

from firmtouch.certificate.edges import Edge
from firmtouch.certificate.matrices import (
    blocks,
    exact,
    identity,
    is_positive_definite,
    kronecker,
    middle,
    symmetrised,
)
from firmtouch.certificate.question import every
from firmtouch.certificate.subject import Subject
from firmtouch.certificate.witness import Multipliers
from firmtouch.regulation import tangent
from firmtouch.regulation.lmi_region import LmiRegion


def energy_proves(subject: Subject, edge: Edge, epsilon: float) -> bool | None:
    """[T4]: Pm = [[K22, eps M22], [eps M22, M22]] > 0 and -(L (x) Pm + R (x) PmA + R^T (x) (PmA)^T) > 0 everywhere."""
    balls, unit, eps = subject.balls(), subject.unit, arb(epsilon) / arb(subject.unit)
    L, R = edge.lmi(unit)
    C = balls.C22 / arb(unit)
    answers = []
    for plant in balls.plants:
        M, K = balls.tangent(plant.M), balls.tangent(balls.K(plant)) / arb(unit) ** 2
        P = blocks([[K, M * eps], [M * eps, M]])
        PA = blocks([[K * -eps, K - C * eps], [-K, M * eps - C]])
        moving = kronecker(R, PA)
        X = -(kronecker(L, P) + moving + moving.transpose())
        answers += [is_positive_definite(P), is_positive_definite(symmetrised(X))]
        if answers[-1] is not True:
            break
    return every(answers)


def energy_slack(subject: Subject, edge: Edge, epsilon: float) -> float:
    """Give the least eigenvalue of all these matrices, in floats."""
    L, R = (middle(X) for X in edge.lmi(subject.unit))
    return tangent.energy_slack(subject.tangents, [LmiRegion(L, R)], epsilon / subject.unit)


def finsler_proves(subject: Subject, edge: Edge, multipliers: Multipliers) -> bool | None:
    """Finsler's lemma for G y = 0 with G = [K22, C22, M22] and y = (z, z', z''):

    L (x) Y1^T P Y1 + R (x) Y1^T P Y2 + R^T (x) Y2^T P Y1 - I (x) (F^T G + G^T F) < 0 and P > 0 at every vertex.
    """  # noqa: D400  # the sentence goes on as a formula
    if not multipliers.unit > 0:
        return None  # time would run backwards
    balls, unit = subject.balls(), arb(multipliers.unit)
    T = exact(multipliers.basis)
    X = T - balls.J_plus * (balls.J * T)
    L, R = edge.lmi(multipliers.unit)
    F, t = exact(multipliers.F), X.ncols()
    one, zero = identity(t), identity(t) * 0
    Y1, Y2 = blocks([[one, zero, zero], [zero, one, zero]]), blocks([[zero, one, zero], [zero, zero, one]])
    C, answers = symmetrised(X.transpose() * balls.C * X) / unit, []
    if len(multipliers.P) != len(balls.vertices):
        return None
    for plant, P_ in zip(balls.vertices, multipliers.P, strict=True):
        M, K = (symmetrised(X.transpose() * each * X) for each in (plant.M, balls.K(plant)))
        G, P = blocks([[K / unit**2, C, M]]), exact(P_)
        moving = kronecker(R, Y1.transpose() * P * Y2)
        product = F.transpose() * G
        X_ = kronecker(L, Y1.transpose() * P * Y1) + moving + moving.transpose()
        X_ = kronecker(identity(L.nrows()), product + product.transpose()) - X_
        answers += [is_positive_definite(P), is_positive_definite(symmetrised(X_))]
        if answers[-1] is not True:
            break
    return every(answers)
