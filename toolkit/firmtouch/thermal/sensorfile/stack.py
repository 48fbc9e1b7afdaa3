"""`stack` and `backing`: what lies behind the touched face, from there inward."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Final

from pydantic import Field, StrictBool, ValidationInfo, model_validator

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import QUANTITY_SCHEMA, Checked, Label, read_all, refuse
from firmtouch.modelfile.sections.section import Section, ShortSection
from firmtouch.modelfile.words import did_you_mean, shown
from firmtouch.thermal.fields import Conductance, Length, amount, read_name, reader
from firmtouch.thermal.tables.catalogue import Catalogue
from firmtouch.thermal.tables.rows import MaterialName, known_to
from firmtouch.thermal.tables.values import REFERENCE, Part

Area = Annotated[float, amount("m^2", least=1e-12, most=1)]
ArealCapacity = Annotated[
    float, amount("J/m^2/K", least=1e-9, most=1e7, zero="a film without a capacity; mark a layer as `sensed` instead")
]
ELECTRICAL: Final = ("resistance", "B", "coefficient")
STEINHART_HART: Final = "three plain numbers a, b, c were expected, of 1/T = a + b ln R + c (ln R)^3 in K and ohm"


@dataclass(frozen=True, slots=True)
class SensingElement:
    """What is felt with: `resistance` in ohm at `at` in K, and either `B` in K or `coefficient` in 1/K.

    Or, instead of all these, the coefficients of Steinhart and Hart.
    """

    resistance: float = 0.0
    at: float = REFERENCE
    B: float | None = None
    coefficient: float | None = None
    steinhart_hart: tuple[float, float, float] | None = None


def _steinhart_hart(raw: object, info: ValidationInfo) -> tuple[float, float, float]:  # noqa: ARG001  # pydantic's
    """Read a, b and c, of a thermistor whose resistance falls over all of its range."""
    if not isinstance(raw, list) or len(raw) != 3:
        refuse(Problem(STEINHART_HART))
    a, b, c = read_all(enumerate(raw), lambda _, each: _PLAIN(each)).values()
    return a, b, c


_PLAIN: Final = reader("1", most=1.0, zero=None)
_THREE: Final[dict[str, Any]] = {"type": "array", "items": QUANTITY_SCHEMA, "minItems": 3, "maxItems": 3}


def read_part(raw: object, info: ValidationInfo) -> str:
    """Read the name of a part that has a capacity."""
    parts = known_to(info).parts
    name = read_name(raw, parts, "part")
    part = parts[name]
    if part is not None and part.capacity is None:
        message = (
            f"{shown(name)} is a part without a heat capacity: no published one, no mass or size, and no dissipation "
            "and time constant of one medium and mounting; add a row with one of these"
        )
        refuse(Problem(message))
    return name


PartName = Annotated[str, Checked(read_part, {"type": "string", "description": "a part of the tables"})]


class FilmSpec(Section):
    """A film so thin, or a part so small, that it has one temperature: an areal heat capacity C'' and no resistance.

    It is one of: a material and a thickness; a part, spread over its footprint; a capacity.
    """

    material: MaterialName | None = Field(None, description="of the film; C'' = rho c thickness")
    thickness: Length | None = None
    part: PartName | None = Field(None, description="C'' = C/area")
    area: Area | None = Field(None, description="over which the part spreads, by default its footprint")
    capacity: ArealCapacity | None = Field(None, description="C'' itself")
    resistance: Annotated[float, amount("ohm", least=1e-3, most=1e9)] | None = Field(
        None, description="at 25 degC, where the film feels; of a part, where its row has none or that of a family"
    )
    B: Annotated[float, amount("K", least=100, most=2e4)] | None = Field(None, description="of a film of an oxide")
    coefficient: Annotated[float, amount("1/K", least=1e-5, most=0.1)] | None = Field(
        None, description="(dR/dT)/R of a metal film"
    )
    steinhart_hart: Annotated[tuple[float, float, float], Checked(_steinhart_hart, _THREE)] | None = Field(
        None, description="[a, b, c] of a thermistor, instead of all these: 1/T = a + b ln R + c (ln R)^3"
    )

    @model_validator(mode="after")
    def _one_way(self, info: ValidationInfo) -> FilmSpec:
        ways = [name for name in ("material", "part", "capacity") if getattr(self, name) is not None]
        if len(ways) != 1:
            given = " and ".join(f"`{each}`" for each in ways) or "none of them"
            refuse(Problem(f"a film is given by `material` and `thickness`, `part`, or `capacity`; here is {given}"))
        pairs = (("thickness", "material"), ("area", "part"))
        for name, of in pairs:
            if getattr(self, name) is not None and ways != [of]:
                refuse(Problem(f"`{name}` goes with `{of}`", path=(name,), at_key=True))
        if ways == ["material"] and self.thickness is None:
            refuse(Problem("`thickness` is missing here", at_key=True))
        part = known_to(info).parts.get(self.part or "")
        self._check_electrical(part)
        self._check_area(part)
        return self

    def _check_electrical(self, part: Part | None) -> None:
        for name in ELECTRICAL:
            given, of_row = getattr(self, name), getattr(part, name, None)
            low, high = of_row if isinstance(of_row, tuple) else (of_row, of_row)
            if given is None or of_row is None:
                continue
            if low == high:
                message = f"a part brings its `{name}` from the table; add a row to the table for another"
                refuse(Problem(message, path=(name,), at_key=True))
            if not low <= given <= high:
                refuse(Problem(f"the parts of this family have {low:g} to {high:g}", path=(name,)))
        for name in ELECTRICAL if self.steinhart_hart is not None else ():
            if getattr(self, name) is not None:
                refuse(Problem(f"`steinhart_hart` is given; `{name}` says it again", path=(name,), at_key=True))
        if self.steinhart_hart is not None and part is not None and part.kind != "ntc":
            refuse(Problem("only an ntc has `steinhart_hart`", path=("steinhart_hart",), at_key=True))
        metal = self.coefficient is not None or (part is not None and part.kind != "ntc")
        if self.B is not None and metal:
            refuse(Problem("a metal has a `coefficient` and no `B`", path=("B",), at_key=True))
        if self.coefficient is not None and part is not None and part.kind == "ntc":
            refuse(Problem("an ntc has a `B` and no `coefficient`", path=("coefficient",), at_key=True))

    def _check_area(self, part: Part | None) -> None:
        if part is not None and part.footprint is None and self.area is None:
            message = f"{shown(part.name)} has no footprint in the tables; give the `area` over which it spreads"
            refuse(Problem(message, path=("part",)))

    def areal_capacity(self, catalogue: Catalogue) -> float:
        """Give C'' in J/(m^2 K): rho c thickness, C/area, or what is given."""
        if self.capacity is not None:
            return self.capacity
        if self.material is not None:
            assert self.thickness is not None
            return catalogue.materials[self.material].volumetric_capacity * self.thickness
        assert self.part is not None
        part = catalogue.parts[self.part]
        area = part.footprint if self.area is None else self.area
        assert part.capacity is not None
        assert area is not None
        return part.capacity.value / area

    def element(self, part: Part | None) -> SensingElement | None:
        """Give what is felt with: the row's of a part, and the film's own where that tells none; else None."""
        if self.steinhart_hart is not None:
            return SensingElement(steinhart_hart=self.steinhart_hart)
        resistance, at, B, coefficient = self.resistance, REFERENCE, self.B, self.coefficient
        if part is not None:
            if resistance is None:
                resistance, at = _only(part.resistance), part.resistance_at
            B = _only(part.B) if B is None else B
            coefficient = part.coefficient if coefficient is None else coefficient
        if resistance is None or (B is None and coefficient is None):
            return None
        return SensingElement(resistance, at, B, coefficient)


def _only(pair: tuple[float, float] | None) -> float | None:
    """Give the value of one part; a family has none."""
    return pair[0] if pair is not None and pair[0] == pair[1] else None


class StackEntry(Section):
    """One of: a layer (`material`, `thickness`), a `film`, or a `joint` between layers."""

    name: Label | None = Field(None, description="for `search`, and for reports")
    material: MaterialName | None = None
    thickness: Length | None = None
    film: FilmSpec | None = None
    joint: Conductance | None = Field(None, description="conductance of a glued or loose joint, in W/m^2/K")
    sensed: StrictBool = Field(
        False, description="true: its temperature is felt; of a layer, that of its inner face, by a film of no capacity"
    )
    heated: StrictBool = Field(
        False, description="true: the heater is in this film, or on this layer's inner face; by default where is felt"
    )

    @model_validator(mode="after")
    def _one_kind(self) -> StackEntry:
        kinds = [name for name in ("material", "film", "joint") if getattr(self, name) is not None]
        if len(kinds) != 1:
            given = " and ".join(f"`{each}`" for each in kinds) or "none of them"
            refuse(Problem(f"an entry is a layer (`material`, `thickness`), a `film` or a `joint`; here is {given}"))
        if self.thickness is not None and kinds != ["material"]:
            refuse(Problem(f"`thickness` does not go with `{kinds[0]}` here", path=("thickness",), at_key=True))
        if kinds == ["material"] and self.thickness is None:
            refuse(Problem("`thickness` is missing here", at_key=True))
        for mark in ("sensed", "heated"):
            if kinds == ["joint"] and getattr(self, mark):
                refuse(Problem("a joint has two temperatures; mark a film or a layer", path=(mark,), at_key=True))
        return self


ENDS: Final = ("base", "adiabatic")


def _end(raw: object, info: ValidationInfo) -> str:  # noqa: ARG001  # the signature is pydantic's
    if raw not in ENDS:
        missing = {
            "air": "give its conductance, `{air: 10 W/m^2/K}`",
            "half_space": "say of what, `{half_space: pdms}`",
        }
        word = raw if isinstance(raw, str) else ""
        hint = missing.get(word, "a backing is `base`, `adiabatic`, `{half_space: MATERIAL}` or `{air: CONDUCTANCE}`")
        near = "" if word in missing else did_you_mean(word, (*ENDS, *missing))
        refuse(Problem(f"{shown(str(raw))} is not possible here; {hint}{near}"))
    return str(raw)


_END: Final[dict[str, Any]] = {"enum": list(ENDS)}


class BackingSpec(ShortSection):
    """What is behind the stack, as seen by the quadrupoles: Z = 0, infinite, 1/(e sqrt(s)) or 1/h."""

    short_for = "end"
    end: Annotated[str, Checked(_end, _END)] | None = Field(
        None, description="`base`: held at its temperature; `adiabatic`: no heat passes"
    )
    half_space: MaterialName | None = Field(None, description="a material that goes on as far as heat does")
    air: Conductance | None = Field(None, description="conductance to still or moving air, in W/m^2/K")

    @model_validator(mode="after")
    def _one_kind(self) -> BackingSpec:
        kinds = [name for name in ("end", "half_space", "air") if getattr(self, name) is not None]
        if len(kinds) != 1:
            given = " and ".join(f"`{each}`" for each in kinds) or "none of them"
            refuse(Problem(f"a backing is one of `end`, `half_space` and `air`; here is {given}"))
        return self
