"""Signed distances: zero and of slope one on the surface, the true distance where that is promised, true curvatures."""

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize
from tests.mechanics.surfaces.given import SURFACES, SYMBOLS, Measured, P, measured, points_of, rotation, surface

from firmtouch.mechanics.surfaces import bend_along, signed_distance

ROUNDING = 1e-13  # of sizes below one, after some dozens of operations
SECOND = 1e-10  # rounding of second derivatives: a few digits more are lost in powers of the curvature


def each_surface(test):
    """Run a test on every surface, with some points of it."""
    return pytest.mark.parametrize("name", SURFACES)(test)


@each_surface
def test_the_slope_is_one_on_the_surface_and_along_the_normal(name):
    one, points = measured(name), points_of(name)
    assert len(points) >= 5
    for x in points:
        n = one(x, "normal")
        assert np.linalg.norm(n) == pytest.approx(1, abs=ROUNDING)
        assert one(x, "gradient") == pytest.approx(n, abs=SECOND)


@each_surface
def test_it_bends_as_casadi_differentiates(name, rng):
    one, points = measured(name), points_of(name)
    for x in [*points, *(0.3 * rng.normal(size=(3, 3)))]:
        gradient, hessian = (each.full() for each in one.by_casadi(x, one.p))
        assert one(x, "bent") == pytest.approx(one(x), abs=ROUNDING)
        assert one(x, "gradient") == pytest.approx(gradient.ravel(), rel=SECOND, abs=SECOND)
        assert one(x, "hessian") == pytest.approx(hessian, rel=SECOND, abs=SECOND * (1 + np.abs(hessian).max()))


@each_surface
def test_derivatives_are_those_of_differences(name):
    one, points = measured(name), points_of(name)
    h = 1e-5  # central differences: h^2 = 1e-10 of third derivatives of some hundreds, and rounding of 1e-11
    for x in points[:3]:
        steps = h * np.eye(3)
        slope = [(one(x + d) - one(x - d)) / (2 * h) for d in steps]
        bent = [(one(x + d, "gradient") - one(x - d, "gradient")) / (2 * h) for d in steps]
        assert one(x, "gradient") == pytest.approx(slope, abs=1e-7)
        assert one(x, "hessian") == pytest.approx(np.array(bent), abs=1e-5)


@each_surface
def test_a_distance_of_first_order_is_wrong_by_the_square(name):
    """s along the normal is the way gone, but for O(way^2): halving the way quarters what is missing at least."""
    one, points = measured(name), points_of(name)
    for x in points[:4]:
        n = one(x, "normal")
        misses = [abs(one(x + way * n) - way) for way in (2e-3, 1e-3)]
        assert misses[1] <= misses[0] / 3.5 + ROUNDING


def turned(axis):
    """A rotation whose third column is a direction."""
    a = np.array(axis) / np.linalg.norm(axis)
    first = np.linalg.svd(a[None])[2][1]
    return np.column_stack([first, np.cross(a, first), a])


