"""A mechanism and its surfaces in MuJoCo's own words (MJCF)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final
from xml.etree import ElementTree as ET

import casadi as ca
import numpy as np

from firmtouch.mechanics import Array, Plant
from firmtouch.mechanics.arrays import Vector, call_vector, frozen
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile.sections.mechanism import Bodies
from firmtouch.oracle.library import NotExpressibleError
from firmtouch.oracle.stiffness import DEFAULT, ContactStiffness
from firmtouch.oracle.surfaces import Ball, JointSum, Plane, Touch
from firmtouch.oracle.tree import Joint, JointKind, Mover, Tree, find_tree, move_point

TIP: Final = 0.01
"""Radius of the small ball at a contact point, in metres; the surface is moved back by it, so that the gap is phi."""
EXTENT: Final = 10.0
"""Half the size of a plane as drawn, and half the length of a cylinder, in metres; contacts take planes as infinite."""
LEAST_INERTIA: Final = 1e-12
"""MuJoCo's bodies must have some inertia; a point mass gets this (kg m^2), far below what the check can see."""
TOLERANCE: Final = "1e-14"
"""Of MuJoCo's solver for the contact force, relative: near rounding, since the force is what is compared."""


@dataclass(frozen=True, slots=True)
class MujocoExport:
    """MJCF text and what it stands for: a joint is called as its coordinate, and constraint j's contact `touch_j`.

    The world is the file's, with z = 0 for mechanisms in the plane; the text places everything as it is at `at`.
    """

    xml: str
    plant: Plant
    at: Array
    touches: tuple[Touch, ...]
    timestep: float


def export_mechanism(
    plant: Plant,
    at: Vector,
    *,
    touches: Sequence[Touch] = (),
    stiffness: ContactStiffness = DEFAULT,
    timestep: float = 5e-4,
) -> MujocoExport:
    """Write a mechanism of bodies as MJCF, with the plant's parameter values; `touches` are from `find_touches`.

    `at` (n) is a configuration at which the expressions are defined, `timestep` is in seconds. `compare_export` tells
    whether it is the same mechanism.

    Raises
    ------
    NotExpressibleError
        If the mechanism is no tree of joints, or MuJoCo would silently change the contact's stiffness.
    """
    stiffness.check(timestep)
    tree = find_tree(plant, at)
    root = ET.Element("mujoco", model=plant.spec.title)
    ET.SubElement(root, "compiler", angle="radian")
    option = ET.SubElement(root, "option", timestep=repr(timestep), gravity=_text(_gravity(plant)), tolerance=TOLERANCE)
    ET.SubElement(option, "flag", autoreset="disable")  # what explodes must be seen, and not begin again
    world = ET.SubElement(root, "worldbody")
    links = _links(world, tree, at)
    solver = {
        "solref": _text([stiffness.timeconst, stiffness.dampratio]),
        "solimp": _text([stiffness.dmin, stiffness.dmax, stiffness.width, stiffness.midpoint, stiffness.power]),
    }
    for j, touch in enumerate(touches):
        if isinstance(touch, JointSum):
            _hold_sum(root, f"touch_{j}", tree, touch=touch, at=at, solver=solver)
            continue
        point = move_point(plant, f"touch_{j}", touch.point, at)
        carrier = tree.carrier_of(point)
        _put_ball(world if carrier is None else links[carrier], point)
        _put_surface(world, f"surface_{j}", touch)
        pair = {"name": point.name, "geom1": f"surface_{j}", "geom2": point.name, "condim": "1"}
        ET.SubElement(_section(root, "contact"), "pair", pair | solver)
    ET.indent(root)
    return MujocoExport(ET.tostring(root, encoding="unicode"), plant, frozen(at), tuple(touches), timestep)


def _gravity(plant: Plant) -> Array:
    assert isinstance(plant.spec.mechanism, Bodies)
    symbols = Symbols(plant.spec)
    gravity = ca.densify(symbols.column(plant.spec.mechanism.gravity))
    return np.append(call_vector(ca.Function("gravity", [symbols.p], [gravity]), plant.p), 0.0)[:3]


