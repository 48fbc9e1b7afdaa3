"""Links and joints as one tree, in an order in which every joint stands behind its carrier."""

from __future__ import annotations

from collections.abc import Sequence

from firmtouch.modelfile.urdf.attributes import Attributes
from firmtouch.modelfile.urdf.robot import Link, UrdfJoint
from firmtouch.modelfile.urdf.xmltext import Element
from firmtouch.modelfile.words import did_you_mean, listed, shown

Links = Sequence[tuple[Element, Link]]
Joints = Sequence[tuple[Element, UrdfJoint]]


def arrange(robot: Element, links: Links, joints: Joints, read: Attributes) -> tuple[str, tuple[UrdfJoint, ...]]:
    """Give the root link's name, and the joints from there on, branch by branch in the file's order."""
    _refuse_duplicates(links, "link", read)
    _refuse_duplicates(joints, "joint", read)
    names = {link.name: element for element, link in links}
    carriers: dict[str, str] = {}
    for element, joint in joints:
        _check_ends(element, joint, names, carriers, read)
    _check_mimics(joints, read)
    roots = [name for name in names if name not in carriers]
    if not names:
        read.refuse(robot, "a robot without links")
    elif len(roots) > 1:
        for each in roots[1:]:
            read.refuse(names[each], f"link {shown(each)} hangs at no joint, and neither does {shown(roots[0])}")
    base = roots[0] if roots else ""
    ordered = _from(base, joints)
    reached = {each.name for each in ordered}
    if len(roots) <= 1:
        circling = [(element, joint) for element, joint in joints if joint.name not in reached and joint.child]
        if circling:
            message = f"joints in a circle: {listed(each.name for _, each in circling)}; only trees are read"
            read.refuse(circling[0][0], message)
    return base, ordered


def _refuse_duplicates(pairs: Links | Joints, what: str, read: Attributes) -> None:
    seen: set[str] = set()
    for element, each in pairs:
        if each.name and each.name in seen:
            read.refuse(element, f"a second {what} of the name {shown(each.name)}", "name")
        seen.add(each.name)


def _check_ends(
    element: Element, joint: UrdfJoint, names: dict[str, Element], carriers: dict[str, str], read: Attributes
) -> None:
    """Check that both links exist and that the child hangs at no other joint; note who carries it."""
    for tag, link in (("parent", joint.parent), ("child", joint.child)):
        if link and link not in names:
            end = element.all(tag)[0]
            message = f"the {tag} of joint {shown(joint.name)}, {shown(link)}, is no link{did_you_mean(link, names)}"
            read.refuse(end, message, "link")
    if joint.child in carriers:
        message = (
            f"link {shown(joint.child)} hangs at two joints, {shown(carriers[joint.child])} and {shown(joint.name)}"
        )
        read.refuse(element, f"{message}; only trees are read")
    carriers.setdefault(joint.child, joint.name)


def _check_mimics(joints: Joints, read: Attributes) -> None:
    known = {joint.name: joint for _, joint in joints}
    for element, joint in joints:
        if joint.mimic is None or not joint.mimic.joint:
            continue
        leader = known.get(joint.mimic.joint)
        what = f"joint {shown(joint.name)} follows {shown(joint.mimic.joint)}"
        if leader is None:
            near = did_you_mean(joint.mimic.joint, known)
            read.refuse(element.all("mimic")[0], f"{what}, which is no joint{near}", "joint")
        elif leader.mimic is not None:
            read.refuse(element.all("mimic")[0], f"{what}, which follows another joint itself", "joint")
        elif leader.type.value == "fixed":
            read.refuse(element.all("mimic")[0], f"{what}, which is fixed", "joint")


def _from(base: str, joints: Joints) -> tuple[UrdfJoint, ...]:
    """Walk without recursion: a chain may be as long as the file."""
    below: dict[str, list[UrdfJoint]] = {}
    for _, joint in joints:
        below.setdefault(joint.parent, []).append(joint)
    ordered: list[UrdfJoint] = []
    waiting = list(reversed(below.pop(base, [])))
    while waiting:
        joint = waiting.pop()
        ordered.append(joint)
        waiting += reversed(below.pop(joint.child, []))
    return tuple(ordered)
