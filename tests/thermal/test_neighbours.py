"""What the pads of an array feel of each other, against superposition, convolution, and closed forms."""

import itertools
import math
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import erfc

from firmtouch.thermal import (
    Base,
    ContactEvent,
    Disc,
    Film,
    HalfSpace,
    Material,
    Slab,
    Stack,
    ThermalValueError,
    Touch,
    array_crosstalk,
    contact_transfer,
    disc_centre_rise,
    neighbour_response,
    neighbour_transfer,
    object_crosstalk,
    point_source_rise,
    point_source_transfer,
    step,
    substrate_crosstalk,
    talbot,
)

RADIUS, PITCH = 0.5e-3, 2e-3
AREA = math.pi * RADIUS**2
T = np.array([1e-3, 1e-2, 0.1, 1.0])
UNIT = Material("unit", 1.0, 1.0, 1.0)
SIZES = st.floats(math.log(1e-2), math.log(1e2)).map(math.exp)


@pytest.mark.parametrize("thickness", [math.inf, 1e-3])
def test_an_array_of_two_is_a_pair(m, thickness):
    pair = object_crosstalk(m.copper, RADIUS, PITCH, T, thickness=thickness)
    for rows, columns in ((1, 2), (2, 1)):
        found = array_crosstalk(m.copper, RADIUS, PITCH, T, rows=rows, columns=columns, thickness=thickness)
        assert found == pytest.approx(pair, rel=1e-14)
    assert (array_crosstalk(m.copper, RADIUS, PITCH, T, rows=1, columns=1, thickness=thickness) == 0).all()


@pytest.mark.parametrize("thickness", [math.inf, 1e-3])
@pytest.mark.parametrize(
    ("rows", "columns", "middle"), [(3, 5, (1, 2)), (4, 2, (2, 1)), (4, 2, (1, 0)), (20, 20, (9, 10))]
)
def test_all_neighbours_add_up(m, thickness, rows, columns, middle):
    """One by one, around any of the middle pads."""
    t, expected = 0.1, 0.0
    for place in itertools.product(range(rows), range(columns)):
        if place != middle:
            r = PITCH * math.dist(place, middle)
            expected += float(point_source_rise(m.copper, r, t, thickness=thickness))
    expected /= float(disc_centre_rise(m.copper, RADIUS, t, thickness=thickness))
    found = array_crosstalk(m.copper, RADIUS, PITCH, t, rows=rows, columns=columns, thickness=thickness)
    assert found.shape == ()
    assert found == pytest.approx(expected, rel=1e-12)


def test_arrays_on_copper(m):
    """Of 20 x 20 pads the others are 14 % at 10 ms, and more than the own one from 0.1 s on; in a plate still more."""
    t = [10e-3, 0.1]
    found = array_crosstalk(m.copper, RADIUS, PITCH, t, rows=20, columns=20)
    assert found == pytest.approx([0.140, 1.113], abs=5e-4)
    assert (found > 4 * object_crosstalk(m.copper, RADIUS, PITCH, t)).all()
    assert (array_crosstalk(m.copper, RADIUS, PITCH, t, rows=20, columns=20, thickness=1e-3) > found).all()


def test_a_large_array_heats_as_one_dimension(m):
    """The sum over a square lattice of erfc(r/d)/r, without r = 0, is 2 sqrt(pi) d - 3.90026492 + 2/(sqrt(pi) d).

    The first is a flux of Q/pitch^2 everywhere; the second is the lattice's constant (Ewald), and 161 pads reach 6 d.
    """
    d, n = 12.0, 161
    t = (d * PITCH) ** 2 / (4 * m.copper.alpha)
    rise = array_crosstalk(m.copper, RADIUS, PITCH, t, rows=n, columns=n) * disc_centre_rise(m.copper, RADIUS, t)
    expected = 2 * math.sqrt(math.pi) * d - 3.90026492 + 2 / (math.sqrt(math.pi) * d)
    assert rise * 2 * math.pi * m.copper.conductivity * PITCH == pytest.approx(expected, rel=3e-10)  # digits given


