"""Constant forces, steps, pulses and sinusoids, against DOP853 on equations that are written out in NumPy."""

from dataclasses import replace

import numpy as np
import pytest

from firmtouch.regulation.controllers import Controller
from firmtouch.simulation.scenario import Feedback
from firmtouch.simulation.start import consistent_start
from firmtouch.simulation.world import Disturbance, nominal_world, tilted

SAME = 2e-9  # tolerance 1e-11 a step of ours, some hundred steps; DOP853 at 1e-12
BEGIN, END = 0.137, 0.291  # on no even instant

FAST = {"pulse", "burst"}


def cases(n):
    """Each: disturbances, the same as a function of time in other words, and its borders."""
    d = 2.0 * np.cos(np.arange(n) + 1)
    return {
        "none": ((), lambda t: 0 * d, ()),
        "constant": ((Disturbance(d),), lambda t: d, ()),
        "step": ((Disturbance(d, start=BEGIN),), lambda t: d * (t >= BEGIN), (BEGIN,)),
        "pulse": ((Disturbance(d, start=BEGIN, end=END),), lambda t: d * (BEGIN <= t < END), (BEGIN, END)),
        "sinusoid": ((Disturbance(d, omega=20.0, phase=0.4),), lambda t: d * np.sin(20 * t + 0.4), ()),
        "burst": (
            (Disturbance(d, start=BEGIN, end=END, omega=20.0), Disturbance(-d, start=0.2)),
            lambda t: d * np.sin(20 * (t - BEGIN)) * (BEGIN <= t < END) - d * (t >= 0.2),
            (BEGIN, 0.2, END),
        ),
    }


@pytest.mark.parametrize(
    "name",
    [
        "planar_2r_wall",
        pytest.param("planar_3r_circle", marks=pytest.mark.slow),
        pytest.param("planar_3r_wall", marks=pytest.mark.slow),
    ],
)
@pytest.mark.parametrize(
    "case", [pytest.param(each, marks=() if each in FAST else pytest.mark.slow) for each in cases(1)]
)
def test_a_run_is_the_solution_that_dop853_finds(shipped, run, reference, name, case):
    loop = shipped(name)
    push, d, borders = cases(loop.operating_point.n)[case]
    words = {"way": 0.1, "push": push, "duration": 0.4}
    done = run(loop, tolerance=1e-11, **words)
    other = reference(loop, done.scenario, done.q[0], done.qdot[0], d, borders=borders)
    assert np.concatenate([done.q[-1], done.qdot[-1]]) == pytest.approx(other.final, abs=SAME, rel=SAME)
    for i in np.flatnonzero(np.diff(done.t) > 0)[::37]:
        assert np.concatenate([done.q[i], done.qdot[i]]) == pytest.approx(other.state(done.t[i]), abs=SAME, rel=SAME)
        # forces: accelerations times masses, of states that differ by SAME
        assert done.lambda_[i] == pytest.approx(other.lambda_(done.t[i]), abs=1e3 * SAME)


SOME = [Controller.AFFINE_WITH_FORCE, *(pytest.param(each, marks=pytest.mark.slow) for each in list(Controller)[:3])]


@pytest.mark.parametrize("controller", SOME)
def test_each_controller_in_a_crooked_world_with_another_plant(shipped, run, reference, controller, rng):
    loop = shipped("planar_3r_circle")
    op = loop.operating_point
    world = replace(
        tilted(op, nominal_world(op), np.array([0.5, -0.3, 0.2])),
        p=op.plant.p * (1 + 0.02 * rng.normal(size=op.plant.p.size)),
        Delta=np.array([0.004]), bias_error=np.array([0.5, -1.0, 0.2]),
    )  # fmt: skip
    words = {"feedback": Feedback(controller), "way": 0.1, "world": world, "duration": 0.3}
    done = run(loop, tolerance=1e-11, **words)
    projection, qdot = consistent_start(op, world, done.scenario.start)
    other = reference(loop, done.scenario, projection.q, qdot)
    assert np.concatenate([done.q[-1], done.qdot[-1]]) == pytest.approx(other.final, abs=SAME, rel=SAME)


@pytest.mark.parametrize("case", ["none", "pulse", "sinusoid"])
def test_the_result_converges_with_the_tolerance(shipped, run, case):
    """And as fast with a pulse as without: its ends are met exactly, so that no step goes over a jump."""
    loop = shipped("planar_3r_circle")
    words = {"way": 0.1, "push": cases(3)[case][0], "duration": 0.4}
    finest = run(loop, tolerance=1e-13, **words).q[-1]
    errors = [np.abs(run(loop, tolerance=10.0**-k, **words).q[-1] - finest).max() for k in (6, 8, 10, 12)]
    for k, error in zip((6, 8, 10, 12), errors, strict=True):
        assert error < 200 * 10.0**-k  # a hundred steps or so, each good to its tolerance
    assert errors[0] > 1e3 * errors[3]  # six decades of tolerance, and never all by luck


def test_a_pulse_changes_the_force_at_its_ends_and_only_there(shipped, run):
    """At both ends the force is reported twice, before and after; J^T c changes it by -c / (1 + g)."""
    loop = shipped("planar_3r_circle")
    op, g = loop.operating_point, loop.gains.G_f[0, 0]
    done = run(loop, push=(Disturbance(op.J.T @ [6.0], start=BEGIN, end=END),), duration=0.5)
    for border, jump in ((BEGIN, -6 / (1 + g)), (END, 6 / (1 + g))):
        before, after = np.flatnonzero(done.t == border)
        assert after == before + 1
        assert done.lambda_[after, 0] - done.lambda_[before, 0] == pytest.approx(jump, rel=1e-9)
        assert done.q[before] == pytest.approx(done.q[after], abs=0)
    assert done.q == pytest.approx(np.tile(op.q_d, (done.t.size, 1)), abs=1e-9)  # it is normal: nothing moves


def test_a_disturbance_that_begins_after_the_end_does_nothing(shipped, run):
    loop = shipped("planar_2r_wall")
    late = run(loop, way=0.1, push=(Disturbance(np.ones(2), start=3.0),), duration=0.5)
    never = run(loop, way=0.1, duration=0.5)
    assert late.q == pytest.approx(never.q, abs=0)


def test_a_run_may_be_cut_in_two(shipped, run):
    """The end of one run is the start of the next: nothing but q and q' is carried along."""
    loop = shipped("planar_3r_circle")
    whole, first = run(loop, way=0.2, duration=0.6), run(loop, way=0.2, duration=0.25)
    second = run(loop, q=first.q[-1], qdot=first.qdot[-1], duration=0.35)
    assert second.q[-1] == pytest.approx(whole.q[-1], abs=1e-8)
    assert second.lambda_[-1] == pytest.approx(whole.lambda_[-1], abs=1e-5)
