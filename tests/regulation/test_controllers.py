"""The four laws, the algebraic force loop, the Lyapunov function (9), and strong force feedback [T7]."""

from dataclasses import replace

import numpy as np
import pytest

import firmtouch
from firmtouch.regulation import Gains, closed_loop_acceleration, control_law, project, steady_state_errors
from firmtouch.regulation.controllers import Controller

EXACT = 1e-10  # forces of some hundred newtons, rounded


def call(law, *arguments):
    return np.asarray(law(*arguments).full()).ravel()


@pytest.fixture(scope="module")
def loop3r(arm_on_circle, loop_of):
    return loop_of(arm_on_circle)


def along(op, distance, direction=0):
    """Start on the constraint, some way along a free direction."""
    free = np.linalg.svd(op.J)[2][op.m + direction]
    return project(op.plant, op.q_d + distance * free).q


@pytest.mark.parametrize("controller", Controller)
def test_at_the_regulation_point_every_law_rests(loop, controller):
    op, law = loop.operating_point, control_law(loop.operating_point, loop.gains, controller)
    assert call(law, op.q_d, np.zeros(op.n), op.lambda_d) == pytest.approx(op.g - op.J.T @ op.lambda_d, abs=EXACT)
    acceleration, lambda_ = closed_loop_acceleration(op, law, op.q_d, np.zeros(op.n), d=np.zeros(op.n))
    size = np.abs(np.linalg.inv(op.M)).max() * max(1.0, np.abs(op.g).max())
    assert acceleration == pytest.approx(np.zeros(op.n), abs=EXACT * size)
    assert lambda_ == pytest.approx(op.lambda_d, rel=1e-9, abs=1e-9)


def test_the_laws_differ_by_the_jacobian_that_turns_the_force_error(loop, rng):
    op, gains = loop.operating_point, loop.gains
    laws = {each: control_law(op, gains, each) for each in Controller}
    for _ in range(3):
        q, v, lambda_ = op.q_d + rng.normal(size=op.n) / 10, rng.normal(size=op.n), rng.normal(size=op.m) * 10
        push = gains.G_f @ (lambda_ - op.lambda_d)
        u = {each: call(law, q, v, lambda_) for each, law in laws.items()}
        affine = op.g - op.J.T @ op.lambda_d - gains.W @ (q - op.q_d) - gains.C @ v
        assert u[Controller.AFFINE] == pytest.approx(affine, abs=EXACT)  # Eq. (15)
        assert u[Controller.AFFINE_WITH_FORCE] == pytest.approx(affine + op.J.T @ push, abs=EXACT)  # Eq. (17)
        difference = u[Controller.ENERGY_WITH_FORCE] - u[Controller.ENERGY]
        assert difference == pytest.approx(op.plant.J(q).T @ push, abs=EXACT)  # Eq. (11)


@pytest.fixture(scope="module")
def shaped(make_model):
    """Make a 2-link mechanism given by energies, and P_d of Eq. (12) (plus a text) in the file's own words."""

    def make(more="0"):
        K = "j*(3*dot(a)**2/2 + dot(b)**2/2 + cos(b - a)*dot(a)*dot(b)/2)"
        P = "k*(12*sin(a) + 4*sin(b))"
        common = {
            "parameters": {"j": "1 kg*m^2", "k": "1 J"},
            "constraints": {"wall": {"expression": "1.2 - cos(a) - cos(b)", "unit": "1"}},
            "guess": {"a": 1.0, "b": 0.8},
        }
        model = make_model("a b", mechanism={"kinetic_energy": K, "potential_energy": P}, **common)
        op = firmtouch.find_operating_point(firmtouch.derive_plant(model.spec))
        gains = Gains(W=np.array([[30.0, 5], [5, 20]]), C=np.eye(2) * 4, G_f=np.eye(1), bias=op.g - op.f_d)
        (a, b), (x, y), W = op.q_d, gains.bias, gains.W
        da, db = f"(a - {a:.17g})", f"(b - {b:.17g})"
        quadratic = f"{W[0, 0]}*{da}**2/2 + {W[0, 1]}*{da}*{db} + {W[1, 1]}*{db}**2/2"
        text = f"{P} - k*({x:.17g}*a + {y:.17g}*b) + k*({quadratic}) + k*({more.format(da=da, db=db)})"  # Eq. (12)
        shaping = make_model("a b", mechanism={"kinetic_energy": K, "potential_energy": text}, **common).spec
        return op, gains, shaping.mechanism.potential_energy

    return make


def test_eq_5_with_the_potential_of_eq_12_is_eq_15(shaped, rng):
    op, gains, P_d = shaped()
    for named, plain in (
        (Controller.ENERGY, Controller.AFFINE),
        (Controller.ENERGY_WITH_FORCE, Controller.ENERGY_WITH_FORCE),
    ):
        one, other = control_law(op, gains, named, P_d=P_d), control_law(op, gains, plain)
        for q, v in op.q_d + rng.normal(size=(4, 2, 2)):
            assert call(one, q, v, [3.0]) == pytest.approx(call(other, q, v, [3.0]), abs=EXACT)


