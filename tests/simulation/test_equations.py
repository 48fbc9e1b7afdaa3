"""The right-hand side: Eqs. (1) and (4) with each of the four laws, the algebraic loops solved exactly."""

from dataclasses import replace

import numpy as np
import pytest

import firmtouch
from firmtouch.regulation import Gains, close_loop, closed_loop_acceleration, control_law, project
from firmtouch.regulation.controllers import Controller
from firmtouch.regulation.force_loop import ForcePath
from firmtouch.simulation.dae import NODES, Input, derive_dae, nodes, parameters_of
from firmtouch.simulation.motion import HOLD
from firmtouch.simulation.scenario import Feedback
from firmtouch.simulation.start import true_surface
from firmtouch.simulation.world import Disturbance, nominal_world, tilted

EXACT = 1e-10  # relative to the forces: two linear solutions of well-conditioned equations, each rounded


def on_surface(op, rng, size=0.1):
    """Draw a state near the regulation point that keeps Eq. (1) and its derivative."""
    q = project(op.plant, op.q_d + size * rng.normal(size=op.n)).q
    J, v = op.plant.J(q), rng.normal(size=op.n)
    return q, v - np.linalg.lstsq(J, J @ v, rcond=None)[0]


def look(dae, world, q, v, *, t=0.0, y=()):
    """Give q'', lambda, u and the rate of y at a state."""
    x, parameters = np.concatenate([q, v, y]), parameters_of(dae, world, t=t)
    rate = dae.rate(t, x, parameters).full().ravel()
    lambda_, u, Phi = (each.full().ravel() for each in dae.outputs(t, x, parameters))
    assert rate[: q.size] == pytest.approx(v, abs=0)
    return rate[q.size : 2 * q.size], lambda_, u, Phi, rate[2 * q.size :]


@pytest.mark.parametrize("controller", Controller)
def test_the_rate_is_the_solution_of_eq_4_and_the_constraints(loop, dae_of, controller, rng):
    op, law = loop.operating_point, control_law(loop.operating_point, loop.gains, controller)
    d = rng.normal(size=op.n)
    dae, world = dae_of(loop, controller), nominal_world(op, Disturbance(d))
    for _ in range(3):
        q, v = on_surface(op, rng)
        found, lambda_, u, Phi, _ = look(dae, world, q, v)
        expected = closed_loop_acceleration(op, law, q, v, d=d)
        # HOLD^2 times what Newton's method leaves of Phi, 1e-12, is 4e-10 m/s^2
        size = np.abs(u).max() + 1
        assert found == pytest.approx(expected[0], abs=EXACT * size * np.abs(np.linalg.inv(op.M)).max() + 1e-9)
        assert lambda_ == pytest.approx(expected[1], abs=EXACT * size + 1e-8)
        assert u == pytest.approx(law(q, v, expected[1]).full().ravel(), abs=EXACT * size * 10 + 1e-8)
        assert np.abs(Phi).max() < 1e-12


@pytest.fixture(scope="module")
def shaped(make_model):
    """Make a mechanism given by its energies, with the P_d of Eq. (12) and quartic terms more, as a file has it."""
    K = "j*(3*dot(a)**2/2 + dot(b)**2/2 + cos(b - a)*dot(a)*dot(b)/2)"
    P = "k*(12*sin(a) + 4*sin(b))"
    common = {
        "parameters": {"j": "1 kg*m^2", "k": "1 J"},
        "constraints": {"wall": {"expression": "1.2 - cos(a) - cos(b)", "unit": "1"}},
        "guess": {"a": 1.0, "b": 0.8},
    }
    model = make_model("a b", mechanism={"kinetic_energy": K, "potential_energy": P}, **common)
    op = firmtouch.find_operating_point(firmtouch.derive_plant(model.spec))
    gains = Gains(W=np.diag([30.0, 20]), C=np.eye(2) * 4, G_f=np.eye(1) * 2, bias=op.g - op.f_d)
    (a, b), (x, y) = op.q_d, gains.bias
    da, db = f"(a - {a:.17g})", f"(b - {b:.17g})"
    text = f"{P} - k*({x:.17g}*a + {y:.17g}*b) + k*(15*{da}**2 + 10*{db}**2) + k*(3*{da}**4 + {da}*{db}**2)"
    shaping = make_model("a b", mechanism={"kinetic_energy": K, "potential_energy": text}, **common).spec
    return close_loop(op, gains), shaping.mechanism.potential_energy