def _links(world: ET.Element, tree: Tree, at: Vector) -> dict[int, ET.Element]:
    """Write a body for each coordinate; one whose link has no mass shares the body of the next joint."""
    carried: dict[int, list[Mover]] = {each.coordinate: [] for each in tree.joints}
    for body in tree.bodies:
        carrier = tree.carrier_of(body)
        if carrier is not None:
            carried[carrier].append(body)
    links: dict[int, ET.Element] = {}
    for joint in tree.joints:
        parent = joint.parent
        if parent is not None and not carried[parent]:
            if sum(each.parent == parent for each in tree.joints) > 1:
                raise NotExpressibleError(
                    f"a link without mass carries both `{joint.name}` and another joint; MuJoCo needs a mass there"
                )
            link = links[parent]
        else:
            link = ET.SubElement(world if parent is None else links[parent], "body", name=f"link_{joint.name}")
        _put_joint(link, joint, at)
        if carried[joint.coordinate]:
            _put_inertia(link, carried[joint.coordinate])
        links[joint.coordinate] = link
    return links


def _put_joint(link: ET.Element, joint: Joint, at: Vector) -> None:
    words = {"name": joint.name, "type": joint.kind.value, "axis": _text(joint.axis)}
    words["ref"] = repr(float(at[joint.coordinate]))
    if joint.kind is JointKind.HINGE:
        words["pos"] = _text(joint.anchor)
    if joint.armature:
        words["armature"] = repr(joint.armature)
    ET.SubElement(link, "joint", words)


def _put_inertia(link: ET.Element, bodies: Sequence[Mover]) -> None:
    """Write all that is fixed to one link as one mass, by the parallel-axis theorem."""
    mass = sum(each.mass for each in bodies)
    centre = sum((each.mass * each.centre for each in bodies), np.zeros(3)) / (mass or 1.0)
    inertia = np.zeros((3, 3))
    for each in bodies:
        r = each.centre - centre
        inertia += each.inertia + each.mass * (r @ r * np.eye(3) - np.outer(r, r))
    if np.linalg.eigvalsh(inertia)[0] < LEAST_INERTIA:
        inertia += LEAST_INERTIA * np.eye(3)
    full = [inertia[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    ET.SubElement(link, "inertial", pos=_text(centre), mass=repr(float(mass)), fullinertia=_text(full))


def _put_ball(link: ET.Element, point: Mover) -> None:
    ball = {"name": point.name, "type": "sphere", "pos": _text(point.centre), "size": repr(TIP), "mass": "0"}
    ET.SubElement(link, "geom", ball | _ALONE)


def _put_surface(world: ET.Element, name: str, touch: Plane | Ball) -> None:
    """Write a surface, moved back by the small ball's radius."""
    if isinstance(touch, Plane):
        position, size = touch.normal * (touch.distance - TIP), [EXTENT, EXTENT, 1.0]
        shape = {"type": "plane", "pos": _text(position), "zaxis": _text(touch.normal), "size": _text(size)}
    else:
        if touch.radius <= TIP:
            raise NotExpressibleError(f"a round surface must have a radius above {TIP:g} m, not {touch.radius:g} m")
        radius = touch.radius - TIP
        size = [radius, EXTENT] if touch.disc else [radius]
        shape = {"type": "cylinder" if touch.disc else "sphere", "pos": _text(touch.centre), "size": _text(size)}
    ET.SubElement(world, "geom", {"name": name} | shape | _ALONE)


_ALONE: Final = {"contype": "0", "conaffinity": "0"}
"""Nothing collides but the pairs that are named."""


def _hold_sum(root: ET.Element, name: str, tree: Tree, *, touch: JointSum, at: Vector, solver: dict[str, str]) -> None:
    """Hold weights . q + constant at zero: MuJoCo's fixed tendon, whose length counts from where it is at `at`."""
    tendon = ET.SubElement(_section(root, "tendon"), "fixed", name=name)
    for joint in tree.joints:
        if touch.weights[joint.coordinate]:
            weight = repr(float(touch.weights[joint.coordinate]))
            ET.SubElement(tendon, "joint", joint=joint.name, coef=weight)
    here = float(touch.weights @ np.asarray(at) + touch.constant)
    held = {"name": name, "tendon1": name, "polycoef": _text([-here, 0.0, 0.0, 0.0, 0.0])}
    ET.SubElement(_section(root, "equality"), "tendon", held | solver)


def _section(root: ET.Element, name: str) -> ET.Element:
    found = root.find(name)
    return ET.SubElement(root, name) if found is None else found


def _text(values: Iterable[float]) -> str:
    return " ".join(repr(float(each)) for each in values)
