"""SymPy's derivation against CasADi's, a foreign derivation as oracle, and the sign of the multipliers."""

import numpy as np
import pytest
import sympy
from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

import firmtouch
from firmtouch.checks.derivatives import worth_comparing
from firmtouch.checks.subject import make_subject
from firmtouch.mechanics.symbolic import derive_symbolically

ROUNDING = 1e-10  # two orders of evaluating the same expressions of some hundred operations


def test_both_derivations_agree_at_random_states(plant, rng):
    if not worth_comparing(make_subject(plant.spec)):
        pytest.skip("SymPy would take minutes; its derivation is not used for this model either")
    ours = derive_symbolically(plant.spec)
    matrices = [ours.M, ours.theta, ours.Phi, ours.J, ours.Jdot_qdot, ours.P_q, ours.P_qq, *ours.Phi_qq]
    arguments = [*ours.q, *ours.qdot, *ours.p]
    evaluate = sympy.lambdify(arguments, [sympy.Matrix([[ours.K, ours.P]]), *matrices], cse=True)
    point = plant.spec.operating_point.q_d or plant.spec.operating_point.guess
    for _ in range(3):
        q = np.array([point[name] for name in plant.spec.coordinates]) + rng.uniform(-0.1, 0.1, plant.n)
        v = rng.uniform(-1, 1, plant.n)
        moving = plant.theta(q, v), plant.Phi(q), plant.J(q), plant.Jdot_qdot(q, v)
        rest = plant.P_q(q), plant.P_qq(q), *plant.Phi_qq(q)
        numbers = [np.array([plant.K(q, v), plant.P(q)]), plant.M(q), *moving, *rest]
        for symbolic, number in zip(evaluate(*q, *v, *plant.p), numbers, strict=True):
            size = max(1.0, np.abs(number).max())
            assert np.reshape(symbolic, number.shape) == pytest.approx(number, rel=0, abs=ROUNDING * size)


def test_the_symbols_are_those_of_the_file(arm_on_circle):
    symbolic = derive_symbolically(arm_on_circle.spec)
    assert [str(each) for each in (*symbolic.q, *symbolic.qdot)] == ["q1", "q2", "q3", "q1_dot", "q2_dot", "q3_dot"]
    assert [str(each) for each in (*symbolic.p, *symbolic.lambda_)] == ["l", "c", "m", "I", "lambda_circle"]


@pytest.fixture
def rod(make_model):
    """A point mass on a rod in Cartesian coordinates: phi grows outwards, so the rod's pull is a negative lambda."""
    body = {"mass": "m", "centre_of_mass": "[x1, y1]"}
    return firmtouch.derive_plant(
        make_model(
            "x1:m y1:m",
            parameters={"m": "3 kg", "l": "2 m"},
            mechanism={"gravity": "[0, -9.81]", "bodies": {"ball": body}},
            constraints={"rod": "norm([x1, y1]) - l"},
            guess={"x1": 0, "y1": -2},
            lambda_d={"rod": -29.43},
            design={"level": "tangent"},
        ).spec
    )


@pytest.mark.parametrize("angle", [0.0, 0.7, -2.0])
@pytest.mark.parametrize("speed", [0.0, 1.5])
def test_the_multiplier_of_a_pendulum_is_its_rod_force(rod, angle, speed):
    q, v = 2 * np.array([np.sin(angle), -np.cos(angle)]), speed * np.array([np.cos(angle), np.sin(angle)])
    J = rod.J(q)
    matrix = np.block([[rod.M(q), -J.T], [J, np.zeros((1, 1))]])
    *acceleration, multiplier = np.linalg.solve(matrix, -np.concatenate([rod.theta(q, v), rod.Jdot_qdot(q, v)]))
    pull = 3 * 9.81 * np.cos(angle) + 3 * speed**2 / 2  # weight along the rod and m v^2 / l
    assert multiplier == pytest.approx(-pull, rel=1e-12)
    assert q[0] * acceleration[1] - q[1] * acceleration[0] == pytest.approx(-2 * 9.81 * np.sin(angle), rel=1e-12)


def test_at_rest_the_pendulums_multiplier_balances_its_weight_and_gives_its_frequency(rod):
    op = firmtouch.find_operating_point(rod)
    assert op.g == pytest.approx(op.f_d)  # Eq. (6) without controls
    assert op.N0[0, 0] / op.M[0, 0] == pytest.approx(9.81 / 2)  # g / l; without lambda times the Hessian it would be 0
    assert op.P_qq == pytest.approx(np.zeros((2, 2)))


def test_sympys_lagranges_method_gives_the_same_plant_with_the_same_sign_of_lambda(make_arm, rng):
    plant = firmtouch.derive_plant(make_arm(2, {"wall": "0.55 - x(p2)"}, [1.0, -0.9]).spec)
    length, c, m, I = plant.p  # noqa: E741
    q1, q2 = q = dynamicsymbols("q1 q2")
    v = [each.diff() for each in q]
    elbow = sympy.Matrix([sympy.cos(q1), sympy.sin(q1)])
    along = sympy.Matrix([sympy.cos(q1 + q2), sympy.sin(q1 + q2)])
    centres = [c * elbow, length * elbow + c * along]
    K = sum(m * centre.diff("t").dot(centre.diff("t")) for centre in centres) / 2 + I * (v[0] ** 2 + sum(v) ** 2) / 2
    P = sum(m * 9.81 * centre[1] for centre in centres)
    wall = 0.55 - (length * elbow + length * along)[0]
    method = LagrangesMethod(K - P, q, hol_coneqs=[wall])
    eom = method.form_lagranges_equations()  # the side that must vanish
    a = [each.diff() for each in v]
    columns = eom.jacobian(method.lam_vec)  # SymPy's sign, which differs between `eom` and `mass_matrix`
    evaluate = sympy.lambdify([a, v, q], [eom.subs(method.lam_vec[0], 0), columns, method.mass_matrix, method.forcing])
    for acceleration, qdot, at in rng.normal(size=(5, 3, 2)):
        left, side, mass_matrix, forcing = evaluate(acceleration, qdot, at)
        J, theta = plant.J(at), plant.theta(at, qdot)
        assert left.ravel() == pytest.approx(plant.M(at) @ acceleration + theta, abs=ROUNDING)  # Eq. (4), u = 0
        assert mass_matrix == pytest.approx(np.hstack([plant.M(at), -J.T]), abs=ROUNDING)  # our sign, as `rhs` has it
        # Whatever the sign of the multiplier, the force that SymPy's equations put on the arm is J^T lambda.
        theirs = np.linalg.solve(np.block([[plant.M(at), side], [J, np.zeros((1, 1))]]), [*forcing.ravel(), 0])
        ours = np.linalg.solve(np.block([[plant.M(at), -J.T], [J, np.zeros((1, 1))]]), [*-theta, 0])
        assert -side.ravel() * theirs[2] == pytest.approx(J.ravel() * ours[2], abs=ROUNDING)