def test_any_potential_with_the_right_gradient_rests_and_shapes_the_law(shaped, rng):
    op, gains, P_d = shaped("3*{da}**4 + {da}*{db}**2")
    law = control_law(op, gains, Controller.ENERGY, P_d=P_d)
    assert call(law, op.q_d, [0, 0], op.lambda_d) == pytest.approx(op.g - op.f_d, abs=EXACT)
    for da, db in rng.normal(size=(3, 2)):
        plain = gains.bias - gains.W @ [da, db]
        gradient = [12 * da**3 + db**2, 2 * da * db]
        assert call(law, np.add(op.q_d, [da, db]), [0, 0], [0.0]) == pytest.approx(plain - gradient, abs=EXACT)


@pytest.mark.parametrize("controller", Controller)
def test_the_acceleration_solves_eq_4_and_keeps_the_constraint(loop, controller, rng):
    op, plant, law = (
        loop.operating_point,
        loop.operating_point.plant,
        control_law(loop.operating_point, loop.gains, controller),
    )
    q, v, d = op.q_d + rng.normal(size=op.n) / 20, rng.normal(size=op.n), rng.normal(size=op.n)
    acceleration, lambda_ = closed_loop_acceleration(op, law, q, v, d=d)
    left = plant.M(q) @ acceleration + plant.theta(q, v)
    right = plant.J(q).T @ lambda_ + call(law, q, v, lambda_) + d
    assert left == pytest.approx(right, abs=EXACT * np.abs(right).max() * 10)
    second_rate = plant.J(q) @ acceleration + plant.Jdot_qdot(q, v)
    assert second_rate == pytest.approx(np.zeros(op.m), abs=EXACT * np.abs(acceleration).max())


def lyapunov(op, gains, q, v):
    """V of Eq. (9) with P_d of Eq. (12), up to a constant."""
    dq = q - op.q_d
    P_d = op.plant.P(q) - gains.bias @ q + dq @ gains.W @ dq / 2
    return v @ op.plant.M(q) @ v / 2 + P_d - op.plant.Phi(q) @ op.lambda_d


@pytest.mark.parametrize("controller", [Controller.AFFINE, Controller.ENERGY_WITH_FORCE, Controller.AFFINE_WITH_FORCE])
def test_v_of_eq_9_falls_at_the_rate_of_the_damping(loop3r, simulate, controller):
    op, gains = loop3r.operating_point, replace(loop3r.gains, G_f=np.array([[20.0]]))

    def integrands(q, v, lambda_):
        turned = (op.J - op.plant.J(q)).T @ gains.G_f @ (lambda_ - op.lambda_d)
        return v @ gains.C @ v, v @ turned

    law = control_law(op, gains, controller)
    run = simulate(op, law, along(op, 0.4), np.zeros(op.n), 1.5, integrands=integrands)
    V = np.array([lyapunov(op, gains, q, v) for q, v in zip(run.q, run.v, strict=True)])
    damped, turned = run.integrals.T
    fed = turned if controller is Controller.AFFINE_WITH_FORCE else 0 * turned
    # The integrator is asked for 1e-10 a step; drift off the constraint adds lambda_d times as much.
    assert V + damped - fed == pytest.approx(np.full(len(V), V[0]), abs=1e-7)
    assert V[0] - V[-1] > 0.1
    if controller is Controller.AFFINE_WITH_FORCE:
        assert np.abs(turned).max() > 1e-3  # the extra term is there, and (11) does not have it
        assert np.abs(V + damped - V[0]).max() > 1e-3
    else:
        assert np.diff(V).max() < 1e-9


def test_t7_force_feedback_of_1000_converges_with_the_force_error_divided_by_1001(loop3r, simulate):
    op, d, left = loop3r.operating_point, np.array([0.02, -0.01, 0.006]), {}
    for g in (0.0, 1000.0):
        gains = replace(loop3r.gains, G_f=np.array([[g]]))
        law = control_law(op, gains, Controller.AFFINE_WITH_FORCE)
        run = simulate(op, law, along(op, 0.6), np.zeros(op.n), 8.0, d=d, tolerance=1e-9)
        assert np.abs(run.v[-1]).max() < 1e-6  # at rest: slowest pole -4, and exp(-32) is 1e-14
        left[g] = run.lambda_[-1, 0] - op.lambda_d[0]
        predicted = (
            steady_state_errors(firmtouch.close_loop(op, gains), op.plant.spec.bounds).force.constraint_force @ d
        )
        assert left[g] == pytest.approx(predicted[0], rel=0.1)  # second order in d
    assert left[1000.0] * 1001 == pytest.approx(left[0.0], rel=0.02)  # J(q) is not J(q_d) at the resting place


def test_t7_every_force_feedback_makes_a_well_posed_algebraic_loop_near_the_point(loop3r, rng):
    op = loop3r.operating_point
    for g in np.geomspace(1e-3, 1e6, 10):
        law = control_law(op, replace(loop3r.gains, G_f=np.array([[g]])), Controller.AFFINE_WITH_FORCE)
        q = along(op, 0.3)
        _, lambda_ = closed_loop_acceleration(op, law, q, np.zeros(op.n), d=np.zeros(op.n))
        assert abs(lambda_ - op.lambda_d) < 100 / (1 + g) + 1e-6
