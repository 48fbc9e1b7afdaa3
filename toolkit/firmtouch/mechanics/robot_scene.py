"""The picture of a robot as numbers: its chains of joints, the surfaces that it touches, and the contact forces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import casadi as ca
import numpy as np

from firmtouch.mechanics.arm import Arm, arm_of
from firmtouch.mechanics.arrays import Array, frozen
from firmtouch.mechanics.plant import Plant
from firmtouch.mechanics.scene import ContactForce, Patch, Scene, solve_force
from firmtouch.mechanics.surfaces import normal, patch
from firmtouch.mechanics.symbols import Symbols
from firmtouch.mechanics.tree.kinematics import constant, joint_pose
from firmtouch.modelfile.sections.constraint import Constraint
from firmtouch.modelfile.sections.frames import Join, OnFrames, RailContact, Rod, SurfaceContact
from firmtouch.modelfile.sections.pose import FrameSpec

PATCH: Final = 0.45
"""Edge of a surface's patch, as a part of how far the robot reaches."""
TANGENT: Final = 0.4
"""Edge of the square that shows the tangent plane, as a part of the patch."""
COUNT: Final = 25
APART: Final = 1e-6
"""Points of a chain nearer than this (m) are one."""


def robot_scene(plant: Plant, q: Array, lambda_d: Array, ghosts: Sequence[Array] = ()) -> Scene:
    """Compute the picture of a robot at q; `ghosts` are further configurations to show behind."""
    symbols = Symbols(plant.spec)
    arm = arm_of(plant.spec, symbols)
    assert arm is not None
    frames = list(_ends(plant, arm))
    chains = ca.Function("chains", [symbols.q, symbols.p], [ca.densify(_chain(arm, each)) for each in frames])

    def lines(at: Array) -> tuple[Array, ...]:
        found = chains.call([at, plant.p])
        return tuple(_joined(np.asarray(each.full()).T) for each in found)

    here = lines(q)
    reach = float(np.max(np.ptp(np.vstack(here), axis=0)))
    return Scene(
        3,
        here,
        tuple(lines(each) for each in ghosts),
        forces=tuple(_forces(plant, arm, q, lambda_d)),
        patches=tuple(_patches(plant, arm, q, PATCH * reach)),
    )


def _ends(plant: Plant, arm: Arm) -> Iterator[FrameSpec]:
    """List the frames that constraints hold, each once; what stands still is no chain."""
    seen: list[FrameSpec] = []
    for entry in plant.spec.entries.values():
        for frame in _frames(entry) if isinstance(entry, OnFrames) else ():
            if frame not in seen and arm.tree.frames[frame.frame].body >= 0:
                seen.append(frame)
                yield frame
    if not seen:
        last = list(arm.tree.frames)[-1]
        yield FrameSpec.model_construct(frame=last, position=None, orientation=())


def _frames(entry: OnFrames) -> tuple[FrameSpec, ...]:
    match entry:
        case SurfaceContact(point=point):
            return (point,) if point is not None else ()
        case RailContact(frame=frame):
            return (frame,)
        case Rod(between=pair) | Join(join=pair):
            return pair
        case _:
            return ()


def _chain(arm: Arm, frame: FrameSpec) -> ca.SX:
    """Give the origins of the bodies from the ground to a frame, and the frame itself, 3 x k."""
    tree, q = arm.tree, arm.symbols.q
    positions = tree.positions(q)
    found = tree.frames[frame.frame]
    first = tree.ancestors(found.body)[-1]
    root = tree.frames[next(iter(tree.frames))]
    points = [constant(root.placement).p if root.body < 0 else ca.SX(3, 1)]
    pose = None
    for i in reversed(tree.ancestors(found.body)):
        step = joint_pose(tree.joints[i], positions[i])
        pose = step if i == first or pose is None else pose @ step
        points.append(pose.p)
    if pose is not None:
        points.append((pose @ constant(found.placement)).p)
    points.append(arm.pose(frame).p)
    return ca.horzcat(*points)


def _joined(points: Array) -> Array:
    """Leave out points that coincide with the one before."""
    kept = [points[0]]
    for each in points[1:]:
        if np.linalg.norm(each - kept[-1]) > APART:
            kept.append(each)
    return frozen(kept if len(kept) > 1 else [*kept, points[-1]])


def _forces(plant: Plant, arm: Arm, q: Array, lambda_d: Array) -> Iterator[ContactForce]:
    """Give the force of each constraint on frames: what its rows in metres do; the others are moments."""
    rows, J = list(plant.spec.constraints.items()), plant.J(q)
    for name, entry in plant.spec.entries.items():
        frames = _frames(entry) if not isinstance(entry, Constraint) else ()
        if not frames:
            continue
        own = entry.rows(name)
        share = sum(
            (lambda_d[j] * J[j] for j, (row, each) in enumerate(rows) if row in own and each.unit == "m"),
            np.zeros(plant.n),
        )
        points = [arm.pose(each).p for each in reversed(frames)]
        yield solve_force(plant, name, points, symbols=arm.symbols, q=q, share=share)


def _patches(plant: Plant, arm: Arm, q: Array, size: float) -> Iterator[Patch]:
    symbols = arm.symbols
    for entry in plant.spec.entries.values():
        if not isinstance(entry, SurfaceContact) or entry.point is None:
            continue
        x = arm.pose(entry.point).p
        at = ca.Function("at", [symbols.q, symbols.p], [ca.densify(x), ca.densify(normal(entry.surface, x, symbols))])
        point, n = (np.asarray(each.full()).ravel() for each in at(q, plant.p))
        points = patch(entry.surface, point, symbols, plant.p, size=size, count=COUNT)
        tangent = np.linalg.svd(n[None, :])[2][1:]
        corners = [
            point + TANGENT * size / 2 * (a * tangent[0] + b * tangent[1])
            for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))
        ]
        yield Patch(points, frozen(point), frozen(n), frozen(corners))
