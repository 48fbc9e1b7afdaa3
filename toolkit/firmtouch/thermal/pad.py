"""A pad of finite size, and its neighbours: where one dimension is not enough.

An isothermal disc of radius a on a half-space draws A e sqrt(s) + 4 k a: the first part is what one dimension has, the
second is the spreading, which dominates for metals under millimetre pads within milliseconds. Where the object is a
plate, of a `thickness` L (m) between insulated faces, images of what happens on its face, at depths of 2 n L, stand for
the far one; from alpha t = 3 L^2 on it warms evenly over its thickness, and that part is integrated in closed form.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from firmtouch.thermal.arrays import (
    Array,
    Complex,
    ThermalValueError,
    require_positive,
    require_thickness,
    require_times,
)
from firmtouch.thermal.quadrupole import port_of
from firmtouch.thermal.stack import Disc, Material

EVEN = 3.0
"""alpha t/L^2 from which a plate warms evenly over its thickness: e^(-3 pi^2) = 1e-13."""
UNFELT = 6.0
"""R / sqrt(4 alpha t) beyond which an image adds nothing: erfc(6) = 2e-17."""


def disc_admittance(material: Material, radius: float, s: ArrayLike, *, thickness: float = math.inf) -> Complex:
    """Give Y = A e sqrt(s) + 4 k a (W/K) of an isothermal disc of `radius` a (m) on a half-space, or that of a plate.

    It is exact for short and for long times. Between, the heat flow after a step is at most 6.8 % above Shoup and
    Szabo's formula. Into a plate (`plate.edge_admittance`) it is from 7.0 % below to 7.6 % above what finite volumes
    give for L/a = 0.2, 1 and 3 and alpha t/a^2 from 1e-3 to 1e2; least where the plate has just warmed through.
    """
    s = np.asarray(s, dtype=np.complex128)
    return np.asarray(math.pi * radius**2 * port_of(Disc(material, radius, thickness), s).v)


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


def _images(material: Material, thickness: float, times: Array) -> tuple[Array, Array]:
    """Give the times until which images are summed, and their depths (m), the face's 0 first; 11 are the most."""
    require_thickness(thickness)
    if math.isinf(thickness):
        return times, np.zeros(1)
    uneven = np.minimum(times, EVEN * thickness**2 / material.alpha)
    count = math.ceil(UNFELT * math.sqrt(4 * material.alpha * uneven.max(initial=0)) / (2 * thickness))
    return uneven, 2 * thickness * np.arange(count + 1)


def point_source_rise(material: Material, distance: ArrayLike, t: ArrayLike, *, thickness: float = math.inf) -> Array:
    """Give dT/Q (K/W) on the face at `distance` r (m) from a constant Q at a point, of a half-space or of a plate.

    The sum of erfc(R / sqrt(4 alpha t)) / (2 pi k R) over all images, R^2 = r^2 + (2 n L)^2 (Carslaw and Jaeger, 10.2),
    until t_0 = 3 L^2/alpha, and then of the line source's E_1(r^2 / 4 alpha t) / (4 pi k L), less its value at t_0.
    `distance` and `t` are broadcast.
    """
    from scipy.special import erfc, exp1

    times, r = require_times(t), np.asarray(distance, dtype=np.float64)
    if r.size:
        require_positive(distance=float(r.min()))
    k, four_alpha = material.conductivity, 4 * material.alpha
    uneven, depths = _images(material, thickness, times)
    R = np.hypot(r[..., np.newaxis], depths)
    each = erfc(R / np.sqrt(four_alpha * uneven)[..., np.newaxis]) / (2 * math.pi * k * R)
    risen = each[..., 0] + 2 * each[..., 1:].sum(axis=-1)
    since = exp1(r**2 / (four_alpha * times)) - exp1(r**2 / (four_alpha * uneven))
    return np.asarray(risen + since / (4 * math.pi * k * thickness))


def disc_centre_rise(material: Material, radius: float, t: ArrayLike, *, thickness: float = math.inf) -> Array:
    """Give dT/Q (K/W) at the centre of a disc that a constant Q enters evenly, of a half-space or of a plate.

    The sum of 2 sqrt(alpha t) / (k A) (ierfc(z / (2 sqrt(alpha t))) - ierfc(sqrt(z^2 + a^2) / (2 sqrt(alpha t)))) over
    all images, z = 2 n L (Carslaw and Jaeger, 10.5), until t_0 = 3 L^2/alpha; ierfc is the integral of erfc. Then the
    plate gains (1 - exp(-a^2 / 4 alpha t)) / (rho c L A) per second.
    """
    from scipy.special import erfc, exp1

    times = require_times(t)
    require_positive(radius=radius)
    area = math.pi * radius**2
    uneven, depths = _images(material, thickness, times)
    depth = np.sqrt(material.alpha * uneven)
    x = radius / (2 * depth)
    # 1/sqrt(pi) - ierfc(x), written so that small x, long times, loses no digits.
    own = -np.expm1(-(x**2)) / math.sqrt(math.pi) + x * erfc(x)

    def ierfc(u: Array) -> Array:
        return np.asarray(np.exp(-(u**2)) / math.sqrt(math.pi) - u * erfc(u))

    near = depths[1:] / (2 * depth[..., np.newaxis])
    images = (ierfc(near) - ierfc(np.hypot(near, x[..., np.newaxis]))).sum(axis=-1)
    b = radius**2 / (4 * material.alpha)

    def gained(until: Array) -> Array:
        """Integrate 1 - exp(-b/t) (s)."""
        return np.asarray(-until * np.expm1(-b / until) + b * exp1(b / until))

    since = (gained(times) - gained(uneven)) / (material.volumetric_capacity * thickness)
    return np.asarray((2 * depth / material.conductivity * (own + 2 * images) + since) / area)


def require_apart(radius: float, pitch: float) -> None:
    """Refuse pads that overlap.

    Raises
    ------
    ThermalValueError
        If their pitch is less than their diameter, or one of them is not positive.
    """
    require_positive(radius=radius, pitch=pitch)
    if pitch < 2 * radius:
        raise ThermalValueError("pitch", pitch, f"at least the pads' diameter, {2 * radius:g}")


def object_crosstalk(
    material: Material, radius: float, pitch: float, t: ArrayLike, *, thickness: float = math.inf
) -> Array:
    """Give the object's rise under the next pad's centre, of that under the pad itself, at t (s) of constant heat flow.

    Raises
    ------
    ThermalValueError
        If pads of this radius overlap at this pitch.
    """
    require_apart(radius, pitch)
    own = disc_centre_rise(material, radius, t, thickness=thickness)
    return point_source_rise(material, pitch, t, thickness=thickness) / own


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
