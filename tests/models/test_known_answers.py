"""Models whose numbers are known by hand, or from elsewhere, or by another derivation."""

from functools import partial
from pathlib import Path

import numpy as np
import pytest

import firmtouch
from firmtouch.mechanics import draw_scene
from firmtouch.regulation import project, split_directions

ROOT = Path(__file__).parents[2]
EXACT = 1e-12  # closed forms of order one to fifty in double precision: some hundred roundings


equal = partial(np.testing.assert_allclose, rtol=0, atol=EXACT)


def read_op(path):
    return firmtouch.find_operating_point(firmtouch.derive_plant(firmtouch.read_model(ROOT / path).spec))


def design(op):
    return firmtouch.assign_poles(op, op.plant.spec.design)


def unit(angle):
    return np.array([np.cos(angle), np.sin(angle)])


class TestPendulumOnARod:
    # Two kilograms on a rod of 0.981 m: m g = 19.62 N and g/length = 10 1/s^2.
    length, m, g = 0.981, 2.0, 9.81

    @pytest.fixture
    def op(self):
        return read_op("models/pendulum_rod.yaml")

    @pytest.fixture
    def loop(self, op):
        return design(op)

    def test_it_hangs_straight_down_as_given(self, op):
        assert op.q_d == pytest.approx([0, -self.length], abs=0)
        assert op.residual == 0

    def test_the_tension_carries_the_weight_so_that_no_constant_force_is_needed(self, op, loop):
        equal(op.J, [[0, 1]])  # phi grows towards the pivot, upwards
        assert op.f_d == pytest.approx([0, self.m * self.g], abs=EXACT)
        assert op.g == pytest.approx([0, self.m * self.g], abs=EXACT)
        assert loop.gains.bias == pytest.approx([0, 0], abs=EXACT)

    @pytest.mark.parametrize("speed", [0.0, 1.0])
    def test_the_multiplier_of_the_free_pendulum_is_the_rods_tension(self, op, speed):
        plant, qdot = op.plant, np.array([speed, 0])
        J = plant.J(op.q_d)
        matrix = np.block([[plant.M(op.q_d), -J.T], [J, np.zeros((1, 1))]])
        right = np.concatenate([-plant.theta(op.q_d, qdot), -plant.Jdot_qdot(op.q_d, qdot)])
        *acceleration, tension = np.linalg.solve(matrix, right)
        assert tension == pytest.approx(self.m * (self.g + speed**2 / self.length), abs=EXACT)
        assert acceleration == pytest.approx([0, speed**2 / self.length], abs=EXACT)

    def test_all_stiffness_at_rest_comes_from_the_rods_curvature(self, op):
        equal(op.M, self.m * np.eye(2))
        equal(op.P_qq, np.zeros((2, 2)))
        equal(op.constraint_hessians, [np.diag([-1 / self.length, 0])])
        equal(op.N0, np.diag([self.m * self.g / self.length, 0]))

    def test_it_swings_with_the_square_root_of_g_over_the_length(self, op, loop):
        V2 = loop.split.V2
        omega_squared = (V2.T @ op.N0 @ V2) / (V2.T @ op.M @ V2)
        assert omega_squared.item() == pytest.approx(10, abs=EXACT)

    def test_the_gains_are_those_of_the_hand_calculation(self, loop):
        # p(s) = s^2 + 8 s + 20, so C22 = 8 m = 16 and K22 = 20 m = 40, of which N0 brings 20. The mixed blocks are zero
        # since M is m I, and the normal ones are the least that keep half of the tangent ones' eigenvalues.
        equal(loop.gains.W, np.diag([20, 20]))
        equal(loop.gains.C, np.diag([16, 8]))
        equal(loop.K, np.diag([40, 20]))

    def test_the_poles_are_the_roots_of_the_hand_polynomial(self, loop):
        for poles in (loop.poles.pencil, loop.poles.reduced):
            assert sorted(poles, key=lambda s: s.imag) == pytest.approx(
                [-4 - 2j, -4 + 2j], abs=1e-9
            )  # well conditioned

    def test_a_constant_push_moves_it_sideways_by_the_push_over_the_stiffness(self, op, loop):
        errors = firmtouch.steady_state_errors(loop, op.plant.spec.bounds)
        equal(errors.force.position, np.diag([1 / 40, 0]))  # T = V2 V2^T / K22
        # A push upwards takes that much off the tension, divided by 1 + G_f.
        equal(errors.force.constraint_force, [[0, -1 / 1.6]])
        assert errors.force.worst_position.value == pytest.approx(0.025, abs=EXACT)  # of 1 N

    def test_a_rod_of_wrong_length_moves_it_by_as_much_and_strains_the_stiffness(self, op, loop):
        errors = firmtouch.steady_state_errors(loop, op.plant.spec.bounds)
        equal(errors.offset.position, [[0], [1]])
        equal(errors.offset.constraint_force, [[20 / 1.6]])

    def test_the_drawn_force_pulls_the_mass_upwards(self, op):
        (contact,) = draw_scene(op.plant, op.q_d, op.lambda_d).forces
        assert contact.force == pytest.approx([0, 19.62], abs=EXACT)


