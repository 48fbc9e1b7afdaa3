"""What is touched and how: `contact`, `objects`, `temperatures`."""

from __future__ import annotations

from typing import Annotated, Any, Final

from pydantic import Field, ValidationInfo, model_validator

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import QUANTITY_SCHEMA, Checked, Label, read_all, refuse
from firmtouch.modelfile.sections.section import Section, ShortSection
from firmtouch.thermal.fields import CONDUCTANCE, Length, Ratio, Temperature, amount, described, read_name, reader
from firmtouch.thermal.tables.rows import MaterialName, known_to

PRESSURE: Final = reader("Pa", least=1, most=1e9, zero="a pressure of zero is no contact")
ROUGHNESS: Final = reader("m", least=1e-9, most=1e-3)
LIGHT: Final = 0.1
"""Largest pressure of a contact, by the hardness, for which its spots deform as the formula says."""
LEVELS: Final = ("low", "nominal", "high")


def read_conductance(raw: object, info: ValidationInfo) -> float:
    """Read h, or the name of a contact of the tables, whose usual value it becomes."""
    contacts = known_to(info).contacts
    if isinstance(raw, str) and raw[:1].isalpha():
        preset = contacts[read_name(raw, contacts, "contact")]
        return 1.0 if preset is None else preset.conductance  # what is wrong with its row is told there
    return CONDUCTANCE(raw)


def _pressures(raw: object, info: ValidationInfo) -> tuple[float, ...]:  # noqa: ARG001  # the signature is pydantic's
    if not isinstance(raw, list):
        return (PRESSURE(raw),)
    if len(raw) != len(LEVELS):
        refuse(Problem("three pressures were expected, low, nominal and high, as in `[20 kPa, 50 kPa, 100 kPa]`"))
    found = tuple(read_all(enumerate(raw), lambda _, each: PRESSURE(each)).values())
    if list(found) != sorted(found):
        refuse(Problem("low, nominal and high must not decrease"))
    return found


_CONDUCTANCE: Final[dict[str, Any]] = {
    "anyOf": [{"type": "number"}, {"type": "string"}],
    "description": "in W/m^2/K, or a contact of the tables",
}
_PRESSURES: Final[dict[str, Any]] = {
    "anyOf": [*QUANTITY_SCHEMA["anyOf"], {"type": "array", "items": QUANTITY_SCHEMA, "minItems": 3, "maxItems": 3}]
}
ContactConductance = Annotated[float, Checked(read_conductance, _CONDUCTANCE)]


class ContactSpec(ShortSection):
    """The contact between the touched face and an object: its conductance h, or what h comes from.

    `contact: smooth` is the table's low, usual and high value; `contact: 1e4 W/m^2/K` is one value alone.
    """

    short_for = "nominal"
    low: ContactConductance | None = Field(None, description="h of a bad touch")
    nominal: ContactConductance | None = Field(None, description="h of the usual touch")
    high: ContactConductance | None = Field(None, description="h of a good touch")
    pressure: Annotated[tuple[float, ...], Checked(_pressures, _PRESSURES)] | None = Field(
        None, description="instead of h: the pressure of the touch, or `[low, nominal, high]`"
    )
    roughness: Annotated[float, described(ROUGHNESS, "in m")] | None = Field(
        None, description="with `pressure`: sigma, of both faces together"
    )
    slope: Annotated[float, amount("1", least=1e-4, most=1)] = Field(
        0.15, description="mean slope m of the asperities [M]"
    )
    hardness: Annotated[float, amount("Pa", least=1e3, most=1e12)] = Field(
        0.25e9, description="H of the softer face; the default is that of Kapton [M]"
    )
    prior: Ratio = Field(0.3, description="relative standard deviation of h, where it is not known in use")

    @model_validator(mode="before")
    @classmethod
    def _preset_whole(cls, raw: Any, info: ValidationInfo) -> Any:  # noqa: ANN401  # whatever the file holds
        """Let the name of a preset stand for its three values."""
        preset = known_to(info).contacts.get(raw) if isinstance(raw, str) else None
        if preset is None:
            return raw
        return {"low": preset.low, "nominal": preset.conductance, "high": preset.high}

    @model_validator(mode="after")
    def _one_way(self) -> ContactSpec:
        by_pressure = self.pressure is not None
        if self.pressure is not None and self.pressure[-1] >= LIGHT * self.hardness:
            message = f"contacts are computed for pressures below a tenth of the hardness, {LIGHT * self.hardness:g} Pa"
            refuse(Problem(message, path=("pressure",)))
        for name in LEVELS:
            if by_pressure and getattr(self, name) is not None:
                refuse(Problem("give either conductances or a `pressure`", path=(name,), at_key=True))
        if by_pressure and self.roughness is None:
            refuse(Problem("`pressure` needs the `roughness` beside it", path=("pressure",), at_key=True))
        if not by_pressure and self.nominal is None:
            refuse(Problem("`nominal` is missing here, or `pressure` and `roughness`", at_key=True))
        for name in ("roughness", "slope", "hardness"):
            if not by_pressure and name in self.model_fields_set:
                refuse(Problem(f"`{name}` needs a `pressure` beside it", path=(name,), at_key=True))
        if list(self.conductances) != sorted(self.conductances):
            refuse(Problem("`low`, `nominal` and `high` must not decrease", path=("nominal",)))
        return self

    @property
    def conductances(self) -> tuple[float, ...]:
        """What of low, nominal and high is given, in W/(m^2 K); empty where a pressure is."""
        return tuple(each for each in (self.low, self.nominal, self.high) if each is not None)


class ObjectSpec(ShortSection):
    """Something that is touched: a material as deep as heat gets, or a plate of it with a free back face."""

    short_for = "material"
    material: MaterialName
    thickness: Length | None = Field(None, description="without it, a half-space")
    name: Label | None = Field(None, description="by default the material's")

    @property
    def called(self) -> str:
        """Its name."""
        return self.name or self.material


class TemperaturesSpec(Section):
    """Temperatures just before the touch, in K after reading."""

    object: Temperature = Field(description="of what is touched")
    sensor: Temperature = Field(description="of the touched face: what the heater holds it at")
    base: Temperature | None = Field(None, description="of the backing, by default the sensor's")
    ambient: Temperature | None = Field(None, description="of the air around, by default the object's")
    prior: Annotated[float, amount("K", most=100, zero=None)] = Field(
        0.0, description="standard deviation of the object's temperature, where it is not known in use"
    )
