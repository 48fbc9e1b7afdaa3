"""What the runs say together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

from firmtouch.montecarlo.record import Record

CONFIDENCE: Final = 0.95
MOST_WORST: Final = 5


@dataclass(frozen=True, slots=True)
class Worst:
    """The runs that are worst in one respect, the worst first: largest `figure` (a record's attribute)."""

    name: str
    figure: str
    records: tuple[Record, ...]


@dataclass(frozen=True, slots=True)
class Summary:
    """Of `runs` runs, `converged` converged; `interval` holds their probability with `CONFIDENCE`.

    `counts` are runs by outcome, `off_surface` starts that could not be put onto the surface and are no runs.
    `inside` are starts inside what is proven, `contradictions` those of them that did not converge, and `pulled` how
    many had a one-sided contact pull, which the proof allows.
    """

    runs: int
    converged: int
    interval: tuple[float, float]
    counts: dict[str, int]
    off_surface: int
    worst: tuple[Worst, ...]
    inside: int
    contradictions: tuple[Record, ...]
    pulled: int

    @property
    def fraction(self) -> float:
        """The converged part of the runs; 0 if there is none."""
        return self.converged / self.runs if self.runs else 0.0


def clopper_pearson(k: int, n: int, *, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """Give the exact interval for the probability of k successes in n trials (Clopper and Pearson, 1934).

    Its ends are quantiles of beta distributions: at the lower, k or more successes have the probability
    (1 - confidence) / 2, at the upper k or less.
    """
    from scipy.special import betaincinv

    tail = (1 - confidence) / 2
    low = float(betaincinv(k, n - k + 1, tail)) if k else 0.0
    high = float(betaincinv(k + 1, n - k, 1 - tail)) if k < n else 1.0
    return low, high


def summarise(records: Iterable[Record]) -> Summary:
    """Sum up; the order of the records does not matter."""
    ordered = sorted(records, key=lambda each: each.label)
    outside = [each for each in ordered if not each.label.proven]
    inside = [each for each in ordered if each.label.proven]
    runs = [each for each in outside if each.counts]
    converged = sum(each.converged for each in runs)
    return Summary(
        runs=len(runs),
        converged=converged,
        interval=clopper_pearson(converged, len(runs)),
        counts=dict(sorted(Counter(each.outcome for each in runs).items())),
        off_surface=len(outside) - len(runs),
        worst=(
            _worst("farthest from rest", "distance", (each for each in runs if not each.converged)),
            _worst("largest force error", "force", runs),
            _worst("nearest to a drive's limit", "torque", (each for each in runs if each.torque is not None)),
        ),
        inside=len(inside),
        contradictions=tuple(each for each in inside if not each.converged),
        pulled=sum(each.pulled for each in inside),
    )


def _worst(name: str, figure: str, records: Iterable[Record]) -> Worst:
    ordered = sorted(records, key=lambda each: (-getattr(each, figure), each.label))
    return Worst(name, figure, tuple(ordered[:MOST_WORST]))
