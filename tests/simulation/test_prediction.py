"""The linear prediction of a scenario: against python-control, against the equations themselves, and as a limit."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline
from scipy.linalg import expm

import firmtouch
from firmtouch.modelfile import parse_model
from firmtouch.modelfile.scenarios import parse_scenarios
from firmtouch.modelfile.sections.bounds import Bounds
from firmtouch.regulation import close_loop, steady_state_errors
from firmtouch.regulation.controllers import Controller
from firmtouch.regulation.state_space import state_space
from firmtouch.simulation.from_file import scenarios_of, usual_duration
from firmtouch.simulation.prediction import predict
from firmtouch.simulation.run import build_simulator, simulate
from firmtouch.simulation.scenario import Feedback, Scenario, Start
from firmtouch.simulation.world import Disturbance, nominal_world, tilted

EXACT = 1e-9  # two exact solutions by matrix exponentials, 300 products one after the other


@pytest.fixture(scope="module")
def corner(arm_in_corner, loop_of):
    """n = 4, m = 2, so that everything that can be a matrix is one; K12 and C12 are not those that decouple the force."""
    loop = loop_of(arm_in_corner)
    gains, split = loop.gains, loop.split
    across = split.V1 @ np.array([[0.5, -1.0], [0.7, 0.3]]) @ split.V2.T
    G_f = np.array([[0.5, 0.2], [0.2, 1.0]])
    changed = replace(gains, W=gains.W + across + across.T, C=gains.C - 0.2 * (across + across.T), G_f=G_f)
    return close_loop(loop.operating_point, changed)


def scenario(loop, world=None, *, q=None, qdot=None, duration=1.0, **feedback):
    op = loop.operating_point
    start = Start(op.q_d if q is None else q, np.zeros(op.n) if qdot is None else qdot)
    return Scenario("test", "", Feedback(**feedback), start, world or nominal_world(op), duration)


def aside(loop, *sizes):
    """A displacement along the free directions."""
    return loop.split.V2 @ np.array(sizes)


def scale(*arrays):
    """The largest entry; 1e-3 at least, since differences carry the rounding of q_d and lambda_d."""
    return max(1e-3, *(float(np.max(np.abs(each))) for each in arrays))


def near(actual, expected, tolerance=EXACT):
    np.testing.assert_allclose(actual, expected, rtol=0, atol=tolerance * scale(expected))


def by_control(loop, t, forces, x0=None):
    """Let python-control solve the linear loop for forces (k x n) that are linear between the instants."""
    import control

    found = control.forced_response(
        state_space(loop), t, np.array(forces).T, 0 if x0 is None else x0, return_states=True
    )
    n = loop.operating_point.n
    return found.outputs[:n].T, found.outputs[n:].T, found.states[:, -1]


class TestPythonControl:
    def test_a_constant_force(self, corner):
        op, d = corner.operating_point, np.array([1.0, -0.4, 0.3, 0.7])
        found = predict(corner, scenario(corner, nominal_world(op, Disturbance(d))))
        dq, dlambda, _ = by_control(corner, found.t, np.tile(d, (found.t.size, 1)))
        near(found.q - op.q_d, dq)
        near(found.lambda_ - op.lambda_d, dlambda)

    def test_a_start_error_with_a_velocity(self, corner):
        op = corner.operating_point
        q, qdot = aside(corner, 0.1, -0.05), aside(corner, -0.3, 0.6)
        found = predict(corner, scenario(corner, q=op.q_d + q, qdot=qdot))
        x0 = np.concatenate([corner.split.V2.T @ q, corner.split.V2.T @ qdot])
        dq, dlambda, _ = by_control(corner, found.t, np.zeros((found.t.size, op.n)), x0)
        near(found.q - op.q_d, dq)
        near(found.lambda_ - op.lambda_d, dlambda)

    def test_a_pulse_that_begins_and_ends(self, corner):
        op, d = corner.operating_point, np.array([0.5, 1.0, -1.0, 0.2])
        found = predict(corner, scenario(corner, nominal_world(op, Disturbance(d, start=0.2, end=0.5))))
        x0 = np.zeros(4)
        for begin, end, force in ((0, 0.2, 0 * d), (0.2, 0.5, d), (0.5, 1.0, 0 * d)):
            # An instant of a change stands twice: just before it and just after it.
            (stretch,) = np.nonzero((found.t >= begin - 1e-12) & (found.t <= end + 1e-12))
            stretch = stretch[(found.t[stretch] > begin + 1e-12) & (found.t[stretch] < end - 1e-12)]
            first, last = stretch[0] - 1, stretch[-1] + 1
            t = np.linspace(begin, end, last - first + 1)
            np.testing.assert_allclose(found.t[first : last + 1], t, atol=1e-12)
            dq, dlambda, x0 = by_control(corner, t - begin, np.tile(force, (t.size, 1)), x0)
            near(found.q[first : last + 1] - op.q_d, dq, 1e-8)
            near(found.lambda_[first : last + 1] - op.lambda_d, dlambda, 1e-8)

    def test_forces_that_swing(self, corner):
        op, d, other = corner.operating_point, np.array([1.0, 0.2, -0.5, 0.4]), np.array([0.0, -0.3, 0.3, 0.6])
        swings = (Disturbance(d, omega=9.0, phase=0.7), Disturbance(other, omega=4.0))
        found = predict(corner, scenario(corner, nominal_world(op, *swings)))
        finer = 40  # python-control joins the instants by lines: an error of (omega h)^2 / 8 = 7e-8 of the force
        t = np.linspace(0, 1, (found.t.size - 1) * finer + 1)
        forces = np.outer(np.sin(9 * t + 0.7), d) + np.outer(np.sin(4 * t), other)
        dq, dlambda, _ = by_control(corner, t, forces)
        near(found.q - op.q_d, dq[::finer], 3e-7)
        near(found.lambda_ - op.lambda_d, dlambda[::finer], 3e-7)

    def test_a_swing_has_its_phase_where_it_begins(self, corner):
        op, d = corner.operating_point, np.array([1.0, 0.2, -0.5, 0.4])
        early = predict(corner, scenario(corner, nominal_world(op, Disturbance(d, omega=7.0, phase=0.3))))
        late = predict(
            corner, scenario(corner, nominal_world(op, Disturbance(d, start=0.5, omega=7.0, phase=0.3)), duration=1.5)
        )
        after = slice(late.t.size - early.t.size, None)
        near(late.t[after] - 0.5, early.t)
        near(late.q[after] - op.q_d, early.q - op.q_d)
        near(late.lambda_[after] - op.lambda_d, early.lambda_ - op.lambda_d)
        before = slice(0, late.t.size - early.t.size)
        near(late.q[before], np.tile(op.q_d, (before.stop, 1)))


def by_the_equations(loop, t, *, d, Delta, q, qdot):
    """Solve M dq'' + C dq' + K dq = J^T (I + G_f) dlambda + d, J dq = Delta in dq itself, without any split."""
    op, gains = loop.operating_point, loop.gains
    n, m = op.n, op.m
    kkt = np.block([[op.M, -op.J.T @ (np.eye(m) + gains.G_f)], [op.J, np.zeros((m, m))]])
    right = np.block([[-loop.K, -gains.C, d[:, None]], [np.zeros((m, 2 * n + 1))]])
    solved = np.linalg.solve(kkt, right)  # (dq'', dlambda) for (dq, dq', 1)
    whole = np.zeros((2 * n + 1, 2 * n + 1))
    whole[:n, n : 2 * n] = np.eye(n)
    whole[n : 2 * n] = solved[:n]
    # The least change onto the constraints, and a velocity along them.
    onto = np.linalg.pinv(op.J)
    dq0 = q - op.q_d + onto @ (Delta - op.J @ (q - op.q_d))
    state = np.concatenate([dq0, qdot - onto @ op.J @ qdot, [1.0]])
    states = np.array([expm(whole * each) @ state for each in t])
    return op.q_d + states[:, :n], op.lambda_d + states @ solved[n:].T


