"""The derived functions against finite differences, closed forms and conservation laws."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import firmtouch
from firmtouch.mechanics.symbolic import derive_symbolically

IDENTITY = 1e-11  # exact identities over some hundred rounded operations, relative to the largest entry
DIFFERENCE = 1e-7  # central differences of step 1e-5: 1e-10 times third derivatives, and 1e-11 of rounding


def central(function, x, h=1e-5):
    """Differentiate by central differences; the derivative's index comes first."""
    steps = np.eye(len(x)) * h
    return np.array([(np.asarray(function(x + e)) - np.asarray(function(x - e))) / (2 * h) for e in steps])


@pytest.fixture
def states(plant, place, rng):
    """Five states around the place that the file names."""
    return [(place + rng.uniform(-0.1, 0.1, plant.n), rng.uniform(-1, 1, plant.n)) for _ in range(5)]


def close(actual, expected, tolerance):
    return actual == pytest.approx(expected, rel=tolerance, abs=tolerance * max(1.0, np.abs(expected).max()))


def test_first_and_second_derivatives_equal_central_differences(plant, states):
    for q, _ in states:
        assert close(central(plant.Phi, q).T, plant.J(q), DIFFERENCE)
        assert close(central(plant.P, q), plant.P_q(q), DIFFERENCE)
        assert close(central(plant.P_q, q), plant.P_qq(q), DIFFERENCE)
        assert close(np.moveaxis(central(plant.J, q), 0, 1), plant.Phi_qq(q), DIFFERENCE)


def test_differences_approach_the_derivatives_with_order_two(plant, states, observed_order):
    (q, _), *_ = states

    def error(h):
        return np.abs(central(plant.J, q, h) - np.moveaxis(plant.Phi_qq(q), 1, 0)).max()

    # Order two up to the next term of the series; below 1e-9 rounding of J over the step hides it.
    assert observed_order(error, 0.02, exact=1e-9) > 1.9


def test_jdot_qdot_is_the_second_rate_of_phi_along_a_straight_line(plant, states):
    for q, qdot in states:
        along = np.einsum("i,jik,k->j", qdot, plant.Phi_qq(q), qdot)
        assert close(plant.Jdot_qdot(q, qdot), along, IDENTITY)


def test_inertia_is_the_hessian_of_the_kinetic_energy(plant, states):
    for q, qdot in states:
        momentum = central(lambda v, q=q: plant.K(q, v), qdot)
        assert close(momentum, plant.M(q) @ qdot, DIFFERENCE)
        assert plant.K(q, qdot) == pytest.approx(qdot @ plant.M(q) @ qdot / 2, rel=IDENTITY)
        assert np.linalg.eigvalsh(plant.M(q))[0] > 0


def test_theta_holds_the_christoffel_symbols_and_m_dot_minus_twice_coriolis_is_skew(plant, states):
    for q, v in states:
        M_q = central(plant.M, q)  # M_q[k, i, j] = dM_ij / dq_k
        M_rate = np.einsum("kij,k->ij", M_q, v)
        C = (M_rate + np.einsum("jik,k->ij", M_q, v) - np.einsum("ijk,k->ij", M_q, v)) / 2
        assert close(plant.theta(q, v), C @ v + plant.P_q(q), DIFFERENCE)
        assert close(M_rate - 2 * C + (M_rate - 2 * C).T, np.zeros_like(C), IDENTITY)


def test_erratum_6_the_kinetic_energy_is_homogeneous_and_theta_is_passive(plant, states):
    for q, v in states:
        M_q = central(plant.M, q)
        left, right = v @ np.tensordot(v, M_q, axes=1) @ v, v @ np.einsum("kij,i,j->k", M_q, v, v)
        assert left == pytest.approx(right, rel=IDENTITY, abs=IDENTITY)
        assert close(2 * v @ (plant.theta(q, v) - plant.P_q(q)), left, DIFFERENCE)
        assert close(plant.K(q, -3 * v), 9 * plant.K(q, v), IDENTITY)


PARAMETERS = {"l": "0.4 m", "c": "0.18 m", "m": "2 kg", "I": "0.03 kg*m^2"}  # those of `make_arm`


