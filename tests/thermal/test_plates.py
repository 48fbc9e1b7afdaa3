"""A plate that is touched on a disc: against finite volumes, dual integral equations, and the limits that are known."""

import math

import numpy as np
import pytest
import scipy.sparse
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.sparse.linalg import splu
from scipy.special import erfc, kve, spherical_jn

from firmtouch.thermal import (
    Disc,
    HalfSpace,
    Material,
    Slab,
    ThermalValueError,
    disc_admittance,
    disc_centre_rise,
    euler,
    object_impedance,
    point_source_rise,
    talbot,
)
from firmtouch.thermal.pad import EVEN, shoup_szabo
from firmtouch.thermal.plate import constriction

UNIT = Material("unit", 1.0, 1.0, 1.0)
"""With a = 1 m too, t is alpha t/a^2 and Y is Y/(k a)."""
RATIOS = st.floats(math.log(1e-3), math.log(1e3)).map(math.exp)


def flow(ratio, t):
    return talbot(lambda s: disc_admittance(UNIT, 1.0, s, thickness=ratio) / s, t)


def growing(first, growth, end):
    """Cut a length into cells that grow from its beginning."""
    count = math.ceil(math.log1p(end * (growth - 1) / first) / math.log(growth))
    edges = np.cumsum(np.concatenate([[0], first * growth ** np.arange(count)]))
    return edges * (end / edges[-1])


def conduction(ratio, finest, growth, reach):
    """Give capacities, what leaves each cell per degree of the others, and what enters from the disc at 1 K."""
    r = np.concatenate([1 - growing(finest, growth, 1.0)[::-1], 1 + growing(finest, growth, reach)[1:]])
    z = growing(finest, growth, ratio)
    middle, deep, ring = (r[1:] + r[:-1]) / 2, (z[1:] + z[:-1]) / 2, np.pi * np.diff(r**2)
    cell = np.arange(ring.size * deep.size).reshape(ring.size, deep.size)
    outward = (2 * np.pi * r[1:-1] / np.diff(middle))[:, None] * np.diff(z)
    inward = ring[:, None] / np.diff(deep)
    one = np.concatenate([cell[:-1].ravel(), cell[:, :-1].ravel()])
    other = np.concatenate([cell[1:].ravel(), cell[:, 1:].ravel()])
    G = np.concatenate([outward.ravel(), inward.ravel()])
    A = scipy.sparse.coo_array((G, (one, other)), shape=(cell.size, cell.size))
    A = (A + A.T).tocsc()
    entering = np.zeros(cell.size)
    entering[cell[:, 0]] = np.where(middle < 1, 2 * ring / z[1], 0)
    return (
        (ring[:, None] * np.diff(z)).ravel(),
        scipy.sparse.diags_array(A.sum(axis=1) + entering).tocsc() - A,
        entering,
    )


def finite_volumes(ratio, *, finest=1e-3, growth=1.1, last=100.0, steps=24):
    """Integrate by an L-stable method of two stages and second order, in steps that grow; give times and Q(t)."""
    capacity, K, entering = conduction(ratio, finest, growth, 12 * math.sqrt(last))  # erfc(6) of the face at its end
    gamma, h, t, T = 1 - math.sqrt(0.5), 1e-3 / steps / 32, 0.0, np.zeros(capacity.size)
    times, flows = [], []
    while t < last:
        solve = splu((scipy.sparse.diags_array(capacity) + gamma * h * K).tocsc(), "MMD_AT_PLUS_A").solve
        for _ in range(steps):
            first = solve(entering - K @ T)
            second = solve(entering - K @ (T + (1 - gamma) * h * first))
            T = T + h * ((1 - gamma) * first + gamma * second)
            t += h
        times.append(t)
        flows.append(entering @ (1 - T))
        h *= 1.5
    shown = np.array(times) > 1e-3
    return np.array(times)[shown], np.array(flows)[shown]


@pytest.mark.slow
def test_finite_volumes_against_shoup_and_szabo():
    """A plate of 60 a is a half-space until 100 a^2/alpha: the image at its back's depth is e^-36 of it."""
    t, found = finite_volumes(60.0)
    assert found == pytest.approx(4 * shoup_szabo(4 * t), rel=9e-3)  # their fit's 0.6 %, and ours


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ratio", "below", "above"), [(0.2, -0.052, 0.044), (1.0, -0.070, 0.076), (3.0, -0.061, 0.073)]
)
def test_plate_against_finite_volumes(ratio, below, above):
    """Its own error is of first order in the cells at the disc's edge, where the flux is infinite."""
    t, fine = finite_volumes(ratio)
    coarse, coarser = (finite_volumes(ratio, finest=each)[1] for each in (2e-3, 4e-3))
    assert np.abs(coarse / fine - 1).max() < 2e-3  # as much again is left
    assert np.abs(coarser / coarse - 1).max() > np.abs(coarse / fine - 1).max()
    excess = flow(ratio, t) / fine - 1
    assert excess.min() == pytest.approx(below, abs=2e-3)
    assert excess.max() == pytest.approx(above, abs=2e-3)