ANGLE = 0.1
R = np.array([[np.cos(ANGLE), -np.sin(ANGLE)], [np.sin(ANGLE), np.cos(ANGLE)]])
E = np.array([[0.01, 0.0, -0.02, 0.005], [0.0, 0.03, 0.01, 0.0]])
SMALL_DELTA = np.array([2e-3, -1e-3])
PUSH = np.array([0.3, -0.1, 0.2, 0.1])


class TestTheEquationsThemselves:
    """In the coordinates q, by the linear DAE: nothing is shared with the split into tangent and normal directions."""

    @pytest.mark.parametrize(
        ("change", "as_force"),
        [
            ({"Delta": SMALL_DELTA}, lambda op: np.zeros(4)),
            ({"E": E}, lambda op: E.T @ op.lambda_d),
            ({"R": R}, lambda op: op.J.T @ (R.T - np.eye(2)) @ op.lambda_d),
            ({"bias_error": PUSH}, lambda op: PUSH),
            ({"Delta": SMALL_DELTA, "E": E, "R": R, "bias_error": PUSH}, lambda op: E.T @ op.lambda_d + op.J.T @ (R.T - np.eye(2)) @ op.lambda_d + PUSH),
        ],
        ids=["offset", "tilt", "rotation", "gravity", "all"],
    )  # fmt: skip
    def test_a_world_that_is_off(self, corner, change, as_force):
        op = corner.operating_point
        world = replace(nominal_world(op), **change)
        q, qdot = op.q_d + aside(corner, 0.02, 0.03), aside(corner, 0.1, 0.2)
        found = predict(corner, scenario(corner, world, q=q, qdot=qdot))
        some = slice(0, None, 23)
        expected = by_the_equations(corner, found.t[some], d=as_force(op), Delta=world.Delta, q=q, qdot=qdot)
        near(found.q[some] - op.q_d, expected[0] - op.q_d)
        near(found.lambda_[some] - op.lambda_d, expected[1] - op.lambda_d)

    def test_other_masses_act_by_their_weight(self, corner):
        op = corner.operating_point
        names = list(op.plant.spec.parameters)
        p = np.array(op.plant.p)
        p[names.index("m")] += 0.1
        found = predict(corner, scenario(corner, replace(nominal_world(op), p=p)))
        heavier = op.plant.with_parameters(p).P_q(op.q_d) - op.g
        assert np.max(np.abs(heavier)) > 0.1
        expected = by_the_equations(corner, found.t[::23], d=-heavier, Delta=np.zeros(2), q=op.q_d, qdot=np.zeros(4))
        near(found.q[::23] - op.q_d, expected[0] - op.q_d)
        near(found.lambda_[::23] - op.lambda_d, expected[1] - op.lambda_d)

    @pytest.mark.parametrize("controller", [Controller.AFFINE, Controller.ENERGY])
    def test_without_force_feedback_the_force_error_is_the_whole_one(self, corner, controller):
        op, d = corner.operating_point, np.array([1.0, -0.4, 0.3, 0.7])
        world = nominal_world(op, Disturbance(d))
        with_feedback = predict(corner, scenario(corner, world))
        without = predict(corner, scenario(corner, world, controller=controller))
        near(without.q, with_feedback.q)
        divided = (with_feedback.lambda_ - op.lambda_d) @ (np.eye(2) + corner.gains.G_f).T
        near(without.lambda_ - op.lambda_d, divided)


