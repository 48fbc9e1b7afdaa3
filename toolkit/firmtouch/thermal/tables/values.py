"""What the rows of the tables are: a material, a part, a contact."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from firmtouch.thermal.stack import Material
from firmtouch.thermal.tables.rows import Held

REFERENCE: Final = 298.15
"""Where a resistance is told, in K, if nothing else is said."""


@dataclass(frozen=True, slots=True)
class TableMaterial(Material):
    """A material at about 300 K; those of a real piece are expected within +- `tolerance`, relative to each size."""

    title: str
    tolerance: float
    source: str


@dataclass(frozen=True, slots=True)
class ContactPreset:
    """A contact: its conductance h in W/(m^2 K), and between what it lies in use."""

    name: str
    title: str
    conductance: float
    low: float
    high: float
    tolerance: float
    source: str


@dataclass(frozen=True, slots=True)
class HeatCapacity:
    """A part's heat capacity in J/K, the way it was found, and what other ways give.

    `basis` is `published`, `delta tau`, `mass` or `volume`; `ways` holds the values of all that were possible.
    `warning` is not empty where the basis and the body (m c, or V rho c) differ by more than a factor of 2.
    """

    value: float
    basis: str
    ways: Mapping[str, float]
    warning: str = ""


@dataclass(frozen=True, slots=True)
class Part:
    """A thermistor or an RTD that can be bought; what its data sheet does not tell is None.

    `size` is its length, width and height in m, `footprint` its area in m^2 as seen from above, `volume` that of its
    body in m^3, `mass` in kg. `resistance` in ohm, at the temperature `resistance_at` in K, and `B` in K are the least
    and the most of a family, the same twice for one part; `coefficient` is that of a metal, in 1/K.
    """

    name: str
    title: str
    kind: str
    tolerance: float
    source: str
    size: tuple[float, float, float] | None = None
    footprint: float | None = None
    volume: float | None = None
    mass: float | None = None
    resistance: tuple[float, float] | None = None
    resistance_at: float = REFERENCE
    B: tuple[float, float] | None = None
    B_between: tuple[float, float] | None = None
    coefficient: float | None = None
    dissipation: Held | None = None
    time_constant: Held | None = None
    capacity: HeatCapacity | None = None


def go_together(delta: Held | None, tau: Held | None) -> bool:
    """Tell whether C = delta tau may be taken: both in the same known medium and mounting, and neither a bound."""
    if delta is None or tau is None or delta.bound or tau.bound:
        return False
    return delta.medium is not None and (delta.medium, delta.mounting) == (tau.medium, tau.mounting)
