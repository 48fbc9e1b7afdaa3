"""Height fields: they meet their data, are C^2, agree with scipy's splines, and say where they end."""

import casadi as ca
import numpy as np
import pytest
from scipy.interpolate import RectBivariateSpline, make_interp_spline
from tests.mechanics.surfaces.given import HEIGHTS, SURFACES, SYMBOLS, Measured, P, rotation, surface

from firmtouch.mechanics.surfaces import bend, inside_domain, normal, signed_distance
from firmtouch.mechanics.surfaces.height_field import Heights
from firmtouch.mechanics.surfaces.spline import basis, coefficients

ROUNDING = 1e-12  # of values of size one, divided by up to three steps of the grid
X, Y = np.linspace(-1, 0.8, 7), np.linspace(-0.1, 0.9, 5)


def spline(values):
    """Give a function from t to the spline's value and its first three derivatives by t."""
    t = ca.SX.sym("t")
    c = ca.DM(coefficients(np.array(values, dtype=float)))
    outputs = ca.vertcat(*(ca.dot(c, each) for each in basis(t, len(values))))
    function = ca.Function("spline", [t], [outputs])
    return lambda at: function(at).full().ravel()


def heights(text):
    """Give a function from a point of the frame and orders to a partial derivative of h."""
    y = ca.SX.sym("y", 3)
    h = Heights(surface(text).shape, y, SYMBOLS)
    orders = [(a, b) for a in range(4) for b in range(4)]
    function = ca.Function("h", [y, SYMBOLS.p], [ca.vertcat(*(h(a, b) for a, b in orders))])
    return lambda u, v, a=0, b=0: function([u, v, 0], P).full()[orders.index((a, b))].item()


FIELD = f"height_field: {{x: [-1, 0.8], y: [-d, 9*d], heights: {HEIGHTS.tolist()}}}"
H = heights(FIELD)


@pytest.mark.parametrize("n", [4, 5, 6, 9, 40])
def test_a_spline_is_scipys(n, rng):
    values = rng.normal(size=n)
    ours, theirs = spline(values), make_interp_spline(np.arange(n), values, k=3)
    for t in [*rng.uniform(-0.5, n - 0.5, 12), *range(n)]:
        for order in range(3):
            assert ours(t)[order] == pytest.approx(theirs(t, nu=order), abs=1e-11)
    between = rng.uniform(0, n - 1, 6)
    assert [ours(t)[3] for t in between] == pytest.approx(theirs(between, nu=3).tolist(), abs=1e-10)


@pytest.mark.parametrize("n", [4, 7])
def test_cubics_are_met_exactly_also_beyond_the_ends(n, rng):
    cubic = np.polynomial.Polynomial(rng.normal(size=4))
    ours = spline(cubic(np.arange(n)))
    for t in rng.uniform(-3, n + 2, 20):
        expected = [cubic.deriv(k)(t) if k else cubic(t) for k in range(4)]
        assert ours(t) == pytest.approx(expected, rel=1e-11, abs=1e-10)


def test_a_spline_is_twice_differentiable_at_its_knots_and_no_more(rng):
    ours, close = spline(rng.normal(size=8)), 1e-9
    jumps = np.array([np.abs(ours(k + close) - ours(k - close)) for k in range(1, 7)])
    assert jumps[:, :3].max() < 1e-7  # the third derivative, of some tens, times the step
    assert np.all(jumps[1:-1, 3] > 0.1)
    assert jumps[[0, -1], 3] == pytest.approx(0, abs=1e-9)  # not a knot
    for k in range(8):
        assert ours(k)[:3] == pytest.approx((ours(k - close) + ours(k + close))[:3] / 2, abs=1e-7)


def test_the_basis_derivatives_are_those_of_casadi(rng):
    t = ca.SX.sym("t")
    value, *further = basis(t, 6)
    for each in further:
        value = ca.jacobian(value, t)
        difference = ca.Function("d", [t], [ca.densify(value - each)])
        for at in [*rng.uniform(-1, 6, 10), 2.0, 3.0]:
            assert np.abs(difference(at).full()).max() < ROUNDING


def test_heights_are_met():
    for i, x in enumerate(X):
        for j, y in enumerate(Y):
            assert H(x, y) == pytest.approx(HEIGHTS[i, j], abs=ROUNDING)


def test_a_landscape_is_scipys(rng):
    theirs = RectBivariateSpline(X, Y, HEIGHTS, s=0)
    for x, y in zip(rng.uniform(-1, 0.8, 20), rng.uniform(-0.1, 0.9, 20), strict=True):
        for a, b in [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (2, 1)]:
            assert H(x, y, a, b) == pytest.approx(theirs(x, y, dx=a, dy=b).item(), abs=1e-10)


def test_a_parabolic_bowl_has_its_curvatures():
    """h = (x^2 + 3 y^2) / 2 has the curvatures 1 and 3 at its bottom, seen from above a hollow."""
    X, Y = np.linspace(-1, 1, 5), np.linspace(-1, 1, 6)
    rows = ((X[:, None] ** 2 + 3 * Y**2) / 2).tolist()
    measured = Measured(f"height_field: {{x: [-1, 1], y: [-1 m, 1 m], heights: {rows}, position: [d, r, 0]}}")
    at = [P[1], P[0], 0]
    assert measured(at) == pytest.approx(0, abs=ROUNDING)
    assert measured.curvatures(at) == pytest.approx([-3, -1], abs=1e-10)


def test_a_landscape_moves_as_a_rigid_body(rng):
    R, still, moved = rotation(("z", np.radians(40)), ("x", 0.1)), Measured(FIELD), Measured(SURFACES["height field"])
    for x in 0.3 * rng.normal(size=(5, 3)):
        there = R @ x + [0, 0, P[0]]
        assert moved(there) == pytest.approx(still(x), abs=ROUNDING)
        assert moved(there, "gradient") == pytest.approx(R @ still(x, "gradient"), abs=1e-10)
        assert moved(there, "hessian") == pytest.approx(R @ still(x, "hessian") @ R.T, abs=1e-9)


def test_it_ends_where_its_data_end():
    spec = surface(SURFACES["height field"])
    R = rotation(("z", np.radians(40)), ("x", 0.1))
    for y, inside in [
        ([0, 0.5, 3], True),
        ([-1 + 1e-9, -0.1 + 1e-9, 0], True),
        ([0.81, 0.5, 0], False),
        ([0, -0.11, 0], False),
    ]:
        assert inside_domain(spec, R @ y + [0, 0, P[0]], SYMBOLS, P) == inside
    assert inside_domain(surface("sphere: {centre: [0, 0, 0], radius: 1}"), [9, 9, 9], SYMBOLS, P)


def test_the_largest_grid_stays_small(rng):
    """Instructions: a product of the coefficients with a row of the basis is 2 * 42^2, and there is one for each order."""
    rows = np.round(rng.normal(size=(40, 40)), 3).tolist()
    spec = surface(f"height_field: {{x: [0, 1], y: [0, 1], heights: {rows}}}")
    x, product = ca.SX.sym("x", 3), 2 * 42**2
    sizes = [
        ca.Function("f", [x, SYMBOLS.p], outputs).n_instructions()
        for outputs in ([signed_distance(spec, x, SYMBOLS)], [normal(spec, x, SYMBOLS)], list(bent(spec, x)))
    ]
    assert sizes[0] < 4 * product
    assert sizes[1] < 4 * product
    assert sizes[2] < 7 * product


def bent(spec, x):
    at_x = bend(spec, x, SYMBOLS)
    return at_x.value, at_x.gradient, at_x.hessian
