"""`force_path`: what lies between the contact force and the force feedback, and the margins asked of that loop."""

from __future__ import annotations

from typing import Annotated, Final

from pydantic import Field, ValidationInfo, model_validator

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import (
    QUANTITY_SCHEMA,
    Checked,
    expect_dimension,
    frequency_between,
    quantity_in,
    read_quantity,
    refuse,
)
from firmtouch.modelfile.sections.amounts import CONTACT_STIFFNESSES
from firmtouch.modelfile.sections.section import Section
from firmtouch.modelfile.units import Dimension

SLOWEST, FASTEST = 0.1, 1e7
"""Bandwidths of force sensors, in rad/s."""
SHORTEST, LONGEST = 1e-7, 1.0
"""Delays and sample times, in s."""
MOST_STEPS: Final = 100
"""A longer delay, in samples, is hardly one of a force loop; each sample is a state for each constraint."""
WHOLE: Final = 1e-9
"""How far, relatively, a delay may be from a whole number of samples: the rounding of two decimal numbers."""


def _modulus(raw: object, info: ValidationInfo) -> float:  # noqa: ARG001  # the signature is pydantic's
    quantity = read_quantity(raw, example="0.5")
    value = expect_dimension(quantity, Dimension())
    if not 0 < value < 1:
        message = f"a modulus margin of {value:g}; it must lie between 0 and 1, both excluded: without feedback it is 1"
        refuse(Problem(message))
    return value


class ForceMargins(Section):
    """Least margins of every loop 1 + g L(s) = 0 of the force feedback; what is not given is not asked."""

    gain: Annotated[float, quantity_in("1", least=1, most=1e6)] | None = Field(
        None, description="least gain margin: the factor by which a gain may still grow"
    )
    delay: Annotated[float, quantity_in("s", least=SHORTEST, most=LONGEST)] | None = Field(
        None, description="least delay margin: the further delay that the loop must bear"
    )
    modulus: Annotated[float, Checked(_modulus, QUANTITY_SCHEMA)] | None = Field(
        None, description="least modulus margin: the distance of the Nyquist curve from -1"
    )

    @model_validator(mode="after")
    def _some_margin(self) -> ForceMargins:
        if self.gain is None and self.delay is None and self.modulus is None:
            refuse(Problem("at least one of `gain`, `delay` and `modulus` is needed"))
        return self


USUAL_MARGINS: Final = ForceMargins.model_construct(gain=2.0, delay=None, modulus=0.5)
"""What is asked where G_f is to be chosen and the file asks for no margins; not validated, which would load pint."""


class ForcePathSpec(Section):
    """The force sensor and the way of its signal, L(s) of [T8]."""

    bandwidth: Annotated[float, frequency_between(SLOWEST, FASTEST)] | None = Field(
        None, description="of the sensor, a low-pass of first order (-3 dB): `80 Hz` (cycles), or in rad/s"
    )
    delay: Annotated[float, quantity_in("s", least=SHORTEST, most=LONGEST)] | None = Field(
        None, description="pure delay; with `sample` a whole multiple of it, beside the one sample that is always there"
    )
    sample: Annotated[float, quantity_in("s", least=SHORTEST, most=LONGEST)] | None = Field(
        None, description="the controller's sample time, its output held; without it, the controller is continuous"
    )
    margins: ForceMargins | None = Field(None, description="least margins of the force loop")
    contact_stiffness: Annotated[dict[str, float], CONTACT_STIFFNESSES.each()] | None = Field(
        None, description="stiffness of the real contact: one quantity, or one for each constraint"
    )

    @model_validator(mode="after")
    def _some_path(self) -> ForcePathSpec:
        if self.bandwidth is None and self.delay is None and self.sample is None:
            refuse(Problem("at least one of `bandwidth`, `delay` and `sample` is needed"))
        if self.delay is not None and self.sample is not None:
            steps = self.delay / self.sample
            if abs(steps - round(steps)) > WHOLE * steps or round(steps) == 0:
                message = f"{steps:.6g} samples; with `sample`, the delay must be a whole number of them"
                refuse(Problem(message, path=("delay",)))
            if steps > MOST_STEPS:
                refuse(Problem(f"{steps:.6g} samples; at most {MOST_STEPS} are read", path=("delay",)))
        return self

    @property
    def bounded(self) -> bool:
        """Tell whether some G_f is too large: with a low-pass alone, none is [T8]."""
        return self.delay is not None or self.sample is not None
