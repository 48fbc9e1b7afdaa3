"""[T10]: enclosures against floats and 30 digits, refusals, and simulations from inside what is proven."""

from dataclasses import replace

import flint
import numpy as np
import pytest
from flint import arb

import firmtouch
from firmtouch.certificate.attraction import (
    Limit,
    NotProvenError,
    Search,
    find_attraction,
    find_joint_box,
    prove_attraction,
    stiffness_chart,
)
from firmtouch.certificate.attraction.chart import Cell, box
from firmtouch.certificate.attraction.comparison import compare_attraction
from firmtouch.certificate.attraction.landscape import Landscape
from firmtouch.certificate.attraction.proof import explore
from firmtouch.certificate.attraction.zeros import has_no_zero
from firmtouch.regulation import project
from firmtouch.regulation.controllers import Controller

MODELS = (
    "pendulum_rod",
    "planar_2r_circle",
    "planar_2r_wall",
    "planar_3r_wall",
    "planar_3r_circle",
    "spatial_3r_sphere",
)
FEW = 150


@pytest.fixture(scope="module")
def shipped(loop_of):
    from pathlib import Path

    root = Path(__file__).parents[3] / "models"
    found = {}

    def get(name):
        if name not in found:
            found[name] = loop_of(firmtouch.read_model(root / f"{name}.yaml"))
        return found[name]

    return get


@pytest.fixture(scope="module")
def attractions(shipped):
    found = {}

    def get(name):
        if name not in found:
            found[name] = find_attraction(shipped(name), most_cells=FEW)
        return found[name]

    return get


def landscape_of(loop):
    return Landscape(loop.operating_point, loop.gains, stiffness_chart(loop))


def lifted(landscape, plant, x2, start):
    """The surface's point above x2, by Newton's method."""
    chart, x1 = landscape.chart, np.array(start)
    for _ in range(30):
        q = chart.q_d + chart.V1 @ x1 + chart.V2 @ x2
        x1 = x1 - np.linalg.solve(plant.J(q) @ chart.V1, plant.Phi(q))
    return x1, q


def energy(loop, q):
    dq = q - loop.operating_point.q_d
    plant = loop.operating_point.plant
    return plant.P(q) - plant.P(loop.operating_point.q_d) - loop.gains.bias @ dq + dq @ loop.gains.W @ dq / 2


def reduced_hessian(loop, landscape, q):
    """p_xx above x2, from the plant's own derivatives."""
    plant, chart = loop.operating_point.plant, landscape.chart
    J, E_q = plant.J(q), plant.P_q(q) - loop.gains.bias + loop.gains.W @ (q - chart.q_d)
    T = chart.V2 - chart.V1 @ np.linalg.solve(J @ chart.V1, J @ chart.V2)
    mu = np.linalg.solve((J @ chart.V1).T, chart.V1.T @ E_q)
    return T.T @ (plant.P_qq(q) + loop.gains.W - np.tensordot(mu, plant.Phi_qq(q), axes=1)) @ T, T.T @ E_q


