"""`<inertial>` and `<origin>`: a body's mass, its centre and its inertia, which must be those of some body."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from firmtouch.modelfile.urdf.attributes import LARGEST_SIZE, Attributes
from firmtouch.modelfile.urdf.robot import Inertial, Pose
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
    """Read what a link weighs; None where the file does not say it."""
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
    elif all(map(math.isfinite, (mass, *inertia))) and (mass or any(inertia)) and (wrong := no_body(mass, inertia)):
        read.refuse(tensor, f"{what} {wrong}")
    return Inertial(pose, mass, inertia)


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
