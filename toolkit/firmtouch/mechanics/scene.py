"""What the report's picture shows, as numbers: where lines, surfaces and contacts are, and which way forces point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from firmtouch.mechanics.arrays import Array, frozen
from firmtouch.mechanics.plant import Plant
from firmtouch.mechanics.symbols import Symbols


@dataclass(frozen=True, slots=True)
class Wall:
    """A surface through points (k x 2), with its solid side to the left or right of them as `solid` points."""

    points: Array
    solid: Array


@dataclass(frozen=True, slots=True)
class Round:
    """A circle or a sphere."""

    centre: Array
    radius: float


@dataclass(frozen=True, slots=True)
class Patch:
    """A part of a surface in space: a grid of points (k x k x 3; nan where it ends) around a contact.

    `normal` (3) is there, away from the solid, and `tangent` (4 x 3) are the corners of a square in the tangent plane.
    """

    points: Array
    contact: Array
    normal: Array
    tangent: Array


@dataclass(frozen=True, slots=True)
class Base:
    """Where a chain of joints stands: a point (3), and its first joint's axis there (3)."""

    point: Array
    axis: Array


@dataclass(frozen=True, slots=True)
class Held:
    """What two joined frames hold between them: `ends` (2 x 3) are their origins, `across` (3) is square to the way.

    The force of the `constraint` acts at the second end, and its reaction at the first.
    """

    constraint: str
    ends: Array
    across: Array


@dataclass(frozen=True, slots=True)
class ContactForce:
    """The force F on the mechanism at a point: J_p^T F is the constraint's share of J^T lambda_d.

    `remainder` is the part of that share which no force at this point makes (a moment, say), relative to it. Where two
    parts of the mechanism press on each other, `reaction_at` is the point of the other, which feels -F.
    """

    constraint: str
    point: Array
    force: Array
    remainder: float
    reaction_at: Array | None = None


@dataclass(frozen=True, slots=True)
class Scene:
    """A mechanism at one configuration, in the plane or in space (`dimension` 2 or 3), in metres.

    `ghosts` are the lines again a little way along each direction that the constraints leave free. `rails` (k x 3 each)
    are curves that frames slide along, and rods.
    """

    dimension: int
    lines: tuple[Array, ...]
    ghosts: tuple[tuple[Array, ...], ...] = ()
    masses: Array = field(default_factory=lambda: frozen(np.empty((0, 2))))
    walls: tuple[Wall, ...] = ()
    rounds: tuple[Round, ...] = ()
    forces: tuple[ContactForce, ...] = ()
    patches: tuple[Patch, ...] = ()
    bases: tuple[Base, ...] = ()
    held: tuple[Held, ...] = ()
    rails: tuple[Array, ...] = ()


def solve_force(
    plant: Plant, name: str, points: Sequence[ca.SX], *, symbols: Symbols, q: Array, share: Array
) -> ContactForce:
    """Find the force F of a constraint at q at the first point, and -F at the second if there is one.

    `share` (n) are its joint forces; the points are columns in terms of `symbols`.
    """
    relative = points[0] - points[1] if len(points) == 2 else points[0]
    outputs = [ca.densify(each) for each in (ca.jacobian(relative, symbols.q), *points)]
    function = ca.Function("points", [symbols.q, symbols.p], outputs)
    J_p, *at = (np.asarray(each.full()) for each in function(q, plant.p))
    force, *_ = np.linalg.lstsq(J_p.T, share, rcond=1e-9)
    remainder = float(np.linalg.norm(J_p.T @ force - share)) / (float(np.linalg.norm(share)) or 1.0)
    first, *reaction_at = (frozen(each.ravel()) for each in at)
    return ContactForce(name, first, frozen(force), remainder, reaction_at[0] if reaction_at else None)
