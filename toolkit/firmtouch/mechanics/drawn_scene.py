"""The picture of a mechanism as numbers: what its file draws, or what can be seen of its bodies or its joints."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from firmtouch.mechanics.arrays import Array, frozen
from firmtouch.mechanics.plant import Plant
from firmtouch.mechanics.rigid_bodies import angular_jacobian, rotation
from firmtouch.mechanics.robot_scene import robot_scene
from firmtouch.mechanics.scene import ContactForce, Round, Scene, Wall, solve_force
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile import Expression, ModelSpec
from firmtouch.modelfile.sections.joint_tree import Robot
from firmtouch.modelfile.sections.mechanism import Bodies, Body


def draw_scene(plant: Plant, q: Array, lambda_d: Array, ghosts: Sequence[Array] = ()) -> Scene | None:
    """Compute the picture of a mechanism at q; `ghosts` are further configurations to show behind.

    Without a `drawing` section, robots are drawn with what they touch, rigid bodies through the axes about which they
    turn, and mechanisms that are given by energies not at all (`None`).
    """
    spec = plant.spec
    if spec.drawing is None and isinstance(spec.mechanism, Robot):
        return robot_scene(plant, q, lambda_d, ghosts)
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
    return solve_force(plant, name, points, symbols=geometry.symbols, q=q, share=lambda_d[j] * plant.J(q)[j])


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
