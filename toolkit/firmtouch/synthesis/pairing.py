"""Step 1: poles -> second-order polynomials p_i(s) = s^2 + c_i s + k_i."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from firmtouch.errors import NoDesignError

MOST_PAIRINGS: Final = 945
"""All pairings of ten real poles; of more, only neighbours are paired."""


@dataclass(frozen=True, slots=True)
class Mode:
    """One p_i(s) = s^2 + c s + k, with c > 0 and k > 0 for stable poles."""

    c: float
    k: float


class UnpairedPoleError(NoDesignError):
    """An odd number of real poles is left to pair: no real p_i(s) has a single real and a complex root."""

    def __init__(self, real: tuple[float, ...]) -> None:
        self.real = real
        listed = ", ".join(f"{each:g}" for each in real)
        super().__init__(f"{len(real)} real poles ({listed}) cannot be paired; the real ones must be even in number")


def pairings(groups: tuple[tuple[complex, ...], ...]) -> Iterator[tuple[Mode, ...]]:
    """List the ways to pair poles: conjugates together, given groups kept, the other real ones in all ways.

    Raises
    ------
    UnpairedPoleError
        If the real poles without a group are odd in number.
    """
    fixed = [_mode(*group) for group in groups if len(group) == 2]
    single = [group[0] for group in groups if len(group) == 1]
    conjugate = [_mode(each, each.conjugate()) for each in single if each.imag > 0]
    real = tuple(sorted((each.real for each in single if each.imag == 0), reverse=True))
    if len(real) % 2:
        raise UnpairedPoleError(real)
    ways = _matchings(real) if _count(len(real)) <= MOST_PAIRINGS else iter([_neighbours(real)])
    for way in ways:
        yield (*fixed, *conjugate, *(_mode(a, b) for a, b in way))


def _mode(a: complex, b: complex) -> Mode:
    return Mode(-(a + b).real, (a * b).real)


def _count(size: int) -> int:
    total = 1
    for odd in range(size - 1, 1, -2):
        total *= odd
    return total


def _neighbours(real: tuple[float, ...]) -> tuple[tuple[float, float], ...]:
    return tuple(zip(real[::2], real[1::2], strict=True))


def _matchings(real: tuple[float, ...]) -> Iterator[tuple[tuple[float, float], ...]]:
    if not real:
        yield ()
        return
    first, rest = real[0], real[1:]
    for i, partner in enumerate(rest):
        if partner in rest[:i]:
            continue  # the same pair again
        for others in _matchings(rest[:i] + rest[i + 1 :]):
            yield ((first, partner), *others)
