"""`<inertial>` and `<origin>`: a mass, its centre and its inertia, of some body where they move."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from firmtouch.modelfile.urdf.attributes import LARGEST_SIZE, Attributes
from firmtouch.modelfile.urdf.robot import Inertial, JointType, Link, Pose, UrdfJoint
from firmtouch.modelfile.urdf.xmltext import Element
from firmtouch.modelfile.words import shown

ENTRIES: Final = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
ROUNDED: Final = 1e-3
"""By how much of the largest moment figures of three digits may miss the triangle inequality without being wrong."""
Moments = tuple[float, float, float, float, float, float]


def read_pose(element: Element, what: str, read: Attributes) -> Pose:
    """Read the `<origin>` of a joint or of an inertia; without one, the frames coincide."""
    origin = read.only(element, "origin", what)
    if origin is None:
        return Pose()
    if "quat_xyzw" in origin.attributes:
        read.refuse(origin, f"the origin of {what} has a `quat_xyzw`; only `rpy` is read", "quat_xyzw")
    read.known(origin, ("xyz", "rpy", "quat_xyzw"))
    zero = (0.0, 0.0, 0.0)
    return Pose(read.triple(origin, "xyz", zero), read.triple(origin, "rpy", zero))


def read_inertial(link: Element, name: str, read: Attributes) -> Inertial | None:
    """Read what a link weighs; None where the file does not say it. Whether a body can be so is told by its joints."""
    what = f"link {shown(name)}"
    element = read.only(link, "inertial", what)
    if element is None:
        return None
    read.known_children(element, ("origin", "mass", "inertia"), f"the inertial of {what}")
    pose = read_pose(element, f"the inertial of {what}", read)
    mass_element, tensor = read.only(element, "mass", what), read.only(element, "inertia", what)
    for tag, each in {"mass": mass_element, "inertia": tensor}.items():
        if each is None:
            read.refuse(element, f"the inertial of {what} has no `<{tag}>`")
    if mass_element is None or tensor is None:
        return None
    read.known(mass_element, ("value",))
    read.known(tensor, ENTRIES)
    mass = read.number(mass_element, "value", largest=LARGEST_SIZE)
    ixx, ixy, ixz, iyy, iyz, izz = (read.number(tensor, each, largest=LARGEST_SIZE) for each in ENTRIES)
    inertia = (ixx, ixy, ixz, iyy, iyz, izz)
    if mass < 0:
        read.refuse(mass_element, f"{what} has a negative mass, {mass:g} kg", "value")
    return Inertial(pose, mass, inertia)


def check_bodies(
    links: Sequence[tuple[Element, Link]], joints: Sequence[UrdfJoint], root: str, read: Attributes
) -> None:
    """Refuse links that move with a mass and an inertia that no body has; the joints stand behind their carriers.

    The inertia of what stands still has no effect, and many files write something there. A link that is fixed to what
    carries it may be a point mass: many tools and sensors are written so.
    """
    still, fixed = {root}, set()
    for joint in joints:
        if joint.type is JointType.FIXED:
            fixed.add(joint.child)
            still |= {joint.child} if joint.parent in still else set()
    for element, link in links:
        if link.inertial is None or link.name in still:
            continue
        mass, inertia = link.inertial.mass, link.inertial.inertia
        if not all(map(math.isfinite, (mass, *inertia))) or mass < 0:
            continue  # told already
        plain = not any(inertia) and (mass == 0 or link.name in fixed)
        if not plain and (wrong := no_body(mass, inertia)):
            read.refuse(element.all("inertial")[0].all("inertia")[0], f"link {shown(link.name)} {wrong}")


def no_body(mass: float, inertia: Moments) -> str | None:
    """Say why no body has this mass and inertia about its centre of mass; None where some body has."""
    ixx, ixy, ixz, iyy, iyz, izz = inertia
    if mass == 0:
        return "has an inertia, but no mass"
    size = max(map(abs, inertia))
    if size == 0:
        return f"has a mass of {mass:g} kg, but no inertia"
    # Scaled by the largest entry, so that no square of it overflows.
    smallest, middle, largest = size * np.linalg.eigvalsh(
        np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]]) / size
    )
    moments = f"principal moments {smallest:.4g}, {middle:.4g} and {largest:.4g} kg m^2"
    if smallest <= 0:
        return f"has an inertia that is not positive definite: {moments}"
    if largest - smallest - middle > ROUNDED * largest:
        return f"has an inertia that no body has: {moments}, of which the largest exceeds the sum of the others"
    return None
