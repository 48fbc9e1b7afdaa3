"""The model of a robot: where it comes from, its joints, what it carries, and how its equations are computed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePath
from typing import Any

import numpy as np

from firmtouch.design import Design
from firmtouch.modelfile.fields import Expression
from firmtouch.modelfile.sections.chain import ChainMechanism
from firmtouch.modelfile.sections.constraint import Constraint
from firmtouch.modelfile.sections.frames import SurfaceContact
from firmtouch.modelfile.sections.joint_tree import Robot
from firmtouch.modelfile.sections.pose import PoseSpec
from firmtouch.modelfile.sections.robot import UrdfMechanism
from firmtouch.modelfile.sections.variables import Coordinate
from firmtouch.modelfile.urdf import EARTH
from firmtouch.modelfile.urdf.robot import JointType
from firmtouch.report.document import Block, Code, Line, Math, Paragraph, Table
from firmtouch.report.mathematics import symbol
from firmtouch.report.numbers import entries, number, unit, vector


def robot(design: Design) -> Iterator[Block]:
    """Write where the robot comes from, its joints and its constraints."""
    spec = design.model.spec
    if isinstance(spec.mechanism, UrdfMechanism):
        yield from from_file(spec.mechanism)
    elif isinstance(spec.mechanism, ChainMechanism):
        chain = spec.mechanism.planar_chain
        yield Paragraph(
            (
                f"The robot is a chain of {chain.n} equal uniform rods in the x-y plane, each of "
                f"{number(chain.length)} m and {number(chain.mass)} kg, with gravity "
                f"{number(chain.gravity)} m/s² against y.",
            )
        )
    yield _joints(design)
    yield _constraints(design)


def recursion(design: Design) -> Paragraph:
    """Say how M and theta are computed, and in how many operations."""
    functions = design.loop.operating_point.plant.functions
    counts = [functions[each].n_instructions() for each in ("M", "theta")]
    return Paragraph(
        (
            Math("M(q)"),
            " and ",
            Math("theta(q, dot(q))"),
            " are not written out but computed by recursion over the tree of joints (composite rigid bodies and "
            "Newton-Euler; R. Featherstone, Rigid Body Dynamics Algorithms, 2008), in "
            f"{counts[0]} and {counts[1]} scalar operations. Their values at the operating point follow.",
        )
    )


def from_file(mechanism: UrdfMechanism) -> Iterator[Block]:
    """Write which robot of which file it is, what of it moves, and what it carries."""
    robot_ = mechanism.urdf
    tools = [Code(each) for each in mechanism.tool]
    line: Line = ("The robot ", Code(robot_.name), " is read from ", Code(PurePath(robot_.file).name), ". ")
    line = (*line, "It stands on ", Code(robot_.root), *_base(mechanism.base))
    if tools:
        line = (*line, "; its tool is " if len(tools) == 1 else "; its tools are ", *_between(tools))
    yield Paragraph((*line, f".{_gravity(mechanism)}"))
    still = _still(mechanism)
    if still:
        yield Paragraph((" ".join(still),))
    if mechanism.payload is not None:
        yield Paragraph(_payload(mechanism))
    if mechanism.rotors:
        yield Paragraph(_rotors(mechanism))


def _base(base: PoseSpec | None) -> Line:
    if base is None:
        return (", whose frame is the world’s",)
    position = base.position.text if base.position else "the origin"
    turns = ", ".join(f"{angle.text} about {axis}" for axis, angle in base.orientation)
    return (" at ", Code(position), *((", turned by ", Code(turns)) if turns else ()))


def _gravity(mechanism: UrdfMechanism) -> str:
    if mechanism.gravity == EARTH:
        return ""
    return f" Gravity is {vector(mechanism.gravity)} m/s² there."


def _still(mechanism: UrdfMechanism) -> list[str]:
    """Name the joints that are locked, follow others, or do not matter for the tool."""
    moving = mechanism.moving()
    joints = mechanism.urdf.joints
    movable = [name for name, each in joints.items() if each.type is not JointType.FIXED]
    found = []
    if moving.stopped:
        places = [
            f"{name} at {number(at)} {'m' if joints[name].type is JointType.PRISMATIC else 'rad'}"
            for name, at in moving.stopped.items()
        ]
        found.append(f"Locked: {', '.join(places)}.")
    followers = [each for each in moving.joints if each.mimic is not None]
    if followers:
        words = [f"{each.name} follows {each.mimic.joint}" for each in followers if each.mimic is not None]
        found.append(f"Of the joints that move, {', '.join(words)}.")
    kept = {each.name for each in moving.joints} | set(moving.stopped)
    left_out = [name for name in movable if name not in kept]
    if left_out:
        found.append(f"Left out, as they do not move the tool: {', '.join(left_out)}, with all that they carry.")
    return found


def _rotors(mechanism: UrdfMechanism) -> Line:
    listed = ", ".join(f"{name.replace('_', ' ')} {each.text}" for name, each in mechanism.rotors.items())
    return ("Of their motors' rotors the joints feel further inertia on the diagonal of ", Math("M"), f": {listed}.")


def _payload(mechanism: UrdfMechanism) -> Line:
    payload = mechanism.payload
    assert payload is not None
    where = payload.frame or mechanism.tool[0]
    line: Line = ("Its link ", Code(where), " carries ", Code(payload.mass.text))
    if payload.centre_of_mass is not None:
        line = (*line, " with the centre of mass at ", Code(payload.centre_of_mass.text))
    if payload.inertia is not None:
        return (*line, " and moments of inertia ", Code(payload.inertia.text), " about it.")
    return (*line, ", taken as a point mass.")


def _between(spans: list[Code]) -> Line:
    line: Line = (spans[0],)
    for i, each in enumerate(spans[1:], start=2):
        line = (*line, " and " if i == len(spans) else ", ", each)
    return line


def _joints(design: Design) -> Table:
    """Write the joints with what the file says of their drives."""
    coordinates = design.model.spec.coordinates
    some_labels = any(each.label for each in coordinates.values())
    rows: list[tuple[Line, ...]] = []
    for name, each in coordinates.items():
        drive = (_bound(each.velocity, f"{each.unit}/s"), _bound(each.effort, "N m" if each.unit == "rad" else "N"))
        row: tuple[Line, ...] = ((Math(symbol(name)),), (each.unit,), (_limits(each),), *((text,) for text in drive))
        rows.append((*row, (each.label or "",)) if some_labels else row)
    headings: tuple[Line, ...] = (("joint",), ("unit",), ("limits",), ("greatest speed",), ("greatest effort",))
    headings = (*headings, ("",)) if some_labels else headings
    return Table(headings, tuple(rows), frozenset({2, 3, 4}))


def _limits(coordinate: Coordinate) -> str:
    if coordinate.limits is None:
        return "none"
    ends = np.array([each.value for each in coordinate.limits])
    if coordinate.unit == "rad":
        low, high = entries(np.degrees(ends))
        return f"{low}° to {high}°"
    low, high = entries(ends)
    return f"{low} to {high} m"


def _bound(quantity: Any, its_unit: str) -> str:  # noqa: ANN401  # a quantity of any dimension, or none
    return "not given" if quantity is None else f"{number(quantity.value)} {its_unit}"


def _constraints(design: Design) -> Table:
    """Write the rows of Phi, and once for each entry what they are about."""
    rows: list[tuple[Line, ...]] = []
    for name, entry in design.model.spec.entries.items():
        about = _about(entry)
        for row, each in entry.rows(name).items():
            rows.append(((Math(f'phi_("{row.replace("_", " ")}")'),), (unit(each.unit),), (each.label or "",), about))
            about = ("",)
    return Table((("constraint",), ("unit",), ("row",), ("what is held",)), tuple(rows), wide=frozenset({3}))


def _about(entry: Any) -> Line:  # noqa: ANN401  # any entry of `constraints`
    if isinstance(entry, Constraint):
        return (Code(entry.written),)
    if not isinstance(entry, SurfaceContact):
        return (Code(entry.written()),)
    return (Code(entry.written()), *_shape(entry))


def _shape(entry: SurfaceContact) -> Line:
    """Write the surface's measures as the file has them."""
    shape = entry.surface.shape
    given = [(name, getattr(shape, name)) for name in type(shape).model_fields]
    texts = [
        f"{name.replace('_', ' ')} {value.text if isinstance(value, Expression) else value}"
        for name, value in given
        if isinstance(value, Expression) or (isinstance(value, str) and value != "outside")
    ]
    return (f": {', '.join(texts)}",) if texts else ()


def is_robot(design: Design) -> bool:
    """Tell whether the mechanism is a robot."""
    return isinstance(design.model.spec.mechanism, Robot)
