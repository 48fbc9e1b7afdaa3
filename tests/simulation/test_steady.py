"""The table of steady-state errors, simulated: rest as it is exactly, and deviations of first order."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import firmtouch
from firmtouch.modelfile.sections.bounds import Bounds
from firmtouch.regulation import SteadyState, steady_state_errors
from firmtouch.regulation.closed_loop import reduced_poles
from firmtouch.regulation.equilibrium import closed_loop_equilibrium
from firmtouch.simulation.steady import EXACT, HALVINGS, REST, simulate_steady_state
from firmtouch.simulation.trajectory import Outcome
from firmtouch.simulation.usual import SMALL
from firmtouch.simulation.world import nominal_world, tilted

MODELS = Path(__file__).parents[2] / "models"
NAMES = ("force", "offset", "rotation", "tilt")
FAST = ("pendulum_rod", "planar_2r_circle", "planar_2r_wall", "planar_3r_circle", "planar_3r_wall")
SLOW = ("spatial_3r_sphere", "spatial_6r_plane", "two_arms_bar")
# Where the largest cause goes beyond what the mechanism bears, the loop is not where the table says. Simulated, the
# contact is lost (both walls are one-sided there).
BEYOND = {("planar_2r_circle", "force", 1), ("spatial_3r_sphere", "force", 1)}
# The deviation changes its sign between one cause and its half, or its direction.
TURNING = {("planar_3r_circle", "tilt", 1), ("planar_3r_wall", "tilt", 1)}


@pytest.fixture(scope="module", params=[*FAST, *(pytest.param(name, marks=pytest.mark.slow) for name in SLOW)])
def simulated(request):
    """A shipped model with its table, and the table simulated."""
    model = firmtouch.read_model(MODELS / f"{request.param}.yaml")
    op = firmtouch.find_operating_point(firmtouch.derive_plant(model.spec))
    loop = firmtouch.assign_poles(op, model.with_method("poles").spec.design)
    errors = steady_state_errors(loop, model.spec.bounds)
    return request.param, loop, errors, simulate_steady_state(loop, errors)


def entries(simulated):
    """Each entry: (name, 0 for the position and 1 for the force), the worst case, and what was simulated."""
    name, _, errors, table = simulated
    for cause in NAMES:
        worst = getattr(errors, cause)
        for i, case in enumerate((worst.worst_position, worst.worst_constraint_force)):
            yield (name, cause, i), case, getattr(table, cause)[i]


def test_there_is_an_entry_for_every_effect_and_none_where_there_is_none(simulated):
    for key, worst, found in entries(simulated):
        assert (found is None) == (worst.value == 0), key


def test_the_causes_are_halved(simulated):
    for key, worst, found in entries(simulated):
        if found is not None:
            np.testing.assert_allclose(found.parts, 0.5 ** np.arange(HALVINGS + 1), rtol=1e-15, err_msg=str(key))
            assert found.effects.shape == (HALVINGS + 1, worst.effect.size)


def test_the_deviations_are_those_of_the_effects(simulated):
    for key, worst, found in entries(simulated):
        if found is not None:
            predicted = found.parts[:, None] * worst.effect
            off = np.linalg.norm(found.effects - predicted, axis=1) / np.linalg.norm(predicted, axis=1)
            np.testing.assert_allclose(found.deviations, off, rtol=1e-12, err_msg=str(key))


def test_the_deviations_fall_as_the_causes_do(simulated):
    for key, _, found in entries(simulated):
        if found is None:
            continue
        assert found.outcome is (Outcome.CONTACT_LOST if key in BEYOND else Outcome.CONVERGED), key
        if found.deviations[-1] <= EXACT or key in BEYOND | TURNING:
            assert np.isnan(found.order), key
        else:
            # Large causes have a second order beside the first, which may be the larger one: none is below a half.
            assert found.order == pytest.approx(1, abs=0.5), key
            assert np.all(np.diff(found.deviations) < 0), key


def test_the_order_tends_to_one(simulated):
    """The prediction is exact in first order: the relative deviation halves with the cause, where that is small."""
    _, loop, errors, _ = simulated
    rows = {each: smaller(getattr(errors, each)) for each in NAMES}
    table = simulate_steady_state(loop, SteadyState(**rows))
    for cause in NAMES:
        for found in getattr(table, cause):
            if found is not None and found.deviations[-1] > EXACT:
                assert found.outcome is Outcome.CONVERGED, cause
                assert found.order == pytest.approx(1, abs=0.06), cause


def smaller(error):
    """The same row with a 32nd of its worst causes."""
    names = ("worst_position", "worst_constraint_force")
    cases = {each: getattr(error, each) for each in names}
    return replace(error, **{
        each: replace(worst, cause=worst.cause / 32, effect=worst.effect / 32)
        for each, worst in cases.items()
    })  # fmt: skip


def test_the_effects_are_those_of_the_exact_rest(simulated):
    """Newton's method on the equations of rest, with another derivation of them, finds what the simulation came to."""
    _, loop, _, _ = simulated
    op = loop.operating_point
    for key, worst, found in entries(simulated):
        if found is None or key in BEYOND:
            continue
        for part, effect in zip(found.parts, found.effects, strict=True):
            cause = part * worst.cause
            world = {"force": {"d": cause}, "offset": {"Delta": cause}}.get(key[1])
            if key[1] == "tilt":
                world = {"E": tilted(op, nominal_world(op), cause).E}
            if world is None:  # a rotation: the angle is |cause| / |lambda_d|, in the plane of the two
                world = {"R": rotation(op.lambda_d, cause)}
            exact = closed_loop_equilibrium(loop, **world)
            position, force = exact.q - op.q_d, exact.lambda_ - op.lambda_d
            # What is still under way has decayed at the rate of the place where it comes to rest, which may be softer
            # than q_d; the integrator errs by 1e-10 at each of some hundred steps. Forces are these times the stiffness.
            on_the_way = (
                10 * np.linalg.norm(position) * np.exp(-REST * slowest_at(loop, exact, **world) / slowest(loop))
            )
            tolerance = (1e-8 + on_the_way) * (1 if key[2] == 0 else np.linalg.norm(loop.K, 2))
            expected = (position, force)[key[2]]
            np.testing.assert_allclose(effect, expected, rtol=0, atol=tolerance, err_msg=f"{key} {part}")
            assert tolerance < 0.02 * np.linalg.norm(expected) or part == 1 or np.linalg.norm(expected) < 1e-6, key