def test_nothing_happens_where_nothing_is_wrong(corner):
    op = corner.operating_point
    found = predict(corner, scenario(corner))
    near(found.q, np.tile(op.q_d, (found.t.size, 1)), 1e-15)
    near(found.lambda_, np.tile(op.lambda_d, (found.t.size, 1)), 1e-15)


def _vector(size):
    return st.lists(st.floats(-1, 1), min_size=size, max_size=size).map(np.array)


CAUSES = st.fixed_dictionaries(
    {"x": _vector(2), "v": _vector(2), "d": _vector(4), "swing": _vector(4), "Delta": _vector(2), "E": _vector(8), "bias_error": _vector(4)}
)  # fmt: skip


@settings(max_examples=15)
@given(first=CAUSES, second=CAUSES, a=st.floats(-2, 2), b=st.floats(-2, 2))
def test_effects_of_causes_add_up(corner, first, second, a, b):
    op = corner.operating_point

    def effect(causes):
        world = nominal_world(
            op, Disturbance(causes["d"], start=0.3), Disturbance(causes["swing"], end=0.6, omega=5.0, phase=1.0)
        )
        world = replace(world, Delta=causes["Delta"], E=causes["E"].reshape(2, 4), bias_error=causes["bias_error"])
        found = predict(
            corner, scenario(corner, world, q=op.q_d + aside(corner, *causes["x"]), qdot=aside(corner, *causes["v"]))
        )
        return np.hstack([found.q - op.q_d, found.lambda_ - op.lambda_d])

    both = {name: a * first[name] + b * second[name] for name in first}
    parts = a * effect(first), b * effect(second)
    # Rounding is that of the largest part, and of q_d and lambda_d that were added and taken away again.
    np.testing.assert_allclose(effect(both), sum(parts), rtol=0, atol=1e-11 * (10 + scale(*parts)))


