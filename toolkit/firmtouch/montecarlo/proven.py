"""Starts inside a proven region of attraction [T10], on the piece of the surface that the proof is about.

The proof is about the model itself, undisturbed, under controllers (15) and (11), while the contact lasts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation import ClosedLoop
from firmtouch.regulation.graph import surface_above
from firmtouch.regulation.lyapunov import potential
from firmtouch.regulation.projection import OffSurfaceError, project
from firmtouch.simulation.scenario import Start

if TYPE_CHECKING:  # those who only run need no proofs, and start sooner without them
    from firmtouch.certificate.attraction.chart import Chart
    from firmtouch.certificate.attraction.finding import Finding
    from firmtouch.certificate.surroundings_file import SurroundingsPart

INSIDE: Final = 0.999
"""The part of a level, and of a box, that starts are drawn from: what is computed here is rounded, the proof is not."""
STEP: Final = 0.02
"""A ray is followed in such steps, in units of where p would reach the level if it were quadratic.

Around a ridge as high as the level, p is above INSIDE level over 2 sqrt(1 - INSIDE) = 0.06 of these units."""
FARTHEST: Final = 4.0
"""In the same units."""
MOST_TRIALS: Final = 1000
SHRINK: Final = 0.98
"""After each failure a box is drawn from that is smaller by this: V may be below the level near q_d alone."""
AT_REST: Final = 0.5
"""The part of the starts that are at rest."""


@dataclass(frozen=True, slots=True)
class Region:
    """V < level (J) on the surface, on the piece that `chart` joins with q_d, with |q_i - q_di| < half_width units_i.

    For a box that is proven as a `whole`, any piece of the surface inside it will do.
    """

    level: float
    chart: Chart
    half_width: float
    units: tuple[float, ...]
    whole: bool

    @property
    def words(self) -> str:
        """Say it to a reader."""
        beside = "" if self.half_width == np.inf else f" within {self.half_width:.3g} rad or m of q_d"
        return f"V < {self.level:.3g} J{beside}"

    def holds(self, q: Array) -> bool:
        """Tell whether all coordinates are inside the box."""
        reach = np.max(np.abs(q - self.chart.q_d) / np.array(self.units))
        return bool(reach <= INSIDE * self.half_width)


class NoStartError(RuntimeError):
    """No start was found inside a region."""


def regions_of_finding(finding: Finding, loop: ClosedLoop) -> tuple[Region, ...]:
    """Give the regions that a search has proven."""
    from firmtouch.certificate.attraction import WholeBox, stiffness_chart

    found = []
    if finding.attraction is not None:
        each = finding.attraction
        found.append(Region(each.level, each.chart, np.inf, each.units, whole=False))
    if finding.box is not None:
        box, chart = finding.box, stiffness_chart(loop)
        found.append(Region(box.level, chart, box.half_width, box.units, whole=isinstance(box, WholeBox)))
    return tuple(found)


def regions_of_file(part: SurroundingsPart | None, loop: ClosedLoop) -> tuple[Region, ...]:
    """Give the regions that a certificate holds; it was proven before it was written, and is believed here."""
    from firmtouch.certificate.attraction import Chart, stiffness_chart
    from firmtouch.certificate.numbers import matrix

    found = []
    if part is not None and part.attraction is not None:
        told = part.attraction
        chart = Chart(loop.operating_point.q_d, matrix(told.V1), matrix(told.V2))
        found.append(Region(told.level, chart, np.inf, tuple(told.units), whole=False))
    if part is not None and part.box is not None:
        box = part.box
        found.append(Region(box.level, stiffness_chart(loop), box.half_width, tuple(box.units), whole=True))
    return tuple(found)


def start_inside(loop: ClosedLoop, region: Region, rng: np.random.Generator) -> tuple[Start, float]:
    """Draw a start and give its V: q on the surface, q' along it (zero in half of the draws), V < level.

    Raises
    ------
    NoStartError
        If none was found.
    """
    for trial in range(MOST_TRIALS):
        q = _in_the_box(loop, region, rng, SHRINK**trial) if region.whole else _along_a_ray(loop, region, rng)
        if q is not None and region.holds(q) and potential(loop, q) < INSIDE * region.level:
            qdot, kinetic = _velocity(loop, q, INSIDE * region.level - potential(loop, q), rng)
            return Start(frozen(q), frozen(qdot)), potential(loop, q) + kinetic
    raise NoStartError(f"no start was found with {region.words}")


def _along_a_ray(loop: ClosedLoop, region: Region, rng: np.random.Generator) -> Array | None:
    """Walk from q_d along a ray of the chart while V < level, and stop somewhere: that piece is the proven one."""
    chart, plant = region.chart, loop.operating_point.plant
    frame = (chart.q_d, chart.V1, chart.V2)
    stiffness = np.diag(chart.V2.T @ loop.K @ chart.V2)
    direction = rng.normal(size=chart.free)
    ray = direction / np.linalg.norm(direction) * np.sqrt(2 * region.level / np.maximum(stiffness, 1e-12))
    walked: list[Array] = [np.zeros(chart.V1.shape[1])]
    for k in range(1, int(FARTHEST / STEP)):
        there = surface_above(plant, *frame, x1=walked[-1], x2=k * STEP * ray)
        if there is None or not region.holds(there[1]) or potential(loop, there[1]) >= INSIDE * region.level:
            break
        walked.append(there[0])
    part = rng.uniform() ** (1 / chart.free) * (len(walked) - 1)
    there = surface_above(plant, *frame, x1=walked[int(part)], x2=part * STEP * ray)
    return None if there is None else there[1]


def _in_the_box(loop: ClosedLoop, region: Region, rng: np.random.Generator, size: float) -> Array | None:
    """Draw from a box of joint coordinates, or a smaller one, and go to the surface nearby."""
    chart = region.chart
    try:
        beside = size * region.half_width * np.array(region.units) * rng.uniform(-1, 1, len(chart.q_d))
        return project(loop.operating_point.plant, chart.q_d + beside).q
    except OffSurfaceError:
        return None


def _velocity(loop: ClosedLoop, q: Array, energy: float, rng: np.random.Generator) -> tuple[Array, float]:
    """Draw a velocity along the surface uniformly from those with less kinetic energy, or zero; gives that too."""
    plant = loop.operating_point.plant
    T = np.linalg.svd(plant.J(q))[2][plant.m :].T
    direction, size, still = rng.normal(size=T.shape[1]), rng.uniform() ** (1 / T.shape[1]), rng.uniform() < AT_REST
    if still:
        return np.zeros(plant.n), 0.0
    L = np.linalg.cholesky(T.T @ plant.M(q) @ T)
    z = np.sqrt(2 * energy) * size * direction / np.linalg.norm(direction)
    return np.asarray(T @ np.linalg.solve(L.T, z)), float(z @ z / 2)
