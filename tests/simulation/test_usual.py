"""The scenarios that every design is put through: what they are made of, and what bounds them."""

import numpy as np
import pytest

from firmtouch.modelfile import parse_model
from firmtouch.modelfile.sections.bounds import Bounds
from firmtouch.regulation import steady_state_errors
from firmtouch.regulation.controllers import Controller
from firmtouch.regulation.force_loop import ForcePath, force_path_of
from firmtouch.simulation.from_file import drive_limits, usual_duration
from firmtouch.simulation.usual import START_ERROR, STEP_AT, causes_of, usual_scenarios

ROUNDING = 1e-12


@pytest.fixture(scope="session")
def errors(loop):
    return steady_state_errors(loop, loop.operating_point.plant.spec.bounds)


@pytest.fixture(scope="session")
def unbounded(loop):
    return steady_state_errors(loop, Bounds())


@pytest.fixture(scope="session")
def scenarios(loop, errors):
    return {each.name: each for each in usual_scenarios(loop, errors)}


def test_there_are_four_with_titles_and_one_more_where_the_force_signal_has_a_path(scenarios, loop):
    through = ["force_path"] if loop.operating_point.plant.spec.force_path is not None else []
    assert list(scenarios) == ["start_error", "force_step", "offset", "tilt", *through]
    assert len({each.title for each in scenarios.values()}) == len(scenarios)


def test_the_force_path_is_the_files_in_the_last_one_alone(scenarios, loop):
    spec = loop.operating_point.plant.spec
    for name, each in scenarios.items():
        expected = force_path_of(spec) if name == "force_path" else ForcePath()
        assert each.feedback.path == expected
    if spec.force_path is not None:
        # It starts as the first one does, so that the two can be compared.
        assert np.array_equal(scenarios["force_path"].start.q, scenarios["start_error"].start.q)


def test_they_are_run_by_the_paper_s_controller_within_the_drives_limits(scenarios, loop):
    op = loop.operating_point
    efforts = [each.effort for each in op.plant.spec.coordinates.values()]
    for each in scenarios.values():
        assert each.feedback.controller is Controller.AFFINE_WITH_FORCE
        assert each.feedback.noise is None
        if any(efforts):
            assert each.feedback.limits.tolist() == [effort.value if effort else np.inf for effort in efforts]
        else:
            assert each.feedback.limits is None


def test_they_last_as_long_as_the_slowest_pole_needs(scenarios, loop):
    slowest = min(-each.real for each in loop.poles.reduced)
    for each in scenarios.values():
        # exp(-4 * 4): four times what settling to 2 % takes, to two digits.
        assert each.duration == pytest.approx(16 / slowest, rel=0.05)
        assert each.duration == float(f"{each.duration:.2g}")


def test_only_one_thing_is_wrong_in_each(scenarios, loop):
    op = loop.operating_point
    for name, each in scenarios.items():
        world = each.world
        assert np.array_equal(world.p, op.plant.p)
        assert np.array_equal(world.R, np.eye(op.m))
        assert not np.any(world.bias_error)
        assert np.any(each.start.q != op.q_d) == (name in ("start_error", "force_path"))
        assert bool(world.disturbances) == (name == "force_step")
        assert np.any(world.Delta) == (name == "offset")
        assert np.any(world.E) == (name == "tilt")
        assert not np.any(each.start.qdot)


def test_the_start_lies_beside_q_d_along_the_free_directions(scenarios, loop):
    op = loop.operating_point
    dq = scenarios["start_error"].start.q - op.q_d
    assert np.max(np.abs(dq)) == pytest.approx(START_ERROR, rel=ROUNDING)
    assert np.max(np.abs(op.J @ dq)) < 1e-14 * np.linalg.norm(op.J, 2)
    # All free directions alike: each moves, by the same amount.
    along = loop.split.V2.T @ dq
    np.testing.assert_allclose(along, along[0], rtol=1e-10)