def slowest(loop):
    return min(-each.real for each in loop.poles.reduced)


def slowest_at(loop, rest, *, R=None, E=0.0, **_):
    """The slowest decay rate about another point of rest."""
    op, plant = loop.operating_point, loop.operating_point.plant
    R = np.eye(op.m) if R is None else R
    J = R @ plant.J(rest.q) + E
    K = loop.gains.W + plant.P_qq(rest.q) - np.tensordot(R.T @ rest.lambda_, plant.Phi_qq(rest.q), axes=1)
    V2 = np.linalg.svd(J)[2][op.m :].T
    return min(-each.real for each in reduced_poles(plant.M(rest.q), loop.gains.C, K, V2))


def rotation(lambda_d, cause):
    """expm of the skew matrix that turns lambda_d towards the cause."""
    from scipy.linalg import expm

    along, across = lambda_d / np.linalg.norm(lambda_d), cause / np.linalg.norm(cause)
    angle = np.linalg.norm(cause) / np.linalg.norm(lambda_d)
    return expm(angle * (np.outer(along, across) - np.outer(across, along)))


def test_where_contact_is_lost_there_is_no_order_but_the_outcome(simulated):
    for key, _, found in entries(simulated):
        if key in BEYOND:
            assert np.isnan(found.order)
            assert found.outcome is Outcome.CONTACT_LOST
            assert found.deviations[0] > 1  # it is nowhere near the prediction
            assert found.deviations[1] < 0.5  # and half the cause is borne


def test_without_bounds_small_causes_are_simulated(loop_of):
    loop = loop_of(firmtouch.read_model(MODELS / "pendulum_rod.yaml"))
    table = simulate_steady_state(loop, steady_state_errors(loop, Bounds()))
    halves = 0.5 ** np.arange(HALVINGS + 1)
    for name, size in SMALL.items():
        for found in getattr(table, name):
            np.testing.assert_allclose(found.parts, size * halves, rtol=1e-15)
            assert found.outcome is Outcome.CONVERGED
            assert found.deviations[0] < 0.05