class TestTheEnd:
    """What is left at the end is what the table of steady-state errors says."""

    @pytest.mark.parametrize("name", ["force", "offset", "rotation", "tilt"])
    def test_it_is_the_tables(self, corner, name):
        op = corner.operating_point
        nominal = nominal_world(op)
        world, cause = {
            "force": (nominal_world(op, Disturbance(PUSH)), PUSH),
            "offset": (replace(nominal, Delta=SMALL_DELTA), SMALL_DELTA),
            "rotation": (replace(nominal, R=R), (R.T - np.eye(2)) @ op.lambda_d),
            "tilt": (replace(nominal, E=E), E.ravel()),
        }[name]
        # After this long exp(-48) of the transient is left.
        found = predict(corner, scenario(corner, world, duration=3 * usual_duration(corner)))
        row = getattr(steady_state_errors(corner, Bounds()), name)
        np.testing.assert_allclose(found.q[-1] - op.q_d, row.position @ cause, rtol=0, atol=1e-12)
        near(found.lambda_[-1] - op.lambda_d, row.constraint_force @ cause)

    def test_a_tilt_of_least_norm_is_the_force_that_it_was_made_for(self, corner):
        op = corner.operating_point
        found = predict(
            corner, scenario(corner, tilted(op, nominal_world(op), PUSH), duration=3 * usual_duration(corner))
        )
        np.testing.assert_allclose(
            found.q[-1] - op.q_d, steady_state_errors(corner, Bounds()).force.position @ PUSH, rtol=0, atol=1e-12
        )


class TestTheNonlinearLoop:
    """The prediction is what the simulation tends to: the difference falls with the square of the causes."""

    def difference(self, loop, make, simulator=None):
        def of(size):
            made = make(size)
            run = simulate(loop, made, simulator=simulator)
            found = predict(loop, made)
            # Between 300 instants a spline errs by (s h)^4 / 384 = 1e-7 of the effect: nothing beside the difference.
            splines = [CubicSpline(found.t, each)(run.t) for each in (found.q, found.lambda_)]
            return float(np.max(np.abs(run.q - splines[0]))), float(np.max(np.abs(run.lambda_ - splines[1])))

        return of

    @pytest.mark.parametrize(
        "cause", ["start", "speed", "force", "swing", "offset", "tilt", "rotation", "gravity", "all"]
    )
    def test_order_two(self, corner, cause):
        op = corner.operating_point

        def make(size):
            world, q, qdot = nominal_world(op), op.q_d, np.zeros(4)
            if cause in ("start", "all"):
                q = q + size * aside(corner, 0.1, -0.05)
            if cause in ("speed", "all"):
                qdot = size * aside(corner, 0.3, 0.5)
            if cause in ("force", "all"):
                world = replace(world, disturbances=(Disturbance(size * PUSH),))
            if cause == "swing":
                world = replace(world, disturbances=(Disturbance(size * PUSH, omega=8.0, phase=0.5),))
            if cause in ("offset", "all"):
                world = replace(world, Delta=size * SMALL_DELTA)
            if cause in ("tilt", "all"):
                world = replace(world, E=size * E)
            if cause == "rotation":
                c, s = np.cos(ANGLE * size), np.sin(ANGLE * size)
                world = replace(world, R=np.array([[c, -s], [s, c]]))
            if cause in ("gravity", "all"):
                world = replace(world, bias_error=size * PUSH)
            return scenario(corner, world, q=q, qdot=qdot, duration=0.6)

        self.falls_with_the_square(self.difference(corner, make, build_simulator(corner, make(1.0))), 0.05)

    def falls_with_the_square(self, difference, size):
        whole, half = difference(size), difference(size / 2)
        for name, first, second in zip(("q", "lambda"), whole, half, strict=True):
            if first > 1e-8:  # less is the integrator's; a rotation moves no position at all
                assert np.log2(first / second) == pytest.approx(2, abs=0.15), name
        assert max(whole) > 1e-7

    @pytest.mark.parametrize("controller", [5, 11, 15, 17])
    def test_order_two_with_every_controller(self, make_arm, loop_of, controller):
        arm = make_arm(
            3, {"circle": "norm(p3 - [0.9, 0.2]) - 0.25"}, [1.2, -0.9, -0.7], lambda_d={"circle": 20}, parameters={"k": "1 J"}
        )  # fmt: skip
        loop = loop_of(arm)
        op = loop.operating_point
        terms = [f"({f:.17g})*(q{i} - ({q:.17g})) + {10 + 3 * i}*(q{i} - ({q:.17g}))**2" for i, (f, q) in enumerate(zip(op.f_d, op.q_d, strict=True), 1)]  # fmt: skip
        P_d = (
            f"    P_d: k*({' + '.join(terms)} + 4*(q1 - ({op.q_d[0]:.17g}))*(q2 - ({op.q_d[1]:.17g})))\n"
            if controller in (5, 11)
            else ""
        )
        text = f"scenarios:\n  run:\n    controller: {controller}\n    duration: 0.4 s\n{P_d}"
        text += "    disturbances: [{force: {q1: 1 N*m, q3: -0.5 N*m}}]\n    limits: false\n"
        (run,) = scenarios_of(parse_scenarios(text.encode(), arm, file="run.yaml"), loop)
        assert (run.feedback.P_d is not None) == (controller in (5, 11))

        def make(size):
            (push,) = run.world.disturbances
            start = Start(op.q_d + size * aside(loop, 0.1, -0.1), np.zeros(3))
            return replace(run, start=start, world=nominal_world(op, Disturbance(size * push.d)))

        self.falls_with_the_square(self.difference(loop, make, build_simulator(loop, make(1.0))), 0.1)