def test_the_force_is_the_worst_for_the_position_and_begins_later(scenarios, errors):
    (push,) = scenarios["force_step"].world.disturbances
    assert push.start == pytest.approx(STEP_AT * scenarios["force_step"].duration, rel=ROUNDING)
    assert (push.end, push.omega) == (np.inf, 0)
    assert np.array_equal(push.d, errors.force.worst_position.cause)
    bound = np.array(errors.force.bound)
    assert errors.force.given
    assert np.linalg.norm(push.d / bound) <= 1 + ROUNDING


def test_the_offset_is_the_worst_for_the_contact_force(scenarios, errors):
    Delta = scenarios["offset"].world.Delta
    assert np.array_equal(Delta, errors.offset.worst_constraint_force.cause)
    assert np.linalg.norm(Delta / np.array(errors.offset.bound)) <= 1 + ROUNDING


def test_the_tilt_turns_no_normal_further_than_its_bound(scenarios, loop, errors):
    op, E = loop.operating_point, scenarios["tilt"].world.E
    np.testing.assert_allclose(
        E.T @ op.lambda_d, errors.tilt.worst_position.cause, rtol=0, atol=ROUNDING * np.linalg.norm(op.lambda_d)
    )
    assert np.linalg.norm(E, 2) <= errors.tilt.bound * np.linalg.norm(op.J, 2) * (1 + ROUNDING)


class TestWithoutBounds:
    """A file that bounds nothing: small causes in SI, in the same directions as unit ones."""

    def test_the_causes_are_small(self, loop, unbounded):
        op = loop.operating_point
        causes = causes_of(unbounded)
        assert not any(getattr(unbounded, name).given for name in causes)
        assert np.linalg.norm(causes["force"]) == pytest.approx(1, rel=1e-9)  # 1 N m or 1 N
        assert np.linalg.norm(causes["offset"]) == pytest.approx(1e-3, rel=1e-9)  # 1 mm or 1 mrad
        radius = np.deg2rad(1) * np.linalg.norm(op.J, 2) * np.linalg.norm(op.lambda_d)
        assert np.linalg.norm(causes["tilt"]) == pytest.approx(radius, rel=1e-9)

    def test_the_scenarios_are_made_of_them(self, loop, unbounded):
        causes = causes_of(unbounded)
        _, step, offset, tilt, *_ = usual_scenarios(loop, unbounded)
        assert np.array_equal(step.world.disturbances[0].d, causes["force"])
        assert np.array_equal(offset.world.Delta, causes["offset"])
        np.testing.assert_allclose(tilt.world.E.T @ loop.operating_point.lambda_d, causes["tilt"], rtol=1e-9)


def test_without_a_contact_force_nothing_is_tilted(arm_on_circle, make_arm, loop_of):
    arm = make_arm(3, {"circle": "norm(p3 - [0.9, 0.2]) - 0.25"}, [1.2, -0.9, -0.7], lambda_d={"circle": 0})
    loop = loop_of(arm)
    names = [each.name for each in usual_scenarios(loop, steady_state_errors(loop, Bounds()))]
    assert names == ["start_error", "force_step", "offset"]


def test_drives_without_a_limit_are_unlimited_beside_those_with_one(make_model, loop_of):
    def limits(**efforts):
        point = {"x": 0, "y": 0}
        energies = {"kinetic_energy": "0.5*m*(dot(x)**2 + dot(y)**2)", "potential_energy": "m*g*y"}
        weight = {"m": "1 kg", "g": "9.81 m/s^2"}
        made = make_model("x:m y:m", constraints={"floor": "y"}, guess=point, parameters=weight, mechanism=energies)
        text = made.document.text
        for name, effort in efforts.items():
            text = text.replace(f'"{name}": "m"', f'"{name}": {{"unit": "m", "effort": "{effort}"}}')
        model = parse_model(text.encode(), name="made")
        loop = loop_of(model)
        assert usual_duration(loop) == pytest.approx(4.0)  # the poles are -4 and -5
        return drive_limits(loop.operating_point)

    assert limits() is None
    assert limits(x="3 kN").tolist() == [3000, np.inf]
