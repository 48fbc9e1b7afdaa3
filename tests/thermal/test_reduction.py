"""Rational models: their stated error is their error, and python-control sees the same."""

import control
import numpy as np
import pytest

from firmtouch.thermal import ContactEvent, HalfSpace, Stack, ThermalValueError, Touch, reduce_step, rise_time

EARLIEST, WINDOW = 1e-5, 1.0


@pytest.fixture
def event(m, designs):
    return ContactEvent(designs.D3, Touch(HalfSpace(m.copper), 1e4), 1.0)


@pytest.mark.parametrize(("per_decade", "error"), [(1, 2e-2), (1.5, 4e-3), (2, 8e-4), (3, 4e-5)])
def test_more_poles_a_decade_err_less(event, per_decade, error):
    """The errors recorded for such stacks, within a factor of 2.5: the stack and the window change them."""
    model = reduce_step(event.temperature, earliest=EARLIEST, window=WINDOW, per_decade=per_decade)
    assert model.error < 2.5 * error
    assert (model.poles < 0).all()
    t = np.geomspace(EARLIEST, WINDOW, 333)
    assert np.abs(model.step(t) - event.temperature(t)).max() <= 1.01 * model.error  # between the checked times


def test_python_control_sees_the_same(event):
    model = reduce_step(event.temperature, earliest=EARLIEST, window=WINDOW)
    system = model.state_space()
    assert np.sort(system.poles().real) == pytest.approx(np.sort(model.poles), rel=1e-12)
    t = np.linspace(0, 0.05, 501)
    _, y = control.step_response(system, t)
    assert y[1:] == pytest.approx(event.temperature(t[1:]), abs=model.error + 1e-9)
    s = 1j * np.logspace(0, 4, 9)
    assert system(s) == pytest.approx(model.transfer(s), rel=1e-9)
    assert model.transfer_function()(s) == pytest.approx(model.transfer(s), rel=1e-4)  # a polynomial of degree 16


def test_its_rise_time_is_the_exact_ones(event):
    model = reduce_step(event.temperature, earliest=EARLIEST, window=0.5)
    exact, reduced = (rise_time(f, 0.5).seconds for f in (event.temperature, model.step))
    assert reduced == pytest.approx(exact, rel=2e-3)  # the end's slope turns 4e-5 into some 1e-3 of time


def test_its_frequency_response_is_the_exact_one_in_the_band(event, m, designs):
    from firmtouch.thermal import contact_transfer

    s = 1j * np.logspace(1, 4, 30)
    exact = contact_transfer(designs.D3, event.touch, s).sensed
    model = reduce_step(event.temperature, earliest=1e-6, window=WINDOW)
    assert model.transfer(s) == pytest.approx(exact, abs=2e-3)


def test_a_response_that_jumps_needs_its_feedthrough(m):
    """Two half-spaces and a perfect contact: H is a constant."""
    event = ContactEvent(Stack((), 0, HalfSpace(m.skin)), Touch(HalfSpace(m.pmma), np.inf), 1.0)
    model = reduce_step(event.temperature, earliest=1e-4, window=1.0, feedthrough=True)
    e = m.skin.effusivity, m.pmma.effusivity
    assert model.D == pytest.approx(e[1] / sum(e), rel=1e-9)
    assert model.error < 1e-10
    assert reduce_step(event.temperature, earliest=1e-4, window=1.0).error > 1e-3


def test_refusals(event):
    with pytest.raises(ThermalValueError, match="window"):
        reduce_step(event.temperature, earliest=1.0, window=0.5)
    with pytest.raises(ThermalValueError, match="poles per decade"):
        reduce_step(event.temperature, earliest=1e-3, window=0.5, per_decade=0.5)
