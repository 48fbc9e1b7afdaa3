"""A bead: how fast heat reaches the inside of a small sphere, whatever holds its surface."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from firmtouch.thermal.arrays import Complex, require_positive
from firmtouch.thermal.stack import Material

MEAN_RISE = 0.1820638
"""t_10-90 alpha/a^2 of a sphere's mean temperature after its surface steps."""
SERIES_BELOW, SERIES = 0.1, (1, -1 / 15, 2 / 315, -1 / 1575, 2 / 31185)
"""Of |x|, and the mean in powers of x^2: below, the closed form loses digits and the series has them all."""


class SphereTransfer(NamedTuple):
    """Temperatures of a sphere's centre and mean, per that of its surface."""

    centre: Complex
    mean: Complex


def sphere_transfer(material: Material, radius: float, s: ArrayLike) -> SphereTransfer:
    """Give x/sinh x and 3 (x coth x - 1)/x^2 with x = a sqrt(s/alpha), `radius` a (m) (Carslaw and Jaeger, 9.3).

    Without overflow at any s off the negative real axis, and 1 at s = 0.
    """
    require_positive(radius=radius)
    root: Complex = np.sqrt(np.asarray(s, dtype=np.complex128) / material.alpha)
    x: Complex = radius * root
    rest = x == 0
    y: Complex = np.where(rest, 1, x)
    decay: Complex = np.exp(-y)
    lost: Complex = -np.expm1(-2 * y)
    centre: Complex = np.where(rest, 1, 2 * y * decay / lost)
    small = np.abs(x) < SERIES_BELOW
    series: Complex = np.polynomial.polynomial.polyval(np.where(small, x, 0) ** 2, SERIES)
    mean: Complex = np.where(small, series, 3 * (y * (2 - lost) / lost - 1) / y / y)
    return SphereTransfer(centre, mean)


def diffusion_floor(material: Material, radius: float) -> float:
    """Give the 10-90 % rise time (s) of the mean temperature, 0.182 a^2/alpha: no mounting makes a bead faster."""
    require_positive(radius=radius)
    return MEAN_RISE * radius**2 / material.alpha
