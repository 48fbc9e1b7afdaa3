"""Constraints whose gradients depend on each other: which rows of J are combinations of which, and what to do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from firmtouch.errors import NoDesignError
from firmtouch.mechanics import Array, Plant
from firmtouch.mechanics.arrays import frozen
from firmtouch.modelfile.sections.frames import OnFrames
from firmtouch.regulation.projection import RANK, OffSurfaceError, project

NEARBY: Final = 0.05
"""How far (rad or m) around q_d configurations are drawn to tell a redundant constraint from a singular place."""
TRIES: Final = 4


@dataclass(frozen=True, slots=True)
class Dependencies:
    """The rank of J, the rows that depend on rows above them, and in words how."""

    rank: int
    rows: tuple[str, ...]
    words: tuple[str, ...]


class DependentConstraintsError(NoDesignError):
    """J has not full row rank; `dependencies` says which rows are combinations of which, `remedy` what to do."""

    def __init__(self, rank: int, dependencies: tuple[str, ...], remedy: str = "") -> None:
        self.rank, self.dependencies, self.remedy = rank, dependencies, remedy
        told = f"the constraints are redundant at q_d (J has rank {rank}): {'; '.join(dependencies)}"
        super().__init__(f"{told}. {remedy}" if remedy else told)


def row_dependencies(plant: Plant, J: Array) -> Dependencies:
    """Find the rank of J and, for each redundant row, which rows above it make it up."""
    names = list(plant.spec.constraints)
    scale = float(np.linalg.norm(J, 2)) or 1.0
    kept: list[int] = []
    rows, words = [], []
    for j, row in enumerate(J):
        weights, rest = np.zeros(0), row
        if kept:
            weights = np.linalg.lstsq(J[kept].T, row, rcond=None)[0]
            rest = row - J[kept].T @ weights
        if float(np.linalg.norm(rest)) > RANK * scale:
            kept.append(j)
            continue
        terms = [f"{w:+.4g} {names[k]}" for w, k in zip(weights, kept, strict=True) if abs(w) > RANK]
        rows.append(names[j])
        words.append(f"the gradient of `{names[j]}` is {' '.join(terms) if terms else 'zero'}")
    return Dependencies(len(kept), tuple(rows), tuple(words))


def remedy_for(plant: Plant, q_d: Array, found: Dependencies) -> str:
    """Say what to do about redundant rows: leave them out where they are redundant all around q_d, else move q_d.

    Around q_d the rank is counted at random configurations on the constraints.
    """
    rng = np.random.default_rng(len(q_d))
    ranks = []
    for _ in range(TRIES):
        try:
            near = project(plant, frozen(q_d + rng.uniform(-NEARBY, NEARBY, len(q_d)))).q
        except OffSurfaceError:
            continue
        ranks.append(row_dependencies(plant, plant.J(near)).rank)
    if ranks and max(ranks) > found.rank:
        return "Around q_d they are not: q_d is a singular configuration, choose another one"
    advice = [
        f"`without: [{', '.join(left_out)}]` in `{name}`"
        for name, entry in plant.spec.entries.items()
        if isinstance(entry, OnFrames)
        and (left_out := [row.suffix for row in entry.all_rows() if row.optional and row.name(name) in found.rows])
    ]
    return f"They are so all around q_d: write {' and '.join(advice)}" if advice else ""
