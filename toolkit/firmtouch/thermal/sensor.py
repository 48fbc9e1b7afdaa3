"""A sensor as a value: its stack, how it is driven, how large and how warm it is, and what it may touch."""

from __future__ import annotations

import math
from dataclasses import dataclass

from firmtouch.thermal.arrays import ThermalValueError, require_positive
from firmtouch.thermal.contact_event import Pulse
from firmtouch.thermal.loop import Loop
from firmtouch.thermal.readout import Readout
from firmtouch.thermal.stack import Air, Stack, Touch

STILL_AIR = Air(10.0)
"""What the touched face gives to the air while it touches nothing [M]: 5 to 10 W/m2K, radiation included."""


@dataclass(frozen=True, slots=True)
class HeldPower:
    """A constant heater power (W/m2); the sensed temperature is the signal (K).

    Where no power is stated, it is what keeps the touched face at its temperature.
    """

    power: float | None = None

    mode = "constant_power"
    unit = "K"


@dataclass(frozen=True, slots=True)
class HeldTemperature:
    """A loop holds the sensed temperature; its heater's power (W/m2) is the signal, or that temperature (K)."""

    loop: Loop
    reads_power: bool = True

    mode = "constant_temperature"

    @property
    def unit(self) -> str:
        """Give the signal's unit."""
        return "W/m^2" if self.reads_power else "K"


@dataclass(frozen=True, slots=True)
class Pulsed:
    """A pulse of heater power that begins with the touch; the sensed temperature is the signal (K)."""

    pulse: Pulse

    mode = "pulse"
    unit = "K"


@dataclass(frozen=True, slots=True)
class TwoFaces:
    """Two pads of different temperatures, the other's being `second` (K); the difference of both is the signal (K)."""

    second: float

    mode = "two_temperature"
    unit = "K"


Drive = HeldPower | HeldTemperature | Pulsed | TwoFaces


@dataclass(frozen=True, slots=True)
class Temperatures:
    """Just before the touch (K): of the object, the touched face, the backing's end, and the air."""

    object: float
    face: float
    base: float
    ambient: float

    @property
    def difference(self) -> float:
        """Give T_o - T_s, the step at the contact."""
        return self.object - self.face


def air_before(at: Temperatures, *, second: bool = False, front: Air = STILL_AIR) -> float:
    """Give `Touch.air` (W/m2K): h_air (T_s - T_a)/(T_s - T_o), and h_air of the difference of two faces.

    Where face and object have one temperature there is no such number, and the air is left out.
    """
    if second:
        return front.conductance
    return front.conductance * (at.face - at.ambient) / -at.difference if at.difference else 0.0


@dataclass(frozen=True, slots=True)
class Pad:
    """A touch element, a disc of a radius (m); `pitch` (m) is the distance of neighbours, `inf` for a single one."""

    radius: float
    pitch: float = math.inf
    rows: int = 1
    columns: int = 1

    def __post_init__(self) -> None:
        require_positive(radius=self.radius)
        if self.pitch < 2 * self.radius:
            raise ThermalValueError("pitch", self.pitch, f"at least the pads' diameter, {2 * self.radius:g}")

    @property
    def area(self) -> float:
        """Give pi a^2 (m2)."""
        return math.pi * self.radius**2

    @property
    def count(self) -> int:
        """Give the number of pads."""
        return self.rows * self.columns


@dataclass(frozen=True, slots=True)
class Unknown:
    """What is not known of a touch: standard deviations of ln h, and of the object's temperature (K)."""

    ln_h: float = 0.0
    temperature: float = 0.0


@dataclass(frozen=True, slots=True)
class Scenario:
    """One touch that a sensor must cope with: an object, and the contact as it may be (`low`, `nominal`, `high`)."""

    object: str
    level: str
    touch: Touch

    @property
    def words(self) -> str:
        """Name it for readers."""
        return f"{self.object}, h = {self.touch.conductance:.3g} W/m²K"


@dataclass(frozen=True, slots=True)
class Sensor:
    """All that its responses need: values in SI units; `heater` is the plane that is heated.

    `front` is what it has before it while it touches nothing.
    """

    stack: Stack
    heater: int
    drive: Drive
    temperatures: Temperatures
    scenarios: tuple[Scenario, ...]
    unknown: Unknown = Unknown()
    pad: Pad | None = None
    readout: Readout | None = None
    front: Air = STILL_AIR

    @property
    def touches(self) -> tuple[Touch, ...]:
        """Give the touches of its scenarios."""
        return tuple(each.touch for each in self.scenarios)
