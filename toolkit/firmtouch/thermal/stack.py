"""A fingertip as a stack of layers, and what it touches: values, in SI units, of areas (per m2) and not of a pad."""

from __future__ import annotations

import math
from dataclasses import dataclass

from firmtouch.thermal.arrays import ThermalValueError, require_conductance, require_positive, require_thickness


@dataclass(frozen=True, slots=True)
class Material:
    """A material: conductivity k (W/mK), density rho (kg/m3), heat capacity c (J/kgK).

    Raises
    ------
    ThermalValueError
        If one of them is not positive.
    """

    name: str
    conductivity: float
    density: float
    heat_capacity: float

    def __post_init__(self) -> None:
        require_positive(conductivity=self.conductivity, density=self.density, heat_capacity=self.heat_capacity)

    @property
    def volumetric_capacity(self) -> float:
        """Give rho c (J/m3K)."""
        return self.density * self.heat_capacity

    @property
    def alpha(self) -> float:
        """Give the diffusivity k / (rho c) (m2/s)."""
        return self.conductivity / self.volumetric_capacity

    @property
    def effusivity(self) -> float:
        """Give e = sqrt(k rho c) (W s^1/2 / m2K)."""
        return math.sqrt(self.conductivity * self.volumetric_capacity)


@dataclass(frozen=True, slots=True)
class Layer:
    """A layer of a material, of a thickness (m) > 0: heat diffuses through it."""

    material: Material
    thickness: float

    def __post_init__(self) -> None:
        require_positive(thickness=self.thickness)


@dataclass(frozen=True, slots=True)
class Film:
    """A film so thin and conductive that it only stores heat: C'' (J/m2K) > 0."""

    areal_capacity: float

    def __post_init__(self) -> None:
        require_positive(areal_capacity=self.areal_capacity)


@dataclass(frozen=True, slots=True)
class Contact:
    """An imperfect contact, of conductance h (W/m2K) > 0: it only resists."""

    conductance: float

    def __post_init__(self) -> None:
        require_conductance(self.conductance)


Element = Layer | Film | Contact


@dataclass(frozen=True, slots=True)
class HalfSpace:
    """A body so thick that its far side is not felt."""

    material: Material


@dataclass(frozen=True, slots=True)
class Base:
    """A held temperature."""


@dataclass(frozen=True, slots=True)
class Adiabatic:
    """A face that no heat passes."""


@dataclass(frozen=True, slots=True)
class Air:
    """A face to the air, with h_a (W/m2K) > 0 from it."""

    conductance: float

    def __post_init__(self) -> None:
        require_positive(conductance=self.conductance)


@dataclass(frozen=True, slots=True)
class Slab:
    """An object of finite thickness (m); no heat passes its far side."""

    material: Material
    thickness: float

    def __post_init__(self) -> None:
        require_positive(thickness=self.thickness)


@dataclass(frozen=True, slots=True)
class Disc:
    """A plate that is touched on a disc only, of a radius (m), and else insulated: Y = A k g tanh(g L) + its edge's.

    Without a thickness (m) it is a half-space: Y = A e sqrt(s) + 4 k a. `pad.disc_admittance` tells how good that is.
    """

    material: Material
    radius: float
    thickness: float = math.inf

    def __post_init__(self) -> None:
        require_positive(radius=self.radius)
        require_thickness(self.thickness)


Backing = HalfSpace | Base | Adiabatic | Air
TouchedObject = HalfSpace | Slab | Disc | Base
"""What can be touched; a `Base` is a body of infinite effusivity, whose face keeps its temperature."""


@dataclass(frozen=True, slots=True)
class Touch:
    """An object, and the conductance h (W/m2K) of the contact with it; `inf` is a perfect one.

    `air` (W/m2K) is what the face gave to the air before, h_air (T_s - T_a), and gives no more, by T_s - T_o.
    """

    object: TouchedObject
    conductance: float
    air: float = 0.0

    def __post_init__(self) -> None:
        require_conductance(self.conductance)
        if not math.isfinite(self.air):
            raise ThermalValueError("air's conductance before the touch", self.air, "a finite number")


Front = Touch | Air | Adiabatic
"""What a fingertip has before it: an object, or nothing."""


@dataclass(frozen=True, slots=True)
class Stack:
    """Elements from the touched face inward, and what is behind them.

    Plane i is before `elements[i]`: plane 0 is the touched face and plane `len(elements)` the backing's. `sensed` is
    the plane whose temperature is measured. Both planes of a film have its temperature.

    Raises
    ------
    ThermalValueError
        If there is no plane `sensed`.
    """

    elements: tuple[Element, ...]
    sensed: int
    backing: Backing

    def __post_init__(self) -> None:
        self.check_plane(self.sensed, "sensed plane")

    def check_plane(self, plane: int, name: str = "plane") -> None:
        """Refuse a plane that is not there."""
        if not 0 <= plane <= len(self.elements):
            raise ThermalValueError(name, plane, f"between 0 and {len(self.elements)}")

    @property
    def thickness(self) -> float:
        """Add up the layers (m)."""
        return sum(each.thickness for each in self.elements if isinstance(each, Layer))
