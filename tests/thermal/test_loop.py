"""The loop on a whole stack: its limits, the lumped loop within it, stability, and how much faster power is."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from firmtouch.thermal import (
    Air,
    Base,
    ConstantTemperature,
    ContactEvent,
    Film,
    HalfSpace,
    Inversion,
    Layer,
    Loop,
    LoopRingsError,
    LoopUnstableError,
    Metric,
    Stack,
    ThermalValueError,
    Touch,
    invert,
    oscillating_poles,
    power_response,
    power_transfer,
    rise_time,
    temperature_response,
    unstable_poles,
)

T = np.logspace(-5, -1, 17)


@pytest.mark.parametrize("lag", [0.0, 0.4e-3])
def test_on_one_film_it_is_the_lumped_loop(lag):
    """C'' = 40 J/m2K with h to a held object: G'' = h + h_a, and the object pushes with h."""
    film, touch = Stack((Film(40.0),), sensed=0, backing=Air(10.0)), Touch(Base(), 1e3)
    loop, lumped = Loop(gain=5e4, heater=0, sensor_lag=lag), ConstantTemperature(40.0, 1010.0, 5e4, lag)
    assert temperature_response(film, touch, loop, T) == pytest.approx(1e3 * lumped.temperature_step(T), abs=1e-9)
    expected = -1e3 * 5e4 / 5.101e4 * lumped.response(T)
    assert power_response(film, touch, loop, T) == pytest.approx(expected, abs=1e-5)  # of 1e3 W/m2K


def test_a_strong_loop_draws_what_a_held_face_would(m):
    """At contact with copper, h = 1e4 and 15 K, a held film draws h dT erfcx(b sqrt t): 0.146 W/mm2 at 10 ms."""
    film = Stack((Film(5.0), Layer(m.foam, 1e-3)), sensed=0, backing=Base())
    touch = Touch(HalfSpace(m.copper), 1e4)
    drawn = 15 * power_response(film, touch, Loop(gain=1e8, heater=0), [10e-3])
    held = ContactEvent(Stack((), 0, Base()), touch, 15.0).flux(np.array([10e-3]))
    assert -drawn == pytest.approx(held, rel=2e-4)  # h/K and the film's own 1e-4
    assert -drawn * 1e-6 == pytest.approx(0.146, abs=5e-4)


def test_integral_action_holds_the_temperature_in_the_end():
    film, touch = Stack((Film(40.0),), sensed=0, backing=Air(10.0)), Touch(Base(), 1e3)
    loop = Loop(gain=2e4, heater=0, integral_gain=4e6)
    assert temperature_response(film, touch, loop, [1e-3, 0.2])[1] == pytest.approx(0, abs=1e-6)
    assert power_response(film, touch, loop, [0.2]) == pytest.approx([-1e3], rel=1e-5)


@pytest.mark.parametrize("gain", [3e4, 1e5])
def test_power_answers_far_before_temperature(m, designs, gain):
    """Of 5 and 7.5 um films at h = 1e4 temperature takes 17-31 ms and power 0.3-1.1 ms, with a lag of 0.2 ms."""
    loop = Loop(gain=gain, heater=1, sensor_lag=0.2e-3)
    for name in ("copper", "glass", "pmma"):
        touch = Touch(HalfSpace(getattr(m, name)), 1e4)
        temperature = rise_time(ContactEvent(designs.D2, touch, 1.0).temperature, 0.5).seconds
        power = rise_time(lambda t, touch=touch: power_response(designs.D2, touch, loop, t), 0.05).seconds
        assert 16e-3 < temperature < 32e-3
        assert 0.2e-3 < power < 1.2e-3


def test_the_dead_time_is_the_powers_delay():
    """One film, a proportional loop: until 2 T_d the power is what the open film's temperature was T_d before."""
    film, touch = Stack((Film(40.0),), sensed=0, backing=Air(10.0)), Touch(Base(), 1e3)
    loop, dead = Loop(gain=1e4, heater=0, dead_time=1e-3), 1e-3
    t = np.array([0.5e-3, 1.3e-3, 1.7e-3])
    open_film = 1e3 / 1010 * -np.expm1(-np.maximum(0, t - dead) * 1010 / 40)
    assert power_response(film, touch, loop, t) == pytest.approx(-1e4 * open_film, abs=1e-3)  # of 2e2: 1e-4 for corners


