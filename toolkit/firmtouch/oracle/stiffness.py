"""How stiff a contact is in MuJoCo: its reference spring and its impedance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from firmtouch.oracle.library import NotExpressibleError

MOST_IMPEDANCE: Final = 0.9999
"""MuJoCo clips the impedance to this without a word."""


@dataclass(frozen=True, slots=True)
class ContactStiffness:
    """MuJoCo's `solref` and `solimp`: the gap's acceleration is a1 with a1 + d (b v + k r) = (1 - d) a0.

    a0 is the acceleration without contact; k = 1 / (dmax timeconst dampratio)^2 and b = 2 / (dmax timeconst) are a
    reference spring on the gap r (m, negative where it penetrates) and its rate v, timeconst in seconds. The impedance
    d grows from dmin to dmax over `width` metres of penetration, along a curve that `midpoint` and `power` shape. At
    rest the contact gives way by (1 - d) / (d^2 k) A times the force, A about the inverse mass that the contact feels:
    only d = 1 would be rigid, and MuJoCo takes 0.9999 at most. Without arguments it is MuJoCo's own default.
    """

    timeconst: float = 0.02
    dampratio: float = 1.0
    dmin: float = 0.9
    dmax: float = 0.95
    width: float = 0.001
    midpoint: float = 0.5
    power: float = 2.0

    @classmethod
    def very_stiff(cls, timeconst: float = 0.001) -> ContactStiffness:
        """Give the most impedance that MuJoCo takes, and a short time constant (seconds): at least two time steps."""
        return cls(timeconst=timeconst, dmin=MOST_IMPEDANCE, dmax=MOST_IMPEDANCE)

    def check(self, timestep: float) -> None:
        """Refuse what MuJoCo would silently change.

        Raises
        ------
        NotExpressibleError
            If the time constant is below two steps, or an impedance is out of range.
        """
        if not self.timeconst >= 2 * timestep:
            raise NotExpressibleError(
                f"the contact's time constant {self.timeconst:g} s is below two time steps of {timestep:g} s, and "
                "MuJoCo would silently take two steps instead; make the step smaller"
            )
        if not 0 < self.dmin <= self.dmax <= MOST_IMPEDANCE:
            raise NotExpressibleError(
                f"impedances must satisfy 0 < dmin <= dmax <= {MOST_IMPEDANCE}, not {self.dmin:g} and {self.dmax:g}"
            )


DEFAULT: Final = ContactStiffness()
VERY_STIFF: Final = ContactStiffness.very_stiff()
