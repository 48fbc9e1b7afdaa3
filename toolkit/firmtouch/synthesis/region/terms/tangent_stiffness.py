"""Stiffness along the surface, so that constant disturbances move the rest position little enough."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.linalg

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import symmetric
from firmtouch.regulation import ClosedLoop
from firmtouch.regulation.steady_state import disturbance_matrices
from firmtouch.synthesis.region.terms.term import Term
from firmtouch.synthesis.region.variables import Constraints, Variables


@dataclass(frozen=True, kw_only=True)
class PositionError(Term):
    """||dq_ss|| <= gamma for all constant forces within the ellipsoid with semi-axes d_i.

    dq_ss = V2 K22^-1 V2^T d, Eq. (25), so the condition is K22^2 >= G^2 with G^2 = V2^T diag(d)^2 V2 / gamma^2. As
    K22^2 >= G K22 + K22 G - G^2 for any symmetric G, it follows from G K22 + K22 G >= 2 G^2, which is linear; for a
    ball it is K22 >= (d / gamma) I, and nothing is lost.
    """

    name: str = "position error"
    at_most: bool = True
    semi_axes: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def exact(self) -> bool:
        """Tell whether the forces fill a ball."""
        return bool(np.ptp(self.semi_axes) == 0)

    def constraints(self, variables: Variables) -> Constraints:
        """Ask for it at every corner, in units of the largest entry of G."""
        V2, T, scaling = variables.split.V2, variables.scaling.T, variables.scaling
        G = scipy.linalg.sqrtm(symmetric(V2.T @ np.diag(self.semi_axes**2) @ V2)).real / self.asked
        size = float(np.linalg.norm(G, 2))
        back = np.linalg.inv(T.T @ V2).T * scaling.omega / np.sqrt(size)  # V2^T X V2 = back^T (T^T X T) back, scaled
        G, t = G / size, variables.t
        constraints: Constraints = []
        for K22 in variables.K22:
            K = back.T @ K22 @ back
            cushion = variables.cushion.N * float(np.linalg.norm(back, 2)) ** 2
            constraints.append(G @ K + K @ G >> 2 * G @ G + 2 * cushion * np.eye(t))
        return constraints

    def reached(self, loop: ClosedLoop) -> float:
        """Give the worst position error."""
        T, _ = disturbance_matrices(loop)
        return float(np.linalg.norm(T * self.semi_axes, 2))
