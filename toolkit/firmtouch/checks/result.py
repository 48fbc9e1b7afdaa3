"""The outcome of a check, and of all checks of a model."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class CheckResult:
    """A figure held against a bound; `detail` says in words what was found, and what to do where it fails."""

    name: str
    holds: bool
    figure: float
    relation: Literal["<=", ">=", "-"]
    bound: float
    detail: str


def at_most(name: str, figure: float, bound: float, detail: str) -> CheckResult:
    """Check figure <= bound; a figure that is no number fails."""
    return CheckResult(name, bool(figure <= bound), figure if math.isfinite(figure) else math.inf, "<=", bound, detail)


def at_least(name: str, figure: float, bound: float, detail: str) -> CheckResult:
    """Check figure >= bound; a figure that is no number fails."""
    return CheckResult(name, bool(figure >= bound), figure if math.isfinite(figure) else -math.inf, ">=", bound, detail)


def told(name: str, detail: str) -> CheckResult:
    """Give a row that tells something and cannot fail."""
    return CheckResult(name, holds=True, figure=math.inf, relation="-", bound=math.inf, detail=detail)


@dataclass(frozen=True, slots=True)
class CheckReport:
    """All checks of one model, in the order in which they were made."""

    model: str
    results: tuple[CheckResult, ...]

    @property
    def holds(self) -> bool:
        """Tell whether every check holds."""
        return all(each.holds for each in self.results)

    @property
    def failed(self) -> tuple[CheckResult, ...]:
        """List the checks that do not hold."""
        return tuple(each for each in self.results if not each.holds)


def largest(values: Iterable[float]) -> float:
    """Give the largest of some errors, or infinity where one is no number."""
    found = list(values)
    return max(found) if all(math.isfinite(each) for each in found) else math.inf