class TestUniformRodsOnAWall:
    # Where linearisations without the multiplier fail: two rods of 1 m and 1 kg, tip on x = 1.2 m, lambda = 5 N.
    @pytest.fixture
    def op(self):
        return read_op("tests/data/trap_2r_wall.yaml")

    @pytest.fixture
    def squared_poles(self, op):
        """Give s^2 of M22 s^2 + X22 = 0."""
        V2 = split_directions(op.J).V2
        return lambda X: -((V2.T @ X @ V2) / (V2.T @ op.M @ V2)).item()

    def test_the_elbow_stands_where_the_file_says(self, op):
        assert op.q_d[1] == pytest.approx(-1.2, abs=EXACT)

    def test_the_open_loop_oscillates(self, op, squared_poles):
        assert squared_poles(op.N0) == pytest.approx(-(3.519**2), abs=2 * 3.519 * 5e-4)  # 3.519 is known to 3 decimals

    def test_dropping_the_multiplier_times_the_hessian_would_call_it_unstable(self, op, squared_poles):
        assert squared_poles(op.P_qq) == pytest.approx(1.914**2, abs=2 * 1.914 * 5e-4)  # 1.914 is known to 3 decimals

    def test_the_frequency_is_that_of_the_energy_along_the_wall(self, op, squared_poles):
        # With q1 solved from the wall's equation one coordinate is left, and no multiplier: E(q2) is the potential less
        # the work of the constant torques that hold the arm, and omega^2 = E'' / M there.
        def configuration(q2):
            return np.array([-q2 / 2 + np.arccos(0.6 / np.cos(q2 / 2)), q2])

        held = op.g - op.f_d

        def energy(q2):
            q1, _ = q = configuration(q2)
            return 9.81 * (1.5 * np.sin(q1) + 0.5 * np.sin(q1 + q2)) - held @ q

        h = 1e-3
        E = [energy(-1.2 + k * h) for k in (-1, 0, 1)]
        along = (configuration(-1.2 + h) - configuration(-1.2 - h)) / (2 * h)
        c = np.cos(1.2)
        M = np.array([[5 / 3 + c, 1 / 3 + c / 2], [1 / 3 + c / 2, 1 / 3]])
        equal(op.M, M)
        omega_squared = (E[0] - 2 * E[1] + E[2]) / h**2 / (along @ M @ along)
        # Central differences: h^2 = 1e-6 times derivatives of order ten, and 1e-15 * 10 of rounding over h^2.
        assert (E[2] - E[0]) / (2 * h) == pytest.approx(0, abs=1e-4)
        assert omega_squared == pytest.approx(-squared_poles(op.N0), rel=1e-4)

    def test_there_are_two_poles_and_not_four(self, op):
        # The multiplier eliminated, the equations have four states, but two of them cannot leave the constraint.
        loop = design(op)
        assert len(loop.poles.pencil) == len(loop.poles.reduced) == 2
        assert np.sort_complex(loop.poles.pencil) == pytest.approx(
            [-5, -4], rel=1e-10
        )  # simple poles of a small pencil
        assert loop.poles.disagreement < 1e-10
        assert np.linalg.norm(loop.gains.W) < 100  # with four poles "placed", gains are of order 1e10

    def test_the_determinant_of_the_whole_pencil_has_degree_two(self, op):
        loop = design(op)
        n, m = op.n, op.m

        def determinant(s):
            stiffness = op.M * s**2 + loop.gains.C * s + loop.K
            return np.linalg.det(
                np.block([[stiffness, -op.J.T @ (np.eye(m) + loop.gains.G_f)], [op.J, np.zeros((m, m))]])
            )

        at = np.arange(-2.0, 2.0 * n - 1)  # enough points for the degree 2 n that the first block alone would have
        *higher, second, first, zeroth = np.polyfit(at, [determinant(s) for s in at], 2 * n)
        assert higher == pytest.approx([0] * (2 * n - 2), abs=1e-12 * abs(zeroth))  # interpolation of exact values
        assert np.sort(np.roots([second, first, zeroth])) == pytest.approx([-5, -4], rel=1e-9)  # the same rounding


