"""What came of a run."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from firmtouch.mechanics import Array
from firmtouch.regulation.equilibrium import Equilibrium
from firmtouch.simulation.scenario import Scenario


class Outcome(Enum):
    """How a run ended, with what it means."""

    CONVERGED = "came to rest where it should"
    ELSEWHERE = "came to rest at another equilibrium"
    MOVING = "still moved at the end"
    DIVERGED = "diverged"
    CONTACT_LOST = "lost contact"
    BEYOND_LIMITS = "went beyond a joint's limits"
    STOPPED = "could not be followed further"

    @property
    def good(self) -> bool:
        """Tell whether nothing went wrong; a run that is short, or swings because it is pushed, may still move."""
        return self in (Outcome.CONVERGED, Outcome.MOVING)


@dataclass(frozen=True, slots=True)
class Trajectory:
    """k instants of a run: t (k), q and q' (k x n), lambda (k x m), u (k x n, what the drives did), Phi (k x m).

    Phi is the true constraints' residual: the drift. `reason` tells the outcome in words, with its time. `moved` is how
    far the start was projected. `rest` is the equilibrium near q_d that the disturbances at the end allow, if there is
    one.
    """

    scenario: Scenario
    t: Array
    q: Array
    qdot: Array
    lambda_: Array
    u: Array
    Phi: Array
    outcome: Outcome
    reason: str
    moved: float
    rest: Equilibrium | None
