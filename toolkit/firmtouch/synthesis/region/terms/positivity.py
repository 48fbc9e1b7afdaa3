"""Positivity: C > 0, W > 0 and K >= mu D, the paper's conditions with a margin."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import cvxpy as cp
import numpy as np
import scipy.linalg

from firmtouch.mechanics import Array
from firmtouch.regulation import ClosedLoop
from firmtouch.synthesis.region.terms.term import Term
from firmtouch.synthesis.region.variables import Constraints, Variables

CLEAR: Final = 1e-3
"""The least of W, C and K beyond what is asked, in scaled coordinates: positive definite, and seen to be."""


@dataclass(frozen=True, kw_only=True)
class Positivity(Term):
    """K = W + N0 >= mu D (14), C > 0 and, on the full level, W > 0; D is a positive diagonal scale of units.

    On the tangent level all this is asked of the tangent blocks, and nothing of W.
    """

    name: str = "margin of (14)"
    asked: float = 0.0
    unit: str = "N m/rad"
    at_most: bool = False
    level: str = "full"
    D: Array = field(default_factory=lambda: np.ones(1))

    def constraints(self, variables: Variables) -> Constraints:
        """Ask for it at every corner, clear of the balls around the polytope."""
        v, scaling = variables, variables.scaling
        tangent, full = np.eye(v.t), np.eye(v.n)
        if self.level == "full":
            margin = self.asked * scaling.scaled_stiffness(np.diag(self.D))
            constraints = [K >> margin + (CLEAR + v.cushion.N_full) * full for K in v.K]
            return [*constraints, v.C >> CLEAR * full, v.W >> CLEAR * full]
        margin = self.asked * scaling.tangent(np.diag(self.D)) / scaling.omega**2
        constraints = [K22 >> margin + (CLEAR + v.cushion.N) * tangent for K22 in v.K22]
        return [*constraints, v.C22 >> CLEAR * tangent]

    def reached(self, loop: ClosedLoop) -> float:
        """Give mu: the least eigenvalue of D^-1 K, or minus infinity where C or W is not positive."""
        K, D, V2 = loop.K, np.diag(self.D), loop.split.V2
        level = loop.full if self.level == "full" else loop.tangent
        others = level.C[0] > 0 and (self.level == "tangent" or level.W[0] > 0)
        if not others:
            return -np.inf
        if self.level == "tangent":
            K, D = V2.T @ K @ V2, V2.T @ D @ V2
        return float(scipy.linalg.eigh(K, D, eigvals_only=True)[0])

    def objective(self, variables: Variables, mu: cp.Variable) -> Constraints:
        """Tie a variable to the margin: K >= mu D (scaled by trace, so that mu is about one)."""
        D = np.diag(self.D)
        if self.level == "full":
            scaled = variables.scaling.scaled_stiffness(D)
            return [K >> mu * scaled for K in variables.K]
        scaled = variables.scaling.tangent(D) / variables.scaling.omega**2
        return [K22 >> mu * scaled for K22 in variables.K22]
