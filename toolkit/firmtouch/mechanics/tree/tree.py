"""A tree of moving bodies, as what the recursions need."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from firmtouch.mechanics.arrays import Array, frozen
from firmtouch.mechanics.tree.inertia import BodyInertia
from firmtouch.mechanics.tree.placement import Placement
from firmtouch.modelfile.urdf import MovingJoint

WORLD = -1
"""The body that carries what stands still; its frame is the world's."""


@dataclass(frozen=True, slots=True)
class TreeJoint:
    """A joint with the body that it carries, all links that are fixed to each other being one.

    The body's frame is at `placement` in the frame of body `parent` when the joint is at zero, and moves from there
    about (`revolves`) or along `axis` (3, unit) by multiplier q[coordinate] + offset, in rad or m. `inertia` is in the
    body's frame.
    """

    name: str
    parent: int
    placement: Placement
    revolves: bool
    axis: Array
    coordinate: int
    multiplier: float
    offset: float
    inertia: BodyInertia


@dataclass(frozen=True, slots=True)
class Frame:
    """A link's frame, at `placement` in the frame of `body`."""

    body: int
    placement: Placement


@dataclass(frozen=True, slots=True)
class KinematicTree:
    """An arm with n coordinates: `joints[i]` carries body i, and stands behind the joint of its parent.

    `frames` are the links that the file names. `gravity` (3, m/s^2) is in the world's axes.
    """

    coordinates: tuple[MovingJoint, ...]
    joints: tuple[TreeJoint, ...]
    frames: dict[str, Frame]
    gravity: Array

    @property
    def n(self) -> int:
        """The number of coordinates."""
        return len(self.coordinates)

    @property
    def G(self) -> Array:
        """How the joints move with the coordinates: joint velocities are G q', joints x n."""
        G = np.zeros((len(self.joints), self.n))
        for i, joint in enumerate(self.joints):
            G[i, joint.coordinate] = joint.multiplier
        return frozen(G)

    def positions(self, q: ca.SX) -> list[ca.SX]:
        """Give the joints' positions at q."""
        return [each.multiplier * q[each.coordinate] + each.offset for each in self.joints]

    def ancestors(self, body: int) -> tuple[int, ...]:
        """Give the joints that move a body, its own first."""
        found = []
        while body != WORLD:
            found.append(body)
            body = self.joints[body].parent
        return tuple(found)
