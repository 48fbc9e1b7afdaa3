"""The rows of the tables as they stand in a file."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

from pydantic import Field, StrictBool, ValidationInfo, model_validator

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import QUANTITY_SCHEMA, Checked, Label, Text, read_all, refuse
from firmtouch.modelfile.sections.section import Section
from firmtouch.modelfile.words import shown
from firmtouch.thermal.fields import (
    DURATION,
    LENGTH,
    Conductance,
    Length,
    Ratio,
    Temperature,
    amount,
    described,
    interval,
    read_name,
    read_temperature,
    reader,
    span,
)

if TYPE_CHECKING:
    from firmtouch.thermal.tables.values import ContactPreset, Part, TableMaterial

BODY: Final = "ntc_oxide"
"""What a part is made of, where its row does not say."""


@dataclass(frozen=True, slots=True)
class Known:
    """The rows that a file's entries may name: those that were there before it, and its own.

    A row of its own that cannot be used is None; what is wrong with it is told where it stands.
    """

    materials: Mapping[str, TableMaterial | None] = field(default_factory=dict)
    parts: Mapping[str, Part | None] = field(default_factory=dict)
    contacts: Mapping[str, ContactPreset | None] = field(default_factory=dict)
    before: Mapping[str, frozenset[str]] = field(default_factory=dict)


def known_to(info: ValidationInfo) -> Known:
    """Give the rows that a file's entries may name."""
    return info.context if isinstance(info.context, Known) else Known()


def read_material(raw: object, info: ValidationInfo) -> str:
    """Read the name of a material of the tables."""
    return read_name(raw, known_to(info).materials, "material")


MaterialName = Annotated[str, Checked(read_material, {"type": "string", "description": "a material of the tables"})]


class RowSpec(Section):
    """What every row of every table has."""

    title: Text | None = Field(None, description="what it is called in reports")
    source: Text = Field(description="where the numbers are from")
    tolerance: Ratio = Field(description="relative half width within which a real one is expected")
    overrides: StrictBool = Field(False, description="true: this row takes the place of one that there is")


class MaterialRow(RowSpec):
    """A material, at about 300 K."""

    k: Annotated[float, amount("W/m/K", least=1e-3, most=1e4)] = Field(description="conductivity, across the layer")
    rho: Annotated[float, amount("kg/m^3", least=0.1, most=3e4)] = Field(description="density")
    c: Annotated[float, amount("J/kg/K", least=10, most=2e4)] = Field(description="specific heat")


class ContactRow(RowSpec):
    """A contact between the touched face and an object."""

    conductance: Conductance = Field(description="h, a usual value")
    low: Conductance = Field(description="h of a bad contact of this sort")
    high: Conductance = Field(description="h of a good contact of this sort")

    @model_validator(mode="after")
    def _in_order(self) -> ContactRow:
        if not self.low <= self.conductance <= self.high:
            refuse(Problem("`low`, `conductance` and `high` must not decrease", path=("conductance",)))
        return self


class Held(Section):
    """A thermal number of a part, and in which surroundings it holds."""

    value: float
    medium: Literal["air", "oil", "water"] | None = Field(None, description="the still medium around the part")
    mounting: Literal["leads", "pcb"] = Field("leads", description="what else takes heat away")
    bound: Literal["at_least", "at_most"] | None = Field(None, description="where the number is no value but a bound")


class Dissipation(Held):
    """The dissipation constant delta: power by rise in temperature."""

    value: Annotated[float, amount("W/K", least=1e-9, most=10)]


class TimeConstant(Held):
    """The time constant tau of cooling in a medium."""

    value: Annotated[float, described(DURATION, "in s")]


def _size(raw: object, info: ValidationInfo) -> tuple[float, ...]:  # noqa: ARG001  # the signature is pydantic's
    if not isinstance(raw, list) or len(raw) != 3:
        refuse(Problem("three lengths were expected: length, width and height, as in `[1 mm, 0.5 mm, 0.5 mm]`"))
    return tuple(read_all(enumerate(raw), lambda _, each: LENGTH(each)).values())


_SIZE: Final[dict[str, Any]] = {"type": "array", "items": QUANTITY_SCHEMA, "minItems": 3, "maxItems": 3}
_OHM: Final = reader("ohm", least=1e-3, most=1e9)
_B: Final = reader("K", least=100, most=2e4)


