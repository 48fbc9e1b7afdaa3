"""A planar chain of equal rods, of any number of links: the arm that one scales up."""

from __future__ import annotations

import math

import numpy as np

from firmtouch.errors import InputError
from firmtouch.mechanics.arrays import frozen
from firmtouch.mechanics.tree.build import MOST_JOINTS
from firmtouch.mechanics.tree.inertia import body_inertia
from firmtouch.mechanics.tree.placement import placement
from firmtouch.mechanics.tree.tree import WORLD, Frame, KinematicTree, TreeJoint
from firmtouch.modelfile.urdf import MovingJoint


def planar_chain(n: int, *, length: float, mass: float, gravity: float = 9.81) -> KinematicTree:
    """Build n uniform slender rods in the x-y plane, each of a length (m) and a mass (kg).

    The first turns about the origin, each other about the end of the one before; q_i (rad, without bounds) is the
    angle to the one before, the first's to the x axis, all about z. Gravity (m/s^2) pulls along -y. The frames are
    `link1` to `link<n>`, each at its rod's beginning with x along it, and `tip` at the end of the last.

    Raises
    ------
    InputError
        If n is not from 1 to MOST_JOINTS, a length or mass is not positive, or a number is not finite.
    """
    if not 1 <= n <= MOST_JOINTS:
        raise InputError(f"a chain of {n} links; it can have 1 to {MOST_JOINTS}")
    for value, what in ((length, "length"), (mass, "mass")):
        if not (math.isfinite(value) and value > 0):
            raise InputError(f"the {what} of a chain's links must be positive, not {value:g}")
    if not math.isfinite(gravity):
        raise InputError(f"gravity must be a finite number, not {gravity:g}")
    about_centre = frozen(np.diag([0.0, 1.0, 1.0]) * mass * length**2 / 12)
    rod = body_inertia(mass, about_centre, placement((length / 2, 0, 0)))
    start, end = placement(), placement((length, 0, 0))
    names = [f"q{i}" for i in range(1, n + 1)]
    joints = tuple(
        TreeJoint(name, i - 1 if i else WORLD, end if i else start, True, frozen((0, 0, 1)), i, 1.0, 0.0, rod)
        for i, name in enumerate(names)
    )
    coordinates = tuple(MovingJoint(name, True, -math.inf, math.inf, math.inf, math.inf) for name in names)
    frames = {f"link{i + 1}": Frame(i, start) for i in range(n)} | {"tip": Frame(n - 1, end)}
    return KinematicTree(coordinates, joints, frames, frozen((0.0, -gravity, 0.0)))