CENTRE = np.array([0.1, 0, 0.1])
LEANING, HANGING, LYING = turned([1, 1, 3]), turned([1, 0, -2]), turned([1, 0, 2])
EXACT = {
    "plane": (lambda u, v: [0.1 + 2 * u, u + v, 0.1 + v], 1.5),
    "sphere": (lambda u, v: CENTRE + 0.2 * np.array([np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)]), 4),
    "cylinder": (lambda u, v: CENTRE + LEANING @ [0.2 * np.cos(u), 0.2 * np.sin(u), v], 4),
    "cone": (lambda u, v: CENTRE + abs(v) * (HANGING @ [np.cos(u) / np.sqrt(3), np.sin(u) / np.sqrt(3), 1]), 4),
    "torus": (
        lambda u, v: CENTRE
        + LYING @ [(0.4 + 0.15 * np.cos(v)) * np.cos(u), (0.4 + 0.15 * np.cos(v)) * np.sin(u), 0.15 * np.sin(v)],
        4,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", EXACT)
def test_exact_distances_are_those_of_the_nearest_point(name, rng):
    """Nearest points of a parametrised surface, searched from a grid and then by descent."""
    place, reach = EXACT[name]
    parameters = [(u, v) for u in np.linspace(-reach, reach, 25) for v in np.linspace(-reach, reach, 25)]
    grid = np.array([place(u, v) for u, v in parameters])
    for _ in range(4):
        x = np.array([0.1, 0.0, 0.0]) + 0.2 * rng.normal(size=3)
        if name == "cone" and measured(name)(x) > 0:
            x = place(*rng.uniform(0.3, 2, 2)) + rng.uniform(0, 0.1) * np.array([0, 1, 0])  # the mantle is nearest
        start = parameters[np.argmin(np.linalg.norm(grid - x, axis=1))]
        found = minimize(
            lambda w, x=x: float(np.sum((place(*w) - x) ** 2)),
            start,
            method="Nelder-Mead",
            options={"xatol": 1e-9, "fatol": 1e-18},
        )
        assert abs(measured(name)(x)) == pytest.approx(np.sqrt(found.fun), abs=1e-8)


def test_known_points_and_signs():
    assert Measured("plane: {point: [0, 0, 30 cm], normal: [0, 0, 5]}")([1, 2, 0.5]) == pytest.approx(0.2)
    cone = Measured("cone: {apex: [0, 0, 0], axis: [0, 0, 2], half_angle: 30 deg}")
    assert cone([1, 0, np.sqrt(3)]) == pytest.approx(0, abs=ROUNDING)
    assert cone([0.3, 0, 3]) < 0 < cone([2, 0, 1])
    assert Measured("torus: {centre: [0, 0, 0], axis: [0, 0, 1], ring_radius: 3, tube_radius: 1}")(
        [3, 0, 1.5]
    ) == pytest.approx(0.5)
    valley = Measured('implicit: {expression: "x**2 + y**2 - z"}')
    assert valley([0.5, 0, 0.25]) == pytest.approx(0, abs=ROUNDING)
    assert valley([0, 0, 1]) < 0 < valley([1, 0, 0])


@pytest.mark.parametrize("kind", ["sphere", "cylinder", "cone", "torus", "ellipsoid", "superellipsoid"])
def test_inside_turns_the_sign(kind, rng):
    text = SURFACES[kind]
    hollow = Measured(text[:-1] + ", side: inside}")
    for x in 0.3 * rng.normal(size=(3, 3)):
        for what in ("s", "gradient", "hessian", "normal"):
            assert np.all(hollow(x, what) == -measured(kind)(x, what))


ROUND = {  # a surface, a point of it, and its principal curvatures in 1/m
    "plane": ("plane: {point: [0, 0, 0], normal: [0, 0, 1]}", [1, 2, 0], (0, 0)),
    "sphere": ("sphere: {centre: [0, 0, 0], radius: r}", [0.2, 0, 0], (5, 5)),
    "cylinder": ("cylinder: {point: [0, 0, 0], axis: [0, 0, 1], radius: r}", [0.12, 0.16, 1], (0, 5)),
    "cone": ("cone: {apex: [0, 0, 0], axis: [0, 0, 1], half_angle: 60 deg}", [np.sqrt(3), 0, 1], (0, 0.5 / np.sqrt(3))),
    "outer equator": ("torus: {centre: [0, 0, 0], axis: [0, 0, 1], ring_radius: 0.5, tube_radius: r}", [0.7, 0, 0], (1 / 0.7, 5)),
    "inner equator": ("torus: {centre: [0, 0, 0], axis: [0, 0, 1], ring_radius: 0.5, tube_radius: r}", [0.3, 0, 0], (-1 / 0.3, 5)),
    "valley": ('implicit: {expression: "z - 3*x**2 - y**2"}', [0, 0, 0], (-6, -2)),
    "gauge of no matter": ('implicit: {expression: "7*(z - 3*x**2 - y**2)*(2 + z)"}', [0, 0, 0], (-6, -2)),
}  # fmt: skip


@pytest.mark.parametrize("which", ROUND)
def test_curvatures_are_known(which):
    text, at, expected = ROUND[which]
    one = Measured(text)
    assert one(at) == pytest.approx(0, abs=ROUNDING)
    assert one.curvatures(at) == pytest.approx(expected, abs=SECOND)


@pytest.mark.parametrize("axes", [(0.2, 0.3, 0.5), (0.5, 0.2, 0.2)])
def test_an_ellipsoid_bends_by_the_textbook(axes, rng):
    """Gauss' and mean curvature of x^2/a^2 + y^2/b^2 + z^2/c^2 = 1."""
    one, squares = Measured(f"ellipsoid: {{centre: [0, 0, 0], semi_axes: {list(axes)}}}"), np.square(axes)
    for _ in range(5):
        direction = rng.normal(size=3)
        x = direction / np.sqrt(np.sum(direction**2 / squares))
        across = np.sum(x**2 / squares**2)
        gauss = 1 / (np.prod(squares) * across**2)
        mean = (squares.sum() - x @ x) / (2 * np.prod(squares) * across**1.5)
        first, second = one.curvatures(x)
        assert (first * second, (first + second) / 2) == pytest.approx((gauss, mean), rel=1e-10)


@pytest.mark.parametrize("radius", [0.2, 3])
def test_a_round_ellipsoid_is_a_sphere_everywhere(radius, rng):
    """And a superellipsoid with exponents 2 is the ellipsoid."""
    sphere = Measured(f"sphere: {{centre: [0.1, 0, d], radius: {radius}}}")
    ellipsoid = Measured(f"ellipsoid: {{centre: [0.1, 0, d], semi_axes: [{radius}, {radius}, {radius}]}}")
    for x in rng.normal(size=(4, 3)):
        for what in ("s", "gradient", "hessian", "normal"):
            assert ellipsoid(x, what) == pytest.approx(sphere(x, what), rel=1e-10, abs=1e-10)


turns = st.lists(st.tuples(st.sampled_from("xyz"), st.floats(-3, 3)), min_size=1, max_size=3)
moves = st.lists(st.floats(-1, 1), min_size=3, max_size=3)


@pytest.mark.parametrize("kind", ["ellipsoid", "superellipsoid", "implicit"])
@settings(max_examples=4)
@given(turns=turns, move=moves, place=moves)
def test_a_surface_moves_as_a_rigid_body(kind, turns, move, place):
    body, at = {
        "ellipsoid": ("semi_axes: [0.2, 0.3, 0.5]", "centre"),
        "superellipsoid": ("semi_axes: [0.2, 0.3, 0.5], exponents: [4, 6]", "centre"),
        "implicit": ('expression: "z - x**2 + 0.4*y**3 + 2*x"', "position"),
    }[kind]
    R, x = rotation(*turns), np.array(place) + 0.01
    written = ", ".join(f"{{{axis}: {angle!r}}}" for axis, angle in turns)
    still = Measured(f"{kind}: {{{body}, {at}: [0, 0, 0]}}")
    moved = Measured(f"{kind}: {{{body}, {at}: {move}, orientation: [{written}]}}")
    there = R @ x + move
    assert moved(there) == pytest.approx(still(x), abs=1e-12)
    assert moved(there, "gradient") == pytest.approx(R @ still(x, "gradient"), rel=1e-9, abs=1e-9)
    bent = R @ still(x, "hessian") @ R.T
    assert moved(there, "hessian") == pytest.approx(bent, abs=1e-9 * (1 + np.abs(bent).max()))


@each_surface
def test_parameters_stay_symbols(name):
    """Proofs need the exact dependence: what a parameter does is no part of the constants."""
    s = signed_distance(surface(SURFACES[name]), ca.SX.sym("x", 3), SYMBOLS)
    depends = ca.which_depends(s, SYMBOLS.p, 1)
    assert depends[1]
    s_at = measured(name).symbolic["s"]
    values = [s_at([0.3, 0.2, 0.4], p).full().item() for p in (P, (P[0] + 0.01, P[1]), (P[0], P[1] + 0.01))]
    assert [each != values[0] for each in values[1:]] == list(depends)


@pytest.mark.parametrize("kind", ["ellipsoid", "height field"])
def test_it_bends_along_the_coordinates_of_a_mechanism(kind):
    """By the chain rule, as CasADi differentiates s(x(q))."""
    q = ca.SX.sym("q", 4)
    weights = ca.DM(np.random.default_rng(3).normal(size=(3, 4)))
    x = 0.3 * ca.sin(weights @ q) + ca.DM([0.1, 0.2, 0.3])
    spec = surface(SURFACES[kind])
    phi, along = signed_distance(spec, x, SYMBOLS), bend_along(spec, x, q, SYMBOLS)
    hessian, gradient = ca.hessian(phi, q)
    parts = [along.value - phi, along.gradient - gradient, ca.vec(along.hessian - hessian)]
    misses = ca.Function("misses", [q, SYMBOLS.p], [ca.vertcat(*parts)])(np.linspace(0.1, 1, 4), P)
    assert np.abs(misses.full()).max() < SECOND
