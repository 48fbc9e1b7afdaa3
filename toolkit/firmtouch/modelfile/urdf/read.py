"""A URDF file -> `UrdfRobot`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Final

from firmtouch.modelfile.files import read_bytes
from firmtouch.modelfile.urdf.attributes import LARGEST_SIZE, Attributes
from firmtouch.modelfile.urdf.inertial import check_bodies, read_inertial, read_pose
from firmtouch.modelfile.urdf.robot import UNLIMITED, JointType, Limits, Link, Mimic, UrdfJoint, UrdfRobot
from firmtouch.modelfile.urdf.structure import arrange
from firmtouch.modelfile.urdf.xmltext import LARGEST, Element, read_xml
from firmtouch.modelfile.words import listed, shown

OF_ROBOTS: Final = ("link", "joint", "material", "gazebo", "transmission", "ros2_control", "sensor")
OF_LINKS: Final = ("inertial", "visual", "collision")
OF_JOINTS: Final = (
    "origin", "parent", "child", "axis", "limit", "mimic", "dynamics", "calibration", "safety_controller",
)  # fmt: skip
UNSUPPORTED: Final = {"floating": "six", "planar": "three"}


def read_urdf(path: Path | str) -> UrdfRobot:
    """Read and check a URDF file.

    Raises
    ------
    ModelFileError
        With every mistake, each at its line and column.
    InputError
        If the file cannot be read at all.
    """
    path = Path(path)
    return parse_urdf(read_bytes(path, LARGEST), file=str(path))


def parse_urdf(content: bytes, *, file: str) -> UrdfRobot:
    """Check the bytes of a URDF file; `file` is its name in messages."""
    document = read_xml(content, file)
    root, read = document.root, Attributes(document)
    if root.tag != "robot":
        read.refuse(root, f"a URDF file holds one `<robot>`, not {shown(f'<{root.tag}>')}")
        read.finish()
    for each in root.all("loop_joint"):
        read.refuse(each, "`<loop_joint>` closes a loop; only trees of joints are read")
    read.known_children(root, (*OF_ROBOTS, "loop_joint"), "a robot")
    links = [(each, _link(each, read)) for each in root.all("link")]
    joints = [(each, _joint(each, read)) for each in root.all("joint") if _is_joint(each)]
    base, ordered = arrange(root, links, joints, read)
    check_bodies(links, ordered, base, read)
    read.finish()
    name = root.attributes.get("name", "")
    return UrdfRobot(name, file, base, {each.name: each for _, each in links}, {each.name: each for each in ordered})


def _is_joint(element: Element) -> bool:
    """Tell a joint from the `<joint name=..>` that some tools list beside their transmissions."""
    return "type" in element.attributes or bool(element.all("parent") or element.all("child"))


def _link(element: Element, read: Attributes) -> Link:
    name = read.word(element, "name", "a link")
    read.known_children(element, OF_LINKS, f"link {shown(name)}")
    return Link(name, read_inertial(element, name, read), element.place)


def _joint(element: Element, read: Attributes) -> UrdfJoint:
    name = read.word(element, "name", "a joint")
    what = f"joint {shown(name)}"
    read.known_children(element, OF_JOINTS, what)
    kind = _type(element, what, read)
    parent, child = (_end(element, tag, what, read) for tag in ("parent", "child"))
    damping, friction = _losses(element, what, read)
    return UrdfJoint(
        name,
        kind,
        parent,
        child,
        pose=read_pose(element, what, read),
        axis=_axis(element, kind, what, read),
        limits=_limits(element, kind, what, read),
        mimic=_mimic(element, kind, what, read),
        damping=damping,
        friction=friction,
        place=element.place,
    )


def _type(element: Element, what: str, read: Attributes) -> JointType:
    word = read.word(element, "type", what)
    kinds = {each.value: each for each in JointType}
    if word in UNSUPPORTED:
        message = (
            f"{what} is {word}: it has {UNSUPPORTED[word]} coordinates and cannot be read; "
            "make it `fixed`, or write it as prismatic and revolute joints"
        )
        read.refuse(element, message, "type")
    elif word and word not in kinds:
        read.refuse(element, f"{what} is of the unknown type {shown(word)}; there are: {listed(kinds)}", "type")
    return kinds.get(word, JointType.FIXED)


def _end(element: Element, tag: str, what: str, read: Attributes) -> str:
    end = read.only(element, tag, what)
    if end is None:
        read.refuse(element, f"{what} has no `<{tag} link=..>`")
        return ""
    read.known(end, ("link",))
    return read.word(end, "link", f"the {tag} of {what}")


def _axis(element: Element, kind: JointType, what: str, read: Attributes) -> tuple[float, float, float]:
    axis = read.only(element, "axis", what)
    if axis is None or kind is JointType.FIXED:
        return 1.0, 0.0, 0.0
    read.known(axis, ("xyz",))
    x, y, z = read.triple(axis, "xyz", (1.0, 0.0, 0.0))
    length = math.hypot(x, y, z)  # which does not underflow where a sum of squares would
    if length == 0:
        read.refuse(axis, f"the axis of {what} has the length 0", "xyz")
        return 1.0, 0.0, 0.0
    return x / length, y / length, z / length


def _limits(element: Element, kind: JointType, what: str, read: Attributes) -> Limits:
    limit = read.only(element, "limit", what)
    if kind is JointType.FIXED:
        return UNLIMITED
    if limit is None:
        if kind is not JointType.CONTINUOUS:
            read.refuse(element, f"{what} is {kind.value} and has no `<limit lower=.. upper=.. effort=.. velocity=..>`")
        return UNLIMITED
    read.known(limit, ("lower", "upper", "effort", "velocity"))
    bounds = [read.number(limit, name) for name in ("velocity", "effort")]
    for name, bound in zip(("velocity", "effort"), bounds, strict=True):
        if bound < 0:
            read.refuse(limit, f"{what} has a negative limit of {name}, {bound:g}", name)
    if kind is JointType.CONTINUOUS:
        return Limits(UNLIMITED.lower, UNLIMITED.upper, *bounds)
    lower, upper = read.number(limit, "lower", 0.0), read.number(limit, "upper", 0.0)
    if lower > upper:
        read.refuse(limit, f"{what} has a lower limit, {lower:g}, above its upper one, {upper:g}", "lower")
    return Limits(lower, upper, *bounds)


def _mimic(element: Element, kind: JointType, what: str, read: Attributes) -> Mimic | None:
    mimic = read.only(element, "mimic", what)
    if mimic is None or kind is JointType.FIXED:
        return None
    read.known(mimic, ("joint", "multiplier", "offset"))
    leader = read.word(mimic, "joint", f"the `<mimic>` of {what}")
    multiplier, offset = (
        read.number(mimic, name, default, largest=LARGEST_SIZE)
        for name, default in (("multiplier", 1.0), ("offset", 0.0))
    )
    return Mimic(leader, multiplier, offset)


def _losses(element: Element, what: str, read: Attributes) -> tuple[float, float]:
    dynamics = read.only(element, "dynamics", what)
    if dynamics is None:
        return 0.0, 0.0
    losses = read.number(dynamics, "damping", 0.0), read.number(dynamics, "friction", 0.0)
    for name, loss in zip(("damping", "friction"), losses, strict=True):
        if loss < 0:
            read.refuse(dynamics, f"{what} has a negative {name}, {loss:g}", name)
    return losses
