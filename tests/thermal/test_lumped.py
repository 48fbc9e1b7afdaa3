"""One and two heat capacities, and the loop that holds one of them."""

import math

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from firmtouch.thermal import (
    ConstantTemperature,
    OnePole,
    ThermalValueError,
    TwoNode,
    euler,
    gain_for_damping,
    required_conductance,
    rise_time,
)

SIZES = st.floats(-6, 0).map(lambda x: 10**x)
T = np.array([1e-3, 1e-2, 0.1])


def test_a_thermistor_chip_needs_more_than_any_contact_gives():
    """delta tau = 0.7 mW/K x 2.2 s on 0.5 mm2: 338 mW/K for 10 ms, 6.8e5 W/m2K on its footprint."""
    needed = required_conductance(0.7e-3 * 2.2, 10e-3)
    assert needed == pytest.approx(0.338, abs=5e-4)
    assert needed / 0.5e-6 == pytest.approx(6.8e5, rel=5e-3)
    assert OnePole(1.54e-3, needed).rise_time == pytest.approx(10e-3, rel=1e-14)


@given(SIZES, SIZES, SIZES, SIZES, SIZES)
def test_two_nodes_against_the_matrix_exponential(C_h, G_a, G_ht, C_t, G_c):
    nodes = TwoNode(C_h, G_a, G_ht, C_t, G_c)
    assert (nodes.poles < 0).all()
    A = nodes.A
    assert np.prod(nodes.poles) == pytest.approx(np.linalg.det(A), rel=1e-9)
    t = 0.7 / abs(nodes.poles[0])
    augmented = scipy.linalg.expm(np.block([[A, nodes.B], [np.zeros((2, 4))]]) * t)
    expected = augmented[:2, 2:]
    # Poles up to 1e6 apart, whose exponential SciPy makes by squaring some twenty times.
    assert nodes.step(t) == pytest.approx(expected, rel=1e-7, abs=1e-9 * np.abs(expected).max())


def test_transfer_functions_are_the_state_space(rng):
    nodes = TwoNode(*10 ** rng.uniform(-5, -2, 5))
    for s in (2j, 300 + 40j, 1e4j):
        expected = np.linalg.solve(s * np.eye(2) - nodes.A, nodes.B)
        assert np.array(nodes.power_transfer(s)) == pytest.approx(expected[:, 0], rel=1e-11)
        assert np.array(nodes.object_transfer(s)) == pytest.approx(expected[:, 1], rel=1e-11)


@pytest.mark.parametrize(("lag", "K", "rise"), [(1e-3, 20e-3, 3.0e-3), (5e-3, 4.1e-3, 13.5e-3)])
def test_a_loop_cannot_outrun_its_sensor(lag, K, rise):
    C, G = 40e-6, 1e-3
    found = gain_for_damping(C, G, lag)
    loop = ConstantTemperature(C, G, found, lag)
    assert found == pytest.approx(K, rel=0.02)  # two digits recorded
    assert loop.damping == pytest.approx(math.sqrt(0.5), rel=1e-12)
    start, end = (brentq(lambda t, level: loop.response(t) - level, 1e-6, 2 * rise, (each,)) for each in (0.1, 0.9))
    assert end - start == pytest.approx(rise, rel=0.02)  # of the final value, two digits recorded
    assert 2 < rise_time(loop.response, 1.0).seconds / lag < 3.5  # t_r ~ 3 tau_s


@given(SIZES, SIZES, SIZES, st.floats(0.3, 3))
def test_closed_loop_steps_are_those_of_their_transfer_functions(C, G, lag, zeta):
    natural = C / G
    lag = min(lag, 0.05 * natural)
    K = max(0.0, G * ((1 + lag / natural) ** 2 * natural / (4 * zeta**2 * lag) - 1))
    loop = ConstantTemperature(C, G, K, lag)
    t = np.array([0.1, 1.0, 5.0]) / np.abs(loop.poles).max()
    expected = euler(lambda s: loop.temperature_transfer(s) / s, t)
    assert loop.temperature_step(t) == pytest.approx(expected, abs=1e-8 / (G + K))
    power = euler(lambda s: loop.power_transfer(s) / s, t)
    assert -loop.response(t) * K / (G + K) == pytest.approx(power, abs=1e-8)


def test_poles_that_meet_are_the_limit_of_poles_that_nearly_do():
    """zeta = 1: cosh and sinh/root pass into 1 and t."""
    C, G, lag = 40e-6, 1e-3, 1e-3
    double = gain_for_damping(C, G, lag, 1.0)
    steps = [ConstantTemperature(C, G, double * (1 + d), lag).temperature_step(T) for d in (0, 1e-9, -1e-9)]
    for near in steps[1:]:
        assert near == pytest.approx(steps[0], rel=1e-7)


def test_poles_that_are_equal_to_the_last_digit():
    """Without a gain the lag does nothing to the temperature: 1 - e^{-t}, from two poles at -1."""
    assert ConstantTemperature(1.0, 1.0, 0.0, 1.0).temperature_step(T) == pytest.approx(-np.expm1(-T), rel=1e-13)


def test_a_loop_without_lag_has_one_pole():
    loop = ConstantTemperature(40e-6, 1e-3, 50e-3)
    assert loop.poles == pytest.approx([-51e-3 / 40e-6])
    assert loop.damping == math.inf
    assert loop.temperature_step(T) == pytest.approx(-np.expm1(loop.poles.real * T) / 51e-3)


def test_refusals():
    with pytest.raises(ThermalValueError, match=r"zeta is 5, but must be at most 3\.24"):
        gain_for_damping(40e-6, 1e-3, 1e-3, 5.0)
    with pytest.raises(ThermalValueError, match="loop gain K"):
        ConstantTemperature(40e-6, 1e-3, -1.0)
    with pytest.raises(ThermalValueError, match="G_a"):
        TwoNode(1, -1, 1, 1, 1)
    with pytest.raises(ThermalValueError, match="rise time is 0"):
        required_conductance(1e-3, 0)
