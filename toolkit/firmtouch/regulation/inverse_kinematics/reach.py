"""The question of inverse kinematics, apart from how it is answered: what must be met, and within which limits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import casadi as ca
import numpy as np

from firmtouch.errors import InputError
from firmtouch.mechanics.arrays import Array, Vector, frozen
from firmtouch.mechanics.tree import KinematicTree, frame_jacobian

AXES_AGREE: Final = 1e-9
"""By how much a given rotation or unit vector may miss being one: what its writer rounded away."""
_HALF_TURN: Final = 1e-12
"""Keeps `turned` and `pointed` finite at half a turn, where no axis of rotation is nearer than others."""


@dataclass(frozen=True, slots=True)
class Reach:
    """r(q) = 0 (k rows, in m and rad) with lower <= q <= upper (n, rad or m; infinite where unlimited).

    `task` gives the rows of the tool's geometric Jacobian [v; w] in which the arm shall be able to move (6 x n, or
    fewer rows), for the manipulability. Where `revolves`, r has the period 2 pi, so that whole turns make no
    difference. `lengths` are the rows of r that are together a position's miss (m); `angles` those that are together
    2 sin(half the angle) of a direction's, as `turned` and `pointed` give it: for messages only.
    """

    residual: ca.Function
    task: ca.Function
    lower: Array
    upper: Array
    revolves: tuple[bool, ...]
    names: tuple[str, ...]
    lengths: tuple[int, ...] = ()
    angles: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        """Refuse what does not fit together, and joints without a range.

        Raises
        ------
        InputError
            If a size is wrong, or a lower limit is not below the upper one.
        """
        n = len(self.names)
        if not len(self.lower) == len(self.upper) == len(self.revolves) == self.residual.size1_in(0) == n:
            raise InputError(f"limits, kinds and functions are not all of {n} joints")
        for name, lower, upper in zip(self.names, self.lower, self.upper, strict=True):
            if not lower < upper:
                message = (
                    f"joint `{name}` has no range: its lower limit {lower:g} is not below its upper one, {upper:g}"
                )
                raise InputError(f"{message}; lock it instead")

    @property
    def n(self) -> int:
        """The number of coordinates."""
        return len(self.names)


def reach_of_tree(
    tree: KinematicTree,
    frame: str,
    residual: ca.SX,
    q: ca.SX,
    *,
    lengths: tuple[int, ...] = (),
    angles: tuple[int, ...] = (),
) -> Reach:
    """Ask for residual(q) = 0 of an arm, within the limits of its file; the tool is `frame`.

    Raises
    ------
    InputError
        If the tree has no such frame, or a joint has no range.
    """
    # A follower that turns half as far as its leader is elsewhere after a whole turn of that.
    turns = [
        each.revolves
        and all(
            joint.revolves and joint.multiplier.is_integer() for joint in tree.joints if joint.coordinate == coordinate
        )
        for coordinate, each in enumerate(tree.coordinates)
    ]
    return Reach(
        ca.Function("r", [q], [ca.densify(residual)]),
        ca.Function("task", [q], [ca.densify(frame_jacobian(tree, frame, q))]),
        frozen([each.lower for each in tree.coordinates]),
        frozen([each.upper for each in tree.coordinates]),
        tuple(turns),
        tuple(each.name for each in tree.coordinates),
        lengths,
        angles,
    )


def turned(R: ca.SX, R_d: Array) -> ca.SX:
    """Give 2 sin(angle / 2) times the axis (3) of the rotation R_d^T R, which is zero only where R = R_d.

    R and R_d (3 x 3) are rotations from the tool's axes to the world's; small angles are given in rad.

    Raises
    ------
    InputError
        If R_d is no rotation.
    """
    if (
        R_d.shape != (3, 3)
        or not np.allclose(R_d @ R_d.T, np.eye(3), rtol=0, atol=AXES_AGREE)
        or np.linalg.det(R_d) < 0
    ):
        raise InputError(f"no rotation: {R_d.tolist()}")
    E = ca.DM(R_d.T) @ R
    v = ca.vertcat(E[2, 1] - E[1, 2], E[0, 2] - E[2, 0], E[1, 0] - E[0, 1])  # 2 sin(angle) times the axis
    return v / ca.sqrt(ca.fmax(1 + ca.trace(E), _HALF_TURN))  # trace = 1 + 2 cos(angle)


def pointed(a: ca.SX, d: Vector) -> ca.SX:
    """Give 2 sin(angle / 2) between unit vectors a(q) and d in two components across d: zero only where a = d.

    Raises
    ------
    InputError
        If d has not three components and the length one.
    """
    d = frozen(d)
    if d.shape != (3,) or not abs(float(np.linalg.norm(d)) - 1) <= AXES_AGREE:
        raise InputError(f"no unit vector: {d.tolist()}")
    across = np.linalg.svd(d[None, :])[2][1:]
    return ca.DM(across) @ a * ca.sqrt(2 / ca.fmax(1 + ca.dot(ca.DM(d), a), _HALF_TURN))
