"""What an arm carries, as part of the body that carries it."""

from __future__ import annotations

import casadi as ca

from firmtouch.errors import InputError
from firmtouch.mechanics.tree.inertia import SpatialInertia
from firmtouch.mechanics.tree.kinematics import constant, find_frame
from firmtouch.mechanics.tree.tree import WORLD, KinematicTree
from firmtouch.modelfile.words import shown


def loaded(
    tree: KinematicTree, frame: str, *, mass: ca.SX, centre_of_mass: ca.SX, inertia: ca.SX
) -> list[SpatialInertia]:
    """Give the inertias of all bodies, with a payload added: its mass (kg), centre (3, m) and inertia about that.

    Both are in the frame's axes, the inertia is 3 x 3 (kg m^2). They may be symbols, and so parameters.

    Raises
    ------
    InputError
        If there is no such frame, or it does not move.
    """
    found = find_frame(tree, frame)
    if found.body == WORLD:
        raise InputError(f"the payload is fixed to {shown(frame)}, which does not move")
    at = constant(found.placement)
    body = SpatialInertia(mass, ca.SX(3, 1), inertia).moved(ca.SX.eye(3), centre_of_mass).moved(at.R, at.p)
    inertias = [each.inertia.symbolic() for each in tree.joints]
    inertias[found.body] += body
    return inertias
