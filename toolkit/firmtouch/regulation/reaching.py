"""What a file says of where its robot shall be -> a question of inverse kinematics, and its answer."""

from __future__ import annotations

from typing import Final

import casadi as ca
import numpy as np

from firmtouch.errors import NoDesignError
from firmtouch.mechanics import Array, Plant
from firmtouch.mechanics.arm import Arm, arm_of
from firmtouch.mechanics.arrays import call_vector, frozen
from firmtouch.mechanics.surfaces import inside_domain, normal, signed_distance
from firmtouch.mechanics.symbols import Symbols
from firmtouch.mechanics.tree import frame_jacobian
from firmtouch.modelfile.rows import others
from firmtouch.modelfile.sections.frames import SurfaceContact
from firmtouch.modelfile.sections.operating_point import ReachSpec
from firmtouch.modelfile.sections.pose import FrameSpec
from firmtouch.regulation.inverse_kinematics import Reach, Reached, pointed, solve_reach
from firmtouch.regulation.projection import NEAR_SURFACE

NEAR_NORMAL: Final = 1e-3
"""How far (rad) a stated direction may be off the normal and still be taken as a rounded one."""
SQUARE: Final = 1e-6
"""The least sine of the angle between two directions that shall span a plane."""


class PointOffSurfaceError(NoDesignError):
    """The point that shall be touched is not on the surface: `distance` (m) from it, inside where negative."""

    def __init__(self, contact: str, distance: float) -> None:
        self.contact, self.distance = contact, distance
        where = "inside" if distance < 0 else "outside of"
        super().__init__(
            f"the point to reach is {1e3 * abs(distance):.4g} mm {where} the surface of `{contact}`; it must be on it"
        )


class BeyondGridError(NoDesignError):
    """A contact lies where its height field is not given."""

    def __init__(self, contacts: tuple[str, ...]) -> None:
        self.contacts = contacts
        named = " and ".join(f"`{each}`" for each in contacts)
        super().__init__(f"the point that touches is beyond the grid of the height field of {named}")


def beyond_grids(plant: Plant, q: Array) -> tuple[str, ...]:
    """List the contacts whose point at q lies beyond the grid of its height field."""
    contacts = {
        name: each
        for name, each in plant.spec.entries.items()
        if isinstance(each, SurfaceContact) and each.surface.height_field is not None
    }
    if not contacts:
        return ()
    symbols = Symbols(plant.spec)
    arm = arm_of(plant.spec, symbols)
    assert arm is not None
    found = []
    for name, each in contacts.items():
        assert each.point is not None
        place = ca.Function("place", [symbols.q, symbols.p], [ca.densify(arm.pose(each.point).p)])
        if not inside_domain(each.surface, call_vector(place, q, plant.p), symbols, plant.p):
            found.append(name)
    return tuple(found)


def reach_configuration(plant: Plant) -> Reached:
    """Find the configurations in which the robot is where the file wants it, all constraints and limits kept.

    Raises
    ------
    PointOffSurfaceError
        If the point is not on the surface that shall be touched.
    OutOfReachError, BeyondLimitsError
        If no configuration meets all, or only beyond joint limits.
    """
    spec = plant.spec.operating_point.reach
    assert spec is not None
    coordinates = plant.spec.coordinates
    near = None if spec.near is None else frozen([spec.near[name] for name in coordinates])
    symbols = Symbols(plant.spec)
    arm = arm_of(plant.spec, symbols)
    assert arm is not None, "the file's reader lets robots alone reach"
    return solve_reach(_question(plant, spec, arm), near=near)