@pytest.fixture(scope="module")
def dual_integrals():
    """Solve the mixed problem by Galerkin's method: flux sum c_n P_2n(sqrt(1 - r^2))/sqrt(1 - r^2) on the disc.

    Its Hankel transforms are (-1)^n j_2n(x); what is left of the plate's coth(q L) x/q after the half-space's steady
    part, 1, dies as x^-2.
    """
    edges = np.concatenate([[0], np.geomspace(1e-5, 1, 24), np.arange(2.0, 150.0)])
    nodes, weights = np.polynomial.legendre.leggauss(6)
    half = np.diff(edges)[:, None] / 2
    x = ((edges[1:] + edges[:-1])[:, None] / 2 + half * nodes).ravel()
    n = np.arange(10)
    J = np.array([(-1.0) ** i * spherical_jn(2 * i, x) for i in n])
    weighted = J * (half * weights).ravel()

    def admittance(ratio, s):
        q = np.sqrt(x**2 + s)
        Z = (weighted * (x / q / np.tanh(q * ratio) - 1)) @ J.T + np.diag(math.pi / 2 / (4 * n + 1))
        return 2 * math.pi * np.linalg.inv(Z)[0, 0]

    return admittance


def test_dual_integral_equations_of_a_half_space(dual_integrals):
    """A slow s is a sphere's of the radius 2 a/pi, its capacity: Y = 4 k a (1 + 2 g a/pi), and then (g a)^2."""
    assert dual_integrals(math.inf, 1e-6) == pytest.approx(4 * (1 + 2e-3 / math.pi), rel=1e-7)


def test_plate_against_dual_integral_equations(dual_integrals):
    """At s = 1e-4 to 1e2 alpha/a^2: from 3.0 % below to 5.8 % above, as the transform smears what time has."""
    s, excess = np.logspace(-4, 2, 13), []
    for ratio in (0.05, 0.2, 0.5, 1.0, 3.0, 10.0):
        exact = [dual_integrals(ratio, each) for each in s]
        excess.append(disc_admittance(UNIT, 1.0, s, thickness=ratio).real / exact - 1)
    assert np.min(excess) == pytest.approx(-0.030, abs=5e-4)
    assert np.max(excess) == pytest.approx(0.058, abs=5e-4)


@pytest.mark.parametrize("ratio", [0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0])
def test_steady_constriction(dual_integrals, ratio):
    y = 1e-4  # g a, of which the next term is y^2 ln y
    fin = kve(0, y) / (2 * math.pi * ratio * y * kve(1, y))
    assert constriction(ratio) == pytest.approx(1 / dual_integrals(ratio, y**2) - fin, rel=3e-3)


def test_constriction_of_a_strip_and_of_a_half_space():
    """ln 2/pi^2 is the edge of a strip by conformal mapping, 2 L ln 2/pi of its length, over 2 pi a L."""
    assert constriction(1e-6) == pytest.approx(math.log(2) / math.pi**2, abs=1e-6)
    assert constriction(1e6) == pytest.approx(0.25 - (math.log(4e6) - np.euler_gamma) / (2e6 * math.pi), rel=1e-9)


def test_a_thick_plate_is_a_half_space():
    """To all digits of Talbot's sum while its back is not felt, g L > 100."""
    t = np.logspace(-3, 2, 11)
    assert flow(1e3, t) == pytest.approx(flow(math.inf, t), rel=1e-11)


def test_a_thin_plate_is_a_radial_fin_in_the_end():
    """What the fin and the disc's own capacity lack is the constriction, 0.07 of more than 110 1/(k a)."""
    ratio, s = 1e-3, np.logspace(-8, 0, 9)
    y = np.sqrt(s)
    fin = 2 * math.pi * ratio * y * kve(1, y) / kve(0, y) + math.pi * s * ratio
    found = disc_admittance(UNIT, 1.0, s, thickness=ratio)
    assert found.real == pytest.approx(fin, rel=0.07 / 110)


def test_a_wide_disc_is_one_dimension(m):
    """The edge's part dies as 1/a, and as 1/(g a) on any disc at short times."""
    s = np.logspace(-2, 4, 13) * (1 + 1j)
    slab = object_impedance(Slab(m.glass, 2e-3), s)
    wide, wider = (np.abs(object_impedance(Disc(m.glass, a, 2e-3), s) / slab - 1) for a in (1e3, 1e4))
    assert wide.max() < 2e-5  # 2/(g a), g = 137/m and more
    assert wider == pytest.approx(wide / 10, rel=1e-3)
    fast = 1e10 / 0.5e-3**2 * m.glass.alpha  # g a = 1e5
    short = HalfSpace(m.glass), Disc(m.glass, 0.5e-3, 1e-3)
    of_all, of_disc = (object_impedance(each, fast) for each in short)
    assert of_all / of_disc - 1 == pytest.approx(4e-5 / math.pi, rel=1e-4)


