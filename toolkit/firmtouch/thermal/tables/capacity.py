"""The heat capacity of a part: as published, from delta and tau, or from what its body holds."""

from __future__ import annotations

from typing import Final

from firmtouch.thermal.tables.rows import Held
from firmtouch.thermal.tables.values import HeatCapacity, TableMaterial, go_together

LARGEST_FACTOR: Final = 2.0
"""Two ways to a capacity that differ by more than this are worth a warning."""


def heat_capacity(
    body: TableMaterial,
    *,
    published: float | None = None,
    delta: Held | None = None,
    tau: Held | None = None,
    mass: float | None = None,
    volume: float | None = None,
) -> HeatCapacity | None:
    """Find a part's heat capacity C in J/K, in the first of four ways that its row allows; None where none is.

    As published; delta tau, where both hold in the same known medium and mounting; m c; V rho c. A time constant
    belongs to its medium: delta in air times tau in oil is no capacity.
    """
    ways: dict[str, float] = {}
    if published is not None:
        ways["published"] = published
    if go_together(delta, tau):
        assert delta is not None
        assert tau is not None
        ways["delta tau"] = delta.value * tau.value
    if mass is not None:
        ways["mass"] = mass * body.heat_capacity
    if volume is not None:
        ways["volume"] = volume * body.volumetric_capacity
    if not ways:
        return None
    basis = next(iter(ways))
    return HeatCapacity(ways[basis], basis, ways, _doubt(ways, basis, body))


def _doubt(ways: dict[str, float], basis: str, body: TableMaterial) -> str:
    """Hold the capacity against that of the body; a weighed mass tells more than a size."""
    held = next((each for each in ("mass", "volume") if each in ways), basis)
    factor = max(ways[basis] / ways[held], ways[held] / ways[basis])
    if factor <= LARGEST_FACTOR:
        return ""
    return (
        f"{ways[basis] * 1e3:.3g} mJ/K ({basis}) is {ways[basis] / ways[held]:.2g} times the "
        f"{ways[held] * 1e3:.3g} mJ/K of its {held} of {body.name}"
    )
