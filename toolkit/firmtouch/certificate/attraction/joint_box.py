"""The box of joint coordinates on which the conditions of [T10] are proven."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import flint
import numpy as np

from firmtouch.certificate.attraction.attraction import BITS, NotProvenError, Search, explored
from firmtouch.certificate.attraction.chart import stiffness_chart
from firmtouch.certificate.attraction.proof import Limit
from firmtouch.certificate.attraction.reach import level_outside
from firmtouch.regulation import ClosedLoop

WIDEST: Final = 2.0
MOST_CELLS: Final = 400
LEVEL_CELLS: Final = 300
SHRINK: Final = 0.85
MOST_TRIALS: Final = 4


@dataclass(frozen=True, slots=True)
class JointBox:
    """On |q_i - q_di| <= half_width units_i the conditions of [T10] are proven, with p >= level (J) on its boundary.

    They are proven for that part of the surface that is connected with q* inside the box.
    """

    half_width: float
    level: float
    units: tuple[float, ...]
    limit: Limit
    cells: int


def find_joint_box(
    loop: ClosedLoop,
    *,
    units: Sequence[float] | None = None,
    at_most: float = np.inf,
    most_cells: int = MOST_CELLS,
) -> JointBox:
    """Grow a box of joint coordinates until another equilibrium, the chart or the number of cells ends it.

    Raises
    ------
    NotProvenError
        If none with a positive level is proven.
    """
    chart = stiffness_chart(loop)
    u = (1.0,) * len(chart.q_d) if units is None else tuple(float(each) for each in units)
    with flint.ctx.workprec(BITS):
        basin = explored(loop, chart, Search((WIDEST,) * chart.free, most_cells), at_most=at_most, units=u)
        half_width = basin.bound
        for _ in range(MOST_TRIALS):
            level = level_outside(basin, half_width, u, LEVEL_CELLS)
            if level > 0:
                return JointBox(half_width, level, u, basin.limit, basin.cells)
            half_width *= SHRINK
    raise NotProvenError(f"p > 0 on the boundary of a box of joint coordinates, with {basin.cells} cells")
