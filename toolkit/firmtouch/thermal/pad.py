"""A pad of finite size, and its neighbours: where one dimension is not enough.

An isothermal disc of radius a on a half-space draws A e sqrt(s) + 4 k a: the first part is what one dimension has, the
second is the spreading, which dominates for metals under millimetre pads within milliseconds.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from firmtouch.thermal.arrays import Array, Complex, ThermalValueError, require_positive, require_times
from firmtouch.thermal.stack import Material


def disc_admittance(material: Material, radius: float, s: ArrayLike) -> Complex:
    """Give Y = A e sqrt(s) + 4 k a (W/K) of an isothermal disc of `radius` a (m) on a half-space.

    It is exact for short and for long times, and at most 6.8 % above Shoup and Szabo's formula between.
    """
    require_positive(radius=radius)
    root: Complex = np.sqrt(np.asarray(s, dtype=np.complex128))
    return np.asarray(math.pi * radius**2 * material.effusivity * root + 4 * material.conductivity * radius)


def disc_heat_flow(material: Material, radius: float, t: ArrayLike) -> Array:
    """Give Q/dT (W/K) into a half-space at t (s) after a disc was put on it: A e / sqrt(pi t) + 4 k a."""
    times = require_times(t)
    require_positive(radius=radius)
    one_dimension = math.pi * radius**2 * material.effusivity / np.sqrt(math.pi * times)
    return np.asarray(one_dimension + 4 * material.conductivity * radius)


def shoup_szabo(tau: ArrayLike) -> Array:
    """Give Q / (4 k a dT) of an isothermal disc at tau = 4 alpha t / a^2, within 0.6 %.

    0.7854 + 0.8862 tau^-1/2 + 0.2146 exp(-0.7823 tau^-1/2) (Shoup and Szabo, J. Electroanal. Chem. 140 (1982) 237,
    where it is the current of a microdisc electrode: the same equation of diffusion).
    """
    root = np.sqrt(require_times(tau))
    return np.asarray(0.7854 + 0.8862 / root + 0.2146 * np.exp(-0.7823 / root))


def spreading_ratio(material: Material, radius: float, t: ArrayLike) -> Array:
    """Give how many times more heat a disc draws at t (s) than one dimension says, by Shoup and Szabo."""
    times = require_times(t)
    require_positive(radius=radius)
    spread = 4 * material.conductivity * radius * shoup_szabo(4 * material.alpha * times / radius**2)
    return np.asarray(spread / (math.pi * radius**2 * material.effusivity / np.sqrt(math.pi * times)))


def point_source_rise(material: Material, distance: float, t: ArrayLike) -> Array:
    """Give dT/Q (K/W) on a half-space's face at `distance` r (m) from a constant Q at a point.

    erfc(r / sqrt(4 alpha t)) / (2 pi k r) (Carslaw and Jaeger, 10.2).
    """
    from scipy.special import erfc

    times = require_times(t)
    require_positive(distance=distance)
    reached = erfc(distance / np.sqrt(4 * material.alpha * times))
    return np.asarray(reached / (2 * math.pi * material.conductivity * distance))


def disc_centre_rise(material: Material, radius: float, t: ArrayLike) -> Array:
    """Give dT/Q (K/W) at the centre of a disc that a constant Q enters evenly.

    2 sqrt(alpha t) / (k A) (1/sqrt(pi) - ierfc(a / (2 sqrt(alpha t)))) (Carslaw and Jaeger, 10.5), ierfc being the
    integral of erfc.
    """
    from scipy.special import erfc

    times = require_times(t)
    require_positive(radius=radius)
    depth = np.sqrt(material.alpha * times)
    x = radius / (2 * depth)
    # 1/sqrt(pi) - ierfc(x), written so that small x, long times, loses no digits.
    lost = -np.expm1(-(x**2)) / math.sqrt(math.pi) + x * erfc(x)
    return np.asarray(2 * depth / (material.conductivity * math.pi * radius**2) * lost)


def object_crosstalk(material: Material, radius: float, pitch: float, t: ArrayLike) -> Array:
    """Give the object's rise under the next pad's centre, of that under the pad itself, at t (s) of constant heat flow.

    Raises
    ------
    ThermalValueError
        If pads of this radius overlap at this pitch.
    """
    require_positive(radius=radius)
    if pitch < 2 * radius:
        raise ThermalValueError("pitch", pitch, f"at least the pads' diameter, {2 * radius:g}")
    return point_source_rise(material, pitch, t) / disc_centre_rise(material, radius, t)


def fin_length(material: Material, thickness: float, loss: float) -> float:
    """Give sqrt(k d / h_loss) (m): how far heat creeps along a film of thickness d (m) that loses h_loss (W/m2K)."""
    require_positive(thickness=thickness, loss=loss)
    return math.sqrt(material.conductivity * thickness / loss)


def fin_crosstalk(material: Material, thickness: float, loss: float, gap: float) -> float:
    """Give exp(-gap / fin length): the neighbour's steady rise through the film, of the pad's own."""
    require_positive(gap=gap)
    return math.exp(-gap / fin_length(material, thickness, loss))


def diffusion_length(material: Material, t: float) -> float:
    """Give sqrt(4 alpha t) (m): beyond it nothing is felt yet at t (s)."""
    require_positive(time=t)
    return math.sqrt(4 * material.alpha * t)
