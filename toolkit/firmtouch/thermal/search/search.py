"""A sensor file with a `search:` section -> the best design that meets the requirements, and a Pareto front.

Differential evolution over parts and sizes together, from the file's own values and a Latin hypercube. A design that
meets everything beats one that does not; of two that do, the objective decides, and of two that do not, what is
missing. The whole population is tried at once, on several processes; the result does not depend on their number.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Self

import numpy as np

from firmtouch.thermal.arrays import Array
from firmtouch.thermal.search.candidate import Candidate, Question, confirmed, start_of, try_out
from firmtouch.thermal.search.front import Front, front_of
from firmtouch.thermal.search.variables import Value, Variable, value_of, variables_of, with_values
from firmtouch.thermal.sensorfile.read import SensorFile
from firmtouch.thermal.sensorfile.search import SearchSpec
from firmtouch.thermal.sensorfile.specification import SensorSpec

EVALUATIONS: Final = 2000
"""Designs that are tried where the file does not say how many."""
PER_VARIABLE, LEAST_POPULATION, MOST_POPULATION = 5, 16, 40
CONVERGED: Final = 1e-3
"""Of ln of the objective: a population that differs by less has met in one place."""
POLISHED, POLISHING, FIRST_STEP, SHORTER = 4, 12, 0.2, 3
"""Designs that compass searches begin from, their rounds, first step, of a range, and what divides it in vain."""
SPENT: Final = 0.25
"""Of all evaluations: what compass searches may take, but for one that there always is."""
BETWEEN: Final = 3
"""Runs of a front between those that make each of its objectives best alone."""
MISSED: Final = 1e3
"""What makes any design that meets everything better than any that does not."""
WORSE: Final = 0.01
"""Of ln of the objective: what rounding may cost."""

Tell = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class SearchResult:
    """What a search found: the chosen design, the front, and how many designs were tried and how many met everything.

    Where none did, `chosen` is the one that misses least. `design` is the file's specification with its values.
    """

    spec: SearchSpec
    design: SensorSpec
    variables: tuple[Variable, ...]
    chosen: Candidate
    front: Front | None
    tried: int
    met: int

    @property
    def found(self) -> bool:
        """Tell whether a design meets everything."""
        return self.chosen.meets


def search(file: SensorFile, *, jobs: int = 1, tell: Tell = lambda _: None) -> SearchResult:
    """Search a design for a sensor file that has a `search:` section."""
    spec = file.spec.search
    assert spec is not None
    objectives = tuple(dict.fromkeys((spec.objective, *spec.front)))
    variables = variables_of(file.spec)
    question = Question(file.spec, variables, file.catalogue, objectives)
    with _Workers(question, jobs) as workers:
        archive = _Archive(workers, spec.evaluations or EVALUATIONS, tell)
        start = start_of(question, {each.path: value_of(file.spec, each.path) for each in variables})
        objective = _cost_of(spec.objective)
        _evolve(archive, variables, objective, start, seed=spec.seed, share=_share(spec, main=True))
        ends = [name for name in spec.front if name != spec.objective]
        for i, name in enumerate(ends, start=1):
            cost = _cost_of(name)
            _evolve(archive, variables, cost, np.array(archive.best(cost).x), seed=spec.seed + i, share=_share(spec))
        for i in range(BETWEEN if spec.front and archive.met else 0):
            weigh = _weighing(archive, spec.front, (i + 1) / (BETWEEN + 1))
            _evolve(
                archive, variables, weigh, np.array(archive.best(weigh).x), seed=spec.seed + 100 + i, share=_share(spec)
            )
        _polish(archive, variables, objective)
        chosen = confirmed(question, _rounded(archive, question, archive.best(objective), spec.objective))
    front = None
    if spec.front and archive.met:
        front = front_of(archive.candidates, spec.front, chosen, by_area=file.spec.pad is None)
    design = with_values(file.spec, chosen.values).model_copy(update={"requirements": question.asked})
    return SearchResult(spec, design, variables, chosen, front, len(archive.candidates), archive.met)


def _cost_of(objective: str) -> Callable[[Candidate], float]:
    return lambda each: each.cost(objective)


def _share(spec: SearchSpec, *, main: bool = False) -> float:
    """Give the part of all evaluations that a run may have: without a front, the first has all."""
    if not spec.front:
        return 1.0
    others = len([name for name in spec.front if name != spec.objective]) + BETWEEN
    return 0.4 if main else 0.6 / others


class _Archive:
    """All designs that were tried, and how many more may be."""

    def __init__(self, workers: _Workers, limit: int, tell: Tell) -> None:
        self._workers, self.limit, self._tell = workers, limit, tell
        self.candidates: list[Candidate] = []

    @property
    def met(self) -> int:
        return sum(each.meets for each in self.candidates)

    def try_all(self, X: Array) -> list[Candidate]:
        found = self._workers.try_all(X)
        self.candidates += found
        self._tell(f"searching: {len(self.candidates)} designs tried, {self.met} meet everything")
        return found

    def best(self, cost: Callable[[Candidate], float]) -> Candidate:
        return min(self.candidates, key=lambda each: _energy(each, cost))


def _energy(candidate: Candidate, cost: Callable[[Candidate], float]) -> float:
    return cost(candidate) if candidate.meets else MISSED + candidate.shortfall


class _Workers:
    """Processes that try designs out; one job stays in this process."""

    def __init__(self, question: Question, jobs: int) -> None:
        self._question, self._jobs = question, jobs
        self._parallel: Any = None

    def __enter__(self) -> Self:
        if self._jobs > 1:
            from joblib import Parallel

            self._parallel = Parallel(n_jobs=self._jobs)
            self._parallel.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        if self._parallel is not None:
            self._parallel.__exit__(*error)

    def try_all(self, X: Array) -> list[Candidate]:
        if self._parallel is None:
            return [try_out(self._question, x) for x in X]
        from joblib import delayed

        parts = np.array_split(X, 2 * self._jobs)
        found = self._parallel(delayed(_try_some)(self._question, part) for part in parts if len(part))
        return [each for part in found for each in part]


def _try_some(question: Question, X: Array) -> list[Candidate]:
    return [try_out(question, x) for x in X]


def _evolve(
    archive: _Archive,
    variables: tuple[Variable, ...],
    cost: Callable[[Candidate], float],
    start: Array,
    *,
    seed: int,
    share: float,
) -> None:
    """Run differential evolution until its share of evaluations is used up, or the population has met in one place."""
    from scipy.optimize import differential_evolution
    from scipy.stats.qmc import LatinHypercube

    free = [i for i, each in enumerate(variables) if each.bounds[0] < each.bounds[1]]
    if not free:
        archive.try_all(start[np.newaxis])
        return
    population = min(max(PER_VARIABLE * len(free), LEAST_POPULATION), MOST_POPULATION)
    low, high = _inside(variables, free)
    rng = np.random.default_rng(seed)
    first = low + (high - low) * LatinHypercube(len(free), rng=rng).random(population)

    def energies(columns: Array) -> Array:
        X = np.tile(start, (columns.shape[1], 1))
        X[:, free] = columns.T
        return np.array([_energy(each, cost) for each in archive.try_all(X)])

    differential_evolution(
        energies,
        [variables[i].bounds for i in free],
        init=first,
        x0=np.clip(start[free], low, high),
        integrality=[bool(variables[i].choices) for i in free],
        maxiter=max(1, round(share * archive.limit / population) - 1),
        tol=0,
        atol=CONVERGED,
        mutation=(0.4, 0.9),
        recombination=0.8,
        polish=False,
        updating="deferred",
        vectorized=True,
        rng=rng,
    )


def _polish(archive: _Archive, variables: tuple[Variable, ...], cost: Callable[[Candidate], float]) -> None:
    """Improve the sizes of the best designs by compass searches, which end in corners where the best lies there.

    It begins from the best designs with different choices: of two parts that are nearly as good, one may need other
    sizes than the other.
    """
    low, high = np.array([each.bounds for each in variables]).T
    sizes = [i for i, each in enumerate(variables) if not each.choices and low[i] < high[i]]
    moves = np.zeros((2 * len(sizes), len(variables)))
    moves[range(len(moves)), sizes * 2] = np.repeat([1.0, -1.0], len(sizes))
    begun = max(1, min(POLISHED, round(SPENT * archive.limit / (POLISHING * max(len(moves), 1)))))
    for start in _best_of_each_choice(archive, variables, cost)[:begun] if sizes else ():
        length, best = FIRST_STEP, start
        for _ in range(POLISHING):
            tried = archive.try_all(np.clip(np.array(best.x) + length * moves * (high - low), low, high))
            before, best = best, min([best, *tried], key=lambda each: _energy(each, cost))
            if best is before:
                length /= SHORTER


def _best_of_each_choice(
    archive: _Archive, variables: tuple[Variable, ...], cost: Callable[[Candidate], float]
) -> list[Candidate]:
    """Give the best designs that differ in their choices, the best first."""
    chosen = [each.path for each in variables if each.choices]
    found: dict[tuple[Value, ...], Candidate] = {}
    for each in sorted(archive.candidates, key=lambda each: _energy(each, cost)):
        found.setdefault(tuple(each.values[path] for path in chosen), each)
    return list(found.values())


def _inside(variables: tuple[Variable, ...], free: list[int]) -> tuple[Array, Array]:
    """Give the bounds, drawn in by less than anything that counts: scaling may round across them."""
    low, high = np.array([variables[i].bounds for i in free]).T
    hair = 1e-9 * (high - low)
    return low + hair, high - hair


def _weighing(archive: _Archive, names: Sequence[str], part: float) -> Callable[[Candidate], float]:
    """Weigh objectives by Chebyshev's distance from the best of each, between the ends that are known (Miettinen)."""
    met = [each for each in archive.candidates if each.meets]
    costs = np.array([[each.cost(name) for name in names] for each in met])
    ideal = costs.min(axis=0)
    ends = costs[costs.argmin(axis=0)]
    span = np.maximum(ends.max(axis=0) - ideal, 1e-9)
    weights = np.array([part, *[1 - part] * (len(names) - 1)])

    def weigh(candidate: Candidate) -> float:
        away = (np.array([candidate.cost(name) for name in names]) - ideal) / span
        return float((weights * away).max() + 1e-3 * away.sum())

    return weigh


def _rounded(archive: _Archive, question: Question, chosen: Candidate, objective: str) -> Candidate:
    """Round the sizes of the chosen design, where that costs next to nothing."""
    pairs = zip(question.variables, chosen.values.values(), strict=True)
    rounded = {each.path: each.rounded(value) for each, value in pairs}
    other = try_out(question, np.array([each.coordinate(rounded[each.path]) for each in question.variables]))
    archive.candidates.append(other)
    keeps = other.meets >= chosen.meets and other.shortfall <= chosen.shortfall + WORSE
    if not keeps or (chosen.meets and other.cost(objective) > chosen.cost(objective) + WORSE):
        return chosen
    return replace(other, values=rounded)
