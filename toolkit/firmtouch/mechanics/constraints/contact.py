"""A point of a robot on a surface, and an axis of its frame along the normal."""

from __future__ import annotations

import casadi as ca

from firmtouch.mechanics.arm import Arm
from firmtouch.mechanics.constraints.row import Row, row_of
from firmtouch.mechanics.surfaces import bend_along, normal
from firmtouch.modelfile.sections.frames import SurfaceContact


def contact_rows(entry: SurfaceContact, arm: Arm) -> list[Row]:
    """Give s(x), and with an aligned axis a, of which e1, e2, a are right-handed, -e2 . n and e1 . n.

    s is the distance from the surface (m), so that its multiplier is the normal force (N), outwards. Where a points
    into the surface, a small turn w changes the others by w . e1 and w . e2: their multipliers are moments (N m).
    """
    assert entry.point is not None
    pose = arm.pose(entry.point)
    q = arm.symbols.q
    s = bend_along(entry.surface, pose.p, q, arm.symbols)
    rows = [Row(s.value, s.gradient, s.hessian, bent=True)]
    if entry.align is not None:
        n = normal(entry.surface, pose.p, arm.symbols)
        first, second = (pose.R[:, "xyz".index(each)] for each in entry.other_axes)
        rows += [row_of(each, q) for each in (-ca.dot(second, n), ca.dot(first, n))]
    return rows