@pytest.mark.parametrize(("name", "rows", "columns"), [("rows", 0, 3), ("columns", 3, -1)])
def test_arrays_of_nothing_are_refused(m, name, rows, columns):
    with pytest.raises(ThermalValueError, match=f"{name} is .*at least 1"):
        array_crosstalk(m.copper, RADIUS, PITCH, T, rows=rows, columns=columns)
    with pytest.raises(ThermalValueError, match="pads' diameter"):
        array_crosstalk(m.copper, RADIUS, RADIUS, T, rows=3, columns=3)


@settings(max_examples=40)
@given(SIZES, SIZES)
def test_point_source_is_the_same_in_both_domains(r, L):
    t = np.logspace(-3, 3, 7)
    for thickness in (L, math.inf):
        found = step(partial(point_source_transfer, UNIT, r, thickness=thickness), t)
        rise = point_source_rise(UNIT, r, t, thickness=thickness)
        # Talbot's error is of what the nodes see, e^{-2 r/sqrt(t)} and more; a point's steady rise is 1/(2 pi r).
        assert found == pytest.approx(rise, rel=1e-9, abs=1e-12 / r)


@settings(max_examples=40)
@given(SIZES, st.floats(-3.4, 6), st.floats(0, 2.4))
def test_images_and_modes_are_one_sum(r, exponent, angle):
    """Poisson's: 6001 images, of which the last are e^-43 or less, for s in the sector of Talbot's nodes."""
    s = 10**exponent * np.exp(1j * angle)
    g = np.sqrt(s)
    R = np.hypot(r, 2 * np.arange(-3000, 3001))
    expected = (np.exp(-g * R) / R).sum() / (2 * math.pi)
    assert point_source_transfer(UNIT, r, s, thickness=1.0) == pytest.approx(expected, rel=1e-11)


def test_two_half_spaces_have_a_neighbour_in_closed_form(m):
    """Perfect contact: T_c = e_o/(e_s+e_o), q'' = e_s T_c sqrt(s), so A e_s T_c^2/(2 pi k r) exp(-r^2/4 at)/sqrt(pi t)."""
    stack = Stack((), sensed=0, backing=HalfSpace(m.pdms))
    touch = Touch(HalfSpace(m.copper), math.inf)
    T_c = m.copper.effusivity / (m.pdms.effusivity + m.copper.effusivity)
    scale = AREA * m.pdms.effusivity * T_c**2 / (2 * math.pi * m.copper.conductivity * PITCH)
    expected = scale * np.exp(-(PITCH**2) / (4 * m.copper.alpha * T)) / np.sqrt(math.pi * T)
    assert neighbour_response(stack, touch, PITCH, AREA, T) == pytest.approx(expected, rel=1e-9, abs=1e-11 * scale)


def convolved(f, g, t, count):
    """Integrate f(u) g(t - u) over 0 < u < t (any shape) by Gauss's nodes in x, u = t (3 x^2 - 2 x^3)."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    x, t = (nodes + 1) / 2, np.asarray(t)[..., np.newaxis]
    return (f(t * x**2 * (3 - 2 * x)) * g(t * (1 - x) ** 2 * (1 + 2 * x)) * 3 * t * x * (1 - x)) @ weights


@pytest.mark.parametrize("thickness", [math.inf, 1e-3])
@pytest.mark.parametrize(("design", "t"), [("D1", 0.2), ("D3", 0.05)])
def test_neighbour_is_a_convolution(m, designs, thickness, design, t):
    """In time: what flows cools the neighbour's place by instants, and of that it feels its own impulse response."""
    stack, touched = (
        getattr(designs, design),
        HalfSpace(m.copper) if math.isinf(thickness) else Slab(m.copper, thickness),
    )
    touch, alpha = Touch(touched, 1e4), m.copper.alpha
    R = PITCH if math.isinf(thickness) else np.hypot(PITCH, 2 * thickness * np.arange(-20, 21))

    def instant(u):
        """Give what a joule at a point of the face makes of the temperature there after u: a half-space's, images added."""
        spread = np.exp(-(np.atleast_1d(R) ** 2) / (4 * alpha * u[..., np.newaxis])).sum(axis=-1)
        return spread / (4 * (math.pi * alpha * u) ** 1.5 * m.copper.volumetric_capacity)

    def felt(u):
        return talbot(lambda s: contact_transfer(stack, touch, s).sensed, u)

    def missing(u):
        return AREA * convolved(ContactEvent(stack, touch, 1.0).flux, instant, u, 64)

    found = neighbour_response(stack, touch, PITCH, AREA, t)
    assert found == pytest.approx(convolved(felt, missing, t, 128), rel=1e-6)  # 4e-7 left, of 2e-6 with 96