@pytest.mark.parametrize("controller", [Controller.ENERGY, Controller.ENERGY_WITH_FORCE])
def test_laws_5_and_11_with_a_given_potential(shaped, run, controller, rng):
    loop, P_d = shaped
    op, law = loop.operating_point, control_law(loop.operating_point, loop.gains, controller, P_d=P_d)
    dae = derive_dae(loop, Feedback(controller, P_d))
    for _ in range(5):
        q, v = on_surface(op, rng, 0.2)
        found, lambda_, u, _, _ = look(dae, nominal_world(op), q, v)
        expected = closed_loop_acceleration(op, law, q, v, d=np.zeros(2))
        assert found == pytest.approx(expected[0], rel=1e-9, abs=1e-9)
        da, db = q - op.q_d
        plain = loop.gains.bias - loop.gains.W @ [da, db] - 4 * v - [12 * da**3 + db**2, 2 * da * db]
        fed = op.plant.J(q).T @ loop.gains.G_f @ (lambda_ - op.lambda_d)
        assert u == pytest.approx(plain + (fed if controller is Controller.ENERGY_WITH_FORCE else 0), abs=1e-9)
    done = run(loop, Feedback(controller, P_d), way=0.2, duration=12.0)
    assert done.outcome.good
    assert done.q[-1] == pytest.approx(op.q_d, abs=1e-4)
    assert done.lambda_[-1] == pytest.approx(op.lambda_d, abs=1e-2)


@pytest.mark.parametrize("controller", Controller)
def test_in_any_world_the_three_equations_hold_off_the_surface_too(loop, controller, rng):
    """Eq. (4) with the true plant; the law; Phi'' + 2 a Phi' + a^2 Phi = 0 with the true constraints."""
    op, m, n = loop.operating_point, loop.operating_point.m, loop.operating_point.n
    turn = np.linalg.qr(np.eye(m) + 0.1 * rng.normal(size=(m, m)))[0]
    world = replace(
        tilted(op, nominal_world(op), 0.1 * rng.normal(size=n)),
        p=op.plant.p * (1 + 0.05 * rng.normal(size=op.plant.p.size)),
        Delta=0.01 * rng.normal(size=m), R=turn, bias_error=rng.normal(size=n),
        disturbances=(Disturbance(np.ones(n), omega=3.0, phase=0.5, start=0.1), Disturbance(np.arange(n) * 1.0)),
    )  # fmt: skip
    law, dae = control_law(op, loop.gains, controller), derive_dae(loop, Feedback(controller), sinusoids=1)
    plant, surface, t = op.plant.with_parameters(world.p), true_surface(op, world), 0.7
    d = np.ones(n) * np.sin(3.0 * 0.6 + 0.5) + np.arange(n)
    q, v = op.q_d + 0.05 * rng.normal(size=n), rng.normal(size=n)
    found, lambda_, u, Phi, _ = look(dae, world, q, v, t=t)
    J = surface.J(q)
    size = np.abs(u).max() + np.abs(lambda_).max()
    assert u == pytest.approx(law(q, v, lambda_).full().ravel() + world.bias_error, abs=EXACT * size)
    assert plant.M(q) @ found + plant.theta(q, v) == pytest.approx(u + d + J.T @ lambda_, abs=EXACT * size)
    assert Phi == pytest.approx(surface.Phi(q), abs=1e-13)
    assert np.abs(Phi).max() > 1e-3
    second = J @ found + world.R @ plant.Jdot_qdot(q, v)
    assert second == pytest.approx(-2 * HOLD * J @ v - HOLD**2 * Phi, abs=EXACT * (np.abs(found).max() + size))


def test_the_tilt_that_acts_as_a_force(loop, rng):
    op, d = loop.operating_point, rng.normal(size=loop.operating_point.n)
    world = tilted(op, nominal_world(op), d)
    assert world.E.T @ op.lambda_d == pytest.approx(d, abs=1e-12)
    assert np.linalg.matrix_rank(world.E) == 1  # the least norm is taken by the outer product


def test_a_filtered_force_drives_the_law_and_follows_the_contact_force(shipped, rng):
    loop = shipped("planar_3r_circle")
    op, lag = loop.operating_point, 2e-3
    dae = derive_dae(loop, Feedback(path=ForcePath(lag=lag)))
    law = control_law(op, loop.gains, Controller.AFFINE_WITH_FORCE)
    (q, v), y = on_surface(op, rng), np.array([17.0])
    assert dae.input is Input.FILTERED
    _, lambda_, u, _, ydot = look(dae, nominal_world(op), q, v, y=y)
    assert u == pytest.approx(law(q, v, y).full().ravel(), rel=1e-13)
    assert ydot == pytest.approx((lambda_ - y) / lag, rel=1e-13)


def test_a_remembered_force_is_given_back_exactly_up_to_degree_seven(shipped, rng):
    loop = shipped("planar_3r_circle")
    op, span = loop.operating_point, (0.3, 0.004)
    dae = derive_dae(loop, Feedback(path=ForcePath(delay=1e-3)))
    law = control_law(op, loop.gains, Controller.AFFINE_WITH_FORCE)
    (q, v), polynomial = on_surface(op, rng), np.poly1d(rng.normal(size=NODES))
    values = {"memory": polynomial(nodes())[None, :], "span": np.array(span)}
    parameters = parameters_of(dae, nominal_world(op), t=0.3)
    for name, value in values.items():
        parameters = np.asarray(dae.layout.with_part(parameters, name, value.ravel())).ravel()
    for part in rng.uniform(size=5):
        u = dae.outputs(span[0] + part * span[1], np.concatenate([q, v]), parameters)[1].full().ravel()
        assert u == pytest.approx(law(q, v, [polynomial(part)]).full().ravel(), rel=1e-11)
