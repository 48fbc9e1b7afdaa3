"""Superellipsoids: their level, their seams and poles, and what they are in special cases."""

import casadi as ca
import numpy as np
import pytest
from tests.mechanics.surfaces.given import SYMBOLS, Measured, surface

from firmtouch.mechanics.surfaces import bend
from firmtouch.mechanics.surfaces.superellipsoid import size_to_the

AXES = np.array([0.2, 0.3, 0.5])
EXPONENTS = [(2, 2), (4, 4), (8, 2), (4, 8), (3, 3), (2.5, 2.5), (3, 5), (32, 32), (6, 2.5)]


def made(e1, e2):
    return Measured(f"superellipsoid: {{centre: [0, 0, 0], semi_axes: {AXES.tolist()}, exponents: [{e1}, {e2}]}}")


def gauge(x, e1, e2):
    u, v, w = np.abs(x) / AXES
    return ((u**e2 + v**e2) ** (e1 / e2) + w**e1) ** (1 / e1)


@pytest.mark.parametrize(("e1", "e2"), EXPONENTS)
def test_it_is_the_level_of_its_gauge(e1, e2, rng):
    measured = made(e1, e2)
    for _ in range(4):
        direction = rng.normal(size=3)
        x = direction / gauge(direction, e1, e2)
        assert measured(x) == pytest.approx(0, abs=1e-14)
        assert np.linalg.norm(measured(x, "gradient")) == pytest.approx(1, abs=1e-12)
        assert measured(1.01 * x) > 0 > measured(0.99 * x)


def test_exponents_of_two_make_an_ellipsoid(rng):
    ellipsoid = Measured(f"ellipsoid: {{centre: [0, 0, 0], semi_axes: {AXES.tolist()}}}")
    for x in 0.4 * rng.normal(size=(5, 3)):
        for what in ("s", "gradient", "hessian", "normal"):
            assert made(2, 2)(x, what) == pytest.approx(ellipsoid(x, what), rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("e", [2.0, 2.2, 2.5, 3.0, 3.5, 4.0, 5.0, 7.0, 8.0, 31.5])
def test_a_power_has_two_derivatives_at_its_seam(e):
    """|t|^e, e |t|^(e-1) sign t, e (e-1) |t|^(e-2), at the seam itself and on both sides of it."""
    t = ca.SX.sym("t")
    value = size_to_the(t, e)
    slope = ca.gradient(value, t)
    function = ca.Function("f", [t], [ca.vertcat(value, slope, ca.gradient(slope, t))])
    for at in (0.0, 1e-320, 1e-80, -1e-12, 1e-3, -0.7, 1.3):
        size = abs(at)
        expected = [size**e, e * size ** (e - 1) * np.sign(at), e * (e - 1) * size ** (e - 2)]
        assert function(at).full().ravel() == pytest.approx(expected, rel=1e-12, abs=1e-18)


def test_even_powers_are_polynomials():
    """No comparison, no root, no logarithm: nothing but the outermost root stands between proofs and a box."""
    x = ca.SX.sym("x", 3)
    spec = surface("superellipsoid: {centre: [0, 0, 0], semi_axes: [r, d, 1], exponents: [8, 4]}")
    at_x = bend(spec, x, SYMBOLS)
    function = ca.Function("f", [x, SYMBOLS.p], [at_x.value, at_x.gradient, at_x.hessian])
    codes = [function.instruction_id(k) for k in range(function.n_instructions())]
    assert ca.OP_LT not in codes
    powers = {ca.OP_POW, ca.OP_CONSTPOW, ca.OP_SQRT}
    assert 0 < sum(code in powers for code in codes) < 12


@pytest.mark.parametrize(("e1", "e2"), [each for each in EXPONENTS if each != (2, 2)])
@pytest.mark.parametrize("place", ["seam", "equator", "pole"])
def test_flat_places_have_the_curvatures_of_their_neighbours(e1, e2, place):
    """On a seam the second derivatives exist: what is measured there is the limit from beside it."""
    direction = {"seam": [0, 1, 1], "equator": [1, 1, 0], "pole": [0, 0, 1]}[place]
    aside = {"seam": [1, 0, 0], "equator": [0, 0, 1], "pole": [1, 0.5, 0]}[place]
    measured = made(e1, e2)
    on = np.array(direction) / gauge(np.array(direction), e1, e2)
    at = measured.curvatures(on)
    assert np.all(np.isfinite(at))
    nearer = []
    for way in (1e-4, 1e-6, 1e-8):
        x = np.array(direction) + way * np.array(aside)
        nearer.append(np.abs(measured.curvatures(x / gauge(x, e1, e2)) - at).max())
    # |t|^(e - 2) with the smallest e - 2 = 1/2: a hundredth of the way makes a tenth of what is missing.
    assert nearer[2] <= max(0.15 * nearer[1], 1e-7)
    assert nearer[1] <= max(0.15 * nearer[0], 1e-7)


def test_a_pole_without_a_second_derivative_is_no_number():
    assert not np.all(np.isfinite(made(2, 4)([0, 0, 0.5], "hessian")))


def test_large_exponents_make_a_box():
    """A body with exponents 32 leaves the box of its semi-axes by nothing, and its faces are nearly flat."""
    measured = made(32, 32)
    face = np.array([0.2, 0.1, 0.1])
    assert measured(face) == pytest.approx(0, abs=1e-10)
    assert measured.curvatures(face) == pytest.approx([0, 0], abs=1e-4)
    assert measured(0.99 * AXES) > 0
