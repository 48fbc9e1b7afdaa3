"""Bounds on the gains: on their norms, on their diagonal entries, and from what torque and noise allow."""

from __future__ import annotations

from dataclasses import dataclass, field

import cvxpy as cp
import numpy as np

from firmtouch.mechanics import Array
from firmtouch.regulation import ClosedLoop
from firmtouch.synthesis.region.terms.term import Term
from firmtouch.synthesis.region.variables import Constraints, Variables


@dataclass(frozen=True, kw_only=True)
class GainNorm(Term):
    """||W|| or ||C|| (2-norm) at most so much."""

    at_most: bool = True
    which: str = "W"

    def constraints(self, variables: Variables) -> Constraints:
        """Bound the symmetric matrix from both sides."""
        scaling, identity = variables.scaling, np.eye(variables.n)
        if self.which == "W":
            X, bound = variables.W, scaling.scaled_stiffness(self.asked * identity)
        else:
            X, bound = variables.C, scaling.scaled_damping(self.asked * identity)
        return [X << bound, X >> -bound]

    def reached(self, loop: ClosedLoop) -> float:
        """Give the norm."""
        return float(np.linalg.norm(getattr(loop.gains, self.which), 2))


@dataclass(frozen=True, kw_only=True)
class GainEntry(Term):
    """|W_ii| or |C_ii| at most so much."""

    at_most: bool = True
    which: str = "W"
    joint: int = 0

    def constraints(self, variables: Variables) -> Constraints:
        """Bound one entry of the diagonal."""
        scaling, i = variables.scaling, self.joint
        power = 2 if self.which == "W" else 1
        X = variables.W if self.which == "W" else variables.C
        return [cp.abs(X[i, i]) <= self.asked / scaling.joint[i] ** 2 / scaling.omega**power]

    def reached(self, loop: ClosedLoop) -> float:
        """Give the entry's size."""
        return abs(float(getattr(loop.gains, self.which)[self.joint, self.joint]))


@dataclass(frozen=True, kw_only=True)
class TorqueLimit(Term):
    """The sum over j of |W_ij| position_j + |C_ij| velocity_j is at most a torque of joint i.

    With start errors and the drives' torques it keeps a start from saturating them; with an encoder's noise and a
    ripple it keeps the gains from amplifying the noise.
    """

    at_most: bool = True
    joint: int = 0
    position: Array = field(default_factory=lambda: np.zeros(0))
    velocity: Array = field(default_factory=lambda: np.zeros(0))

    def constraints(self, variables: Variables) -> Constraints:
        """Bound the sum of absolute values."""
        scaling, i = variables.scaling, self.joint
        stiffness = scaling.omega**2 * scaling.joint[i] * scaling.joint * self.position / self.asked
        damping = scaling.omega * scaling.joint[i] * scaling.joint * self.velocity / self.asked
        return [stiffness @ cp.abs(variables.W[i, :]) + damping @ cp.abs(variables.C[i, :]) <= 1]

    def reached(self, loop: ClosedLoop) -> float:
        """Give the torque."""
        W, C = (np.abs(X[self.joint]) for X in (loop.gains.W, loop.gains.C))
        return float(W @ self.position + C @ self.velocity)
