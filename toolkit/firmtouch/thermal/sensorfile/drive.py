"""`drive`, `pad`, `electronics`: how the film is heated, how large it is, and how it is read."""

from __future__ import annotations

from typing import Annotated, Final, Literal

from pydantic import Field, model_validator

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import refuse
from firmtouch.modelfile.sections.section import Section, ShortSection
from firmtouch.thermal.fields import Duration, NoiseDensity, Temperature, amount, described, reader, whole

Mode = Literal["constant_power", "constant_temperature", "pulse", "two_temperature"]
MODES: Final = ("constant_power", "constant_temperature", "pulse", "two_temperature")
USES: Final[dict[str, tuple[tuple[str, ...], tuple[str, ...]]]] = {
    "constant_power": ((), ("power", "flux")),
    "constant_temperature": (("loop_gain",), ("integral_gain", "sensor_lag", "delay")),
    "pulse": ((), ("power", "flux", "duration")),
    "two_temperature": (("second",), ()),
}
"""What each mode needs, and what else it can use."""
LOOP_GAIN: Final = reader("W/m^2/K", least=1, most=1e9)
POWER: Final = reader("W", least=1e-9, most=1e4)
FLUX: Final = reader("W/m^2", least=1e-3, most=1e9)
SAMPLING: Final = reader("Hz", least=1e-2, most=1e9)
VOLTAGE: Final = reader("V", least=1e-6, most=1e3)
Power = Annotated[float, described(POWER, "in W")]
Lag = Annotated[float, amount("s", most=100, zero=None)]


class DriveSpec(ShortSection):
    """How the heater is driven, and so what the signal is.

    `constant_power`: T of the sensed film, which the touch cools. `constant_temperature`: the power that a loop needs
    to hold it. `pulse`: T after a step of power at the touch. `two_temperature`: T of two pads at different ones.
    """

    short_for = "mode"
    mode: Mode
    power: Power | None = Field(None, description="of one pad's heater")
    flux: Annotated[float, described(FLUX, "in W/m^2")] | None = Field(None, description="power by area of the heater")
    loop_gain: Annotated[float, described(LOOP_GAIN, "in W/m^2/K")] | None = Field(
        None, description="heater flux by deviation of the sensed temperature"
    )
    integral_gain: Annotated[float, amount("W/m^2/K/s", most=1e12, zero=None)] = Field(
        0.0, description="heater flux by deviation and time; without it, the loop is proportional"
    )
    sensor_lag: Lag = Field(0.0, description="time constant of the temperature's reading")
    delay: Lag = Field(0.0, description="pure delay of the loop")
    duration: Duration | None = Field(None, description="of the pulse; without it, as long as the window")
    second: Temperature | None = Field(None, description="temperature of the second pad's face")

    @model_validator(mode="after")
    def _belongs_to_mode(self) -> DriveSpec:
        needed, usable = USES[self.mode]
        for name in self.model_fields_set - {"mode", *needed, *usable}:
            if name in type(self).model_fields:
                refuse(Problem(f"`{name}` does not go with the mode `{self.mode}`", path=(name,), at_key=True))
        for name in needed:
            if getattr(self, name) is None:
                refuse(Problem(f"the mode `{self.mode}` needs a `{name}`", at_key=True))
        if self.power is not None and self.flux is not None:
            refuse(Problem("give either `power` or `flux`", path=("flux",), at_key=True))
        if self.mode == "pulse" and self.power is None and self.flux is None:
            refuse(Problem("the mode `pulse` needs a `power` or a `flux`", at_key=True))
        return self


class PadSpec(Section):
    """One touch element, a disc, and how many there are."""

    radius: Annotated[float, amount("m", least=1e-6, most=0.1)]
    pitch: Annotated[float, amount("m", least=1e-6, most=1)] | None = Field(
        None, description="distance of neighbours, centre to centre"
    )
    rows: Annotated[int, whole(1, 1000)] = 1
    columns: Annotated[int, whole(1, 1000)] = 1

    @model_validator(mode="after")
    def _apart(self) -> PadSpec:
        if self.pitch is None and self.rows * self.columns > 1:
            refuse(Problem(f"{self.rows} x {self.columns} pads need a `pitch`", at_key=True))
        if self.pitch is not None and self.pitch < 2 * self.radius:
            message = f"pads of {2 * self.radius:g} m across overlap at a pitch of {self.pitch:g} m"
            refuse(Problem(message, path=("pitch",)))
        return self


class ElectronicsSpec(Section):
    """The reading of the sensed film: its bridge, amplifier and converter, or its noise as measured."""

    sampling: Annotated[float, described(SAMPLING, "in Hz")] = Field(description="samples in a second")
    temperature_noise: Annotated[float, amount("K", least=1e-9, most=10)] | None = Field(
        None, description="standard deviation of one sample as measured, instead of all below"
    )
    bridge_voltage: Annotated[float, described(VOLTAGE, "in V")] | None = Field(
        None, description="across the half-bridge of equal arms"
    )
    noise_density: NoiseDensity | None = Field(None, description="of the amplifier's input, such as `10 nV/sqrt(Hz)`")
    gain: Annotated[float, amount("1", least=1e-3, most=1e6)] = Field(1.0, description="between bridge and converter")
    adc_bits: Annotated[int, whole(4, 32)] | None = None
    adc_range: Annotated[float, described(VOLTAGE, "in V")] | None = Field(None, description="of the converter's input")
    bandwidth: Annotated[float, described(SAMPLING, "in Hz")] | None = Field(
        None, description="of the noise, by default half the sampling"
    )

    @model_validator(mode="after")
    def _one_way(self) -> ElectronicsSpec:
        bridge = {"bridge_voltage", "noise_density", "gain", "adc_bits", "adc_range", "bandwidth"}
        if self.temperature_noise is not None:
            for name in sorted(self.model_fields_set & bridge):
                message = f"`temperature_noise` is given; `{name}` would count noise a second time"
                refuse(Problem(message, path=(name,), at_key=True))
        elif self.bridge_voltage is None:
            refuse(Problem("give a `bridge_voltage`, or the `temperature_noise` as measured", at_key=True))
        if (self.adc_bits is None) != (self.adc_range is None):
            have, lack = ("adc_range", "adc_bits") if self.adc_bits is None else ("adc_bits", "adc_range")
            refuse(Problem(f"`{have}` needs `{lack}` beside it", path=(have,), at_key=True))
        return self
