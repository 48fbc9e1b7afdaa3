"""`requirements`: what the sensor shall do; what is not given is not asked."""

from __future__ import annotations

import math
from typing import Annotated, Any, Final, Literal

from pydantic import Field, ValidationInfo, model_validator

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import Checked, refuse
from firmtouch.modelfile.sections.section import Section, ShortSection
from firmtouch.thermal.fields import Duration, Length, Ratio, Temperature, amount, reader
from firmtouch.thermal.sensorfile.drive import Power
from firmtouch.thermal.tables.rows import known_to, read_material

WINDOW: Final = 0.5
"""Time after the touch, in s, in which the end value is looked for where the file does not say."""
METRICS: Final = ("10-90", "63 %", "d_prime")
EFFUSIVITY: Final = reader("1", least=1, most=1e6)
Excess = Annotated[float, amount("K", least=1e-6, most=300)]


class RiseTimeSpec(Section):
    """How fast the signal must be there: by a metric that is named, since the metrics differ by a factor of 5."""

    at_most: Duration
    metric: Literal["10-90", "63 %", "d_prime"] = Field(
        description="`10-90` or `63 %` of the extremum; `d_prime`: until all pairs of `discrimination` have d'"
    )
    signal: Literal["temperature", "power"] | None = Field(
        None, description="by default the drive's: the heater's power at constant temperature, otherwise temperature"
    )
    window: Duration = Field(
        WINDOW, description="the time after the touch in which the end value, its extremum, counts"
    )

    @model_validator(mode="after")
    def _inside(self) -> RiseTimeSpec:
        if self.at_most > self.window:
            message = f"{self.at_most:g} s is longer than the window of {self.window:g} s in which the end value counts"
            refuse(Problem(message, path=("at_most",)))
        return self


def _two(raw: object, info: ValidationInfo) -> tuple[str, str]:  # noqa: ARG001  # the signature is pydantic's
    if not isinstance(raw, list) or len(raw) != 2 or not all(isinstance(each, str) for each in raw):
        refuse(Problem("two objects were expected, as in `[copper, glass]`"))
    if raw[0] == raw[1]:
        refuse(Problem("an object cannot be told from itself"))
    return raw[0], raw[1]


_TWO: Final[dict[str, Any]] = {"type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2}


class DiscriminationSpec(Section):
    """Pairs of objects that must be told apart, with h of the contact not known but for its prior."""

    pairs: tuple[Annotated[tuple[str, str], Checked(_two, _TWO)], ...] = Field(min_length=1, max_length=200)
    d_prime: Annotated[float, amount("1", least=0.1, most=1e4)] = Field(
        5.0, description="least distance of the two signals, in standard deviations"
    )
    time: Duration = Field(description="after the touch, when they must be told apart")


class CrosstalkSpec(ShortSection):
    """What the next pad's heat does to the object's face under a pad, of what the pad's own does."""

    short_for = "at_most"
    at_most: Ratio
    time: Duration | None = Field(None, description="after the touch; by default the rise time that is asked")


class PowerSpec(Section):
    """Largest heater power."""

    pad: Power | None = Field(None, description="of one pad, also while it is touched")
    array: Power | None = Field(None, description="of all pads, all touched")

    @model_validator(mode="after")
    def _some(self) -> PowerSpec:
        if self.pad is None and self.array is None:
            refuse(Problem("at least one of `pad` and `array` is needed"))
        return self


def _effusivity(raw: object, info: ValidationInfo) -> float:
    if isinstance(raw, str) and raw[:1].isalpha():
        material = known_to(info).materials[read_material(raw, info)]
        return 1.0 if material is None else material.effusivity  # what is wrong with its row is told there
    return EFFUSIVITY(raw)


_EFFUSIVITY: Final[dict[str, Any]] = {
    "anyOf": [{"type": "number"}, {"type": "string"}],
    "description": "a material, or its effusivity e in W s^(1/2)/(m^2 K)",
}
Effusivity = Annotated[float, Checked(_effusivity, _EFFUSIVITY)]


class RangeSpec(Section):
    """Objects over this range of effusivity must be graded: sd(ln e) at most `sd`."""

    least: Effusivity
    most: Effusivity
    sd: Annotated[float, amount("1", least=1e-4, most=10)] = Field(
        0.2, description="largest standard deviation of ln e"
    )
    time: Duration = Field(description="after the touch, when this must be so")

    @model_validator(mode="after")
    def _some(self) -> RangeSpec:
        if self.least >= self.most:
            refuse(Problem("the range is empty: `least` must be less than `most`", path=("least",)))
        return self


class RequirementsSpec(Section):
    """What the sensor shall do."""

    rise_time: RiseTimeSpec | None = None
    discrimination: DiscriminationSpec | None = None
    range: RangeSpec | None = None
    crosstalk: CrosstalkSpec | None = None
    surface_temperature: Temperature | None = Field(None, description="highest of the touched face")
    power: PowerSpec | None = None
    self_heating: Excess | None = Field(None, description="largest rise of the sensed film by its own current")
    feedback: Ratio | None = Field(None, description="largest P |alpha_R|/delta of the sensed film; at 1 it runs away")
    loop_margin: Ratio | None = Field(
        None, description="least distance of the loop's L from -1, at most 1; 0.5 is a usual one"
    )
    recovery: Duration | None = Field(None, description="longest time until it can feel again after release")
    pitch: Length | None = Field(None, description="largest distance of neighbours")
    thickness: Length | None = Field(None, description="largest of the whole stack")

    @property
    def quickest(self) -> float:
        """The rise time that is asked, in s; infinite where none is."""
        return math.inf if self.rise_time is None else self.rise_time.at_most

    @property
    def asked(self) -> tuple[str, ...]:
        """The names of what is asked."""
        return tuple(name for name in type(self).model_fields if getattr(self, name) is not None)
