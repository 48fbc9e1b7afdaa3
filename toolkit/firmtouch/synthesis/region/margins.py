"""How much more the finished gains bear: each margin a number with a unit, and proven, not sampled."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from firmtouch.errors import InputError, NoDesignError
from firmtouch.mechanics import Array
from firmtouch.regulation import ClosedLoop, Gains, split_directions
from firmtouch.regulation.lmi_region import LmiRegion
from firmtouch.regulation.tangent import Tangent
from firmtouch.regulation.uncertainty import uncertainty_polytope, vertex_point
from firmtouch.synthesis.region.alternation import general_proof
from firmtouch.synthesis.region.problem import RegionProblem
from firmtouch.synthesis.region.proof import best_energy_slack
from firmtouch.synthesis.region.terms.positivity import Positivity
from firmtouch.synthesis.region.terms.term import RegionTerm

MOST_GENERAL: Final = 20
"""Free directions times loops up to which a general Lyapunov matrix is tried where [T4] proves no more."""
FARTHEST: Final = 64.0
"""Beyond this factor a margin is called unlimited."""
POLES_TO: Final = 1e-3
PROVEN_TO: Final = 0.15
"""How closely limits are found, as a part of what is gained: a proof takes long, and any found one is true."""
LARGEST_MULTIPLIER: Final = 1e12


@dataclass(frozen=True, slots=True)
class EdgeSlack:
    """The pole that is nearest to an edge of the region, over all vertices, and how far inside it is."""

    term: str
    slack: float
    unit: str
    pole: complex
    vertex: int


@dataclass(frozen=True, slots=True)
class Interval:
    """The values from `low` to `high` (infinite: no limit was met) for which the design provably still holds.

    That is: the poles lie in the region, and K is positive definite.
    """

    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Margins:
    """Margins of a finished design, in SI.

    mu is the least eigenvalue of D^-1 K over the polytope (14); `lambda_d` the largest ||dlambda|| with K > 0 still
    (exact for one constraint, else a lower bound), `N0` the largest relative error ||dN0|| / ||N0|| with K > 0 still.
    `parameters` are intervals that each uncertain parameter alone may have, the others staying in theirs;
    `W` and `C` multiply the gains. `edges` are the slacks of the poles to the edges of the region.
    """

    mu: float
    lambda_d: float
    N0: float
    parameters: dict[str, Interval]
    W: Interval
    C: Interval
    edges: tuple[EdgeSlack, ...]


def find_margins(problem: RegionProblem, gains: Gains, loops: tuple[ClosedLoop, ...], epsilon: float) -> Margins:
    """Compute all margins of finished gains, whose closed loops at the vertices are given.

    `epsilon` is the search's, in 1/s.
    """
    positivity = next(each for each in problem.terms if isinstance(each, Positivity))
    proof, radius = Proof(problem, gains, epsilon), problem.polytope.remainder_N0
    return Margins(
        mu=min(positivity.reached(loop) for loop in loops) - radius / float(np.min(positivity.D)),
        lambda_d=min(_multiplier_margin(loop, positivity.level, radius) for loop in loops),
        N0=min(_stiffness_margin(loop, positivity.level, radius) for loop in loops),
        parameters={name: _tolerated(problem, gains, proof, name) for name in problem.polytope.parameters},
        W=_multiplier(problem, gains, proof, "W"),
        C=_multiplier(problem, gains, proof, "C"),
        edges=tuple(_edges(problem, loops)),
    )


def _on_level(X: Array, loop: ClosedLoop, level: str) -> Array:
    return X if level == "full" else loop.split.V2.T @ X @ loop.split.V2


def _multiplier_margin(loop: ClosedLoop, level: str, radius: float) -> float:
    """K - sum_j dlambda_j Phi_j'' > 0: for one constraint a generalised eigenvalue, for more ||sum_j Hj^2||^(-1/2).

    `radius` is that of a ball around the polytope, which N0 may lie outside by.
    """
    K = _on_level(loop.K - radius * np.eye(len(loop.K)), loop, level)
    values, vectors = np.linalg.eigh(K)
    if values[0] <= 0:
        return 0.0
    half = (vectors / np.sqrt(values)) @ vectors.T
    hessians = [half @ _on_level(X, loop, level) @ half for X in loop.operating_point.constraint_hessians]
    size = float(np.sqrt(np.linalg.norm(sum(X @ X for X in hessians), 2)))
    return 1 / size if size > 1 / LARGEST_MULTIPLIER else np.inf


def _stiffness_margin(loop: ClosedLoop, level: str, radius: float) -> float:
    K, size = _on_level(loop.K, loop, level), float(np.linalg.norm(loop.operating_point.N0, 2))
    return max(float(np.linalg.eigvalsh(K)[0]) - radius, 0.0) / size if size else np.inf


def _edges(problem: RegionProblem, loops: tuple[ClosedLoop, ...]) -> list[EdgeSlack]:
    """Measure each pole against each edge: what the term bounds, for this one pole."""
    found = []
    for term in problem.terms:
        if not isinstance(term, RegionTerm):
            continue
        slack, i, s = min(
            ((term.margin(term.of_pole(s)), i, s) for i, loop in enumerate(loops) for s in loop.poles.pencil),
            key=lambda each: each[0],
        )
        found.append(EdgeSlack(term.name, slack, term.unit, s, i))
    return found


def regions_of(problem: RegionProblem) -> list[LmiRegion]:
    """List the regions that the poles shall lie in, time counted in 1/omega; without any, the left half plane."""
    regions = [each.region() for each in problem.terms if isinstance(each, RegionTerm)]
    stable = LmiRegion(np.zeros((1, 1)), np.ones((1, 1)))
    return [each.in_time_unit(problem.scaling.omega) for each in (regions or [stable])]


class Proof:
    """Proves that all loops between some have their poles in the region.

    By [T4]; where that proves no more, and for what [T4] does not prove from the start, by general Lyapunov matrices.
    Neither covers a ball around the polytope, so that with one nothing beyond the design itself is claimed.
    """

    def __init__(self, problem: RegionProblem, gains: Gains, epsilon: float) -> None:
        self._regions = regions_of(problem)
        self._hint = epsilon / problem.scaling.omega
        self._exact = not (problem.polytope.remainder_M or problem.polytope.remainder_N0)
        self._energy = best_energy_slack(problem.tangents(gains), self._regions, self._hint) > 0

    def possible(self, tangents: Sequence[Tangent]) -> bool:
        """Tell whether at least the poles of these loops lie in the region: no proof, but soon done."""
        poles = [s for each in tangents for s in np.linalg.eigvals(each.companion())]
        return self._exact and all(region.excess(s) < 0 for s in poles for region in self._regions)

    def holds(self, tangents: Sequence[Tangent]) -> bool:
        """Prove it."""
        if self._energy and best_energy_slack(tangents, self._regions, self._hint) > 0:
            return True
        small = len(tangents) * len(tangents[0].M) <= MOST_GENERAL
        return (small or not self._energy) and general_proof(tangents, self._regions) is not None

    def farthest(self, tangents: Callable[[float], Sequence[Tangent] | None], end: float | None = None) -> float:
        """Find about the largest factor from one on whose loops are proven; infinite beyond FARTHEST.

        The poles alone give an upper end, found by bisection; proofs are tried from there downwards.
        """

        def proven(factor: float) -> bool:
            loops = tangents(factor)
            return loops is not None and self.holds(loops)

        end = self.upper_end(tangents) if end is None else end
        if end == 1.0:
            return 1.0
        if proven(end):
            return np.inf if end == FARTHEST else end
        return _bisected(proven, 1.0, end, PROVEN_TO)

    def upper_end(self, tangents: Callable[[float], Sequence[Tangent] | None]) -> float:
        """Find about the largest factor from one on at which the poles lie in the region: proofs end before it."""

        def possible(factor: float) -> bool:
            loops = tangents(factor)
            return loops is not None and self.possible(loops)

        return _bisected(possible, 1.0, FARTHEST, POLES_TO)


def _bisected(fine: Callable[[float], bool], good: float, bad: float, accuracy: float) -> float:
    """Give the end if it is fine, else the largest factor found that is, to a part of its distance from one."""
    if fine(bad):
        return bad
    while bad - good > accuracy * (bad - 1.0):
        middle = (good + bad) / 2
        good, bad = (middle, bad) if fine(middle) else (good, middle)
    return good


def _multiplier(problem: RegionProblem, gains: Gains, proof: Proof, which: str) -> Interval:
    """Find a with W -> a W (or C -> a C): as one more vertex, so that all between 1 and a are proven too."""

    def scaled(a: float) -> list[Tangent] | None:
        W, C = (gains.W * a, gains.C) if which == "W" else (gains.W, gains.C * a)
        if not _positive(problem, W):
            return None
        return [*problem.tangents(gains), *problem.tangents(replace(gains, W=W, C=C))]

    return Interval(1 / proof.farthest(lambda factor: scaled(1 / factor)), proof.farthest(scaled))


def _positive(problem: RegionProblem, W: Array) -> bool:
    """Tell whether K is positive definite at every vertex, on the level that is asked for."""
    level = next(each.level for each in problem.terms if isinstance(each, Positivity))
    V2 = np.eye(len(W)) if level == "full" else split_directions(problem.op.J).V2
    return all(np.linalg.eigvalsh(V2.T @ (W + point.N0) @ V2)[0] > 0 for point in problem.points)


def _tolerated(problem: RegionProblem, gains: Gains, proof: Proof, name: str) -> Interval:
    """Widen one parameter's interval upwards, and downwards, as far as the proof goes.

    What is nowhere negative in the file, such as a mass, is not made so.
    """
    low, high = problem.polytope.parameters[name]
    width = (high - low) or abs(high) or 1.0
    floor = 0.0 if low >= 0 else -np.inf

    def widened(a: float, b: float) -> list[Tangent] | None:
        polytope = problem.polytope
        try:
            wider = uncertainty_polytope(
                problem.op,
                parameters=polytope.parameters | {name: (max(a, floor), b)},
                lambda_box=polytope.lambda_box,
                lambda_ball=polytope.lambda_ball,
            )
        except (NoDesignError, InputError):
            return None
        points = tuple(vertex_point(problem.op, vertex) for vertex in wider.vertices)
        there = replace(problem, points=points)
        return there.tangents(gains) if _positive(there, gains.W) else None

    def upwards(factor: float) -> list[Tangent] | None:
        return widened(low, high + (factor - 1) * width)

    def downwards(factor: float) -> list[Tangent] | None:
        return widened(low - (factor - 1) * width, high)

    up, down = proof.upper_end(upwards), proof.upper_end(downwards)
    both = widened(low - (down - 1) * width, high + (up - 1) * width) if max(up, down) > 1 else None
    if both is not None and proof.holds(both):  # at once is soonest, where it can be proven
        up, down = (np.inf if each == FARTHEST else each for each in (up, down))
    else:
        up, down = proof.farthest(upwards, up), proof.farthest(downwards, down)
    return Interval(max(low - (down - 1) * width, floor), high + (up - 1) * width)