def test_stability_is_that_of_the_poles(m):
    """On one film (C s + G)(tau_s s + 1) + K e^{-sT}: the gain at which it starts to grow is known from the phase."""
    film, touch = Stack((Film(40.0),), sensed=0, backing=Air(10.0)), Touch(Base(), 1e3)
    lag, dead = 0.4e-3, 1e-3
    omega = brentq(lambda w: math.atan(w * 40 / 1010) + math.atan(w * lag) + w * dead - math.pi, 1.0, 1e4)
    limit = 1010 * math.hypot(1, omega * 40 / 1010) * math.hypot(1, omega * lag)
    for factor, poles in ((0.98, 0), (1.02, 2)):
        loop = Loop(gain=factor * limit, heater=0, sensor_lag=lag, dead_time=dead)
        assert unstable_poles(film, touch, loop) == poles
    with pytest.raises(LoopUnstableError, match="2 poles have positive real parts") as refused:
        power_response(film, touch, loop, T)
    assert refused.value.poles == 2


def test_an_integral_without_enough_gain_is_unstable_with_a_lag(m):
    """(C s + G)(tau_s s + 1) s + K s + K_i: Routh's K_i < (C + G tau_s)(G + K) / (C tau_s)."""
    film, touch, lag = Stack((Film(40.0),), sensed=0, backing=Air(10.0)), Touch(Base(), 1e3), 1e-3
    limit = (40 + 1010 * lag) * (1010 + 2e4) / (40 * lag)
    for factor, poles in ((0.99, 0), (1.01, 2)):
        loop = Loop(gain=2e4, heater=0, integral_gain=factor * limit, sensor_lag=lag)
        assert unstable_poles(film, touch, loop) == poles


def test_a_loop_on_a_half_space_with_an_integral_is_counted_right(m):
    """Both have their branch points at 0; without a lag such a loop is passive, so it cannot grow."""
    stack = Stack((Layer(m.kapton, 10e-6),), sensed=1, backing=HalfSpace(m.pdms))
    loop = Loop(gain=1e5, heater=1, integral_gain=1e6)
    assert unstable_poles(stack, Touch(HalfSpace(m.glass), 1e4), loop) == 0


@pytest.mark.parametrize(("gain", "lag"), [(5e5, 1e-3), (5e7, 5e-3)])
def test_ringing_poles_are_found_and_refused_where_euler_cannot_follow(gain, lag):
    """Where it has turned hundreds of times all orders agree on the mean, and are wrong: the poles tell, not the sum."""
    film, touch = Stack((Film(40.0),), sensed=0, backing=Air(10.0)), Touch(Base(), 1e3)
    loop, lumped = Loop(gain=gain, heater=0, sensor_lag=lag), ConstantTemperature(40.0, 1010.0, gain, lag)
    found = oscillating_poles(film, touch, loop)
    assert found == pytest.approx([lumped.poles[lumped.poles.imag > 0][0]], rel=1e-9)
    with pytest.raises(LoopRingsError, match="still rings at") as refused:
        power_response(film, touch, loop, np.linspace(40, 4000, 20) / found[0].imag)
    assert refused.value.pole == found[0]
    assert refused.value.t == pytest.approx(40 / found[0].imag)
    early = np.linspace(1, 20, 20) / found[0].imag
    expected = 1e3 * lumped.temperature_step(early)
    assert temperature_response(film, touch, loop, early) == pytest.approx(expected, abs=1e-4 * expected.max())


def test_a_damped_loop_has_no_ringing_poles(m, designs):
    loop = Loop(gain=3e4, heater=1)
    assert oscillating_poles(designs.D3, Touch(HalfSpace(m.glass), 1e4), loop) == ()


def test_talbot_is_right_on_a_damped_loop_too(m, designs):
    """Two methods of unlike contours agree where both apply."""
    touch, loop = Touch(HalfSpace(m.glass), 1e4), Loop(gain=1e4, heater=1)
    by_euler = power_response(designs.D3, touch, loop, T)
    by_talbot = invert(lambda s: power_transfer(designs.D3, touch, loop, s) / s, T, method=Inversion.TALBOT)
    assert by_euler == pytest.approx(by_talbot, abs=1e-9 * np.abs(by_talbot).max())
    assert rise_time(lambda t: power_response(designs.D3, touch, loop, t), 0.05, Metric.SIXTY_THREE).seconds < 2e-3


@pytest.mark.parametrize(
    ("wrong", "name"),
    [({"gain": 0.0}, "loop gain"), ({"sensor_lag": -1.0}, "sensor lag"), ({"dead_time": math.inf}, "dead time")],
)
def test_refusals(wrong, name):
    with pytest.raises(ThermalValueError, match=name):
        Loop(**{"gain": 1.0, "heater": 0} | wrong)