def test_a_2r_arm_by_its_energies_is_the_same_plant_as_by_its_bodies(make_arm, make_model, rng):
    constraints, guess = {"wall": "0.55 - l*cos(q1) - l*cos(q1 + q2)"}, [1.0, -0.9]
    bodies = firmtouch.derive_plant(make_arm(2, constraints, guess).spec)
    speed = "(l*dot(q1))**2 + (c*(dot(q1) + dot(q2)))**2 + 2*l*c*cos(q2)*dot(q1)*(dot(q1) + dot(q2))"
    energies = {
        "kinetic_energy": f"(m*c**2*dot(q1)**2 + m*({speed}) + I*dot(q1)**2 + I*(dot(q1) + dot(q2))**2)/2",
        "potential_energy": "m*g*((c + l)*sin(q1) + c*sin(q1 + q2))",
    }
    guess = {"q1": 1.0, "q2": -0.9}
    parameters = PARAMETERS | {"g": "9.81 m/s^2"}
    model = make_model("q1 q2", parameters=parameters, mechanism=energies, constraints=constraints, guess=guess)
    given = firmtouch.derive_plant(model.spec)
    for q, v in rng.normal(size=(5, 2, 2)):
        assert close(given.M(q), bodies.M(q), IDENTITY)
        assert close(given.theta(q, v), bodies.theta(q, v), IDENTITY)
        assert close(given.P_qq(q), bodies.P_qq(q), IDENTITY)
        assert given.K(q, v) == pytest.approx(bodies.K(q, v), rel=IDENTITY)


@pytest.fixture(scope="module")
def make_top(make_model):
    """Make a free rigid body at the end of an idle slider, which carries the constraint that a model must have."""

    def make(orientation, **body):
        body = {
            "mass": "m",
            "inertia": [1, 2, 3.5],
            "orientation": orientation,
            "centre_of_mass": "[0*s, 0*s, s]",
            **body,
        }
        mechanism = {"gravity": "[0, 0, 0]", "bodies": {"top": body}}
        guess = {"s": 0, "a": 0.3, "b": 0.4, "c": 0.2}
        parameters = {"m": "2 kg"}
        model = make_model(
            "s:m a b c", parameters=parameters, mechanism=mechanism, constraints={"held": "s"}, guess=guess
        )
        return firmtouch.derive_plant(model.spec)

    return make


TURNS = [{"z": "a"}, {"y": "b"}, {"x": "c"}]
MATRIX = [
    ["cos(a)*cos(b)", "cos(a)*sin(b)*sin(c) - sin(a)*cos(c)", "cos(a)*sin(b)*cos(c) + sin(a)*sin(c)"],
    ["sin(a)*cos(b)", "sin(a)*sin(b)*sin(c) + cos(a)*cos(c)", "sin(a)*sin(b)*cos(c) - cos(a)*sin(c)"],
    ["-sin(b)", "cos(b)*sin(c)", "cos(b)*cos(c)"],
]


def test_an_orientation_as_turns_and_as_a_matrix_is_the_same(make_top, rng):
    turns, matrix = make_top(TURNS), make_top(MATRIX)
    for q, v in rng.normal(size=(5, 2, 4)):
        assert close(turns.M(q), matrix.M(q), IDENTITY)
        assert close(turns.theta(q, v), matrix.theta(q, v), IDENTITY)


def test_sympy_turns_about_each_axis_as_casadi_does(make_top, rng):
    plant = make_top([{"x": "a"}, {"y": "b"}, {"z": "c"}])
    symbolic = derive_symbolically(plant.spec)
    kinetic_energy = sympy.lambdify([*symbolic.q, *symbolic.qdot, *symbolic.p], symbolic.K)
    for q, v in rng.normal(size=(5, 2, 4)):
        assert kinetic_energy(*q, *v, *plant.p) == pytest.approx(plant.K(q, v), rel=IDENTITY)


def test_an_inertia_as_a_turned_matrix_is_the_same_body(make_top, rng):
    axes = Rotation.from_euler("ZYX", [0.5, -0.3, 0.8]).as_matrix()
    turned = (axes @ np.diag([1, 2, 3.5]) @ axes.T).tolist()
    turned = [[turned[max(i, j)][min(i, j)] for j in range(3)] for i in range(3)]
    back = [{"x": -0.8}, {"y": 0.3}, {"z": -0.5}]
    plain, other = make_top(TURNS), make_top([*TURNS, *back], inertia=turned)
    for q, v in rng.normal(size=(5, 2, 4)):
        assert close(other.M(q), plain.M(q), IDENTITY)
        assert close(other.theta(q, v), plain.theta(q, v), IDENTITY)


def test_a_free_body_keeps_its_angular_momentum_in_the_world(make_top):
    top, inertia = make_top(TURNS), np.diag([1, 2, 3.5])

    def rate(_, state):
        return np.concatenate([state[4:], -np.linalg.solve(top.M(state[:4]), top.theta(state[:4], state[4:]))])

    def angular_momentum(state):
        turn = lambda t: Rotation.from_euler("ZYX", state[1:4] + t * state[5:8]).as_matrix()  # noqa: E731
        R, R_rate = turn(0.0), (turn(1e-6) - turn(-1e-6)) / 2e-6
        S = R.T @ R_rate
        return R @ inertia @ [S[2, 1], S[0, 2], S[1, 0]]

    run = solve_ivp(rate, (0, 1), [0, 0.3, 0.4, 0.2, 0, 0.5, 0.7, -0.9], rtol=1e-10, atol=1e-10)
    momenta = np.array([angular_momentum(state) for state in run.y.T])
    assert np.ptp(run.y[1:4], axis=1).min() > 0.1  # it tumbles
    assert close(momenta, np.broadcast_to(momenta[0], momenta.shape), 1e-8)  # rotation differences: 1e-10 a step


