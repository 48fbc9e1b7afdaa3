"""From many starts to all configurations that meet a question, or to what stands in the way."""

from __future__ import annotations

from typing import Final

import numpy as np

from firmtouch.errors import InputError
from firmtouch.mechanics.arrays import Array, frozen
from firmtouch.regulation.inverse_kinematics.errors import BeyondLimitsError, OutOfReachError, miss
from firmtouch.regulation.inverse_kinematics.evaluation import EDGE, Evaluation
from firmtouch.regulation.inverse_kinematics.reach import Reach
from firmtouch.regulation.inverse_kinematics.solution import FARTHEST, NEAREST, Reached, Solution, order
from firmtouch.regulation.inverse_kinematics.steps import Cost, Descent, descend, polish, slide

MOST_STARTS: Final = 128
IDLE: Final = 96
"""A search ends after so many starts in a row without a new solution ..."""
KNOWN_PLACE: Final = 15
"""... of which one that arrives at a known place of a continuum counts for so many: places are few."""
UNLIMITED_STARTS: Final = 32
"""Without limits there are more solutions and no dead ends at limits, so fewer starts meet one."""
SAME: Final = 1e-4
"""Isolated solutions nearer than this (rad or m, in every joint) are one: singular ones are found to about 1e-7."""
SAME_PLACE: Final = 0.3
"""Places on continua nearer than this (rad or m, in every joint) are told as one."""
FROM_LIMIT: Final = 1e-3
"""How near to a limit, as a part of its range, the search for more room may come: there the logarithm is steep."""


def solve_reach(reach: Reach, *, near: Array | None = None, starts: int = MOST_STARTS) -> Reached:
    """Find the configurations with r(q) = 0 within the limits, and say which one to take.

    Searches begin at `near` (n, rad or m), in the middle of the ranges, and at up to `starts` configurations of a fixed
    sequence, so that the answer is always the same. Angles are given within the limits, and there nearest to `near` or
    to zero. Where r leaves the arm free to move, each solution is moved on within its continuum: to the place nearest
    to `near`, or without it to the place of the largest `room` (`Solution`). By the same measure one is taken.

    Raises
    ------
    BeyondLimitsError
        If r(q) = 0 was only met beyond the limits.
    OutOfReachError
        If it was not met at all.
    InputError
        If `near` has not n finite numbers, or `starts` is below one.
    """
    if near is not None and not (near.shape == (reach.n,) and np.all(np.isfinite(near))):
        raise InputError(f"`near` must be {reach.n} finite numbers, not {near.tolist()}")
    if starts < 1:
        raise InputError(f"{starts} starts; at least one is needed")
    search = _Search(Evaluation(reach), near)
    begin = [] if near is None else [near]
    return search.run([*begin, *search.at.starts(starts)])


class _Search:
    """One question with its preference."""

    def __init__(self, at: Evaluation, near: Array | None) -> None:
        self.at, self.near = at, near
        self.toward = np.zeros(at.reach.n) if near is None else near
        self.limits = at.reach.lower, at.reach.upper

    def run(self, starts: list[Array]) -> Reached:
        """Find all distinct solutions within the limits; without any, find out why."""
        found: list[Solution] = []
        ends: list[Descent] = []
        idle = 0
        for start in starts:
            end = descend(self.at, start, self.limits)
            ends.append(end)
            idle += 1
            if end.met:
                continuum = self.at.rank(end.q) < self.at.reach.n
                if self._add(found, end.q, continuum=continuum):
                    idle = 0
                elif continuum:
                    idle += KNOWN_PLACE
            if idle >= IDLE and found:
                break
        met = sum(each.met for each in ends)
        if not found:
            found = [self.at.solution(self._without_limits(starts[:UNLIMITED_STARTS], ends))]
        solutions = order(found, self.near)
        because = FARTHEST if self.near is None else NEAREST
        return Reached(solutions, because, len(ends), met, self.at.rank(solutions[0].q))

    def _add(self, found: list[Solution], q: Array, *, continuum: bool) -> bool:
        """Keep a solution, or the best place of its continuum, unless it is known."""
        q = self._moved_on(q) if continuum else q
        # At a limit rounding may have put it beyond.
        q = frozen(np.clip(self.at.within_one_turn(q, self.toward), *self.limits))
        if any(self.at.distance(q, each.q) < (SAME_PLACE if continuum else SAME) for each in found):
            return False
        found.append(self.at.solution(q))
        return True

    def _moved_on(self, q: Array) -> Array:
        """Move within a continuum to its best place near q: nearest to the given one, or with the largest room."""
        q = self.at.within_one_turn(q, self.toward)
        if self.near is not None:
            near = self.near
            distance = Cost(lambda x: float((x - near) @ (x - near)), lambda x: 2 * (x - near))
            return slide(self.at, q, distance, self.limits, self.limits)
        lower, upper = self.limits
        inset = np.zeros(len(q))
        inset[self.at.limited] = FROM_LIMIT * (upper - lower)[self.at.limited]
        room = Cost(self.at.minus_log_room, self.at.minus_log_room_gradient)
        return slide(self.at, q, room, (lower + inset, upper - inset), self.limits)

    def _without_limits(self, starts: list[Array], ends: list[Descent]) -> Array:
        """Set the limits aside: give a solution within them after all, or raise with what stands in the way."""
        reach = self.at.reach
        free = np.full(reach.n, -np.inf), np.full(reach.n, np.inf)
        excess_cost = Cost(lambda x: float(self._excess(x) @ self._excess(x)), lambda x: 2 * self._excess(x))
        misses, found = [], []
        for start in starts:
            end = descend(self.at, start, free)
            q = self.at.within_one_turn(end.q, self.toward)
            if not end.met:
                misses.append(Descent(q, end.residual))
                continue
            if self.at.rank(q) < reach.n:
                q = self.at.within_one_turn(slide(self.at, q, excess_cost, free, free), self.toward)
            inside = polish(self.at, np.clip(q, *self.limits), self.limits)
            if inside.met:
                return frozen(inside.q)
            found.append(q)
        if not found:
            nearest = min(misses, key=lambda each: each.largest)
            raise OutOfReachError(miss(reach, frozen(nearest.q), nearest.residual), len(ends) + len(starts))
        least = min(found, key=lambda each: float(np.linalg.norm(self._excess(each))))
        excess = zip(reach.names, self._excess(least), strict=True)
        beyond = {name: float(each) for name, each in excess if abs(each) > EDGE}
        nearest = min(ends, key=lambda each: each.largest)
        raise BeyondLimitsError(reach, least, beyond, miss(reach, frozen(nearest.q), nearest.residual))

    def _excess(self, q: Array) -> Array:
        """Give how far each joint is beyond its limits: above the upper one > 0, below the lower one < 0."""
        lower, upper = self.limits
        return frozen(np.maximum(0, q - upper) - np.maximum(0, lower - q))