@pytest.mark.parametrize("name", MODELS)
def test_a_piece_holds_the_surface_p_and_its_two_derivatives(name, shipped, rng):
    loop = shipped(name)
    plant, landscape = loop.operating_point.plant, landscape_of(loop)
    low = rng.uniform(-0.05, 0, landscape.chart.free)
    cell = Cell(tuple(low), tuple(low + 0.03))
    with flint.ctx.workprec(64):
        piece = landscape.piece(cell)
        lower, upper = piece.bounds()
        H, mean = piece.hessian.whole, piece.mean_hessian()
        for x2 in rng.uniform(cell.low, cell.high, size=(20, landscape.chart.free)):
            x1, q = lifted(landscape, plant, x2, np.zeros(plant.m))
            assert all(
                abs(a - b) <= r
                for a, b, r in zip(piece.place.axis(tuple(x2)).entries(), x1, piece.place.radius, strict=True)
            )
            assert all(abs(a - b).lower() < 1e-12 for a, b in zip(landscape.hull(piece.place, cell), q, strict=True))
            assert lower - 1e-11 <= energy(loop, q) <= upper + 1e-11
            hessian, here = reduced_hessian(loop, landscape, q)
            assert all(abs(H[i, j] - hessian[i, j]).lower() < 1e-9 for i, j in np.ndindex(hessian.shape))
            xi = x2 - np.array(cell.centre)
            for i in range(landscape.chart.free):
                step = sum((mean[i, j] * xi[j] for j in range(len(xi))), arb(0))
                assert abs(piece.gradient[i, 0] + step - here[i]).lower() < 1e-9
            part = Cell(
                tuple(np.minimum(x2, np.array(cell.high) - 1e-3)),
                tuple(np.minimum(x2, np.array(cell.high) - 1e-3) + 1e-3),
            )
            inside = lifted(landscape, plant, np.array(part.centre), x1)[1]
            below, above = piece.bounds(part)
            assert below - 1e-11 <= energy(loop, inside) <= above + 1e-11


def test_p_at_a_point_is_that_of_thirty_digits(make_model, loop_of):
    import mpmath

    loop = loop_of(make_model(
        "x:m y:m", mechanism={"kinetic_energy": "m*(dot(x)**2 + dot(y)**2)/2", "potential_energy": "m*g*y"},
        parameters={"m": "2 kg", "g": "9.81 m/s^2", "l": "0.7 m"}, constraints={"rod": "l - sqrt(x**2 + y**2)"},
        guess={"x": "0.2 m", "y": "-0.6 m"},
    ))  # fmt: skip
    landscape, gains = landscape_of(loop), loop.gains
    with flint.ctx.workprec(128), mpmath.workdps(30):
        piece = landscape.piece(Cell((0.05,), (0.05,)))
        q_d, V1, V2 = (landscape.chart.q_d, landscape.chart.V1[:, 0], landscape.chart.V2[:, 0])
        there = lambda s: [mpmath.mpf(q_d[i]) + V1[i] * s + V2[i] * mpmath.mpf(0.05) for i in range(2)]  # noqa: E731
        s = mpmath.findroot(lambda s: mpmath.mpf(0.7) - mpmath.hypot(*there(s)), 0.0)
        dq = [a - mpmath.mpf(b) for a, b in zip(there(s), q_d, strict=True)]
        quadratic = mpmath.fsum(mpmath.mpf(gains.W[i, j]) * dq[i] * dq[j] for i in range(2) for j in range(2)) / 2
        value = 2 * mpmath.mpf(9.81) * dq[1] - mpmath.fdot(gains.bias, dq) + quadratic
        assert abs(piece.value - arb(mpmath.nstr(value, 28))).lower() < 1e-25
        lower, upper = piece.bounds()
        assert upper - lower < 1e-10


def test_subdividing_never_enlarges(shipped):
    landscape = landscape_of(shipped("planar_3r_circle"))
    with flint.ctx.workprec(64):
        whole = Cell((0.0, 0.0), (0.1, 0.03))
        piece = landscape.piece(whole)
        for half in whole.halves():
            part = landscape.piece(half)
            assert part.bounds()[0] >= piece.bounds()[0]
            assert part.bounds()[1] <= piece.bounds()[1]
            H, smaller = piece.hessian.whole, part.hessian.whole
            assert all(smaller[i, j].rad() <= H[i, j].rad() for i, j in np.ndindex(2, 2))


@pytest.mark.parametrize("name", MODELS)
def test_every_small_model_has_a_region(name, shipped, attractions):
    found = attractions(name)
    assert found.level > 0
    assert found.distance > 0.02
    assert min(found.speeds.norm, found.speeds.all_joints, found.together.distance, found.together.speed) > 0
    assert found.offset < 1e-9
    assert found.controllers == (Controller.AFFINE, Controller.ENERGY_WITH_FORCE)


