"""The picture of a robot as numbers: its chains of joints, the surfaces that it touches, and the contact forces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import casadi as ca
import numpy as np

from firmtouch.mechanics.arm import Arm, arm_of
from firmtouch.mechanics.arrays import Array, frozen
from firmtouch.mechanics.plant import Plant
from firmtouch.mechanics.scene import Base, ContactForce, Held, Patch, Scene, solve_force
from firmtouch.mechanics.surfaces import normal, patch
from firmtouch.mechanics.symbols import Symbols
from firmtouch.mechanics.tree.kinematics import Pose, axis_of, constant, joint_pose
from firmtouch.mechanics.tree.tree import WORLD
from firmtouch.modelfile.sections.constraint import Constraint
from firmtouch.modelfile.sections.frames import (
    CircleSpec,
    CurveSpec,
    Join,
    LineSpec,
    OnFrames,
    RailContact,
    Rod,
    SurfaceContact,
)
from firmtouch.modelfile.sections.pose import FrameSpec
from firmtouch.modelfile.sections.robot import UrdfMechanism

PATCH: Final = 0.45
"""Edge of a surface's patch, as a part of how far the robot reaches."""
TANGENT: Final = 0.4
"""Edge of the square that shows the tangent plane, as a part of the patch."""
COUNT: Final = 25
RAIL: Final = 0.5
"""Half the length of a straight rail's piece, as a part of how far the robot reaches."""
ROUND: Final = 97
"""Points of a round rail."""
APART: Final = 1e-6
"""Points of a chain nearer than this (m) are one."""


def robot_scene(plant: Plant, q: Array, lambda_d: Array, ghosts: Sequence[Array] = ()) -> Scene:
    """Compute the picture of a robot at q; `ghosts` are further configurations to show behind."""
    symbols = Symbols(plant.spec)
    arm = arm_of(plant.spec, symbols)
    assert arm is not None
    frames = list(_ends(plant, arm))
    chains = ca.Function("chains", [symbols.q, symbols.p], [ca.densify(_chain(plant, arm, each)) for each in frames])

    def lines(at: Array) -> tuple[Array, ...]:
        found = chains.call([at, plant.p])
        return tuple(_joined(np.asarray(each.full()).T) for each in found)

    here = lines(q)
    reach = float(np.max(np.ptp(np.vstack(here), axis=0)))
    held = tuple(_held(plant, arm, q))
    return Scene(
        3,
        here,
        tuple(lines(each) for each in ghosts),
        forces=tuple(_forces(plant, arm, q, lambda_d)),
        patches=tuple(_patches(plant, arm, q, PATCH * reach)),
        bases=tuple(_bases(plant, arm, frames, q)),
        held=held,
        rails=tuple(_rails(plant, arm, q, RAIL * reach)),
    )


def _ends(plant: Plant, arm: Arm) -> Iterator[FrameSpec]:
    """List the frames that constraints hold, each once; what stands still is no chain.

    A chain ends at a hand, and what stands off from it in a join is held by it.
    """
    seen: list[FrameSpec] = []
    for entry in plant.spec.entries.values():
        for found in _frames(entry) if isinstance(entry, OnFrames) else ():
            frame = _bare(found.frame) if isinstance(entry, Join) else found
            if frame not in seen and arm.tree.frames[frame.frame].body >= 0:
                seen.append(frame)
                yield frame
    if not seen:
        yield _bare(list(arm.tree.frames)[-1])


def _bare(frame: str) -> FrameSpec:
    return FrameSpec.model_construct(frame=frame, position=None, orientation=())


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


def _chain(plant: Plant, arm: Arm, frame: FrameSpec) -> ca.SX:
    """Give the origins of the bodies from the ground to a frame, and the frame itself, 3 x k."""
    tree, q = arm.tree, arm.symbols.q
    positions = tree.positions(q)
    found = tree.frames[frame.frame]
    first = tree.ancestors(found.body)[-1]
    points = [_foot(plant, arm, first).p]
    pose = None
    for i in reversed(tree.ancestors(found.body)):
        step = joint_pose(tree.joints[i], positions[i])
        pose = step if i == first or pose is None else pose @ step
        points.append(pose.p)
    if pose is not None:
        points.append((pose @ constant(found.placement)).p)
    points.append(arm.pose(frame).p)
    return ca.horzcat(*points)