def test_a_plate_draws_nothing_in_the_end():
    with np.errstate(all="raise", under="ignore"):
        assert disc_admittance(UNIT, 1.0, 0.0, thickness=0.5) == 0
        assert np.isfinite(disc_admittance(UNIT, 1.0, [1e-30, 1e30], thickness=0.5)).all()


@settings(max_examples=40)
@given(RATIOS)
def test_talbot_is_right_on_a_plate(ratio):
    """Bessel's branch cut lies where Talbot's contour does not go: Euler's sum, to the right of it, gives the same."""
    t = np.logspace(-4, 4, 9) * min(1, ratio) ** 2
    found = flow(ratio, t)
    other = euler(lambda s: disc_admittance(UNIT, 1.0, s, thickness=ratio) / s, t)
    # Euler's ten digits are of what one dimension draws while the plate fills, pi/L.
    assert found == pytest.approx(other, rel=1e-8, abs=1e-9 * math.pi / min(1, ratio))
    assert (np.diff(found) < 0).all()


@settings(max_examples=40)
@given(RATIOS)
def test_a_plate_is_passive_and_warms_without_oscillating(ratio):
    """Re Y > 0 on the imaginary axis; Im Y grows with Im s, as of all that only resists and stores."""
    omega = np.geomspace(1e-6, 1e8, 200) / max(1, ratio) ** 2
    Y = disc_admittance(UNIT, 1.0, 1j * omega, thickness=ratio)
    assert (Y.real > 0).all()
    assert (Y.imag > 0).all()


@pytest.mark.parametrize("wrong", [0.0, -1e-3, math.nan])
def test_plates_of_no_thickness_are_refused(m, wrong):
    for make in (
        lambda: Disc(m.glass, 1e-3, wrong),
        lambda: point_source_rise(m.glass, 1e-3, 1.0, thickness=wrong),
        lambda: disc_centre_rise(m.glass, 1e-3, 1.0, thickness=wrong),
    ):
        with pytest.raises(ThermalValueError, match=r"thickness is .*`inf` is a half-space"):
            make()
    with pytest.raises(ThermalValueError, match="distance"):
        point_source_rise(m.glass, [1e-3, 0.0], 1.0)


@pytest.mark.parametrize("t", [0.1, EVEN, 3.01, 1e3])
@pytest.mark.parametrize("r", [0.05, 0.7, 20.0])
def test_point_source_is_all_its_images(r, t):
    """Before and after the even part is integrated in closed form; 600 images are erfc(19) at 1e3 L^2/alpha."""
    R = np.hypot(r, 2 * np.arange(-600, 601))
    expected = (erfc(R / math.sqrt(4 * t)) / R).sum() / (2 * math.pi)
    assert point_source_rise(UNIT, r, t, thickness=1.0) == pytest.approx(expected, rel=1e-11, abs=1e-25)


def test_far_from_a_point_a_plate_is_a_sheet():
    """A line source, E_1/(4 pi k L), where r is tens of L: quadrature of the heat that has passed."""
    t, r = 1e4, 30.0
    expected = quad(lambda u: math.exp(-(r**2) / 4 / u) / u, 0, t, epsabs=0, epsrel=1e-12)[0] / (4 * math.pi)
    assert point_source_rise(UNIT, r, t, thickness=1.0) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("t", [0.1, EVEN, 3.01, 1e3])
@pytest.mark.parametrize("radius", [0.2, 5.0])
def test_disc_is_the_points_that_it_is_made_of(radius, t):
    """Quadrature over its area, of a plate's; the point's own 1/r cancels with the ring's length."""
    found = quad(lambda r: 2 * r * float(point_source_rise(UNIT, r, t, thickness=1.0)), 0, radius, epsrel=1e-11)[0]
    assert disc_centre_rise(UNIT, radius, t, thickness=1.0) == pytest.approx(found / radius**2, rel=1e-9)


def test_a_wide_heated_disc_is_a_heated_slab():
    """t/(rho c L) + L/(3 k) per flux once the slab is even: the edge, at a = 400 sqrt(alpha t), is e^-10000."""
    for t in (5.0, 50.0):
        found = disc_centre_rise(UNIT, 3e3, t, thickness=1.0) * math.pi * 3e3**2
        assert found == pytest.approx(t + 1 / 3, rel=1e-12)


@settings(max_examples=30)
@given(RATIOS, st.floats(-3, 3))
def test_thinner_plates_warm_more(ratio, exponent):
    t = 10**exponent
    for rise in (
        lambda L: point_source_rise(UNIT, 1.0, t, thickness=L),
        lambda L: disc_centre_rise(UNIT, 1.0, t, thickness=L),
    ):
        thin, thick, endless = (float(rise(L)) for L in (ratio, 1.5 * ratio, math.inf))
        assert thin * (1 + 1e-12) >= thick
        assert thick * (1 + 1e-12) >= endless
    assert disc_centre_rise(UNIT, 1.0, t, thickness=1e3) == pytest.approx(disc_centre_rise(UNIT, 1.0, t), rel=1e-2)
