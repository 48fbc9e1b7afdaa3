"""What a fingertip feels when it touches: closing a contact is a step, exactly.

At t = 0 an object at T_o meets a face at T_s, both in steady state. By the compensation theorem all deviations that
follow are those of the post-contact network with a step dV = T_o - T_s at the contact and every other source zero; what
went on inside of the finger before does not matter. It needs a linear network. A constant heater power adds nothing, so
open loop is that too. What the face gave to the air, and gives no more under the object, is a second step, of flux
(`Touch.air`); without it the error is h_air (1/h + Z_o), next to nothing on metals and some 10 % on a foam in a second.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from firmtouch.thermal.arrays import Array, ThermalValueError, Transfer, require_positive, require_times
from firmtouch.thermal.inversion import step
from firmtouch.thermal.quadrupole import contact_transfer, heater_transfer
from firmtouch.thermal.stack import Air, Front, Stack, Touch


@dataclass(frozen=True, slots=True)
class ContactEvent:
    """A stack that meets an object with T_o - T_s = `difference` (K) between the two faces."""

    stack: Stack
    touch: Touch
    difference: float

    def temperature(self, t: ArrayLike, *, plane: int | None = None) -> Array:
        """Give the deviation (K) at a plane, the sensed one unless told; constant heater power or none."""
        return self.difference * step(lambda s: contact_transfer(self.stack, self.touch, s, plane=plane).sensed, t)

    def object_face(self, t: ArrayLike) -> Array:
        """Give the deviation (K) of the object's face."""
        return self.difference * step(lambda s: contact_transfer(self.stack, self.touch, s).object_face, t)

    def flux(self, t: ArrayLike) -> Array:
        """Give q'' (W/m2) into the fingertip."""
        return self.difference * step(lambda s: contact_transfer(self.stack, self.touch, s).flux, t)


@dataclass(frozen=True, slots=True)
class Pulse:
    """A heater's power P'' (W/m2) in a plane, from t = 0 for a duration (s; `inf` is a step)."""

    power: float
    heater: int
    duration: float = np.inf

    def __post_init__(self) -> None:
        if not self.duration > 0:
            raise ThermalValueError("pulse duration", self.duration, "positive (`inf` is a step)")


def pulse_response(stack: Stack, front: Front | Sequence[Front], pulse: Pulse, t: ArrayLike) -> Array:
    """Give the sensed plane's deviation (K) for a pulse; between half-spaces 2 q sqrt(t/pi) / (e_s + e_o) (3.3).

    It feels e_o without a temperature difference. With one, the contact's response adds.
    """
    return pulse.power * while_on(lambda s: heater_transfer(stack, front, s, heater=pulse.heater), pulse, t)


def while_on(transfer: Transfer, pulse: Pulse, t: ArrayLike) -> Array:
    """Give the response to a source of one that is on as long as a pulse: its step, less that step later."""
    times = require_times(t)
    found = step(transfer, times)
    after = times > pulse.duration
    if after.any():
        found[..., after] -= step(transfer, times[after] - pulse.duration)
    return found


def hold_power(stack: Stack, air: Air, *, heater: int, rise: float) -> float:
    """Give P'' (W/m2) that holds the sensed plane `rise` (K) above air and base, untouched: G'' times the rise.

    Raises
    ------
    ThermalValueError
        If the rise is not positive.
    """
    require_positive(rise=rise)
    with np.errstate(invalid="ignore"):
        per_power = float(heater_transfer(stack, air, 0.0, heater=heater).real)
    return rise / per_power


class TwoTemperatures(NamedTuple):
    """What two equal sensors of different temperatures feel on one object: deviations (K) and their difference."""

    first: Array
    second: Array
    difference: Array


def two_temperatures(
    stack: Stack, touch: Touch, t: ArrayLike, *, faces: tuple[float, float], object_temperature: float
) -> TwoTemperatures:
    """Give both responses; their difference is (T_2 - T_1) times the unit response, whatever the object's temperature.

    One sensor cannot tell a cold insulator from a less cold conductor, two can.

    Raises
    ------
    ThermalValueError
        If both faces have the same temperature.
    """
    if faces[0] == faces[1]:
        raise ThermalValueError("second face temperature", faces[1], "other than the first")
    unit = ContactEvent(stack, touch, 1.0).temperature(t)
    first, second = ((object_temperature - face) * unit for face in faces)
    return TwoTemperatures(first, second, first - second)


def object_temperature(faces: tuple[float, float], deviations: tuple[ArrayLike, ArrayLike]) -> Array:
    """Give T_o from two sensors' deviations at the same time: theta_1/theta_2 = (T_o - T_1)/(T_o - T_2)."""
    first, second = (np.asarray(each, dtype=np.float64) for each in deviations)
    return np.asarray((faces[1] * first - faces[0] * second) / (first - second))
