"""Joints and links of a mechanism, found from how its bodies move: the file has bodies in the world, MuJoCo a tree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import Final

import casadi as ca
import numpy as np

from firmtouch.mechanics import Array, Plant
from firmtouch.mechanics.arrays import Vector, call, frozen
from firmtouch.mechanics.rigid_bodies import angular_jacobian, rotation
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile import Expression
from firmtouch.modelfile.sections.joint_tree import Robot
from firmtouch.modelfile.sections.mechanism import Bodies, Body
from firmtouch.oracle.library import NotExpressibleError

ALIKE: Final = 1e-9
"""Axes and velocities (for one rad/s or m/s of a coordinate, metre size) that differ by less are the same."""
NO_TREE: Final = "MuJoCo cannot express this mechanism as a tree of joints"


class JointKind(Enum):
    """What a coordinate does, in MuJoCo's words."""

    HINGE = "hinge"
    SLIDE = "slide"


@dataclass(frozen=True, slots=True)
class Joint:
    """A coordinate as a joint at the reference configuration.

    `axis` (3) is a unit vector in the world, `anchor` (3, metres) a point on it; `parent` is the coordinate of the link
    that carries this one, None where that is the ground; `armature` (kg m^2) is what its rotors add to its inertia.
    """

    coordinate: int
    name: str
    kind: JointKind
    axis: Array
    anchor: Array
    parent: int | None
    armature: float


@dataclass(frozen=True, slots=True)
class Mover:
    """Something that moves with the coordinates, at the reference configuration: a body, or a point (mass zero).

    `centre` (3, metres); `inertia` (3 x 3, kg m^2) is about the centre, in the world's axes; row i of `angular` (n x 3)
    and of `linear` (n x 3) is how it turns, and how its part at the world's origin moves, for one rad/s or m/s of
    coordinate i.
    """

    name: str
    mass: float
    centre: Array
    inertia: Array
    angular: Array
    linear: Array

    @property
    def moved_by(self) -> frozenset[int]:
        """The coordinates that move it."""
        sizes = np.abs(np.hstack([self.angular, self.linear])).max(axis=1)
        return frozenset(np.flatnonzero(sizes > ALIKE).tolist())


@dataclass(frozen=True, slots=True)
class Tree:
    """Joints, each after its parent, and the bodies that they carry."""

    joints: tuple[Joint, ...]
    bodies: tuple[Mover, ...]

    def carrier_of(self, mover: Mover) -> int | None:
        """Find the coordinate whose link carries something; None for what never moves."""
        moved_by = mover.moved_by
        return next((each.coordinate for each in reversed(self.joints) if each.coordinate in moved_by), None)


def find_tree(plant: Plant, at: Vector) -> Tree:
    """Find the joints of a mechanism of bodies, at the configuration `at`.

    A geared rotor is carried with its spin locked, and the inertia of that is added to the joint's, which is all that
    MuJoCo can say of it: the couplings between its spin and the turning of its carrier are left out.

    Raises
    ------
    NotExpressibleError
        If the mechanism is given by energies or is a robot, or a coordinate is no joint of a tree.
    """
    mechanism = plant.spec.mechanism
    if isinstance(mechanism, Robot):
        raise NotExpressibleError(
            "robots are held against Pinocchio, not against MuJoCo: only mechanisms of `bodies` are exported"
        )
    if not isinstance(mechanism, Bodies):
        raise NotExpressibleError(
            "MuJoCo takes a mechanism of rigid bodies; this one is given by its energies, which say nothing of where "
            "its masses are (give `bodies` instead)"
        )
    symbols = Symbols(plant.spec)
    bodies = tuple(_move_body(plant, symbols, name, body, at) for name, body in mechanism.bodies.items())
    armatures = [sum(_spin_inertia(each, i) for each in bodies) for i in range(plant.n)]
    bodies = tuple(_lock_spins(each) for each in bodies)
    carried = {i: frozenset(k for k, each in enumerate(bodies) if i in each.moved_by) for i in range(plant.n)}
    # What carries more stands nearer to the ground; coordinates that carry the same stand in the file's order.
    order = sorted(range(plant.n), key=lambda i: (-len(carried[i]), i))
    joints: list[Joint] = []
    for i in order:
        ancestors = [each.coordinate for each in joints if carried[each.coordinate] & carried[i]]
        if not carried[i] or not all(carried[i] <= carried[each] for each in ancestors):
            what = "bodies of more than one branch" if carried[i] else "no body"
            raise NotExpressibleError(f"coordinate `{_name(plant, i)}` moves {what}: {NO_TREE}")
        parent = ancestors[-1] if ancestors else None
        joint = _joint(plant, i, [bodies[k] for k in sorted(carried[i])], parent)
        joints.append(replace(joint, armature=armatures[i]))
    return Tree(tuple(joints), bodies)