def _question(plant: Plant, spec: ReachSpec, arm: Arm) -> Reach:
    symbols, coordinates = arm.symbols, plant.spec.coordinates
    contact = _contact(plant, spec)
    frame = spec.frame or (contact[1].point if contact else None)
    assert frame is not None
    pose = arm.pose(frame)
    point = _number(symbols.column(spec.point), plant, symbols)
    direction = None if spec.direction is None else _unit(_number(symbols.column(spec.direction), plant, symbols))
    if contact is not None:
        point, n = _on_surface(plant, *contact, point, symbols)
        direction = -n if direction is None else _kept_along(n, *contact, spec.axis, direction)
    rows = [pose.p - ca.DM(point)]
    angles = 0
    if direction is not None:
        rows.append(pointed(pose.R[:, "xyz".index(spec.axis)], direction))
        angles = 2
        if spec.across is not None:
            across = _across(_number(symbols.column(spec.across), plant, symbols), direction)
            rows.append(pointed(pose.R[:, "xyz".index(others(spec.axis)[0])], across))
    rows.append(plant.functions["Phi"](symbols.q, symbols.p))
    J = frame_jacobian(arm.tree, frame.frame, symbols.q)
    task = J if direction is not None else J[:3, :]
    return Reach(
        _of_q(ca.vertcat(*rows), plant, symbols),
        _of_q(task, plant, symbols),
        frozen([each.lower for each in coordinates.values()]),
        frozen([each.upper for each in coordinates.values()]),
        tuple(each.unit == "rad" for each in coordinates.values()),
        tuple(coordinates),
        lengths=(0, 1, 2),
        angles=tuple(range(3, 3 + angles)),
    )


def _kept_along(n: Array, name: str, contact: SurfaceContact, axis: str, direction: Array) -> Array:
    """Move a direction that is along the normal but for rounding there, if the contact keeps that axis along it."""
    if contact.align != axis:
        return direction
    along, sine = float(direction @ n), float(np.linalg.norm(np.cross(direction, n)))
    if sine > NEAR_NORMAL:
        angle = np.rad2deg(np.arctan2(sine, abs(along)))
        raise NoDesignError(
            f"`direction` is {angle:.3g} deg off the normal of `{name}`, along which `align: {axis}` keeps that axis; "
            "leave one of them out"
        )
    return frozen(np.copysign(1.0, along) * n)


def _contact(plant: Plant, spec: ReachSpec) -> tuple[str, SurfaceContact] | None:
    """Find the contact that is meant: the named one, or the only one where no other frame is named."""
    contacts = {name: each for name, each in plant.spec.entries.items() if isinstance(each, SurfaceContact)}
    if spec.contact is not None:
        return spec.contact, contacts[spec.contact]
    if len(contacts) == 1 and _same(spec.frame, next(iter(contacts.values())).point):
        return next(iter(contacts.items()))
    return None


def _same(frame: FrameSpec | None, point: FrameSpec | None) -> bool:
    return frame is None or frame == point


def _on_surface(
    plant: Plant, name: str, contact: SurfaceContact, point: Array, symbols: Symbols
) -> tuple[Array, Array]:
    """Move a point that is on the surface but for rounding onto it; give the normal there too."""
    x = ca.SX.sym("x", 3)
    outputs = [signed_distance(contact.surface, x, symbols), normal(contact.surface, x, symbols)]
    function = ca.Function("surface", [x, symbols.p], [ca.densify(each) for each in outputs])
    for _ in range(8):
        s, n = (np.asarray(each.full()).ravel() for each in function(point, plant.p))
        if not (np.all(np.isfinite(n)) and abs(float(s[0])) <= NEAR_SURFACE):
            raise PointOffSurfaceError(name, float(s[0]))
        point = point - float(s[0]) * n
    if not inside_domain(contact.surface, point, symbols, plant.p):
        raise BeyondGridError((name,))
    return frozen(point), frozen(n)


def _of_q(expression: ca.SX, plant: Plant, symbols: Symbols) -> ca.Function:
    """Make a function of q alone, at the parameters' values."""
    return ca.Function("of_q", [symbols.q], [ca.densify(ca.substitute(expression, symbols.p, ca.DM(plant.p)))])


def _number(expression: ca.SX, plant: Plant, symbols: Symbols) -> Array:
    return call_vector(ca.Function("number", [symbols.p], [ca.densify(expression)]), plant.p)


def _unit(v: Array) -> Array:
    return frozen(v / np.linalg.norm(v))


def _across(v: Array, direction: Array) -> Array:
    """Give the unit vector square to the direction that is nearest to v."""
    part = v - (v @ direction) * direction
    if not np.linalg.norm(part) > SQUARE * np.linalg.norm(v):
        raise NoDesignError("`across` points along the direction itself")
    return _unit(frozen(part))
