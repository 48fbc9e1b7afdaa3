"""A sensor file -> a `Study`: of the sensor as it is, or, where the file has a `search:` section, of the best found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from firmtouch.thermal.analysis import Analysis, analyse
from firmtouch.thermal.sensorfile.read import SensorFile

if TYPE_CHECKING:  # SciPy's optimisers take a while to load
    from firmtouch.thermal.search import SearchResult


@dataclass(frozen=True, slots=True, eq=False)
class Study:
    """An analysis, and the search that led to what is analysed, where there was one."""

    analysis: Analysis
    search: SearchResult | None = None

    @property
    def verdict(self) -> Literal["met", "not_met", "infeasible"]:
        """Say whether all that is asked is met; `infeasible`: by no design that a search tried."""
        if self.search is not None and not self.search.found:
            return "infeasible"
        return "met" if self.analysis.met else "not_met"


def study_sensor(file: SensorFile, *, jobs: int = 1, tell: Callable[[str], None] = lambda _: None) -> Study:
    """Analyse the sensor of a file, after a search where the file has one, in some processes.

    Raises
    ------
    LoopUnstableError, LoopRingsError, NoResponseError
        If the sensor cannot be analysed.
    """
    if file.spec.search is None:
        tell("analysing")
        return Study(analyse(file))
    from firmtouch.thermal.search import search

    found = search(file, jobs=jobs, tell=tell)
    tell("analysing the best design")
    return Study(analyse(file, found.design), found)
