"""Where the bodies and frames of a tree are, and how they move, as CasADi expressions of q."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from firmtouch.errors import InputError
from firmtouch.mechanics.tree.placement import Placement
from firmtouch.mechanics.tree.tree import WORLD, Frame, KinematicTree, TreeJoint
from firmtouch.modelfile.words import did_you_mean, listed, shown


@dataclass(frozen=True, slots=True)
class Pose:
    """A point x of the inner frame is at R x + p in the outer one."""

    R: ca.SX
    p: ca.SX

    def __matmul__(self, inner: Pose) -> Pose:
        """Give the pose of a frame that `inner` places in this one."""
        return Pose(self.R @ inner.R, self.R @ inner.p + self.p)


def constant(placement: Placement) -> Pose:
    """Give a placement as constants of CasADi."""
    return Pose(ca.SX(ca.DM(placement.R)), ca.SX(ca.DM(placement.p)))


def axis_of(joint: TreeJoint) -> ca.SX:
    """Give a joint's axis in its body's frame, which is that in the frame of its placement too."""
    return ca.SX(ca.DM(joint.axis))


def joint_pose(joint: TreeJoint, position: ca.SX) -> Pose:
    """Place a joint's body in its parent."""
    at, a = constant(joint.placement), axis_of(joint)
    if not joint.revolves:
        return Pose(at.R, at.p + at.R @ a * position)
    along = a @ a.T
    # Written so that an axis along x, y or z costs one sine, one cosine and no product.
    R = along + ca.cos(position) * (ca.SX(ca.DM.eye(3).full()) - along) + ca.sin(position) * ca.skew(a)
    return Pose(at.R @ R, at.p)


def joint_poses(tree: KinematicTree, q: ca.SX) -> list[Pose]:
    """Place every body in its parent."""
    return [joint_pose(joint, position) for joint, position in zip(tree.joints, tree.positions(q), strict=True)]


def frame_pose(tree: KinematicTree, frame: str, q: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Give a frame's origin (3, metres) in the world, and the rotation (3 x 3) from its axes to the world's.

    Raises
    ------
    InputError
        If the tree has no such frame.
    """
    found = find_frame(tree, frame)
    pose = constant(found.placement)
    positions = tree.positions(q)
    for i in tree.ancestors(found.body):
        pose = joint_pose(tree.joints[i], positions[i]) @ pose
    return pose.p, pose.R


def frame_jacobian(tree: KinematicTree, frame: str, q: ca.SX) -> ca.SX:
    """Give the geometric Jacobian of a frame (6 x n): [v; w] = J q'.

    v is the velocity of the frame's origin (m/s), w the frame's angular velocity (rad/s), both in the world's axes.

    Raises
    ------
    InputError
        If the tree has no such frame.
    """
    p, _ = frame_pose(tree, frame, q)
    world: dict[int, Pose] = {}
    local = joint_poses(tree, q)
    chain = tree.ancestors(find_frame(tree, frame).body)
    J = ca.SX(ca.DM.zeros(6, tree.n))
    for i in reversed(chain):
        joint = tree.joints[i]
        world[i] = local[i] if joint.parent == WORLD else world[joint.parent] @ local[i]
        a = world[i].R @ axis_of(joint)
        column = ca.vertcat(ca.cross(a, p - world[i].p), a) if joint.revolves else ca.vertcat(a, ca.SX(ca.DM.zeros(3)))
        J[:, joint.coordinate] += joint.multiplier * column
    return J


def find_frame(tree: KinematicTree, frame: str) -> Frame:
    """Find a frame by its name.

    Raises
    ------
    InputError
        If the tree has no such frame.
    """
    if frame not in tree.frames:
        choices = did_you_mean(frame, tree.frames) or f"; there are: {listed(tree.frames)}"
        raise InputError(f"there is no frame {shown(frame)}{choices}")
    return tree.frames[frame]
