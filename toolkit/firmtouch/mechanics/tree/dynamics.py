"""M, theta, P and K of a tree by recursion over its bodies (Featherstone, Rigid Body Dynamics Algorithms, 2008).

Each recursion works in the bodies' own frames. Everywhere `inertias` may replace what the tree says of its bodies, in
the order of its joints: with symbols in them, a payload for instance becomes a parameter.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from firmtouch.mechanics.tree.inertia import SpatialInertia
from firmtouch.mechanics.tree.kinematics import Pose, axis_of, joint_poses
from firmtouch.mechanics.tree.tree import WORLD, KinematicTree

Inertias = Sequence[SpatialInertia]


def theta(tree: KinematicTree, q: ca.SX, qdot: ca.SX, inertias: Inertias | None = None) -> ca.SX:
    """Give the centrifugal, Coriolis and gravity forces of Eq. (4), n, in N m or N."""
    return inverse_dynamics(tree, q, qdot, ca.SX(tree.n, 1), inertias)


def inverse_dynamics(
    tree: KinematicTree, q: ca.SX, qdot: ca.SX, qddot: ca.SX, inertias: Inertias | None = None
) -> ca.SX:
    """Give M(q) q'' + theta(q, q'), n, by the recursive Newton-Euler algorithm.

    Gravity enters as an acceleration of the world, upwards.
    """
    poses, bodies = joint_poses(tree, q), _bodies(tree, inertias)
    G = ca.DM(tree.G)
    rates, accelerations = G @ qdot, G @ qddot
    motions: list[tuple[ca.SX, ca.SX, ca.SX]] = []  # w, w', acceleration of the origin, in the body's frame
    forces, torques = [], []
    for i, joint in enumerate(tree.joints):
        zero = ca.SX(3, 1)
        w, wdot, acceleration = motions[joint.parent] if joint.parent != WORLD else (zero, zero, -_gravity(tree))
        R, p, a = poses[i].R, poses[i].p, axis_of(joint)
        acceleration = R.T @ (acceleration + ca.cross(wdot, p) + ca.cross(w, ca.cross(w, p)))
        w, wdot, slide = R.T @ w, R.T @ wdot, a * rates[i]
        if joint.revolves:
            wdot += ca.cross(w, slide) + a * accelerations[i]
            w += slide
        else:
            acceleration += 2 * ca.cross(w, slide) + a * accelerations[i]
        motions.append((w, wdot, acceleration))
        m, h, I = bodies[i].mass, bodies[i].moment, bodies[i].tensor  # noqa: E741  # the inertia
        forces.append(m * acceleration + ca.cross(wdot, h) + ca.cross(w, ca.cross(w, h)))
        torques.append(I @ wdot + ca.cross(w, I @ w) + ca.cross(h, acceleration))
    efforts = []
    for i, joint in reversed(list(enumerate(tree.joints))):
        efforts.append(ca.dot(axis_of(joint), torques[i] if joint.revolves else forces[i]))
        if joint.parent != WORLD:
            force, torque = _carried(poses[i], forces[i], torques[i])
            forces[joint.parent] += force
            torques[joint.parent] += torque
    return G.T @ ca.vertcat(*reversed(efforts))


def mass_matrix(tree: KinematicTree, q: ca.SX, inertias: Inertias | None = None) -> ca.SX:
    """Give M(q), n x n, by the composite rigid body algorithm.

    Column i is what it takes to accelerate joint i alone, from rest and without gravity: it moves all bodies
    from there on as one.
    """
    poses = joint_poses(tree, q)
    composites = _composites(tree, poses, _bodies(tree, inertias))
    M = ca.SX(ca.DM.zeros(len(tree.joints), len(tree.joints)))
    for i, joint in enumerate(tree.joints):
        a, body = axis_of(joint), composites[i]
        force = ca.cross(a, body.moment) if joint.revolves else body.mass * a
        torque = body.tensor @ a if joint.revolves else ca.cross(body.moment, a)
        for j in tree.ancestors(i):
            M[i, j] = ca.dot(axis_of(tree.joints[j]), torque if tree.joints[j].revolves else force)
            M[j, i] = M[i, j]
            force, torque = _carried(poses[j], force, torque)
    G = ca.DM(tree.G)
    return G.T @ M @ G


def potential_energy(tree: KinematicTree, q: ca.SX, inertias: Inertias | None = None) -> ca.SX:
    """Give P(q) = -sum of m g . c over the moving bodies, in J."""
    poses = joint_poses(tree, q)
    composites = _composites(tree, poses, _bodies(tree, inertias))
    moment = ca.SX(3, 1)
    for i, joint in enumerate(tree.joints):
        if joint.parent == WORLD:
            moment += poses[i].R @ composites[i].moment + composites[i].mass * poses[i].p
    return -ca.dot(_gravity(tree), moment)


def kinetic_energy(tree: KinematicTree, q: ca.SX, qdot: ca.SX, inertias: Inertias | None = None) -> ca.SX:
    """Give K(q, q') in J from the bodies' velocities, without M: one may be tested against the other."""
    poses, bodies = joint_poses(tree, q), _bodies(tree, inertias)
    rates = ca.DM(tree.G) @ qdot
    K = ca.SX(0)
    velocities: list[tuple[ca.SX, ca.SX]] = []  # of the origin, and w, in the body's frame
    for i, joint in enumerate(tree.joints):
        v, w = velocities[joint.parent] if joint.parent != WORLD else (ca.SX(3, 1), ca.SX(3, 1))
        v, w = poses[i].R.T @ (v + ca.cross(w, poses[i].p)), poses[i].R.T @ w
        slide = axis_of(joint) * rates[i]
        v, w = (v, w + slide) if joint.revolves else (v + slide, w)
        velocities.append((v, w))
        body = bodies[i]
        K += body.mass * ca.dot(v, v) / 2 + ca.dot(v, ca.cross(w, body.moment)) + ca.dot(w, body.tensor @ w) / 2
    return K


def _gravity(tree: KinematicTree) -> ca.SX:
    return ca.SX(ca.DM(tree.gravity))


def _bodies(tree: KinematicTree, inertias: Inertias | None) -> Inertias:
    if inertias is None:
        return [each.inertia.symbolic() for each in tree.joints]
    assert len(inertias) == len(tree.joints)
    return inertias


def _carried(pose: Pose, force: ca.SX, torque: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Give a force and a torque about the body's origin as its parent feels them."""
    force = pose.R @ force
    return force, pose.R @ torque + ca.cross(pose.p, force)


def _composites(tree: KinematicTree, poses: Sequence[Pose], bodies: Inertias) -> list[SpatialInertia]:
    """Give each body together with all that it carries."""
    composites = list(bodies)
    for i, joint in reversed(list(enumerate(tree.joints))):
        if joint.parent != WORLD:
            composites[joint.parent] += composites[i].moved(poses[i].R, poses[i].p)
    return composites
