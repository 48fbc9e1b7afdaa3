"""What a region design is about, as one value: the plants, the terms, and the coordinates of the search."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import scipy.linalg

from firmtouch.errors import InputError
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen, symmetric
from firmtouch.modelfile import ModelSpec
from firmtouch.modelfile.sections.structure import Structure
from firmtouch.modelfile.vector_units import Units, units_of
from firmtouch.regulation import Gains, OperatingPoint, Split, split_directions
from firmtouch.regulation.force_loop.choice import force_feedback_of
from firmtouch.regulation.tangent import Tangent
from firmtouch.regulation.uncertainty import Polytope, uncertain_parameters, uncertainty_polytope, vertex_point
from firmtouch.synthesis.region.audit import Audit, audit
from firmtouch.synthesis.region.coordinates import Scaling, scale
from firmtouch.synthesis.region.search import Range
from firmtouch.synthesis.region.specification import terms_of
from firmtouch.synthesis.region.terms.bandwidth import Bandwidth
from firmtouch.synthesis.region.terms.decay import Decay
from firmtouch.synthesis.region.terms.guaranteed_cost import GuaranteedCost
from firmtouch.synthesis.region.terms.term import Term
from firmtouch.synthesis.region.variables import Cushion, Variables, corner_of

TYPICAL: Final = 2.5
"""Poles of a well-damped loop lie about this factor from the decay rate, and from the bandwidth."""


@dataclass(frozen=True, slots=True)
class RegionProblem:
    """All that a search is about: the plant's polytope, what is asked, and the coordinates it is solved in.

    `shaped` says that the normal blocks of W and C are free, and chosen in a second stage; `disturbance` are the
    semi-axes of the constant forces that it looks at.
    """

    op: OperatingPoint
    polytope: Polytope
    points: tuple[OperatingPoint, ...]
    terms: tuple[Term, ...]
    objective: Mapping[str, float]
    structure: Structure
    G_f: Array
    feedback_limit: Array | None
    shaped: bool
    disturbance: Array
    units: Units
    scaling: Scaling
    where: Range

    def variables(self) -> Variables:
        """Make fresh decision variables."""
        T, joint, omega = self.scaling.T, self.scaling.joint, self.scaling.omega
        size = float(np.linalg.norm(T, 2)) ** 2
        M, N = self.polytope.remainder_M, self.polytope.remainder_N0
        cushion = Cushion(M * size, N * size / omega**2, N / omega**2 / float(np.min(joint)) ** 2)
        corners = tuple(corner_of(point, self.scaling) for point in self.points)
        pattern = np.array(self.structure.pattern)
        return Variables(self.op, self.scaling, corners, pattern=pattern, cushion=cushion)

    def gains(self, W: Array, C: Array) -> Gains:
        """Complete W and C to gains."""
        return Gains(symmetric(W), symmetric(C), self.G_f, frozen(self.op.g - self.op.f_d))

    def tangents(self, gains: Gains) -> list[Tangent]:
        """Scale the closed loops at all vertices."""
        scaling = self.scaling
        C = scaling.tangent(gains.C) / scaling.omega
        return [
            Tangent(scaling.tangent(point.M), C, scaling.tangent(gains.W + point.N0) / scaling.omega**2)
            for point in self.points
        ]

    def audit(self, gains: Gains) -> Audit:
        """See what gains reach at every vertex."""
        return audit(self.op, self.points, gains, self.terms)

    def with_terms(self, terms: tuple[Term, ...]) -> RegionProblem:
        """Ask for something else of the same plants, with eps looked for where that makes sense."""
        return replace(self, terms=terms, where=_range(terms, self.scaling.omega))


def build_problem(op: OperatingPoint, spec: ModelSpec) -> RegionProblem:
    """Build the problem that a file's region design poses.

    Raises
    ------
    NoDesignError
        If the intervals make too many vertices.
    InputError
        If the inertia matrix is not positive definite at one of them.
    """
    region = spec.design.region
    assert region is not None
    shaped = region.structure.kind == "full" and spec.design.normal_blocks.policy == "free"
    if "force_error" in region.objective and not shaped:
        raise InputError(
            "the objective `force_error` needs `structure: full` and `normal_blocks: free`: it chooses K12"
        )
    uncertain = region.uncertainty
    forces = uncertain.lambda_d if uncertain else None
    polytope = uncertainty_polytope(
        op,
        parameters=uncertain_parameters(spec),
        lambda_box=forces.box if forces else None,
        lambda_ball=forces.ball if forces else None,
    )
    terms, split = terms_of(spec), split_directions(op.J)
    omega = reference_frequency(op, split, terms)
    return RegionProblem(
        op=op,
        polytope=polytope,
        points=tuple(vertex_point(op, vertex) for vertex in polytope.vertices),
        terms=terms,
        objective=region.objective,
        structure=region.structure,
        G_f=force_feedback_of(spec.design),
        feedback_limit=None if region.force_feedback_limit is None else frozen(region.force_feedback_limit),
        disturbance=_disturbance(spec),
        units=units_of(spec),
        shaped=shaped,
        scaling=scale(op, split, omega),
        where=_range(terms, omega),
    )


def _disturbance(spec: ModelSpec) -> Array:
    """Give the semi-axes of the constant forces; 1 in SI where the file gives none."""
    given = spec.bounds.disturbance
    return frozen([1.0 if given is None else given[name] for name in spec.coordinates])


def reference_frequency(op: OperatingPoint, split: Split, terms: tuple[Term, ...]) -> float:
    """Guess about how fast the loop will be (rad/s): it is the search's unit of time, and moves no solution."""
    slow = next((each.asked for each in terms if isinstance(each, Decay)), None)
    fast = next((each.asked for each in terms if isinstance(each, Bandwidth)), None)
    if slow is not None and fast is not None:
        return float(np.sqrt(slow * fast))
    if slow is not None or fast is not None:
        return slow * TYPICAL if slow is not None else (fast or 0.0) / TYPICAL
    cost = next((each for each in terms if isinstance(each, GuaranteedCost)), None)
    V2 = split.V2
    if cost is not None:  # a double integrator's optimal control: omega^4 = q / r
        reach = (op.M @ V2) / cost.torque[:, None]
        return float((np.sum((V2 / cost.position[:, None]) ** 2) / np.sum(reach**2)) ** 0.25)
    natural = scipy.linalg.eigvalsh(V2.T @ op.N0 @ V2, V2.T @ op.M @ V2)
    return float(np.sqrt(np.max(np.abs(natural)))) or 1.0


def _range(terms: tuple[Term, ...], omega: float) -> Range:
    slow = next((each.asked for each in terms if isinstance(each, Decay)), omega / TYPICAL)
    return Range(slow, next((each.asked for each in terms if isinstance(each, Bandwidth)), np.inf))