def test_a_design_of_any_shipped_model_is_predicted_to_come_to_rest(loop):
    """The table's own worst force, on each model, by the prediction's last instant."""
    op = loop.operating_point
    errors = steady_state_errors(loop, op.plant.spec.bounds)
    worst = errors.force.worst_position
    found = predict(
        loop, scenario(loop, nominal_world(op, Disturbance(worst.cause)), duration=2 * usual_duration(loop))
    )
    np.testing.assert_allclose(found.q[-1] - op.q_d, worst.effect, rtol=0, atol=1e-8 * scale(worst.effect))


MASS = b"""\
schema: firmtouch.model/1
title: A mass beside a wall
parameters: {m: 2 kg, g: 9.81 m/s^2}
coordinates: {x: m, y: m}
mechanism: {kinetic_energy: 0.5*m*(dot(x)**2 + dot(y)**2), potential_energy: m*g*y}
constraints: {wall: {expression: y, unit: m}}
operating_point: {q_d: {x: 0, y: 0}, lambda_d: {wall: 5 N}}
design: {poles: [-3+4j, -3-4j], force_feedback: 1}
"""


def test_a_mass_beside_a_wall_is_predicted_as_by_hand():
    """A mass on a spring, M x'' + C x' + K x = d, beside a wall: the step response of a textbook."""
    model = parse_model(MASS, name="mass")
    op = firmtouch.find_operating_point(firmtouch.derive_plant(model.spec))
    loop = firmtouch.assign_poles(op, model.spec.design)
    found = predict(loop, scenario(loop, nominal_world(op, Disturbance(np.array([3.0, 4.0]))), duration=2.0))
    t = found.t
    # x'' + 6 x' + 25 x = 3/2:  x = 0.06 (1 - exp(-3 t) (cos 4t + 3/4 sin 4t)); the wall bears 4 N, halved by G_f = 1.
    x = 0.06 * (1 - np.exp(-3 * t) * (np.cos(4 * t) + 0.75 * np.sin(4 * t)))
    np.testing.assert_allclose(found.q, np.column_stack([x, 0 * t]), rtol=0, atol=1e-12)
    np.testing.assert_allclose(found.lambda_[:, 0], 5 - 4 / 2, rtol=0, atol=1e-11)
