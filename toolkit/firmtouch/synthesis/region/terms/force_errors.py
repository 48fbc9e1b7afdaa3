"""Steady-state errors of the contact force, under constant forces and under an offset of the surface [T6]."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, field

import cvxpy as cp
import numpy as np

from firmtouch.mechanics import Array
from firmtouch.regulation import ClosedLoop
from firmtouch.regulation.steady_state import disturbance_matrices, offset_matrices
from firmtouch.synthesis.region.terms.term import Term
from firmtouch.synthesis.region.variables import Constraints, Variables


@dataclass(frozen=True, kw_only=True)
class ForceError(Term):
    """||dlambda_ss|| <= gamma for all causes within an ellipsoid with these semi-axes; `feedback` is Lambda.

    The constraints of its kinds hold around a `reference`, which comes from gains found before.
    """

    at_most: bool = True
    semi_axes: Array = field(default_factory=lambda: np.zeros(0))
    feedback: Array = field(default_factory=lambda: np.zeros((0, 0)))
    reference: Array | None = None

    @property
    def exact(self) -> bool:
        """Tell that the constraint holds around a reference."""
        return False

    @abstractmethod
    def matrix(self, loop: ClosedLoop) -> Array:
        """Give dlambda_ss for each unit of the cause."""

    def reached(self, loop: ClosedLoop) -> float:
        """Give the worst force error."""
        return float(np.linalg.norm(self.matrix(loop) * self.semi_axes, 2))


@dataclass(frozen=True, kw_only=True)
class OffsetForceError(ForceError):
    """||dlambda_ss|| <= gamma for all offsets within the ellipsoid with semi-axes Delta_j, Eq. (32).

    dlambda_ss = Lambda U S^-1 X S^-1 U^T Delta with the Schur complement X = K11 - K12 K22^-1 K12^T, which is the least
    of N^T K N over all N = V1 - V2 L^T. So any L gives a linear condition that suffices: S^-1 N^T K N S^-1 <= x I. With
    L = K12 K22^-1 itself nothing is lost for m = 1, or where Lambda and the semi-axes are multiples of one.
    The reference is L (m x (n-m)), zero if it is not known yet.
    """

    name: str = "force error under offset"

    def constraints(self, variables: Variables) -> Constraints:
        """Bound N^T K N at every corner, in units of the bound."""
        split, scaling = variables.split, variables.scaling
        L = np.zeros((len(split.S), variables.t)) if self.reference is None else self.reference
        most = self.asked / (np.linalg.norm(self.feedback, 2) * float(np.max(self.semi_axes)))
        N = scaling.joint[:, None] * (split.V1 - split.V2 @ L.T) / split.S * scaling.omega / np.sqrt(most)
        cushion = variables.cushion.N_full * float(np.linalg.norm(N, 2)) ** 2
        return [N.T @ K @ N << (1 - cushion) * np.eye(len(split.S)) for K in variables.K]

    def matrix(self, loop: ClosedLoop) -> Array:
        """Give dlambda_ss / Delta."""
        return offset_matrices(loop)[1]


@dataclass(frozen=True, kw_only=True)
class DisturbanceForceError(ForceError):
    """||dlambda_ss|| <= gamma for all constant forces within the ball that holds the semi-axes d_i, Eq. (26).

    dlambda_ss = -B [I, -L] V^T d with B = Lambda U S^-1 and L = K12 K22^-1, so it holds if L L^T <= H,
    H = (gamma/d)^2 (B^T B)^-1 - I. Around a reference G for K22, as K22^2 >= G K22 + K22 G - G^2, this follows from
    [[G K22 + K22 G - G^2, K12^T], [K12, H]] >= 0, which is linear, and at K22 = G nothing is lost.
    The reference is G, (n-m) x (n-m); without it the term waits for the first round.
    """

    name: str = "force error under disturbance"

    def constraints(self, variables: Variables) -> Constraints:
        """Bound L through K12 and K22, in mass-normalised coordinates."""
        split, scaling = variables.split, variables.scaling
        B = self.feedback @ split.U / split.S
        H = (self.asked / float(np.max(self.semi_axes))) ** 2 * np.linalg.inv(B.T @ B) - np.eye(len(split.S))
        if np.linalg.eigvalsh(H)[0] <= 0:
            return [cp.Constant(0) >= 1]  # even with K12 = 0 the normal part of d is too much
        if self.reference is None:
            return []
        size = float(np.linalg.norm(self.reference, 2))
        G = self.reference / size
        tangent, normal = (scaling.joint[:, None] * V * scaling.omega / np.sqrt(size) for V in (split.V2, split.V1))
        constraints: Constraints = []
        for K in variables.K:
            K22, K12 = tangent.T @ K @ tangent, normal.T @ K @ tangent
            constraints.append(cp.bmat([[G @ K22 + K22 @ G - G @ G, K12.T], [K12, H]]) >> 0)
        return constraints

    def matrix(self, loop: ClosedLoop) -> Array:
        """Give dlambda_ss / d."""
        return disturbance_matrices(loop)[1]