@pytest.fixture(scope="module")
def make_spherical_pendulum(make_model):
    """Make a point mass on a rod, by azimuth a and polar angle b from below; a slider carries the constraint."""

    def make(gravity="[0, 0, -9.81]", place="[l*sin(b)*cos(a), l*sin(b)*sin(a), -l*cos(b)]"):
        body = {"mass": "m", "centre_of_mass": f"{place} + [0*s, 0*s, 0*s]"}
        slider = {"mass": "m", "centre_of_mass": "[s, 0*s, 0*s]"}
        mechanism = {"gravity": gravity, "bodies": {"ball": body, "slider": slider}}
        parameters, guess = {"m": "1.5 kg", "l": "0.8 m"}, {"a": 0.2, "b": 0.7, "s": 0}
        return firmtouch.derive_plant(
            make_model(
                "a b s:m", parameters=parameters, mechanism=mechanism, constraints={"held": "s"}, guess=guess
            ).spec
        )

    return make


def test_a_spherical_pendulum_has_its_closed_form(make_spherical_pendulum, rng):
    plant, m, length, g = make_spherical_pendulum(), 1.5, 0.8, 9.81
    for (a, b, s), v in rng.normal(size=(5, 2, 3)):
        sin, cos = np.sin(b), np.cos(b)
        assert close(plant.M([a, b, s]), np.diag([m * (length * sin) ** 2, m * length**2, m]), IDENTITY)
        twist = 2 * m * length**2 * sin * cos * v[0] * v[1]
        fall = m * g * length * sin - m * length**2 * sin * cos * v[0] ** 2
        assert close(plant.theta([a, b, s], v), np.array([twist, fall, 0]), IDENTITY)


def test_turning_gravity_and_the_frame_together_changes_nothing(make_spherical_pendulum, rng):
    plain = make_spherical_pendulum()
    turned = make_spherical_pendulum("[0, 9.81, 0]", "[l*sin(b)*cos(a), l*cos(b), l*sin(b)*sin(a)]")
    for q, v in rng.normal(size=(5, 2, 3)):
        assert close(turned.theta(q, v), plain.theta(q, v), IDENTITY)
        assert close(turned.M(q)[:2, :2], plain.M(q)[:2, :2], IDENTITY)


def test_the_potentials_zero_and_the_names_do_not_matter(make_model, rng):
    def make(x, y, zero):
        energies = {
            "kinetic_energy": f"j*((1 + {x}**2)*dot({x})**2/2 + dot({x})*dot({y})/4 + dot({y})**2)",
            "potential_energy": f"k*(sin({x})*{y} + {y}**2 + {zero})",
        }
        constraints, guess = {"c": {"expression": f"{y} - {x}**2", "unit": "1"}}, {x: 0.3, y: 0.1}
        units = {"j": "1 kg*m^2", "k": "1 J"}
        model = make_model(f"{x} {y}", parameters=units, mechanism=energies, constraints=constraints, guess=guess)
        return firmtouch.derive_plant(model.spec)

    one, other = make("x1", "y1", 0), make("beta", "alpha", 1234.5)
    for q, v in rng.normal(size=(5, 2, 2)):
        assert np.array_equal(one.M(q), other.M(q))
        assert np.array_equal(one.theta(q, v), other.theta(q, v))
        assert np.array_equal(one.P_qq(q), other.P_qq(q))
        assert np.array_equal(one.Phi_qq(q), other.Phi_qq(q))
        assert other.P(q) - one.P(q) == pytest.approx(1234.5)


def test_other_parameters_scale_what_they_should(make_arm, rng):
    model = make_arm(2, {"wall": "0.55 - x(p2)"}, [1.0, -0.9])
    plant = firmtouch.derive_plant(model.spec)
    index = list(model.spec.parameters)
    heavier = plant.p * [2.0 if name in ("m", "I") else 1.0 for name in index]
    q, v = rng.normal(size=(2, 2))
    assert close(plant.with_parameters(heavier).theta(q, v), 2 * plant.theta(q, v), IDENTITY)
    assert close(plant.with_parameters(heavier).J(q), plant.J(q), IDENTITY)
    with pytest.raises(ValueError, match="read-only"):
        plant.p[0] = 1.0
