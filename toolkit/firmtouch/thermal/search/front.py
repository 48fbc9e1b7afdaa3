"""The Pareto front of all designs that a search tried: how much of one objective another one costs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from firmtouch.thermal.arrays import Array
from firmtouch.thermal.search.candidate import Candidate

UNITS: Final = {"rise_time": "s", "power": "W", "thickness": "m", "discrimination": "1"}
POINTS: Final = 15
"""Designs that a front shows, its ends among them."""


@dataclass(frozen=True, slots=True)
class Front:
    """Designs of which none is better in every one of some objectives, from the best in the first to the worst.

    `units` are those of the objectives; a power is a pad's (W), and without a pad one by area (W/m2).
    """

    objectives: tuple[str, ...]
    units: tuple[str, ...]
    designs: tuple[Candidate, ...]
    chosen: Candidate


def front_of(
    candidates: Sequence[Candidate], objectives: Sequence[str], chosen: Candidate, *, by_area: bool = False
) -> Front:
    """Find the front among those that meet everything, thinned out evenly."""
    met = [*(each for each in candidates if each.meets), chosen]
    costs = np.array([[each.cost(name) for name in objectives] for each in met])
    best = [met[i] for i in np.flatnonzero(_not_dominated(costs))]
    best.sort(key=lambda each: each.cost(objectives[0]))
    units = tuple("W/m^2" if name == "power" and by_area else UNITS[name] for name in objectives)
    return Front(tuple(objectives), units, tuple(_thinned(best, objectives)), chosen)


def _not_dominated(costs: Array) -> Array:
    """Tell of each row whether no other is at least as good in all columns and better in one; the first of equals."""
    order = np.lexsort(costs.T[::-1])
    kept: list[int] = []
    for i in order:
        front = costs[kept]
        if not kept or not (front <= costs[i]).all(axis=1).any():
            kept.append(int(i))
    found = np.zeros(len(costs), dtype=bool)
    found[kept] = True
    return found


def _thinned(designs: list[Candidate], objectives: Sequence[str]) -> list[Candidate]:
    """Keep the ends, and of the others again and again the one that is farthest from all kept."""
    if len(designs) <= POINTS:
        return designs
    costs = np.array([[each.cost(name) for name in objectives] for each in designs])
    span = np.maximum(costs.max(axis=0) - costs.min(axis=0), 1e-12)
    places = (costs - costs.min(axis=0)) / span
    kept = sorted({*places.argmin(axis=0).tolist()})
    while len(kept) < POINTS:
        away = np.linalg.norm(places[:, np.newaxis] - places[kept], axis=2).min(axis=1)
        kept.append(int(away.argmax()))
    return [designs[i] for i in sorted(set(kept))]
