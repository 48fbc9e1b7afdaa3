"""A robot of a specification as its tree, with the payload, and its frames as CasADi expressions."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from firmtouch.mechanics.arrays import Array, frozen
from firmtouch.mechanics.rigid_bodies import rotation
from firmtouch.mechanics.symbols import Symbols
from firmtouch.mechanics.tree import KinematicTree, Placement, frame_pose, grow_tree, loaded, placement, planar_chain
from firmtouch.mechanics.tree.dynamics import Inertias
from firmtouch.mechanics.tree.kinematics import Pose
from firmtouch.modelfile import ModelSpec
from firmtouch.modelfile.sections.chain import ChainMechanism
from firmtouch.modelfile.sections.joint_tree import Robot
from firmtouch.modelfile.sections.pose import FrameSpec, PoseSpec
from firmtouch.modelfile.sections.robot import PayloadSpec, UrdfMechanism


@dataclass(frozen=True, slots=True)
class Arm:
    """A tree with the inertias of its bodies, in which parameters may stand, and the names of its specification.

    `rotors` (n) is what each coordinate feels of its motor, kg m^2 or kg: behind a gear a rotor turns so much faster
    than all else that its other motion does not count.
    """

    tree: KinematicTree
    inertias: Inertias
    symbols: Symbols
    rotors: Array

    def pose(self, frame: FrameSpec) -> Pose:
        """Place a frame, or what stands off from it, in the world at q."""
        p, R = frame_pose(self.tree, frame.frame, self.symbols.q)
        return Pose(R, p) @ offset(frame, self.symbols)


def arm_of(spec: ModelSpec, symbols: Symbols) -> Arm | None:
    """Build the tree of a specification's robot; None where its mechanism is none.

    Raises
    ------
    InputError
        If the robot cannot be built as asked; a `ModelFileError` where its file is to blame.
    """
    mechanism = spec.mechanism
    if not isinstance(mechanism, Robot):
        return None
    tree = tree_of(mechanism, symbols)
    inertias: Inertias = [each.inertia.symbolic() for each in tree.joints]
    rotors: Array = np.zeros(tree.n)
    if isinstance(mechanism, UrdfMechanism):
        rotors = np.array(mechanism.rotor_inertias())
        if mechanism.payload is not None:
            inertias = _with_payload(tree, mechanism.payload, mechanism.tools(), symbols)
    return Arm(tree, inertias, symbols, frozen(rotors))


def tree_of(mechanism: Robot, symbols: Symbols) -> KinematicTree:
    """Build a robot's tree, without what it carries."""
    if isinstance(mechanism, ChainMechanism):
        chain = mechanism.planar_chain
        return planar_chain(chain.n, length=chain.length, mass=chain.mass, gravity=chain.gravity)
    assert isinstance(mechanism, UrdfMechanism)
    return grow_tree(mechanism.moving(), _in_numbers(mechanism.base, symbols), mechanism.gravity)


def offset(pose: PoseSpec, symbols: Symbols) -> Pose:
    """Give the pose that a file describes, of parameters alone."""
    R = rotation(pose.orientation, symbols) if pose.orientation else ca.SX.eye(3)
    return Pose(R, ca.SX(3, 1) if pose.position is None else symbols.column(pose.position))


def _with_payload(tree: KinematicTree, payload: PayloadSpec, tools: tuple[str, ...], symbols: Symbols) -> Inertias:
    moments = payload.inertia
    return loaded(
        tree,
        payload.frame or tools[0],
        mass=symbols.scalar(payload.mass),
        centre_of_mass=ca.SX(3, 1) if payload.centre_of_mass is None else symbols.column(payload.centre_of_mass),
        inertia=ca.SX(3, 3) if moments is None else ca.diag(symbols.column(moments)),
    )


def _in_numbers(base: PoseSpec | None, symbols: Symbols) -> Placement:
    if base is None:
        return placement()
    pose = offset(base, symbols)
    R, p = (np.asarray(ca.evalf(each).full()) for each in (pose.R, pose.p))
    return Placement(frozen(R), frozen(p.ravel()))
