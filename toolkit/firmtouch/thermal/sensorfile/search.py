"""`search`: what a design may choose, and what is best."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Final, Literal

from pydantic import Field, ValidationInfo, model_validator

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import Checked, Label, refuse
from firmtouch.modelfile.sections.section import Section
from firmtouch.modelfile.words import listed, shown
from firmtouch.thermal.fields import CONDUCTANCE, LENGTH, choices_of, interval, read_temperature, read_whole, whole
from firmtouch.thermal.sensorfile.drive import FLUX, LOOP_GAIN, MODES, POWER, SAMPLING, VOLTAGE
from firmtouch.thermal.sensorfile.stack import read_part
from firmtouch.thermal.sensorfile.touch import PRESSURE
from firmtouch.thermal.tables.rows import read_material

OBJECTIVES: Final = ("rise_time", "power", "thickness", "discrimination")
Objective = Literal["rise_time", "power", "thickness", "discrimination"]
_NAMES: Final[dict[str, Any]] = {"type": "string"}


def _mode(raw: object, info: ValidationInfo) -> str:  # noqa: ARG001  # the signature is pydantic's
    if not isinstance(raw, str) or raw not in MODES:
        message = f"{shown(str(raw))} is no mode of the drive; there are: {listed(MODES)}"
        refuse(Problem(message, near=(str(raw), MODES)))
    return raw


class Choice(Section):
    """A group of variables; what is not named keeps the value that the file gives it."""

    @model_validator(mode="after")
    def _some(self) -> Choice:
        if not any(True for _ in self.variables()):
            refuse(Problem(f"nothing to search here; there are: {listed(type(self).model_fields)}"))
        return self

    def variables(self) -> Iterator[str]:
        """Give the names of the variables that are searched."""
        for name in type(self).model_fields:
            if getattr(self, name) is not None:
                yield name


def _range(read: Any, of: str) -> Checked:  # noqa: ANN401  # any reading function of one quantity
    return interval(read, f"`[least, most]` {of}")


Names = tuple[str, ...]
Pair = tuple[float, float]


class EntryChoice(Choice):
    """Of an entry of the stack, by its name."""

    thickness: Annotated[Pair, _range(LENGTH, "in m")] | None = None
    material: Annotated[Names, choices_of(read_material, _NAMES, "materials")] | None = None
    part: Annotated[Names, choices_of(read_part, _NAMES, "parts")] | None = None


class ContactChoice(Choice):
    """Of the contact: how firmly it is touched, or what the touched face is made to conduct."""

    nominal: Annotated[Pair, _range(CONDUCTANCE, "in W/m^2/K")] | None = None
    pressure: Annotated[Pair, _range(PRESSURE, "in Pa")] | None = None


class DriveChoice(Choice):
    """Of the drive."""

    mode: Annotated[Names, choices_of(_mode, {"enum": list(MODES)}, "modes")] | None = None
    loop_gain: Annotated[Pair, _range(LOOP_GAIN, "in W/m^2/K")] | None = None
    power: Annotated[Pair, _range(POWER, "in W")] | None = None
    flux: Annotated[Pair, _range(FLUX, "in W/m^2")] | None = None


class PadChoice(Choice):
    """Of the pad."""

    radius: Annotated[Pair, _range(LENGTH, "in m")] | None = None
    pitch: Annotated[Pair, _range(LENGTH, "in m")] | None = None


class TemperaturesChoice(Choice):
    """Of the temperatures."""

    sensor: Annotated[Pair, _range(read_temperature, "such as `[35 degC, 45 degC]`")] | None = None


class ElectronicsChoice(Choice):
    """Of the electronics."""

    sampling: Annotated[Pair, _range(SAMPLING, "in Hz")] | None = None
    bridge_voltage: Annotated[Pair, _range(VOLTAGE, "in V")] | None = None
    adc_bits: (
        Annotated[
            tuple[int, ...], choices_of(lambda raw, _: read_whole(raw, 4, 32), {"type": "integer"}, "numbers of bits")
        ]
        | None
    ) = None


GROUPS: Final = ("contact", "drive", "pad", "temperatures", "electronics")


class SearchSpec(Section):
    """A design's variables with their ranges, and what is best among designs that meet the requirements."""

    stack: dict[Label, EntryChoice] = Field({}, description="entries of the stack, by their names")
    contact: ContactChoice | None = None
    drive: DriveChoice | None = None
    pad: PadChoice | None = None
    temperatures: TemperaturesChoice | None = None
    electronics: ElectronicsChoice | None = None
    objective: Objective = Field(description="what is made best: discrimination is largest, all others are least")
    front: tuple[Objective, ...] = Field((), max_length=3, description="two or three that a Pareto front weighs")
    evaluations: Annotated[int, whole(10, 1_000_000)] | None = Field(
        None, description="about how many designs are tried"
    )
    seed: Annotated[int, whole(0, 2**32 - 1)] = Field(0, description="of what the search draws")

    @model_validator(mode="after")
    def _something(self) -> SearchSpec:
        if not self.stack and all(getattr(self, each) is None for each in GROUPS):
            refuse(Problem(f"nothing to search; there are: {listed(('stack', *GROUPS))}", at_key=True))
        if len(self.front) == 1 or len(set(self.front)) < len(self.front):
            refuse(Problem("a front weighs two or three different objectives", path=("front",)))
        return self

    def variables(self) -> tuple[tuple[str, ...], ...]:
        """Give the path of each variable: `("stack", "cover", "thickness")`, `("drive", "loop_gain")`."""
        of_stack = [("stack", name, each) for name, entry in self.stack.items() for each in entry.variables()]
        groups = [(name, getattr(self, name)) for name in GROUPS]
        return (*of_stack, *((name, each) for name, group in groups if group is not None for each in group.variables()))
