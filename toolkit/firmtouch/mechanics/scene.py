"""What the report's picture shows, as numbers: where lines, surfaces and contacts are, and which way forces point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from firmtouch.mechanics.arrays import Array, frozen
from firmtouch.mechanics.plant import Plant
from firmtouch.mechanics.rigid_bodies import angular_jacobian, rotation
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile import Expression, ModelSpec
from firmtouch.modelfile.sections.mechanism import Bodies, Body


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

    `ghosts` are the lines again a little way along each direction that the constraints leave free.
    """

    dimension: int
    lines: tuple[Array, ...]
    ghosts: tuple[tuple[Array, ...], ...] = ()
    masses: Array = field(default_factory=lambda: frozen(np.empty((0, 2))))
    walls: tuple[Wall, ...] = ()
    rounds: tuple[Round, ...] = ()
    forces: tuple[ContactForce, ...] = ()
    patches: tuple[Patch, ...] = ()


def draw_scene(plant: Plant, q: Array, lambda_d: Array, ghosts: Sequence[Array] = ()) -> Scene | None:
    """Compute the picture of a mechanism at q; `ghosts` are further configurations to show behind.

    Without a `drawing` section, rigid bodies are drawn through the axes about which they turn, and mechanisms that are
    given by energies are not drawn at all (`None`).
    """
    spec = plant.spec
    geometry = _Geometry(spec)
    masses = geometry.evaluate(plant, geometry.masses, q)
    if spec.drawing is None:
        skeleton = geometry.skeleton()
        if skeleton is None:
            return None
        lines = [skeleton]
        dimension = skeleton.shape[0]
        walls: tuple[Wall, ...] = ()
        rounds: tuple[Round, ...] = ()
        forces: tuple[ContactForce, ...] = ()
    else:
        lines = [geometry.points(line) for line in spec.drawing.lines.values()]
        dimension = spec.drawing.points()[0].size if spec.drawing.points() else 2
        forces = tuple(_contact_force(plant, geometry, name, q, lambda_d) for name in spec.drawing.contacts)
        walls, rounds = _surfaces(plant, geometry, q, forces)
    return Scene(
        dimension,
        tuple(geometry.evaluate(plant, line, q) for line in lines),
        tuple(tuple(geometry.evaluate(plant, line, each) for line in lines) for each in ghosts),
        masses,
        walls,
        rounds,
        forces,
    )


class _Geometry:
    """Positions of a specification as SX columns, evaluated on demand."""

    def __init__(self, spec: ModelSpec) -> None:
        self.symbols = Symbols(spec)
        self._bodies = spec.mechanism.bodies.values() if isinstance(spec.mechanism, Bodies) else ()
        centres = [self.symbols.column(body.centre_of_mass) for body in self._bodies]
        self.masses = ca.horzcat(*centres) if centres else ca.SX(2, 0)

    def points(self, expressions: Sequence[Expression]) -> ca.SX:
        return ca.horzcat(*map(self.symbols.column, expressions))

    def evaluate(self, plant: Plant, points: ca.SX, q: Array) -> Array:
        function = ca.Function("points", [self.symbols.q, self.symbols.p], [ca.densify(points)])
        return frozen(np.asarray(function(q, plant.p).full()).T)

    def skeleton(self) -> ca.SX | None:
        """Join the axes of rotation, body by body, and end at the last centre of mass."""
        columns = [self._axis(body) for body in self._bodies]
        joints = [each for each in columns if each is not None]
        if not joints:
            return None
        *_, last = (self.symbols.column(body.centre_of_mass) for body in self._bodies)
        return ca.horzcat(*joints, last)

    def _axis(self, body: Body) -> ca.SX | None:
        """Find the point at rest when the body's last rotating coordinate moves: c + w x v / w^2."""
        if body.orientation is None:
            return None
        q, centre = self.symbols.q, self.symbols.column(body.centre_of_mass)
        J_v = ca.jacobian(centre, q)
        if isinstance(body.orientation, Expression):
            J_w = ca.jacobian(self.symbols.scalar(body.orientation), q)
            i = _last_column(J_w)
            return None if i is None else centre + ca.vertcat(-J_v[1, i], J_v[0, i]) / J_w[i]
        R = rotation(body.orientation, self.symbols)
        J_w = R @ angular_jacobian(R, q)
        i = _last_column(J_w)
        return None if i is None else centre + ca.cross(J_w[:, i], J_v[:, i]) / ca.sumsqr(J_w[:, i])


def _last_column(J: ca.SX) -> int | None:
    used = [i for i in range(J.shape[1]) if J[:, i].nnz()]
    return used[-1] if used else None


def _contact_force(plant: Plant, geometry: _Geometry, name: str, q: Array, lambda_d: Array) -> ContactForce:
    assert plant.spec.drawing is not None
    points = [geometry.symbols.column(each) for each in plant.spec.drawing.contacts[name]]
    j = list(plant.spec.constraints).index(name)
    return solve_force(plant, geometry.symbols, name, points, q, lambda_d[j] * plant.J(q)[j])


def solve_force(
    plant: Plant, symbols: Symbols, name: str, points: Sequence[ca.SX], q: Array, share: Array
) -> ContactForce:
    """Find the force F at the first point, and -F at the second if there is one, whose joint forces are `share` (n)."""
    relative = points[0] - points[1] if len(points) == 2 else points[0]
    outputs = [ca.densify(each) for each in (ca.jacobian(relative, symbols.q), *points)]
    function = ca.Function("points", [symbols.q, symbols.p], outputs)
    J_p, *at = (np.asarray(each.full()) for each in function(q, plant.p))
    force, *_ = np.linalg.lstsq(J_p.T, share, rcond=1e-9)
    remainder = float(np.linalg.norm(J_p.T @ force - share)) / (float(np.linalg.norm(share)) or 1.0)
    first, *reaction_at = (frozen(each.ravel()) for each in at)
    return ContactForce(name, first, frozen(force), remainder, reaction_at[0] if reaction_at else None)


def _surfaces(
    plant: Plant, geometry: _Geometry, q: Array, forces: Sequence[ContactForce]
) -> tuple[tuple[Wall, ...], tuple[Round, ...]]:
    """Evaluate the surfaces; a wall is solid on the side that the forces point away from."""
    assert plant.spec.drawing is not None
    push = sum((each.force for each in forces), np.zeros(2)) if all(f.force.size == 2 for f in forces) else np.zeros(2)
    walls, rounds = [], []
    for surface in plant.spec.drawing.surfaces.values():
        if surface.through is not None:
            walls.append(Wall(geometry.evaluate(plant, geometry.points(surface.through), q), frozen(-push)))
        elif surface.centre is not None and surface.radius is not None:
            centre = geometry.evaluate(plant, geometry.symbols.column(surface.centre), q)[0]
            radius = geometry.evaluate(plant, geometry.symbols.scalar(surface.radius), q)[0, 0]
            rounds.append(Round(centre, float(radius)))
    return tuple(walls), tuple(rounds)