class PartRow(RowSpec):
    """A thermistor or an RTD."""

    kind: Literal["ntc", "ptc", "rtd"] = Field(description="ntc: an oxide; ptc and rtd: a metal")
    size: Annotated[tuple[float, float, float], Checked(_size, _SIZE)] | None = Field(
        None, description="of a box: length, width, height"
    )
    diameter: Length | None = Field(None, description="of a bead, or, with `length`, of a rod that lies")
    length: Length | None = Field(None, description="of a rod")
    mass: Annotated[float, amount("kg", least=1e-12, most=1)] | None = None
    body: MaterialName | None = Field(None, description=f"the material of its body, by default {BODY}")
    resistance: Annotated[tuple[float, float], span(_OHM, "or of a family, `[low, high]`")] | None = None
    resistance_at: Temperature | None = Field(None, description="where it has this resistance, by default 25 degC")
    B: Annotated[tuple[float, float], span(_B, "or of a family, `[low, high]`")] | None = Field(
        None, description="of an ntc: R = R25 exp(B (1/T - 1/T25))"
    )
    B_between: Annotated[tuple[float, float], interval(read_temperature, "temperatures")] | None = None
    coefficient: Annotated[float, amount("1/K", least=1e-5, most=0.1)] | None = Field(
        None, description="of a metal: (dR/dT)/R at `resistance_at`"
    )
    dissipation: Dissipation | None = None
    time_constant: TimeConstant | None = None
    capacity: Annotated[float, amount("J/K", least=1e-12, most=1e3)] | None = Field(
        None, description="as published; without it, it is found from delta and tau, from the mass or the size"
    )

    @model_validator(mode="after")
    def _one_shape(self) -> PartRow:
        if self.size is not None and self.diameter is not None:
            refuse(Problem("give either `size` or `diameter`", path=("diameter",), at_key=True))
        if self.length is not None and self.diameter is None:
            refuse(Problem("a rod's `length` needs its `diameter`", path=("length",), at_key=True))
        if self.B is not None and self.coefficient is not None:
            refuse(Problem("give either `B` or `coefficient`", path=("coefficient",), at_key=True))
        for name in ("B", "B_between") if self.kind != "ntc" else ("coefficient",):
            if getattr(self, name) is not None:
                refuse(Problem(f"`{name}` does not go with the kind `{self.kind}`", path=(name,), at_key=True))
        return self

    @property
    def volume(self) -> float | None:
        """The volume of the body in m^3: of a box, a rod or a ball."""
        if self.size is not None:
            return math.prod(self.size)
        if self.diameter is None:
            return None
        return math.pi * self.diameter**2 * (self.diameter / 6 if self.length is None else self.length / 4)

    @property
    def footprint(self) -> float | None:
        """The area in m^2 that it takes, seen from above."""
        if self.size is not None:
            return self.size[0] * self.size[1]
        if self.diameter is None:
            return None
        return math.pi * self.diameter**2 / 4 if self.length is None else self.diameter * self.length


MOST_ROWS: Final = 500
TABLES: Final = {"materials": MaterialRow, "parts": PartRow, "contacts": ContactRow}


class RowsSpec(Section):
    """Rows that a file adds to the tables."""

    materials: dict[Label, MaterialRow] = Field({}, max_length=MOST_ROWS, description="materials, by name")
    parts: dict[Label, PartRow] = Field({}, max_length=MOST_ROWS, description="thermistors and RTDs, by name")
    contacts: dict[Label, ContactRow] = Field({}, max_length=MOST_ROWS, description="contacts, by name")

    @model_validator(mode="after")
    def _replaced_on_purpose(self, info: ValidationInfo) -> RowsSpec:
        before = known_to(info).before
        problems: list[Problem] = []
        for table in TABLES:
            names = before.get(table, frozenset())
            for name, row in getattr(self, table).items():
                if name in names and not row.overrides:
                    message = f"{shown(name)} is in the table already; choose another name, or write `overrides: true`"
                    problems.append(Problem(message, path=(table, name), at_key=True))
                if name not in names and row.overrides:
                    choices = tuple(sorted(names))
                    message = f"{shown(name)} overrides nothing: there is no such row"
                    problems.append(Problem(message, path=(table, name), at_key=True, near=(name, choices)))
        if problems:
            refuse(*problems)
        return self


class CatalogueFileSpec(RowsSpec):
    """A file of rows for the tables."""

    schema_: Literal["firmtouch.catalogue/1"] = Field(
        "firmtouch.catalogue/1", alias="schema", description="the file's format"
    )
    title: Text | None = None