def _foot(plant: Plant, arm: Arm, first: int) -> Pose:
    """Give the frame that a chain stands on: the link that carries its first joint, or the robot's root."""
    tree, mechanism = arm.tree, plant.spec.mechanism
    carrier = next(iter(tree.frames))
    if isinstance(mechanism, UrdfMechanism):
        carrier = mechanism.urdf.joints[tree.joints[first].name].parent
    found = tree.frames[carrier]
    return constant(found.placement) if found.body == WORLD else Pose(ca.SX.eye(3), ca.SX(3, 1))


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
        point, n = _values(plant, arm, q, x, normal(entry.surface, x, symbols))
        points = patch(entry.surface, point, symbols, plant.p, size=size, count=COUNT)
        tangent = np.linalg.svd(n[None, :])[2][1:]
        corners = [
            point + TANGENT * size / 2 * (a * tangent[0] + b * tangent[1])
            for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))
        ]
        yield Patch(points, frozen(point), frozen(n), frozen(corners))


def _bases(plant: Plant, arm: Arm, frames: Sequence[FrameSpec], q: Array) -> Iterator[Base]:
    """Give where the chains stand, each place once."""
    tree = arm.tree
    for first in dict.fromkeys(tree.ancestors(tree.frames[each.frame].body)[-1] for each in frames):
        joint = tree.joints[first]
        axis = constant(joint.placement).R @ axis_of(joint)
        foot, towards = _values(plant, arm, q, _foot(plant, arm, first).p, axis)
        yield Base(foot, towards)


def _held(plant: Plant, arm: Arm, q: Array) -> Iterator[Held]:
    """Give what joined frames hold between them, where they are apart."""
    for name, entry in plant.spec.entries.items():
        if not isinstance(entry, Join):
            continue
        one, other = (arm.pose(_bare(each.frame)) for each in entry.join)
        start, end, R = _values(plant, arm, q, one.p, other.p, one.R)
        along = end - start
        length = float(np.linalg.norm(along))
        if length > APART:
            # Of the hand's axes the one that is most square to what is held, made so.
            best = R[:, int(np.argmin(np.abs(R.T @ along)))]
            across = best - (best @ along) * along / length**2
            yield Held(name, frozen([start, end]), frozen(across / np.linalg.norm(across)))


def _rails(plant: Plant, arm: Arm, q: Array, half: float) -> Iterator[Array]:
    """Give the curves that frames slide along, near them, and the rods between frames."""
    symbols = arm.symbols
    for entry in plant.spec.entries.values():
        match entry:
            case Rod(between=(one, other)):
                yield frozen(_values(plant, arm, q, arm.pose(one).p, arm.pose(other).p))
            case RailContact(rail=CurveSpec(line=LineSpec() as line), frame=frame):
                x, along = _values(plant, arm, q, arm.pose(frame).p, symbols.column(line.direction))
                along = along / np.linalg.norm(along)
                yield frozen([x - half * along, x + half * along])
            case RailContact(rail=CurveSpec(circle=CircleSpec() as circle)):
                outputs = (symbols.column(circle.centre), symbols.column(circle.axis), symbols.scalar(circle.radius))
                centre, axis, radius = _values(plant, arm, q, *outputs)
                first, second = np.linalg.svd(axis[None, :])[2][1:]
                turns = np.linspace(0, 2 * np.pi, ROUND)[:, None]
                yield frozen(centre + radius[0] * (np.cos(turns) * first + np.sin(turns) * second))


def _values(plant: Plant, arm: Arm, q: Array, *expressions: ca.SX) -> tuple[Array, ...]:
    """Evaluate expressions at q; columns as vectors."""
    symbols = arm.symbols
    function = ca.Function("values", [symbols.q, symbols.p], [ca.densify(each) for each in expressions])
    found = (np.asarray(each.full()) for each in function.call([q, plant.p]))
    return tuple(frozen(each[:, 0] if each.shape[1] == 1 else each) for each in found)
