"""What the pads of an array feel of each other: through the object that they touch, and through their own layers.

The object carries most of it. A pad that takes heat from it leaves less for the others, so that their signals shrink.
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
from firmtouch.thermal.inversion import talbot
from firmtouch.thermal.pad import disc_centre_rise, point_source_rise, require_apart
from firmtouch.thermal.quadrupole import contact_transfer
from firmtouch.thermal.stack import Base, Disc, HalfSpace, Layer, Material, Slab, Stack, Touch

ANISOTROPY = 4.0
"""In-plane conductivity of polymer films per that across, 2 to 4 of polyimide."""
FELT = 37.0
"""e^-37 = 1e-16: decays that are summed until then."""


def array_crosstalk(
    material: Material,
    radius: float,
    pitch: float,
    t: ArrayLike,
    *,
    rows: int,
    columns: int,
    thickness: float = math.inf,
) -> Array:
    """Give the rise under the central pad's centre from all other pads of an array, of that from the pad itself.

    All have the same constant heat flow for t (s); one of the middle ones is central where their number is even. Each
    other pad is a point source, as in `object_crosstalk`, which is the array of two.

    Raises
    ------
    ThermalValueError
        If pads of this radius overlap at this pitch, or there are no rows or columns.
    """
    require_apart(radius, pitch)
    for name, count in (("rows", rows), ("columns", columns)):
        if count < 1:
            raise ThermalValueError(name, count, "at least 1")
    times = require_times(t)
    i, j = np.arange(rows) - rows // 2, np.arange(columns) - columns // 2
    squares, counts = np.unique(i[:, np.newaxis] ** 2 + j**2, return_counts=True)
    distances = pitch * np.sqrt(squares[squares > 0])
    rises = point_source_rise(material, distances, times[..., np.newaxis], thickness=thickness)
    own = disc_centre_rise(material, radius, times, thickness=thickness)
    return np.asarray(rises @ counts[squares > 0] / own)


def _by_images(g: Complex, distance: float, thickness: float, count: int) -> Complex:
    """Sum exp(-g R)/R over 2 `count` + 1 images."""
    R = np.hypot(distance, 2 * thickness * np.arange(count + 1))
    each = np.exp(-g[..., np.newaxis] * R) / R
    return np.asarray(each[..., 0] + 2 * each[..., 1:].sum(axis=-1))


def _by_modes(g: Complex, distance: float, thickness: float, count: int) -> Complex:
    """Sum the same as Fourier's series across the plate: K_0(r sqrt(g^2 + (m pi/L)^2))/L over |m| <= `count`."""
    from scipy.special import kve

    across = np.arange(count + 1) * math.pi / thickness
    x: Complex = distance * np.sqrt(g[..., np.newaxis] ** 2 + across**2)
    each = kve(0, x) * np.exp(-x)
    return np.asarray((each[..., 0] + 2 * each[..., 1:].sum(axis=-1)) / thickness)


def point_source_transfer(material: Material, distance: float, s: ArrayLike, *, thickness: float = math.inf) -> Complex:
    """Give dT/Q (K/W) on the face at `distance` r (m) from a point where Q enters: exp(-g r) / (2 pi k r).

    Of a plate of `thickness` L (m): the sum over its images, or over its modes where fewer of them count; exact both.
    """
    require_positive(distance=distance)
    require_thickness(thickness)
    s = np.asarray(s, dtype=np.complex128)
    g: Complex = np.sqrt(s / material.alpha)
    share = 2 * math.pi * material.conductivity
    if math.isinf(thickness):
        return np.asarray(np.exp(-g * distance) / (share * distance))
    found: Complex = np.empty_like(g)
    early = np.abs(g) * thickness > 1
    for some in (early, ~early):
        if not some.any():
            continue
        of, slow = g[some], float(g[some].real.min())
        images = FELT / (2 * thickness * slow) if slow > 0 else math.inf
        fast = math.hypot(FELT, float(np.abs(of).max()) * distance)
        modes = fast * thickness / (math.pi * distance)
        by, count = (_by_images, images) if images < modes else (_by_modes, modes)
        found[some] = by(of, distance, thickness, math.ceil(count))
    return found / share


def neighbour_transfer(stack: Stack, touch: Touch, distance: float, area: float, s: ArrayLike) -> Complex:
    """Give what is missing at a neighbour's sensed plane per dV, times 1/s for the step: T_c A (q''/dV) G(r).

    G is `point_source_transfer` of the object, at the `distance` r (m) between two pads of an `area` A (m2). A held
    temperature (`Base`) passes nothing on.
    """
    require_positive(distance=distance, area=area)
    s = np.asarray(s, dtype=np.complex128)
    match touch.object:
        case Base():
            return np.zeros_like(s)
        case HalfSpace(material=material):
            thickness = math.inf
        case Slab(material=material, thickness=thickness) | Disc(material=material, thickness=thickness):
            pass
    own = contact_transfer(stack, touch, s)
    return np.asarray(own.sensed * area * own.flux * point_source_transfer(material, distance, s, thickness=thickness))


def neighbour_response(stack: Stack, touch: Touch, distance: float, area: float, t: ArrayLike) -> Array:
    """Give by how much less an equal neighbour's sensed plane warms at t (s), per kelvin of this pad's T_o - T_s.

    The pad takes A q'' from the object, whose face falls by that at the neighbour; the neighbour feels this as it would
    feel a colder object. To be compared with the pad's own `ContactEvent.temperature` of 1 K. The object is linear and
    the pads are small against their `distance` (m): what the neighbour takes does not come back.
    """
    return talbot(lambda s: neighbour_transfer(stack, touch, distance, area, s) / s, t)


def substrate_crosstalk(stack: Stack, gap: float, t: ArrayLike) -> Array:
    """Give a bound on the neighbour's rise at t (s) through the layers across a `gap` (m), of the pad's own.

    The largest erfc(gap / sqrt(4 * `ANISOTROPY` alpha t)) of the layers and of what they lie on: as if one of them were
    held at 1 at the pad's rim, and lost nothing on its way. Heat that spreads around the rim, leaves through the other
    layers or never warmed the rim as much makes it less. Films of metal that join pads are not in it: `fin_crosstalk`.
    """
    from scipy.special import erfc

    times = require_times(t)
    require_positive(gap=gap)
    alphas = [each.material.alpha for each in stack.elements if isinstance(each, Layer)]
    if isinstance(stack.backing, HalfSpace):
        alphas.append(stack.backing.material.alpha)
    if not alphas:
        return np.zeros_like(times)
    return np.asarray(erfc(gap / np.sqrt(4 * ANISOTROPY * max(alphas) * times)))
