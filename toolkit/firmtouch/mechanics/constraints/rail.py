"""A frame of a robot that slides along a line or a circle."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from firmtouch.mechanics.arm import Arm
from firmtouch.mechanics.constraints.turns import turns
from firmtouch.mechanics.space import direction, unit
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile.sections.frames import CircleSpec, LineSpec, RailContact


@dataclass(frozen=True, slots=True)
class Foot:
    """The curve near a point: how far the point is beside it in two directions (m), and its frame there.

    Of the frame's axes (the columns of R) z runs along the curve, and the distances count along x and y.
    """

    beside: tuple[ca.SX, ca.SX]
    R: ca.SX


def rail_rows(entry: RailContact, arm: Arm) -> list[ca.SX]:
    """Give two distances from the curve (m), and the turns of what is held against the curve's frame (rad)."""
    pose = arm.pose(entry.frame)
    if entry.rail.line is not None:
        foot = _on_line(entry.rail.line, pose.p, arm.symbols)
    else:
        assert entry.rail.circle is not None
        foot = _on_circle(entry.rail.circle, pose.p, arm.symbols)
    return [*foot.beside, *turns(foot.R.T @ pose.R, entry.hold)]


def _on_line(line: LineSpec, x: ca.SX, symbols: Symbols) -> Foot:
    z = direction(line.direction, symbols)
    y = _square_to(z) if line.up is None else unit(_beside(z, symbols.column(line.up)))
    R = ca.horzcat(ca.cross(y, z), y, z)
    away = R.T @ (x - symbols.column(line.point))
    return Foot((away[0], away[1]), R)


def _on_circle(circle: CircleSpec, x: ca.SX, symbols: Symbols) -> Foot:
    y = direction(circle.axis, symbols)
    away = x - symbols.column(circle.centre)
    height = ca.dot(away, y)
    outwards = away - height * y
    distance = ca.norm_2(outwards)
    R = ca.horzcat(outwards / distance, y, ca.cross(outwards / distance, y))
    return Foot((distance - symbols.scalar(circle.radius), height), R)


def _beside(z: ca.SX, v: ca.SX) -> ca.SX:
    """Give the part of a vector that is square to a unit vector."""
    return v - ca.dot(v, z) * z


def _square_to(z: ca.SX) -> ca.SX:
    """Give a unit vector square to another one: of the world's axes, the one that is farthest from it made so.

    With parameters in `z` its entries are no numbers yet; then the x axis has to do.
    """
    sizes = [abs(float(ca.evalf(each))) if not ca.symvar(each) else 1.0 for each in ca.vertsplit(z)]
    axis = ca.SX(ca.DM([float(i == sizes.index(min(sizes))) for i in range(3)]))
    return unit(_beside(z, axis))
