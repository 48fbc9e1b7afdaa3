"""`mechanism`: rigid bodies, the two energies, or a robot."""

from __future__ import annotations

from typing import Annotated, Any, Final

from pydantic import Discriminator, Field, Tag, ValidationInfo, model_validator

from firmtouch.modelfile.declarations import Declarations
from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import (
    EXPRESSION_SCHEMA,
    Checked,
    Expression,
    Label,
    declared,
    expression_in,
    read_all,
    read_expression,
    refuse,
)
from firmtouch.modelfile.sections.chain import ChainMechanism
from firmtouch.modelfile.sections.robot import UrdfMechanism
from firmtouch.modelfile.sections.section import Section
from firmtouch.modelfile.sections.space import Rotations, read_rotations

PLANE_OR_SPACE: Final = (2, 3)
Matrix = tuple[tuple[Expression, ...], ...]


def _matrix(raw: list[Any], known: Declarations, unit: str) -> Matrix:
    if len(raw) != 3 or not all(isinstance(row, list) and len(row) == 3 for row in raw):
        refuse(Problem("a 3 x 3 matrix was expected: three lists of three expressions"))

    def read(_: int, row: list[Any]) -> tuple[Expression, ...]:
        return tuple(read_all(enumerate(row), lambda _, each: read_expression(each, known, unit=unit)).values())

    return tuple(read_all(enumerate(raw), read).values())


def _inertia(raw: object, info: ValidationInfo) -> Expression | Matrix:
    known = declared(info).constant()
    if not isinstance(raw, list):
        return read_expression(raw, known, unit="kg*m^2")
    if raw and isinstance(raw[0], list):
        return _matrix(raw, known, "kg*m^2")
    if len(raw) != 3:
        refuse(Problem(f"{len(raw)} moments of inertia; in space there are three principal ones"))
    return _matrix([[each if i == j else 0 for j in range(3)] for i, each in enumerate(raw)], known, "kg*m^2")


def _orientation(raw: object, info: ValidationInfo) -> Expression | Matrix | Rotations:
    known = declared(info)
    if not isinstance(raw, list):
        return read_expression(raw, known, unit="1")
    if raw and isinstance(raw[0], list):
        return _matrix(raw, known, "1")
    return read_rotations(raw, lambda angle: read_expression(angle, known, unit="1"), "{z: q1}")


_SCALARS: Final = EXPRESSION_SCHEMA["anyOf"]
_ROWS: Final = {"type": "array", "items": {"type": "array", "items": EXPRESSION_SCHEMA}}
_MOMENTS: Final = {"type": "array", "items": EXPRESSION_SCHEMA}
_AXES: Final = {"type": "object", "properties": dict.fromkeys("xyz", EXPRESSION_SCHEMA), "maxProperties": 1}
Inertia = Annotated[Expression | Matrix, Checked(_inertia, {"anyOf": [*_SCALARS, _MOMENTS, _ROWS]})]
Orientation = Annotated[
    Expression | Matrix | Rotations,
    Checked(_orientation, {"anyOf": [*_SCALARS, {"type": "array", "items": _AXES}, _ROWS]}),
]


class Body(Section):
    """A rigid body, placed by expressions in the coordinates."""

    mass: Annotated[Expression, expression_in("kg", constant=True)] = Field(description="constant, in kg")
    centre_of_mass: Annotated[Expression, expression_in("m", sizes=PLANE_OR_SPACE)] = Field(
        description="where the centre of mass is in the world: `[x, y]` or `[x, y, z]`"
    )
    inertia: Inertia | None = Field(
        None,
        description="about the centre of mass: in the plane a scalar; in space, in the body's axes, the three "
        "principal moments or a symmetric 3 x 3 matrix; without it, a point mass",
    )
    orientation: Orientation | None = Field(
        None,
        description="in the plane an angle; in space a list of rotations about the moving axes, such as "
        "`[{z: q1}, {y: q2}]`, or the 3 x 3 rotation matrix from body to world",
    )

    @model_validator(mode="after")
    def _plane_or_space(self) -> Body:
        if self.inertia is not None and self.orientation is None:
            refuse(Problem("a body with an inertia needs an `orientation`"))
        if not self.centre_of_mass.kind.known:
            return self
        in_plane = self.centre_of_mass.size == 2
        wanted = {"inertia": "a scalar", "orientation": "an angle"} if in_plane else {
            "inertia": "three principal moments or a 3 x 3 matrix",
            "orientation": "a list of rotations or a 3 x 3 matrix",
        }  # fmt: skip
        for key, what in wanted.items():
            given = getattr(self, key)
            if given is not None and isinstance(given, Expression) != in_plane:
                where = "the plane" if in_plane else "space"
                refuse(Problem(f"the centre of mass lies in {where}, so `{key}` must be {what}", path=(key,)))
        return self


class Bodies(Section):
    """A mechanism as rigid bodies in the plane or in space."""

    gravity: Annotated[Expression, expression_in("m/s^2", sizes=PLANE_OR_SPACE, constant=True)] = Field(
        description="gravity as a vector in the world, such as `[0, -9.81]`"
    )
    bodies: dict[Label, Body] = Field(min_length=1)

    @model_validator(mode="after")
    def _one_space(self) -> Bodies:
        if not self.gravity.kind.known:
            return self
        problems = [
            Problem(
                f"a vector of {size}, where gravity has {self.gravity.size}", path=("bodies", name, "centre_of_mass")
            )
            for name, body in self.bodies.items()
            if (size := body.centre_of_mass.size) != self.gravity.size and body.centre_of_mass.kind.known
        ]
        if problems:
            refuse(*problems)
        return self


class Energies(Section):
    """A mechanism as its two energies: the paper's general case, Eq. (2)."""

    kinetic_energy: Annotated[Expression, expression_in("J", velocities=True)] = Field(
        description="K(q, q'), with `dot(q1)` for the velocity of q1"
    )
    potential_energy: Annotated[Expression, expression_in("J")] = Field(description="P(q)")


_TELLING: Final = {
    "kinetic_energy": "energies",
    "potential_energy": "energies",
    "urdf": "urdf",
    "planar_chain": "planar_chain",
}


def _which(raw: object) -> str:
    keys = raw if isinstance(raw, dict) else ()
    return next((sort for key, sort in _TELLING.items() if key in keys), "bodies")


Mechanism = Annotated[
    Annotated[Bodies, Tag("bodies")]
    | Annotated[Energies, Tag("energies")]
    | Annotated[UrdfMechanism, Tag("urdf")]
    | Annotated[ChainMechanism, Tag("planar_chain")],
    Discriminator(_which),
]
