"""Where a loop comes to rest in a world that is not the model's: the run, Newton's method, and the first-order table."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from firmtouch.regulation import steady_state_errors
from firmtouch.regulation.controllers import Controller
from firmtouch.simulation.run import find_equilibrium
from firmtouch.simulation.scenario import Feedback
from firmtouch.simulation.trajectory import Outcome
from firmtouch.simulation.world import Disturbance, nominal_world, tilted

CAUSES = ["force", "gravity", "offset", "rotation", "tilt", "mass"]


def weight_parameter(op):
    """The place in p of what all weights are proportional to, or of what a robot carries."""
    return next(i for i, name in enumerate(op.plant.spec.parameters) if name in ("g", "mp"))


def caused(loop, cause, size):
    """Give a world with an error of a size, and (dq, dlambda) that section 5 of the theory says, in first order."""
    op = loop.operating_point
    n, m, world = op.n, op.m, nominal_world(op)
    table = steady_state_errors(loop, op.plant.spec.bounds)
    d = size * np.cos(np.arange(n) + 1)
    if cause in ("force", "gravity", "tilt"):
        made = {
            "force": replace(world, disturbances=(Disturbance(d),)),
            "gravity": replace(world, bias_error=d),
            "tilt": tilted(op, world, d),
        }[cause]
        return made, table.force.position @ d, table.force.constraint_force @ d
    if cause == "offset":
        Delta = 0.01 * size * (1 + np.arange(m))
        return replace(world, Delta=Delta), table.offset.position @ Delta, table.offset.constraint_force @ Delta
    if cause == "rotation":
        Omega = 0.1 * size * np.triu(np.ones((m, m)), 1)
        R = expm(Omega - Omega.T)
        turned = (R.T - np.eye(m)) @ op.lambda_d
        return replace(world, R=R), table.rotation.position @ turned, table.rotation.constraint_force @ turned
    i = weight_parameter(op)  # the weights grow
    p = op.plant.p.copy()
    p[i] *= 1 + 0.1 * size
    d = op.g - op.plant.with_parameters(p).P_q(op.q_d)
    return replace(world, p=p), table.force.position @ d, table.force.constraint_force @ d


def applies(loop, cause):
    return not (cause == "rotation" and loop.operating_point.m == 1)  # R = 1 then


@pytest.mark.parametrize("cause", CAUSES)
@pytest.mark.parametrize("controller", [Controller.AFFINE_WITH_FORCE, Controller.ENERGY_WITH_FORCE])
def test_the_table_is_right_to_second_order(loop, dae_of, cause, controller, observed_order):
    if not applies(loop, cause):
        return
    op, dae = loop.operating_point, dae_of(loop, controller)

    def error(size):
        world, dq, dlambda = caused(loop, cause, size)
        rest = find_equilibrium(dae, world, 0.0)
        return np.concatenate([rest.q - op.q_d - dq, (rest.lambda_ - op.lambda_d - dlambda) / 100])

    # Newton's method ends at 1e-12 of the forces; quadratic terms may be small beside the cubic ones.
    for part in (slice(0, op.n), slice(op.n, None)):
        order = observed_order(lambda size, part=part: np.abs(error(size)[part]).max(), 0.04, exact=1e-11)
        assert order > 1.7


@pytest.mark.parametrize("cause", CAUSES)
@pytest.mark.parametrize(
    "name", ["planar_2r_wall", pytest.param("planar_3r_circle", marks=pytest.mark.slow), "planar_3r_wall"]
)
def test_the_run_comes_to_rest_where_newton_says(shipped, run, cause, name):
    loop = shipped(name)
    if not applies(loop, cause):
        return
    op, size = loop.operating_point, 1.0
    world, dq, _ = caused(loop, cause, size)
    slowest = min(-each.real for each in loop.poles.reduced)
    done = run(loop, way=0.1, world=world, duration=24 / slowest)
    assert done.outcome is Outcome.CONVERGED
    # exp(-24) is 4e-11 (somewhat more where poles nearly meet, or a force shifts them); then the integrator's 1e-10
    assert done.q[-1] == pytest.approx(done.rest.q, abs=3e-9)
    assert done.lambda_[-1] == pytest.approx(done.rest.lambda_, abs=3e-6)
    if np.abs(dq).max() > 1e-6:
        assert np.abs(done.rest.q - op.q_d).max() > 1e-6  # it is somewhere else


def test_a_bias_error_is_a_force_exactly(shipped, run):
    """u + bias_error + d: only the sum counts, in motion too; a pulse may cancel it for a while."""
    loop, e = shipped("planar_3r_circle"), np.array([0.4, -0.2, 0.1])
    world = nominal_world(loop.operating_point)
    one = run(loop, way=0.1, world=replace(world, bias_error=e))
    other = run(loop, way=0.1, push=(Disturbance(e),))
    assert one.q == pytest.approx(other.q, abs=1e-9)
    none = run(loop, way=0.1, world=replace(world, bias_error=e), push=(Disturbance(-e),))
    assert none.q == pytest.approx(run(loop, way=0.1).q, abs=1e-9)


def test_a_reported_rest_is_that_of_the_end_not_of_the_whole(shipped, run):
    loop, op = shipped("planar_2r_wall"), shipped("planar_2r_wall").operating_point
    done = run(loop, push=(Disturbance(np.array([3.0, 1.0]), end=0.5),), duration=6.0)
    assert done.rest.q == pytest.approx(op.q_d, abs=1e-10)
    assert done.outcome is Outcome.CONVERGED
    cut = run(loop, push=(Disturbance(np.array([3.0, 1.0]), end=7.0),), duration=6.0)
    assert np.abs(cut.rest.q - op.q_d).max() > 1e-3
    assert cut.outcome is Outcome.CONVERGED


@pytest.mark.parametrize("controller", [Controller.AFFINE_WITH_FORCE, Controller.ENERGY_WITH_FORCE])
def test_t7_any_force_feedback_converges_and_divides_the_force_error(shipped, with_gains, run, controller):
    """[T7]: G_f = g I from 0 to 1000 under ideal contact and a constant force: dlambda (1 + g) is the same."""
    loop, d = shipped("planar_3r_circle"), np.array([0.05, -0.025, 0.015])
    op, left = loop.operating_point, {}
    for g in (0.0, 1.0, 10.0, 100.0, 1000.0):
        done = run(
            with_gains(loop, G_f=np.eye(1) * g), Feedback(controller), way=0.3, push=(Disturbance(d),), duration=3.0
        )
        assert done.outcome is Outcome.CONVERGED
        assert done.lambda_[-1] == pytest.approx(done.rest.lambda_, abs=1e-7)
        left[g] = (done.lambda_[-1, 0] - op.lambda_d[0]) * (1 + g)
    # for (11) the law turns with the surface, as the contact force does: exact; for (17) the ratio errs as dq does, a mrad
    within = 1e-6 if controller is Controller.ENERGY_WITH_FORCE else 0.01
    assert abs(left[0.0]) > 0.05
    for each in left.values():
        assert each == pytest.approx(left[0.0], rel=within)
