"""The policy for the mixed blocks X12, as linear equations on the gains [T1], [T2]."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation import ClosedLoop
from firmtouch.synthesis.region.terms.term import Term
from firmtouch.synthesis.region.variables import Constraints, Variables


@dataclass(frozen=True, kw_only=True)
class MixedBlocks(Term):
    """K12 = L K22 and C12 = L C22 with L = weight M12 M22^-1: 1 decouples the force transient, 0 rejects disturbances.

    It holds for the nominal plant. What is reached is the largest deviation, relative to the blocks X22.
    """

    name: str = "mixed blocks"
    asked: float = 1e-6
    unit: str = ""
    at_most: bool = True
    nominal: bool = True
    weight: float = 1.0

    @property
    def can_be_eased(self) -> bool:
        """It is a wish that holds or not."""
        return False

    def constraints(self, variables: Variables) -> Constraints:
        """Tie the mixed blocks of the nominal plant, whose M22 is I in these coordinates."""
        v, L = variables, self.weight * variables.nominal_M12
        K, K22 = v.W + v.nominal.N0, v.W22 + v.nominal.N22
        return [v.normal_frame.T @ X @ v.frame == L @ X22 for X, X22 in ((K, K22), (v.C, v.C22))]

    def reached(self, loop: ClosedLoop) -> float:
        """Give the largest relative deviation from the equations."""
        return max(
            float(np.linalg.norm(X.X12 - self.of(loop) @ X.X22) / np.linalg.norm(X.X22))
            for X in (loop.split.blocks(loop.K), loop.split.blocks(loop.gains.C))
        )

    def of(self, loop: ClosedLoop) -> Array:
        """Give L in the coordinates of the split."""
        M = loop.split.blocks(loop.operating_point.M)
        return frozen(self.weight * np.linalg.solve(M.X22, M.X12.T).T)
