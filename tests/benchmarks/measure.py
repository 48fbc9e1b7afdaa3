"""Timing, and a figure held against its bound."""

from __future__ import annotations

import statistics
import subprocess
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Figure:
    """A measured figure and the bound that it must keep; `detail` tells the times that it was made of."""

    name: str
    value: float
    relation: str
    bound: float
    unit: str
    detail: str

    @property
    def holds(self) -> bool:
        return self.value <= self.bound if self.relation == "<=" else self.value >= self.bound


def seconds(work: Callable[[], object]) -> float:
    """Time one call."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def best_of(count: int, work: Callable[[], object]) -> float:
    """Give the least of some times: what the work takes when nothing else disturbs it."""
    return min(seconds(work) for _ in range(count))


def run(command: Sequence[str]) -> float:
    """Time one run of a program, which must succeed."""
    return seconds(lambda: subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL))


def alternated(count: int, *commands: Sequence[str]) -> list[float]:
    """Give the median time of each command; they take turns, so that a busy machine slows all of them alike."""
    times = [[run(command) for command in commands] for _ in range(count)]
    return [statistics.median(each) for each in zip(*times, strict=True)]
