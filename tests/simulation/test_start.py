"""Consistent starts: the projection onto the true constraints and along them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmtouch.regulation.projection import OffSurfaceError
from firmtouch.simulation.scenario import Start
from firmtouch.simulation.start import consistent_start, true_surface
from firmtouch.simulation.trajectory import Outcome
from firmtouch.simulation.world import nominal_world, tilted

ON_IT = 1e-11  # Newton's method ends at 1e-12


def crooked(op, rng, size):
    """A world whose surface is shifted, turned and tilted, and whose lengths are others."""
    n, m = op.n, op.m
    turn = np.linalg.qr(np.eye(m) + size * rng.normal(size=(m, m)))[0]
    world = tilted(op, nominal_world(op), size * rng.normal(size=n))
    return replace(world, Delta=0.1 * size * rng.normal(size=m), R=turn, p=op.plant.p * (1 + 0.1 * size))


def test_q_comes_to_lie_on_the_true_surface_and_its_rate_along_it(loop, rng):
    op = loop.operating_point
    world = crooked(op, rng, 0.05)
    surface = true_surface(op, world)
    given_start = Start(op.q_d + 0.05 * rng.normal(size=op.n), rng.normal(size=op.n))
    projection, qdot = consistent_start(op, world, given_start)
    p = world.p
    plant = op.plant.with_parameters(p)
    Phi = world.R @ plant.Phi(projection.q) + world.E @ (projection.q - op.q_d) - world.Delta
    assert np.abs(Phi).max() < ON_IT
    assert np.abs(op.plant.Phi(projection.q)).max() > 1e-4  # and not on the model's
    J = surface.J(projection.q)
    assert np.abs(J @ qdot).max() < ON_IT
    assert projection.moved == pytest.approx(np.linalg.norm(projection.q - given_start.q))
    # the least change of q' is normal to the surface: in the range of J^T
    change = given_start.qdot - qdot
    assert change == pytest.approx(J.T @ np.linalg.lstsq(J.T, change, rcond=None)[0], abs=1e-12)
    again, same = consistent_start(op, world, Start(projection.q, qdot))
    assert again.q == pytest.approx(projection.q, abs=ON_IT)
    assert same == pytest.approx(qdot, abs=ON_IT)


def test_a_gradient_that_is_offered_is_that_of_the_surface(loop, rng):
    op = loop.operating_point
    surface, q, h = true_surface(op, crooked(op, rng, 0.05)), op.q_d + 0.1 * rng.normal(size=op.n), 1e-6
    differences = [(surface.Phi(q + h * e) - surface.Phi(q - h * e)) / (2 * h) for e in np.eye(op.n)]
    assert surface.J(q) == pytest.approx(np.column_stack(differences), abs=1e-8)  # h^2, and 1e-16 / h


@given(seed=st.integers(0, 10**6))
def test_the_move_is_the_least_one_to_first_order(shipped, seed):
    """The move's part along the surface falls with the square of the distance, the move with the distance."""
    op, rng = shipped("planar_3r_circle").operating_point, np.random.default_rng(seed)
    direction, world = rng.normal(size=op.n), nominal_world(op)
    direction /= np.linalg.norm(direction)
    for size in (1e-2, 1e-3):
        q = consistent_start(op, world, Start(op.q_d + size * direction, np.zeros(op.n)))[0].q
        move, J = q - op.q_d - size * direction, op.plant.J(q)
        along = move - np.linalg.lstsq(J, J @ move, rcond=None)[0]
        assert np.linalg.norm(move) <= 1.2 * size
        # the surface's curvature and J's change: some 1/m in metres of a radian
        assert np.linalg.norm(along) <= 5 * size**2


def test_a_run_begins_at_the_projected_start_and_says_how_far_it_was_moved(shipped, run, rng):
    loop = shipped("planar_3r_circle")
    op = loop.operating_point
    world = crooked(op, rng, 0.02)
    q, v = op.q_d + 0.03, rng.normal(size=op.n) / 10
    done = run(loop, q=q, qdot=v, world=world, duration=0.1)
    projection, qdot = consistent_start(op, world, Start(q, v))
    assert done.q[0] == pytest.approx(projection.q, abs=0)
    assert done.qdot[0] == pytest.approx(qdot, abs=0)
    assert done.moved == projection.moved > 1e-3
    assert np.abs(done.Phi).max() < 1e-9


def test_a_start_that_cannot_be_projected_says_where_it_got_to(shipped, run):
    loop = shipped("planar_2r_wall")
    op = loop.operating_point
    beyond = replace(nominal_world(op), Delta=np.array([-0.5]))  # a wall at 1.12 m, and the arm is 0.95 m long
    with pytest.raises(OffSurfaceError, match="came to") as caught:
        run(loop, world=beyond)
    found = caught.value.projection
    reached = 0.5 * np.cos(found.q[0]) + 0.45 * np.cos(found.q.sum())
    assert found.residual == pytest.approx(1.12 - reached, abs=1e-12)  # its evidence is true
    assert reached == pytest.approx(0.95, abs=0.1)  # and near the best that can be done
    assert "0.1" in str(caught.value)


def test_a_start_where_j_loses_rank_ends_at_once_with_its_reason(shipped, run, capfd):
    loop = shipped("planar_2r_wall")
    op = loop.operating_point
    p = op.plant.p.copy()
    p[list(op.plant.spec.parameters).index("d")] = 0.95  # stretched out, the tip just touches: J = 0
    done = run(loop, q=np.zeros(2), world=replace(nominal_world(op), p=p))
    assert done.outcome is Outcome.STOPPED
    assert "singular" in done.reason
    assert done.t[-1] == 0.0
    assert capfd.readouterr() == ("", "")


@pytest.mark.slow
def test_a_run_into_a_singular_place_stops_and_keeps_what_came_before(shipped, run, capfd):
    loop = shipped("planar_2r_wall")
    op = loop.operating_point
    p = op.plant.p.copy()
    p[list(op.plant.spec.parameters).index("d")] = 0.94999  # the whole surface is a loop of some mrad
    done = run(loop, world=replace(nominal_world(op), p=p), duration=2.0)
    assert done.outcome in (Outcome.STOPPED, Outcome.DIVERGED)
    assert 0 < done.t[-1] < 2.0
    assert f"{done.t[-1]:.4g}" in done.reason
    assert np.all(np.isfinite(done.q))
    assert capfd.readouterr() == ("", "")


def test_a_force_loop_without_a_solution_stops_the_run(shipped, run):
    loop = shipped("planar_2r_wall")
    singular = replace(loop, gains=replace(loop.gains, G_f=-np.eye(1)))  # I + G_f = 0 at q_d
    done = run(singular)
    assert done.outcome is Outcome.STOPPED
    assert done.t[-1] == 0.0
