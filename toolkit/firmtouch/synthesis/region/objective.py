"""What is made small: the gains, the guaranteed cost, or minus the margin of (14), or a weighted sum of these."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import cvxpy as cp
import numpy as np

from firmtouch.synthesis.region.terms.guaranteed_cost import GuaranteedCost
from firmtouch.synthesis.region.terms.positivity import Positivity
from firmtouch.synthesis.region.terms.term import Term
from firmtouch.synthesis.region.variables import Constraints, Variables

REGULARISED = 1e-3
"""The part that the gains have in every objective, so that no gain grows for nothing."""


class Objective:
    """Expressions for cvxpy, one for each name, in SI: `gains` = ||W||_F + omega ||C||_F, `margin` = -mu, `cost` = J.

    `scale` makes their sizes comparable: the stiffness omega^2 M of the plant for gains and margin, 1/omega for J.
    """

    def __init__(self, variables: Variables, terms: tuple[Term, ...], weights: Mapping[str, float]) -> None:
        self.variables = v = variables
        self.weights = {name: weight for name, weight in weights.items() if name != "force_error"}  # the second stage's
        stiffness = v.scaling.omega**2 * float(np.mean(v.scaling.joint**2))
        sizes = np.outer(v.scaling.joint, v.scaling.joint) * v.scaling.omega**2
        self.constraints: Constraints = []
        self.expressions: dict[str, Any] = {
            "gains": cp.norm(cp.multiply(sizes, v.W), "fro") + cp.norm(cp.multiply(sizes, v.C), "fro")
        }
        self.scale = {"gains": stiffness, "margin": stiffness, "cost": 1 / v.scaling.omega}
        if "margin" in weights:
            mu = cp.Variable()
            positivity = next(each for each in terms if isinstance(each, Positivity))
            self.constraints += positivity.objective(v, mu)
            self.scale["margin"] = stiffness / float(np.mean(positivity.D))
            self.expressions["margin"] = -mu
        if "cost" in weights:
            cost = next(each for each in terms if isinstance(each, GuaranteedCost))
            self.expressions["cost"] = cost.objective(v)

    def total(self) -> Any:  # noqa: ANN401  # a cvxpy expression
        """Give the weighted sum."""
        weights = {"gains": REGULARISED} | self.weights
        return sum(weight / self.scale[name] * self.expressions[name] for name, weight in weights.items())
