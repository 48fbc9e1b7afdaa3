"""Draws lie in their sets, fill them evenly, and depend on the seed and the run's number alone."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from firmtouch.errors import ModelFileError
from firmtouch.modelfile.scenarios import parse_scenarios
from firmtouch.montecarlo import Label, draw, sets_of
from firmtouch.montecarlo.draw import generator, in_ellipsoid, rotation, tilt
from firmtouch.montecarlo.study import nominal_scenario
from firmtouch.simulation.scenario import Noise

COUNT = 2000
# A Kolmogorov-Smirnov test of a right sampler fails with this probability; the seeds are fixed, so it does so never.
LEAST_P = 1e-3


@pytest.fixture
def streams():
    return [generator(1993, Label(False, i)) for i in range(1, COUNT + 1)]


def uniform(values) -> bool:
    """Whether values in [0, 1] may be uniform there."""
    return stats.kstest(values, "uniform").pvalue > LEAST_P


class TestEllipsoids:
    def test_radii_to_the_nth_power_and_angles_are_uniform(self, streams):
        axes = np.array([2.0, 0.5])
        scaled = np.array([in_ellipsoid(axes, rng) for rng in streams]) / axes
        assert uniform(np.sum(scaled**2, axis=1))
        assert uniform(np.arctan2(scaled[:, 1], scaled[:, 0]) / (2 * np.pi) + 0.5)

    def test_in_three_dimensions_each_coordinate_has_the_balls_marginal(self, streams):
        drawn = np.array([in_ellipsoid(np.ones(3), rng) for rng in streams])
        assert np.max(np.linalg.norm(drawn, axis=1)) <= 1
        for x in drawn.T:  # the volume of the ball below x is (2 + 3 x - x^3) / 4 of it
            assert uniform((2 + 3 * x - x**3) / 4)

    def test_an_axis_of_length_zero_is_no_direction(self, streams):
        drawn = np.array([in_ellipsoid(np.array([0.0, 3.0]), rng) for rng in streams])
        assert not np.any(drawn[:, 0])
        assert uniform(drawn[:, 1] / 6 + 0.5)

    def test_nothing_is_drawn_from_a_point(self, streams):
        assert not np.any(in_ellipsoid(np.zeros(3), streams[0]))


class TestTiltsAndRotations:
    def test_tilts_of_one_row_fill_a_ball(self, streams):
        sizes = np.array([np.linalg.norm(tilt(0.2, (1, 3), rng)) for rng in streams])
        assert uniform((sizes / 0.2) ** 3)

    def test_tilts_of_more_rows_keep_the_2_norm(self, streams):
        sizes = np.array([np.linalg.norm(tilt(0.2, (2, 3), rng), 2) for rng in streams[:500]])
        assert 0.19 < np.max(sizes) <= 0.2

    @pytest.mark.parametrize("m", [2, 3, 4])
    def test_rotations_are_orthogonal_and_small_enough(self, streams, m):
        for rng in streams[:200]:
            R = rotation(0.3, m, rng)
            assert np.allclose(R.T @ R, np.eye(m), atol=1e-14)  # a few roundings
            assert np.linalg.det(R) > 0
            angles = np.angle(np.linalg.eigvals(R))
            assert np.max(np.abs(angles)) <= 0.3 + 1e-12

    def test_in_the_plane_the_angle_is_uniform(self, streams):
        R = [rotation(0.3, 2, rng) for rng in streams]
        assert uniform(np.array([np.arctan2(each[1, 0], each[0, 0]) for each in R]) / 0.6 + 0.5)

    def test_one_constraint_is_not_rotated(self, streams):
        assert rotation(0.3, 1, streams[0]) == np.eye(1)


@pytest.fixture(scope="module")
def drawn(loop_of, models):
    """A loop, its nominal scenario, its sets, and many draws."""
    loop = loop_of(models("planar_2r_circle"))
    op, base = loop.operating_point, nominal_scenario(loop)
    sets = sets_of(op, base)
    return op, base, sets, [draw(op, base, sets, generator(7, Label(False, i))) for i in range(1, COUNT + 1)]


class TestScenarios:
    def test_the_files_intervals_and_bounds_are_what_is_drawn_from(self, drawn):
        op, _, sets, _ = drawn
        bounds = op.plant.spec.bounds
        assert sets.parameters == {"m2": (3.0, 4.5)}
        assert sets.disturbance.tolist() == list(bounds.disturbance.values())
        assert sets.offset.tolist() == list(bounds.offset.values())
        assert (sets.tilt, sets.rotation) == (bounds.tilt, 0.0)
        assert sets.position.tolist() == [0.1, 0.1]

    def test_starts_and_parameters_are_uniform(self, drawn):
        op, base, _, scenarios = drawn
        for i in range(op.n):
            assert uniform(np.array([(each.start.q - base.start.q)[i] for each in scenarios]) / 0.2 + 0.5)
        at = list(op.plant.spec.parameters).index("m2")
        assert uniform((np.array([each.world.p[at] for each in scenarios]) - 3.0) / 1.5)
        others = np.delete(scenarios[0].world.p, at)
        assert np.array_equal(others, np.delete(op.plant.p, at))

    def test_forces_offsets_and_tilts_are_within_their_bounds(self, drawn):
        op, _, sets, scenarios = drawn
        for each in scenarios:
            (force,) = each.world.disturbances
            assert np.sum((force.d / sets.disturbance) ** 2) <= 1
            assert np.all(np.abs(each.world.Delta) <= sets.offset)
            assert np.linalg.norm(each.world.E, 2) <= sets.tilt * np.linalg.norm(op.J, 2) * (1 + 1e-12)

    def test_a_draw_depends_on_seed_and_number_alone(self, drawn):
        op, base, sets, scenarios = drawn
        again = draw(op, base, sets, generator(7, Label(False, 100)))
        assert np.array_equal(again.start.q, scenarios[99].start.q)
        assert np.array_equal(again.world.p, scenarios[99].world.p)
        for other in (generator(8, Label(False, 100)), generator(7, Label(True, 100))):
            assert not np.array_equal(draw(op, base, sets, other).start.q, again.start.q)

    def test_the_scenarios_own_world_stays(self, drawn):
        op, base, sets, _ = drawn
        world = replace(base.world, Delta=np.array([0.01]), E=np.array([[0.1, 0.2]]))
        found = draw(op, replace(base, world=world), sets, generator(1, Label(False, 1))).world
        plain = draw(op, base, sets, generator(1, Label(False, 1))).world
        assert np.allclose(found.Delta - plain.Delta, 0.01, rtol=1e-12)
        assert np.allclose(found.E - plain.E, [[0.1, 0.2]], rtol=1e-12)

    def test_each_run_has_noise_of_its_own(self, drawn):
        op, base, sets, _ = drawn
        noisy = replace(base, feedback=replace(base.feedback, noise=Noise(*np.ones((3, 1)))))
        seeds = {draw(op, noisy, sets, generator(1, Label(False, i))).feedback.noise.seed for i in range(1, 20)}
        assert len(seeds) == 19


class TestDrawSection:
    def read(self, text, model):
        return parse_scenarios(
            f"scenarios: {{one: {{}}, heavy: {{parameters: {{m2: 4 kg}}}}}}\n{text}".encode(), model, file="s.yaml"
        )

    def sets(self, text, models, loop_of, *, scenario="one"):
        from firmtouch.simulation.from_file import scenarios_of

        model = models("planar_2r_circle")
        loop, file = loop_of(model), self.read(text, model)
        base = next(each for each in scenarios_of(file, loop) if each.name == scenario)
        return sets_of(loop.operating_point, base, file)

    def test_it_overrides_and_switches_off(self, models, loop_of):
        text = "draw: {position: 2 deg, velocity: {q1: 0.5 rad/s, q2: 0}, disturbance: none, offset: 1 mm, tilt: none, parameters: {m1: [4 kg, 6 kg]}}"
        found = self.sets(text, models, loop_of)
        assert np.allclose(found.position, np.deg2rad(2))
        assert found.velocity.tolist() == [0.5, 0.0]
        assert not np.any(found.disturbance)
        assert (found.offset.tolist(), found.tilt, found.parameters) == ([0.001], 0.0, {"m1": (4.0, 6.0)})

    def test_without_it_a_parameter_that_the_scenario_sets_is_not_drawn(self, models, loop_of):
        assert self.sets("", models, loop_of).parameters == {"m2": (3.0, 4.5)}
        assert self.sets("", models, loop_of, scenario="heavy").parameters == {}
        assert self.sets("draw: {parameters: [m2]}", models, loop_of, scenario="heavy").parameters == {"m2": (3.0, 4.5)}

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("draw: {positions: 1}", "2:8: unknown key `positions`"),
            ("draw: {position: -1}", "2:18: -1 is out of range; it must not be negative"),
            ("draw: {parameters: [m3]}", "2:21: `m3` is no parameter"),
            ("draw: {parameters: [m1, m1]}", "2:25: `m1` stands here twice"),
            ("draw: {parameters: {m1: [6 kg, 4 kg]}}", "2:25: the interval from 6 to 4 (in SI) is empty"),
            ("draw: {parameters: {m1: [6 m, 4 kg]}}", "2:26: `6 m` is in m, but kg was expected"),
            ("draw: {parameters: {m1: 3 kg}}", "2:25: two quantities were expected"),
            ("draw: {parameters: []}\nx: 1", "3:1: unknown key `x`"),
            ("draw: {rotation: 2 deg}", "2:8: a rotation mixes constraints, and there is only one"),
            ("draw: {disturbance: {q1: 1 N*m}}", "2:21: no entry for the coordinate `q2`"),
        ],
    )
    def test_mistakes_are_told_at_their_place(self, models, text, message):
        with pytest.raises(ModelFileError) as error:
            self.read(text, models("planar_2r_circle"))
        assert f"s.yaml:{message}" in str(error.value)

    def test_a_parameter_without_an_interval_needs_one(self, models, loop_of):
        with pytest.raises(ModelFileError, match=r"s.yaml:2:20: `m1` has no `interval` in the model"):
            self.sets("draw: {parameters: [m1]}", models, loop_of)


def test_a_model_without_intervals_and_bounds_draws_starts_alone(loop_of, arm_on_circle):
    loop = loop_of(arm_on_circle)
    sets = sets_of(loop.operating_point, nominal_scenario(loop))
    assert not sets.parameters
    assert not np.any(np.concatenate([sets.disturbance, sets.offset, [sets.tilt, sets.rotation]]))
