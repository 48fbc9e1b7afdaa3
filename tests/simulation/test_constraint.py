"""Phi = 0 is kept: index one by two differentiations, held by Baumgarte's stabilisation."""

import numpy as np
import pytest

from firmtouch.simulation import dae, motion
from firmtouch.simulation.world import Disturbance

KEPT = 1e-8  # m (or rad): what is asked for over a minute
SWINGS = 3.0, 7.3


def shaken(op, size=0.3):
    """Two forces that swing for ever, so that the loop never comes to rest."""
    return tuple(
        Disturbance(size * np.cos(np.arange(op.n) + k), omega=omega, phase=float(k)) for k, omega in enumerate(SWINGS)
    )


def test_a_minute_of_motion_keeps_the_constraints_to_1e_8(loop, run):
    op = loop.operating_point
    done = run(loop, way=0.05, push=shaken(op), duration=60.0)
    assert done.t[-1] == pytest.approx(60.0)
    assert done.outcome.good
    if op.n - op.m > 1 or op.m == 1:  # where a force can move it: not where J^T holds nearly all of it
        assert np.abs(done.qdot[done.t > 55]).max() > 1e-3
    assert np.abs(done.Phi).max() < KEPT
    # what was integrated and what is reported are one thing
    assert done.Phi[-1] == pytest.approx(op.plant.Phi(done.q[-1]), abs=1e-13)


@pytest.mark.parametrize("name", ["planar_2r_wall", pytest.param("planar_3r_circle", marks=pytest.mark.slow)])
def test_without_the_stabilisation_the_constraints_drift_away(shipped, run, monkeypatch, name):
    loop = shipped(name)
    words = {"way": 0.05, "push": shaken(loop.operating_point), "duration": 60.0}
    held = np.abs(run(loop, **words).Phi).max()
    monkeypatch.setattr(motion, "HOLD", 0.0)
    free = np.abs(run(loop, **words).Phi)
    quarter = len(free) // 4
    assert free.max() > 30 * held
    assert free[-quarter:].max() > 2 * free[:quarter].max()  # and it grows


def test_an_error_on_the_constraint_dies_out_at_the_rate_that_was_chosen(shipped):
    """Phi = (Phi_0 + (Phi'_0 + a Phi_0) t) exp(-a t) exactly, for whatever the rest does."""
    from firmtouch.simulation.continuous import build_integrator
    from firmtouch.simulation.scenario import Feedback
    from firmtouch.simulation.world import nominal_world

    loop = shipped("planar_3r_circle")
    op, t = loop.operating_point, np.linspace(0.05, 1, 20)
    equations = dae.derive_dae(loop, Feedback())
    parameters = dae.parameters_of(equations, nominal_world(op), t=0.0)
    q, v = op.q_d + 0.02 * loop.split.V1[:, 0] + 0.1 * loop.split.V2[:, 1], 0.1 * loop.split.V1[:, 0]
    x = build_integrator(equations, 1e-11, t)(np.concatenate([q, v]), 0.0, 1.0, parameters)
    Phi, rate, a = op.plant.Phi(q)[0], (op.plant.J(q) @ v)[0], motion.HOLD
    expected = (Phi + (rate + a * Phi) * t) * np.exp(-a * t)
    found = np.array([op.plant.Phi(each)[0] for each in x[: op.n].T])
    assert abs(Phi) > 1e-3
    assert found == pytest.approx(expected, abs=1e-10)


@pytest.mark.parametrize(
    "name",
    [
        "planar_2r_wall",
        pytest.param("planar_3r_circle", marks=pytest.mark.slow),
        pytest.param("planar_3r_wall", marks=pytest.mark.slow),
    ],
)
@pytest.mark.parametrize("electronics", [{"lag": 2e-3}, {"delay": 1e-3}, {"sample": 1e-3}], ids=str)
def test_the_constraints_are_kept_whatever_the_electronics_do(shipped, run, name, electronics):
    from firmtouch.regulation.force_loop import ForcePath
    from firmtouch.simulation.scenario import Feedback

    loop = shipped(name)
    feedback = Feedback(path=ForcePath(**electronics))
    done = run(loop, feedback, way=0.05, push=shaken(loop.operating_point), duration=1.0)
    assert done.outcome.good
    assert np.abs(done.Phi).max() < KEPT