def move_point(plant: Plant, name: str, point: Expression, at: Vector) -> Mover:
    """Find how a point moves."""
    symbols = Symbols(plant.spec)
    return _mover(plant, symbols, name, (symbols.column(point), None, ca.SX(0), ca.SX.zeros(3, 3)), at)


def _name(plant: Plant, i: int) -> str:
    return list(plant.spec.coordinates)[i]


def _move_body(plant: Plant, symbols: Symbols, name: str, body: Body, at: Vector) -> Mover:
    centre, mass = symbols.column(body.centre_of_mass), symbols.scalar(body.mass)
    angular, inertia = None, ca.SX.zeros(3, 3)
    if isinstance(body.orientation, Expression):
        turn = ca.jacobian(symbols.scalar(body.orientation), symbols.q)
        angular = ca.vertcat(ca.SX.zeros(2, plant.n), turn)
        if body.inertia is not None:
            # In the plane only the moment about z counts; the others are made equal so that such a body can exist.
            assert isinstance(body.inertia, Expression)
            inertia = symbols.scalar(body.inertia) * ca.SX.eye(3)
    elif body.orientation is not None:
        R = rotation(body.orientation, symbols)
        angular = R @ angular_jacobian(R, symbols.q)
        if body.inertia is not None:
            assert not isinstance(body.inertia, Expression)
            inertia = R @ ca.vertcat(*(ca.horzcat(*map(symbols.scalar, row)) for row in body.inertia)) @ R.T
    return _mover(plant, symbols, name, (centre, angular, mass, inertia), at)


def _mover(
    plant: Plant, symbols: Symbols, name: str, what: tuple[ca.SX, ca.SX | None, ca.SX, ca.SX], at: Vector
) -> Mover:
    """Evaluate; a point shows its angular velocity by its acceleration, w = v x (dv/dq_i) / v^2."""
    centre, angular, mass, inertia = what
    if centre.numel() == 2:
        centre = ca.vertcat(centre, 0)
    velocity = ca.jacobian(centre, symbols.q)
    bend = ca.horzcat(*(ca.jacobian(velocity[:, i], symbols.q[i]) for i in range(plant.n)))
    outputs = (centre, velocity, bend, ca.SX(3, plant.n) if angular is None else angular, mass, inertia)
    values = [call(ca.Function("move", [symbols.q, symbols.p], [ca.densify(each)]), at, plant.p) for each in outputs]
    c, v, a, w = values[0].ravel(), values[1].T, values[2].T, values[3].T
    if angular is None:
        squares = np.sum(v**2, axis=1, keepdims=True)
        w = np.where(squares > ALIKE**2, np.cross(v, a) / np.where(squares > 0, squares, 1), 0.0)
    return Mover(name, float(values[4].item()), frozen(c), values[5], frozen(w), frozen(v - np.cross(w, c)))


def _spin_inertia(body: Mover, i: int) -> float:
    """Give the inertia about its axis, by the gear's ratio squared, of a rotor that coordinate i spins; else zero."""
    w = body.angular[i]
    speed, at_centre = float(np.linalg.norm(w)), body.linear[i] + np.cross(w, body.centre)
    geared = speed > ALIKE and abs(speed - 1) > ALIKE and float(np.abs(at_centre).max()) <= ALIKE * max(1.0, speed)
    return float(w @ body.inertia @ w) if geared else 0.0


def _lock_spins(body: Mover) -> Mover:
    locked = [i for i in range(len(body.angular)) if _spin_inertia(body, i)]
    angular, linear = np.array(body.angular), np.array(body.linear)
    angular[locked], linear[locked] = 0.0, 0.0
    return replace(body, angular=frozen(angular), linear=frozen(linear))


def _joint(plant: Plant, i: int, carried: Sequence[Mover], parent: int | None) -> Joint:
    first = carried[0]
    w, v = first.angular[i], first.linear[i]
    for other in carried[1:]:
        differs = max(float(np.abs(other.angular[i] - w).max()), float(np.abs(other.linear[i] - v).max()))
        if differs > ALIKE:
            raise NotExpressibleError(
                f"bodies `{first.name}` and `{other.name}` move differently (by {differs:.3g}) with "
                f"`{_name(plant, i)}`, as with a gear or an angle that is counted from the ground: {NO_TREE}"
            )
    rotates = float(np.linalg.norm(w)) > ALIKE
    speed = float(np.linalg.norm(w if rotates else v))
    pitch = float(w @ v)
    if abs(speed - 1) > ALIKE or abs(pitch) > ALIKE:
        raise NotExpressibleError(
            f"coordinate `{_name(plant, i)}` is no angle or length of a joint (`{first.name}` moves by {speed:.6g} for "
            f"one unit of it, and by {pitch:.3g} along the axis while it turns): MuJoCo has no such joint"
        )
    kind = JointKind.HINGE if rotates else JointKind.SLIDE
    axis, anchor = (w, np.cross(w, v)) if rotates else (v, np.zeros(3))
    return Joint(i, _name(plant, i), kind, frozen(axis / speed), frozen(anchor), parent, 0.0)
