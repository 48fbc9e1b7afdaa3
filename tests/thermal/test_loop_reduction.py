"""A loop's rational model: closed once more by python-control, against the exact response, and in its poles."""

from dataclasses import replace

import control
import numpy as np
import pytest

from firmtouch.thermal import (
    Adiabatic,
    Base,
    Film,
    HalfSpace,
    Loop,
    Stack,
    ThermalValueError,
    Touch,
    power_response,
    power_transfer,
    reduce_loop,
    temperature_response,
)

LOOP = Loop(gain=5e4, heater=1, sensor_lag=0.2e-3)
EARLIEST, WINDOW = 1e-5, 0.5
W = np.geomspace(20 / WINDOW, 0.1 / EARLIEST, 60) * 1j


@pytest.fixture(scope="module")
def touch(m):
    return Touch(HalfSpace(m.glass), 1e4)


@pytest.fixture(scope="module")
def reduced(designs, touch):
    return reduce_loop(designs.D3, touch, LOOP, earliest=EARLIEST, window=WINDOW)


def test_the_step_is_as_near_as_it_says_and_the_frequency_response_too(designs, touch, reduced):
    assert reduced.relative_error < 1e-3  # each channel is reduced to 1e-4
    t = np.geomspace(EARLIEST, WINDOW, 317)
    exact = power_response(designs.D3, touch, LOOP, t)
    # Between the times at which the error was measured; a thousandth of it more.
    assert np.abs(reduced.step(t) - exact).max() <= 1.05 * reduced.error
    far = np.abs(reduced.transfer(W) / power_transfer(designs.D3, touch, LOOP, W) - 1)
    assert far.max() < 0.01


def test_python_control_closes_the_loop_to_the_same(reduced):
    """p = -K F theta by its own `feedback`, around the two channels."""
    lag = control.ss(control.tf([LOOP.gain], [LOOP.sensor_lag, 1]))
    heater, contact = reduced.heater.state_space(), reduced.contact.state_space()
    theirs = -contact * lag * control.feedback(control.ss([], [], [], [[1.0]]), heater * lag)
    ours = reduced.state_space()
    for s in W[::7]:
        assert ours(s) == pytest.approx(theirs(s), rel=1e-9)
        assert reduced.transfer(s) == pytest.approx(theirs(s), rel=1e-9)


def test_a_closed_loop_has_complex_poles_and_is_stable(reduced):
    assert (reduced.poles.real < 0).all()
    assert (np.abs(reduced.poles.imag) > 0.1 * np.abs(reduced.poles)).any()


@pytest.mark.parametrize(
    "changes", [{}, {"sensor_lag": 0.0}, {"integral_gain": 1e7}, {"sensor_lag": 0.0, "integral_gain": 1e7}]
)
@pytest.mark.parametrize("power", [True, False])
def test_each_part_of_a_loop(designs, touch, changes, power):
    """With and without lag and integral, the power and the temperature, against Euler's method."""
    loop = replace(LOOP, **changes)
    found = reduce_loop(designs.D3, touch, loop, earliest=EARLIEST, window=WINDOW, reads_power=power)
    t = np.geomspace(EARLIEST, WINDOW, 40)
    exact = (power_response if power else temperature_response)(designs.D3, touch, loop, t)
    assert found.step(t) == pytest.approx(exact, abs=2e-3 * np.abs(exact).max())
    assert found.relative_error < 2e-3


def test_one_film():
    """C'' on h and a base with a proportional loop: one pole at -(h + K)/C'', and p -> -K h/(h + K)."""
    stack, loop = Stack((Film(10.0),), 0, Adiabatic()), Loop(gain=5e3, heater=0)
    found = reduce_loop(stack, Touch(Base(), 1e3), loop, earliest=1e-5, window=0.1)
    assert found.step(np.array([0.1])) == pytest.approx([-5e3 / 6], rel=3e-4)  # as the channels
    t = np.geomspace(1e-5, 0.1, 30)
    assert found.step(t) == pytest.approx(-5e3 / 6 * -np.expm1(-600 * t), abs=1e-3 * 5e3 / 6)


def test_a_dead_time_is_refused(designs, touch):
    with pytest.raises(ThermalValueError, match="dead time"):
        reduce_loop(designs.D3, touch, replace(LOOP, dead_time=1e-3), earliest=EARLIEST, window=WINDOW)