def test_neighbour_feels_nothing_yet(m, designs):
    """Glass in a millisecond: r^2/4 alpha t = 1300, of which Talbot's nodes see e^-140 and less."""
    found = neighbour_response(designs.D3, Touch(HalfSpace(m.glass), 1e4), PITCH, AREA, [1e-4, 1e-3])
    assert np.abs(found).max() < 1e-25
    assert (neighbour_response(designs.D3, Touch(Base(), 1e4), PITCH, AREA, T) == 0).all()


def test_neighbour_of_a_thick_plate_is_that_of_a_half_space(m, designs):
    thick, endless = (
        neighbour_response(designs.D3, Touch(Disc(m.copper, RADIUS, L), 1e4), PITCH, AREA, T) for L in (2.0, math.inf)
    )
    assert thick == pytest.approx(endless, rel=1e-9)
    thin = neighbour_response(designs.D3, Touch(Disc(m.copper, RADIUS, 1e-3), 1e4), PITCH, AREA, T)
    assert (thin[1:] > endless[1:]).all()


@settings(max_examples=20)
@given(SIZES)
def test_neighbour_grows_with_the_area_and_stays_below_the_object(scale):
    """Linear in A; and the place's own fall, A q'' G, is all that there is to feel: |T_c| < 1 on the positive axis."""
    stack = Stack((Film(10.0),), sensed=0, backing=HalfSpace(UNIT))
    s = np.logspace(-3, 3, 13)
    touch = Touch(Slab(UNIT, 0.3), 5.0)
    one, more = (neighbour_transfer(stack, touch, 2.0, area, s).real for area in (0.1, 0.1 * scale))
    assert more == pytest.approx(scale * one, rel=1e-13)
    place = 0.1 * contact_transfer(stack, touch, s).flux * point_source_transfer(UNIT, 2.0, s, thickness=0.3)
    assert (one > 0).all()
    assert (one < place.real).all()


def test_layers_carry_little_to_the_neighbour(m, designs):
    """Of D3's layers the foam is the quickest; a half-space behind counts too."""
    alpha = max(each.alpha for each in (m.parylene, m.kapton, m.foam))
    found = substrate_crosstalk(designs.D3, 1e-3, T)
    assert found == pytest.approx(erfc(1e-3 / np.sqrt(16 * alpha * T)), rel=1e-13)
    assert found[1] < 1e-12
    assert (np.diff(found) > 0).all()
    behind = substrate_crosstalk(designs.D4, 1e-3, 1.0)
    assert behind == pytest.approx(erfc(1e-3 / math.sqrt(16 * m.pdms.alpha)), rel=1e-13)
    assert substrate_crosstalk(Stack((Film(3.0),), 0, Base()), 1e-3, 1.0) == 0
    with pytest.raises(ThermalValueError, match="gap"):
        substrate_crosstalk(designs.D3, 0.0, 1.0)


@settings(max_examples=20)
@given(SIZES, st.floats(-2, 1))
def test_the_bound_is_above_what_a_heated_disc_does(gap, exponent):
    """A plane beside a disc of radius 1 has nowhere more than where it is next to it, and that only rises.

    So what lies behind the plane stays below erfc, by the maximum principle. The layer conducts four times better along,
    which is a half-space of four times the diffusivity.
    """
    t = 10**exponent
    nodes, weights = np.polynomial.legendre.leggauss(24)
    radii, angles = (nodes + 1) / 2, np.pi * (nodes + 1) / 2

    def beside(r):
        distance = np.sqrt(r**2 + radii[:, None] ** 2 - 2 * r * radii[:, None] * np.cos(angles))
        return float(((point_source_rise(Material("quick", 1.0, 1.0, 0.25), distance, t) @ weights) * radii) @ weights)

    bound = float(substrate_crosstalk(Stack((), 0, HalfSpace(UNIT)), gap, t))
    assert beside(1.2 + gap) <= beside(1.2) * bound * (1 + 1e-6)  # of 24 nodes a way of 0.2 off