class TestArmOnADisc:
    @pytest.fixture
    def op(self):
        return read_op("models/planar_2r_circle.yaml")

    def test_the_constraints_hessian_is_the_closed_form(self, op):
        l1, l2, centre, radius = 0.50, 0.45, np.array([0.60, 0.15]), 0.15
        a1, a2 = op.q_d[0], op.q_d.sum()
        tip = l1 * unit(a1) + l2 * unit(a2)
        normal = (tip - centre) / radius
        turned = np.array([[0, -1], [1, 0]])
        J_p = np.column_stack([turned @ tip, turned @ (l2 * unit(a2))])
        # phi'' = J_p^T (I - n n^T) J_p / r, the rim's curvature, and n . p'', that of the joints' arcs.
        bend = J_p.T @ (np.eye(2) - np.outer(normal, normal)) @ J_p / radius
        swing = -normal @ tip * np.diag([1, 0]) - l2 * normal @ unit(a2) * np.array([[0, 1], [1, 1]])
        assert op.J[0] == pytest.approx(normal @ J_p, abs=1e-10)  # phi = 0 holds to 1e-12, divided by the radius
        assert op.constraint_hessians[0] == pytest.approx(bend + swing, abs=1e-10)

    def test_the_force_pushes_the_tip_out_of_the_disc(self, op):
        (contact,) = draw_scene(op.plant, op.q_d, op.lambda_d).forces
        centre, radius = np.array([0.60, 0.15]), 0.15
        assert contact.force == pytest.approx(40 * (contact.point - centre) / radius, abs=1e-8)  # phi to 1e-12, * 40/r


class TestToolSquareToAWall:
    def test_the_force_and_the_moment_are_carried_by_the_joints_as_statics_says(self):
        op = read_op("models/planar_3r_wall.yaml")
        elbow = 0.45 * np.sin(op.q_d[0])
        tip = wrist = elbow + 0.40 * np.sin(op.q_d[0] + op.q_d[1])  # the hand is level
        # 50 N to the left at the tip, below which lie the shoulder and, by less, the elbow; the moment is 0.5 N m.
        assert op.f_d == pytest.approx([50 * tip + 0.5, 50 * (tip - elbow) + 0.5, 50 * (tip - wrist) + 0.5], abs=1e-9)


class TestTwoArmsWithABar:
    weight = 4.0 * 9.81

    @pytest.fixture
    def op(self):
        return read_op("models/two_arms_bar.yaml")

    def test_the_bar_is_level_between_the_hands(self, op):
        left_arm, right_arm, bar = draw_scene(op.plant, op.q_d, op.lambda_d).lines
        assert bar[0] == pytest.approx(left_arm[-1], abs=EXACT)
        assert bar[1] == pytest.approx(right_arm[-1], abs=1e-11)  # the loop is closed by a projection to 1e-12
        assert bar[1] - bar[0] == pytest.approx([0.5, 0], abs=1e-9)  # the guess is a mirror image of itself

    def test_the_squeeze_loads_each_joint_with_its_lever_below_the_bar(self, op):
        height = 0.35 * np.sin(op.q_d[0]) + 0.30 * np.sin(op.q_d[0] + op.q_d[1]) + 0.12
        levers = np.array([height, height - 0.35 * np.sin(op.q_d[0]), 0.12])
        # The bar pushes the right hand to the right, which is clockwise about the joints below, and the left one back.
        assert op.f_d == pytest.approx(40 * np.concatenate([levers, -levers]), abs=1e-9)

    def test_the_multipliers_keep_their_meaning_when_the_bar_is_turned(self, op):
        turned = project(op.plant, op.q_d + np.array([0, 0, 0.4, 0, 0, 0.4])).q
        scene = draw_scene(op.plant, turned, op.lambda_d)
        bar = scene.lines[2][1] - scene.lines[2][0]
        assert abs(bar[1]) > 0.05  # it is turned indeed
        assert scene.forces[0].force == pytest.approx(40 * bar / 0.5, abs=1e-9)

    def test_force_and_moment_at_the_grasp_are_those_of_hand_made_jacobians(self, op):
        left_arm, right_arm, bar = draw_scene(op.plant, op.q_d, op.lambda_d).lines
        along, across = (bar[1] - bar[0]) / 0.5, left_arm[-1] - left_arm[-2]
        across = across / np.linalg.norm(across)
        lambda_d = np.array([40.0, -7.0, 3.0])
        F = lambda_d[0] * along + lambda_d[1] * across

        def torque(joint):
            lever = bar[1] - joint
            return lever[0] * F[1] - lever[1] * F[0] + lambda_d[2]

        expected = [-torque(joint) for joint in left_arm[:-1]] + [torque(joint) for joint in right_arm[:-1]]
        assert op.J.T @ lambda_d == pytest.approx(expected, abs=1e-9)

    def test_half_the_weight_as_shear_makes_both_arms_carry_alike(self, op):
        left_arm, right_arm, bar = draw_scene(op.plant, op.q_d, op.lambda_d).lines
        half = self.weight / 2

        def held(across):
            return np.split(op.g - op.J.T @ np.array([40.0, across, 0.0]), 2)

        left, right = held(-half)
        assert left == pytest.approx(-right, abs=1e-9)  # mirror images have torques of opposite sign; q_d to 1e-12
        # Without shear the left arm carries the right hand's half too, at the bar's far end.
        left_alone, right_alone = held(0.0)
        assert left_alone - left == pytest.approx(half * (bar[1, 0] - left_arm[:-1, 0]), abs=1e-9)
        assert right_alone - right == pytest.approx(-half * (bar[1, 0] - right_arm[:-1, 0]), abs=1e-9)
