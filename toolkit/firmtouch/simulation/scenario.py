"""What is simulated: a feedback, a start, and a world, for a while."""

from __future__ import annotations

from dataclasses import dataclass, field

from firmtouch.mechanics import Array
from firmtouch.modelfile import Expression
from firmtouch.regulation.controllers import Controller
from firmtouch.regulation.force_loop import ForcePath
from firmtouch.simulation.world import World


@dataclass(frozen=True, slots=True)
class Noise:
    """Standard deviations of what is measured at each sample, in SI: of q and q' (n each) and of lambda (m)."""

    position: Array
    velocity: Array
    force: Array
    seed: int = 0


@dataclass(frozen=True, slots=True)
class Feedback:
    """A control law with the electronics around it.

    `path` is what lies between the contact force and the law; with a sample time the whole law is sampled and its
    output held. `limits` (n) are the greatest joint forces. `P_d` belongs to controllers (5) and (11).
    """

    controller: Controller = Controller.AFFINE_WITH_FORCE
    P_d: Expression | None = None
    path: ForcePath = field(default_factory=ForcePath)
    limits: Array | None = None
    noise: Noise | None = None


@dataclass(frozen=True, slots=True)
class Start:
    """Where the mechanism is let go, q and q' (n each): what is given, before it is put onto the constraints."""

    q: Array
    qdot: Array


@dataclass(frozen=True, slots=True)
class Scenario:
    """One run: `duration` in s. `name` is a file's word for it, `title` a reader's."""

    name: str
    title: str
    feedback: Feedback
    start: Start
    world: World
    duration: float