def test_the_bars_of_distance_hold(attractions):
    assert attractions("planar_2r_wall").distance > 0.3
    assert attractions("planar_3r_wall").distance > 0.3


@pytest.mark.parametrize("name", ["planar_2r_circle", "planar_2r_wall"])
def test_every_simulated_start_inside_converges(name, shipped, attractions):
    comparison = compare_attraction(shipped(name), attractions(name))
    proven, converge = comparison.proven > 0, comparison.converge > 0
    assert proven.sum() >= 8
    assert np.all(converge[proven])
    if name == "planar_2r_circle":
        assert not np.all(converge)  # beyond the other equilibrium they go elsewhere


def test_starts_with_speed_inside_converge_under_both_laws(shipped, attractions, simulate, rng):
    loop, found = shipped("planar_3r_circle"), attractions("planar_3r_circle")
    op = loop.operating_point
    strong = replace(loop.gains, G_f=np.array([[50.0]]))
    for controller in found.controllers:
        for _ in range(2):
            q = project(op.plant, op.q_d + rng.uniform(-0.5, 0.5, 3) * found.together.distance).q
            assert np.max(np.abs(q - op.q_d)) < found.together.distance
            free = np.linalg.svd(op.plant.J(q))[2][1:].T @ rng.normal(size=2)
            v = free / np.max(np.abs(free)) * found.together.speed * 0.999
            V = v @ op.plant.M(q) @ v / 2 + energy(loop, q)
            assert V < found.level
            law = firmtouch.regulation.control_law(op, strong, controller)
            run = simulate(op, law, q, v, 2.0, tolerance=1e-8)
            assert np.max(np.abs(run.q[-1] - op.q_d)) < 1e-3


def test_kinetic_energies_within_the_speeds_are_below_the_level(shipped, attractions, rng):
    for name in MODELS:
        op, found = shipped(name).operating_point, attractions(name)
        T = shipped(name).split.V2
        for z in rng.normal(size=(20, T.shape[1])):
            v = T @ z
            for fast in (v / np.linalg.norm(v) * found.speeds.norm, v / np.max(np.abs(v)) * found.speeds.all_joints):
                assert fast @ op.M @ fast / 2 <= found.level * (1 + 1e-9)
        reached = np.sqrt(2 * found.level * np.diag(T @ np.linalg.inv(T.T @ op.M @ T) @ T.T))
        assert found.speeds.fastest == pytest.approx(reached, rel=1e-6, abs=1e-6)


def test_the_level_bounds_p_on_the_way_out(shipped, attractions, rng):
    """Rays from q_d: before p first reaches the level, x2 stays in the extent and p grows from zero without a rest."""
    loop, found = shipped("planar_3r_circle"), attractions("planar_3r_circle")
    landscape, plant = landscape_of(loop), loop.operating_point.plant
    for _ in range(10):
        angle = rng.uniform(0, 2 * np.pi)
        ray, x1 = np.array([np.cos(angle), 0.3 * np.sin(angle)]), np.zeros(1)
        for t in np.arange(0.01, 2, 0.01):
            x1, q = lifted(landscape, plant, t * ray, x1)
            if energy(loop, q) >= found.level:
                break
            assert np.all(np.abs(t * ray) <= found.extent + 1e-9)
            assert energy(loop, q) > 0
            if np.max(np.abs(q - loop.operating_point.q_d)) > found.distance:
                continue
            assert np.linalg.norm(reduced_hessian(loop, landscape, q)[1]) > 1e-6


def test_proving_again_gives_the_same_and_asking_for_more_gives_no(shipped, attractions):
    for name in ("planar_2r_circle", "planar_3r_wall"):
        loop, found = shipped(name), attractions(name)
        again = prove_attraction(loop, found.chart, found.search, found.level)
        assert (again.level, again.distance, again.extent.tolist()) == (
            found.level,
            found.distance,
            found.extent.tolist(),
        )
        with pytest.raises(NotProvenError, match="was asked for"):
            prove_attraction(loop, found.chart, found.search, found.level * 1.05)


