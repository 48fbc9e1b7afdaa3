"""What a search leaves to a proof."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from firmtouch.mechanics import Array


@dataclass(frozen=True, slots=True)
class Multipliers:
    """F ((n-m) x 3(n-m)) of one edge and P (2(n-m) x 2(n-m)) for every plant, in coordinates `basis` and time 1/unit.

    `basis` (n x (n-m)) spans ker J, nearly.
    """

    F: Array
    P: tuple[Array, ...]
    basis: Array
    unit: float


@dataclass(frozen=True, slots=True)
class Witness:
    """What a search found beside the gains, from which a proof can begin: eps of [T4] in 1/s, multipliers by edge."""

    epsilon: float | None = None
    multipliers: Mapping[str, Multipliers] = field(default_factory=dict)
