"""Every pole inside the edges of the region, or left of what was assigned: by two routes that share nothing.

By matrix inequalities: [T4] with one eps for all plants, or Finsler's multipliers where a search had to go further, or,
for a single plant, any Lyapunov matrix. And by Routh's scheme on the characteristic polynomials of all vertices.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final

import numpy as np
from flint import arb

from firmtouch.certificate.edges import Edge, EdgeKind, is_hurwitz
from firmtouch.certificate.inequalities import energy_proves, energy_slack, finsler_proves
from firmtouch.certificate.lyapunov import lyapunov_matrix, proves
from firmtouch.certificate.matrices import BallMatrix, blocks, identity
from firmtouch.certificate.question import Question, Scope, every
from firmtouch.certificate.subject import Balls, Subject

HALVINGS: Final = 40
STABLE: Final = Edge(EdgeKind.DECAY, 0.0)

Route = tuple[str, Callable[[float], bool | None], Callable[[], float]]
"""A route's name, what it proves of a value, and what floats say that it reaches."""


def questions(subject: Subject) -> Iterator[Question]:
    """Ask for each edge by both routes."""
    for edge in subject.asked.edges or (STABLE,):
        yield _by_inequality(subject, edge)
        yield _by_routh(subject, edge)


def _words(edge: Edge) -> str:
    words = {
        EdgeKind.DECAY: "Re s < -alpha for every pole",
        EdgeKind.DAMPING: "-Re s / |s| > zeta for every pole",
        EdgeKind.BANDWIDTH: "|s| < w for every pole",
    }
    return words[edge.kind]


def _by_routh(subject: Subject, edge: Edge) -> Question:
    kind = edge.kind

    def holds(value: float) -> bool | None:
        balls = subject.balls()
        moved = Edge(kind, value)
        polynomials = (characteristic(subject, balls, each) for each in range(len(balls.plants)))
        return every(is_hurwitz(moved.moved(p, subject.unit)) for p in polynomials)

    return Question(
        f"{kind.words}, Routh-Hurwitz",
        _words(edge),
        Scope.VERTICES,
        ">" if kind.relation == ">=" else "<",
        edge.value,
        kind.unit,
        "Routh-Hurwitz",
        lambda: _reached(subject, kind),
        holds,
    )


def _by_inequality(subject: Subject, edge: Edge) -> Question:
    kind, witness = edge.kind, subject.witness
    single = not subject.plants.vary
    route, holds, estimate = _energy(subject, kind)
    if kind.words in witness.multipliers:
        route, holds, estimate = _multipliers(subject, kind, edge.value)
    elif single and (witness.epsilon is None or _misses(estimate, edge)):
        route, holds, estimate = _lyapunov(subject, kind)
    return Question(
        f"{kind.words}, LMI",
        _words(edge),
        Scope.NOMINAL if single else Scope.POLYTOPE,
        ">" if kind.relation == ">=" else "<",
        edge.value,
        kind.unit,
        route,
        estimate,
        holds,
        sufficient=True,
    )


def _misses(estimate: Callable[[], float], edge: Edge) -> bool:
    """Tell whether floats see that an inequality does not reach an edge."""
    best = estimate()
    return not (best > edge.value if edge.kind.relation == ">=" else best < edge.value)


def _energy(subject: Subject, kind: EdgeKind) -> Route:
    """[T4] with the eps that the search found."""
    epsilon = subject.witness.epsilon

    def holds(value: float) -> bool | None:
        return None if epsilon is None else energy_proves(subject, Edge(kind, value), epsilon)

    def estimate() -> float:
        """Bisect for the best value whose inequality still has slack; none if the region has none itself."""
        if epsilon is None:
            return np.inf if kind.relation == "<=" else -np.inf
        return _best(lambda value: energy_slack(subject, Edge(kind, value), epsilon) > 0, subject, kind)

    return f"[T4], eps = {epsilon:.4g} 1/s" if epsilon is not None else "[T4]", holds, estimate


def _multipliers(subject: Subject, kind: EdgeKind, asked: float) -> Route:
    multiplier = subject.witness.multipliers[kind.words]

    def holds(value: float) -> bool | None:
        return finsler_proves(subject, Edge(kind, value), multiplier)

    return "Finsler's lemma", holds, lambda: asked


def _lyapunov(subject: Subject, kind: EdgeKind) -> Route:
    def holds(value: float) -> bool | None:
        balls = subject.balls()
        moved = _scaled(Edge(kind, value), subject.unit)
        P = lyapunov_matrix(subject.tangents[0].companion(), moved)
        return None if P is None else proves(P, companion(subject, balls, 0), moved)

    return "Lyapunov", holds, lambda: _reached(subject, kind)


def _scaled(edge: Edge, unit: float) -> Edge:
    """Count time in 1/unit, a power of two: nothing is rounded."""
    return edge if edge.kind is EdgeKind.DAMPING else Edge(edge.kind, edge.value / unit)


def _best(fine: Callable[[float], bool], subject: Subject, kind: EdgeKind) -> float:
    """Bisect between what is hopeless and what the poles reach."""
    reached = _reached(subject, kind)
    if kind.relation == ">=":
        good, bad = -abs(reached) if kind is EdgeKind.DECAY else 0.0, reached
    else:
        good, bad = 64 * reached, reached
    if not fine(good):
        return -np.inf if kind.relation == ">=" else np.inf
    for _ in range(HALVINGS):
        middle = (good + bad) / 2
        good, bad = (middle, bad) if fine(middle) else (good, middle)
    return good


def _reached(subject: Subject, kind: EdgeKind) -> float:
    """See what the poles reach, in floats."""
    values = [
        kind.of_pole(complex(s) * subject.unit)
        for each in subject.tangents
        for s in np.linalg.eigvals(each.companion())
    ]
    return float(min(values) if kind.relation == ">=" else max(values))


def companion(subject: Subject, balls: Balls, i: int) -> BallMatrix:
    """Enclose A of x' = A x on ker J, with x = (x2, dx2/d(unit t)), of one plant."""
    unit, plant = arb(subject.unit), balls.plants[i]
    M, K, C = balls.tangent(plant.M), balls.tangent(balls.K(plant)) / unit**2, balls.C22 / unit
    t = M.nrows()
    lower = M.solve(blocks([[-K, -C]]))
    return blocks([[identity(t) * 0, identity(t)], [lower]])


def characteristic(subject: Subject, balls: Balls, i: int) -> list[arb]:
    """Enclose the coefficients of det(s I - A), from the constant one on, with s counted in `unit`."""
    coefficients: list[arb] = companion(subject, balls, i).charpoly().coeffs()
    return coefficients
