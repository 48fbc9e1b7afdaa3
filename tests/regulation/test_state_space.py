"""The system that python-control gets has the poles and the rest points of the closed loop."""

import control
import numpy as np
import pytest

from firmtouch.regulation import state_space
from firmtouch.regulation.closed_loop import pole_distance
from firmtouch.regulation.steady_state import disturbance_matrices


def test_its_poles_are_those_of_the_pencil(loop):
    poles = tuple(complex(each) for each in control.poles(state_space(loop)))
    # Double poles move by the square root of rounding.
    assert pole_distance(poles, loop.poles.pencil) < 1e-6


def test_its_gain_at_rest_is_the_steady_state_table(loop):
    system = state_space(loop)
    gain = control.dcgain(system)
    position, constraint_force = disturbance_matrices(loop)
    # Both solve the same linear equations, by different routes, with condition numbers below 1e4.
    np.testing.assert_allclose(gain, np.vstack([position, constraint_force]), atol=1e-9 * np.abs(gain).max())


def test_decoupling_keeps_the_force_still_while_the_position_converges(loop):
    if loop.operating_point.plant.spec.design.normal_blocks.policy != "decouple":
        pytest.skip("another policy was asked for")
    system = state_space(loop)
    n = loop.operating_point.n
    # [T1]: the multiplier does not see the state at all, only what passes straight through.
    force_rows = np.asarray(system.C)[n:]
    assert np.abs(force_rows).max() < 1e-9 * (1 + np.abs(loop.K).max())
