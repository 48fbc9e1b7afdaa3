"""The conductance of a contact from pressure and roughness: spots that touch, and the gas between (Yovanovich)."""

from __future__ import annotations

from dataclasses import dataclass

from firmtouch.thermal.arrays import ThermalValueError, require_positive

AIR_CONDUCTIVITY = 0.026
"""W/mK, at 25 degrees."""
AIR_JUMP = 0.37e-6
"""M (m): the gas's temperature jump at both faces, air at one bar."""


@dataclass(frozen=True, slots=True)
class Roughness:
    """Two faces as one: rms height sigma (m), mean slope m, microhardness H (Pa) of the softer.

    `gas_conductivity` (W/mK) and `gas_jump` M (m) are air's.
    """

    sigma: float
    slope: float
    hardness: float
    gas_conductivity: float = AIR_CONDUCTIVITY
    gas_jump: float = AIR_JUMP

    def __post_init__(self) -> None:
        require_positive(
            roughness=self.sigma,
            slope=self.slope,
            hardness=self.hardness,
            gas_conductivity=self.gas_conductivity,
            gas_jump=self.gas_jump,
        )


@dataclass(frozen=True, slots=True)
class ContactConductance:
    """h_c of the spots and h_g of the gas (W/m2K); `total` is their sum."""

    spots: float
    gas: float

    @property
    def total(self) -> float:
        """Give h = h_c + h_g."""
        return self.spots + self.gas


def contact_conductance(pressure: float, rough: Roughness, k1: float, k2: float) -> ContactConductance:
    """Give h(P, sigma) for a pressure P (Pa) between materials of conductivities k1, k2 (W/mK).

    h_c = 1.25 k_s (m/sigma) (P/H)^0.95 with k_s = 2 k1 k2/(k1 + k2), and h_g = k_gas/(Y + M) with the faces' distance
    Y = 1.53 sigma (P/H)^-0.097. Both are for plastic contact, P well below H; radiation is left out.

    Raises
    ------
    ThermalValueError
        If a size is not positive, or P is not below a tenth of H: the formulae are for light contacts.
    """
    require_positive(pressure=pressure, k1=k1, k2=k2)
    relative = pressure / rough.hardness
    if relative >= 0.1:
        raise ThermalValueError("pressure", pressure, f"below a tenth of the hardness, {rough.hardness / 10:g} Pa")
    k_s = 2 * k1 * k2 / (k1 + k2)
    distance = 1.53 * rough.sigma * relative**-0.097
    return ContactConductance(
        spots=1.25 * k_s * rough.slope / rough.sigma * relative**0.95,
        gas=rough.gas_conductivity / (distance + rough.gas_jump),
    )