def test_less_is_proven_with_fewer_cells(shipped, attractions):
    loop, found = shipped("planar_2r_wall"), attractions("planar_2r_wall")
    half = prove_attraction(loop, found.chart, Search(found.search.half_widths, 100), found.level / 2)
    assert half.limit is Limit.ASKED
    assert half.level == found.level / 2
    assert half.distance < found.distance


@pytest.fixture(scope="module")
def soft(make_model):
    """A pendulum that a weak spring holds at 45 degrees: gravity alone makes another equilibrium on the circle."""
    model = make_model(
        "x:m y:m", mechanism={"kinetic_energy": "m*(dot(x)**2 + dot(y)**2)/2", "potential_energy": "m*g*y"},
        parameters={"m": "2 kg", "g": "9.81 m/s^2", "l": "1 m"}, constraints={"rod": "l - sqrt(x**2 + y**2)"},
        guess={"x": "0.3 m", "y": "-0.95 m"}, lambda_d={"rod": -5},
    )  # fmt: skip
    op = firmtouch.find_operating_point(firmtouch.derive_plant(model.spec))
    gains = firmtouch.Gains(W=8.0 * np.eye(2), C=4.0 * np.eye(2), G_f=np.zeros((1, 1)), bias=op.g - op.f_d)
    return firmtouch.close_loop(op, gains)


def test_a_second_equilibrium_is_never_inside(soft):
    """With W = w I, E on the circle is (w q_d + bias - m g e_y) . q up to a sign: it has one top, opposite to q_d."""
    landscape = landscape_of(soft)
    with flint.ctx.workprec(64):
        basin = explore(landscape, box((0.999,)), most_cells=200)
        for piece in basin.pieces[1:]:
            assert has_no_zero(piece)
    found = find_attraction(soft, most_cells=100)
    assert found.extent[0] < 1.0


def test_other_equilibria_of_shipped_designs_are_outside(shipped, attractions):
    """The 2R arm on the disc has one 0.159 rad away, where p is 0.0784 J; found by Newton's method from all around."""
    loop, found = shipped("planar_2r_circle"), attractions("planar_2r_circle")
    op = loop.operating_point
    plant, q, mu = op.plant, op.q_d + np.array([0.04, -0.16]), np.array([48.0])
    for _ in range(30):
        J = plant.J(q)
        H = plant.P_qq(q) + loop.gains.W - np.tensordot(mu, plant.Phi_qq(q), axes=1)
        force = plant.P_q(q) - loop.gains.bias + loop.gains.W @ (q - op.q_d) - J.T @ mu
        step = np.linalg.solve(np.block([[H, -J.T], [J, np.zeros((1, 1))]]), np.concatenate([force, plant.Phi(q)]))
        q, mu = q - step[:2], mu - step[2:]
    away = np.max(np.abs(q - op.q_d))
    assert away == pytest.approx(0.159, abs=1e-3)
    assert 0.95 * energy(loop, q) < found.level < energy(loop, q)
    assert find_joint_box(loop, most_cells=FEW).half_width == pytest.approx(away, rel=0.05)
    assert find_joint_box(loop, most_cells=FEW).half_width < away


def test_damping_that_is_not_positive_is_refused(shipped):
    loop = shipped("planar_2r_wall")
    bad = firmtouch.close_loop(loop.operating_point, replace(loop.gains, C=np.diag([1.0, 0.0])))
    with pytest.raises(NotProvenError, match="C > 0"):
        find_attraction(bad)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["two_arms_bar", "spatial_6r_plane"])
def test_every_model_of_six_joints_has_a_region(name, shipped):
    found = find_attraction(shipped(name))
    assert found.level > 0
    assert found.distance > 0.02
