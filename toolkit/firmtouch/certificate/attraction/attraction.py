"""The region of attraction [T10] of controllers (15) and (11): searched for, proven, told in an engineer's words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import flint
import numpy as np
from flint import arb

from firmtouch.certificate.attraction.chart import Chart, box, stiffness_chart
from firmtouch.certificate.attraction.landscape import Landscape
from firmtouch.certificate.attraction.proof import Basin, Limit, explore
from firmtouch.certificate.attraction.reach import reach
from firmtouch.certificate.attraction.rounding import lower, upper
from firmtouch.certificate.attraction.speed import Speeds, speed_within, speeds
from firmtouch.certificate.matrices import exact, is_positive_definite
from firmtouch.errors import NoDesignError
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation import ClosedLoop
from firmtouch.regulation.controllers import Controller

BITS: Final = 64
WIDEST: Final = 2.0
"""The box that is searched, along the softest direction, in rad or m; shorter along stiffer ones."""
MOST_CELLS: Final = 600
REACH_CELLS: Final = 300
CONTROLLERS: Final = (Controller.AFFINE, Controller.ENERGY_WITH_FORCE)
"""Eq. (15), and Eq. (11) with P_d of Eq. (12) and any symmetric G_f >= 0. For Eq. (17) this is open [T11]."""


class NotProvenError(NoDesignError):
    """The conditions of [T10] were not proven; `reason` says which."""

    def __init__(self, reason: str) -> None:
        self.reason = reason
        super().__init__(f"no region of attraction was proven: {reason}")


@dataclass(frozen=True, slots=True)
class Search:
    """What repeats a proof: the box |x2_i| <= half_widths_i of the chart, and how many cells may be enclosed."""

    half_widths: tuple[float, ...]
    most_cells: int


@dataclass(frozen=True, slots=True)
class Together:
    """Every start within |q_i - q_di| < distance units_i with |q_i'| < speed units_i and J q' = 0 converges."""

    distance: float
    speed: float


@dataclass(frozen=True, slots=True)
class Attraction:
    """A proven region of attraction, for the exact binary64 gains and parameters and for an exact surface.

    Every start on the proven graph with J q' = 0 and V = q'^T M q' / 2 + p < level (J), p = P_cd counted from q_d,
    converges to q*, the closed loop's exact equilibrium, |q*_i - q_di| <= offset. In particular every start at rest
    that the surface connects with q* inside |q_i - q_di| < distance units_i does. `extent` are half-widths (n - m) of
    a box of x2 that holds the proven cells, and `cells` how many were enclosed to find them.
    """

    controllers: tuple[Controller, ...]
    chart: Chart
    search: Search
    units: tuple[float, ...]
    level: float
    limit: Limit
    cells: int
    offset: float
    extent: Array
    distance: float
    speeds: Speeds
    together: Together


def find_attraction(
    loop: ClosedLoop, *, units: Sequence[float] | None = None, most_cells: int = MOST_CELLS
) -> Attraction:
    """Search for the highest level that a number of cells can prove.

    `units` (n, ones by default) are how many rad or m of each joint count as much as one of the others.

    Raises
    ------
    NotProvenError
        If there is none, not even around q_d.
    """
    chart = stiffness_chart(loop)
    stiffness = np.maximum(np.diag(chart.V2.T @ loop.K @ chart.V2), np.finfo(float).tiny)
    half_widths = tuple((WIDEST * np.sqrt(np.min(stiffness) / stiffness)).tolist())
    return _attraction(loop, chart, Search(half_widths, most_cells), np.inf, units)


def prove_attraction(
    loop: ClosedLoop, chart: Chart, search: Search, level: float, *, units: Sequence[float] | None = None
) -> Attraction:
    """Prove a level again, from the box and the number of cells alone: the same call gives the same answer.

    Raises
    ------
    NotProvenError
        If the level is not proven with so many cells.
    """
    found = _attraction(loop, chart, search, level, units)
    if found.level < level:
        raise NotProvenError(
            f"the level {level:.6g} J was asked for, and {found.level:.6g} J proven: {found.limit.value}"
        )
    return found


def _attraction(
    loop: ClosedLoop, chart: Chart, search: Search, level: float, units: Sequence[float] | None
) -> Attraction:
    with flint.ctx.workprec(BITS):
        u = _units(chart, units)
        basin = explored(loop, chart, search, at_most=level, units=None)
        proven = lower(arb(basin.bound) - basin.rest.value.upper())
        if not proven > 0:
            raise NotProvenError(f"no positive level, with {basin.cells} cells: {basin.limit.value}")
        distance = reach(basin, basin.bound, u, REACH_CELLS)
        return Attraction(
            controllers=CONTROLLERS,
            chart=chart,
            search=search,
            units=u,
            level=basin.bound,
            limit=basin.limit,
            cells=basin.cells,
            offset=max(upper(abs(a - b)) for a, b in zip(basin.rest.q, chart.q_d.tolist(), strict=True)),
            extent=_extent(basin),
            distance=distance,
            speeds=speeds(basin.landscape, basin.rest.q, proven, u),
            together=_together(basin, proven, u),
        )


def explored(loop: ClosedLoop, chart: Chart, search: Search, *, at_most: float, units: Sequence[float] | None) -> Basin:
    """Explore, by p or with `units` by the distance, after asking for C > 0."""
    if is_positive_definite(exact(loop.gains.C)) is not True:
        raise NotProvenError("C > 0 does not hold, or only just")
    landscape = Landscape(loop.operating_point, loop.gains, chart)
    basin = explore(landscape, box(search.half_widths), most_cells=search.most_cells, at_most=at_most, units=units)
    if basin is None:
        raise NotProvenError("not even a small cell around q_d has p_xx certainly nonsingular")
    return basin


def _together(basin: Basin, level: float, units: tuple[float, ...]) -> Together:
    """Give half of the level to where a start is, and half to how fast it is, with M bounded wherever that may be."""
    distance = reach(basin, level / 2, units, REACH_CELLS)
    q_d = basin.landscape.chart.q_d.tolist()
    q = [arb(x, distance * u) for x, u in zip(q_d, units, strict=True)]
    return Together(distance, speed_within(basin.landscape, q, level / 2, units))


def _extent(basin: Basin) -> Array:
    cells = [each.place.cell for each in basin.pieces]
    return frozen(np.max([np.maximum(np.abs(each.low), np.abs(each.high)) for each in cells], axis=0))


def _units(chart: Chart, units: Sequence[float] | None) -> tuple[float, ...]:
    return (1.0,) * len(chart.q_d) if units is None else tuple(float(each) for each in units)
