"""Frequency responses, loop margins and rational models against closed forms of one film."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from firmtouch.thermal import Adiabatic, Air, Base, Film, Loop, Stack, Touch
from firmtouch.thermal.analysis import feel, rational_models, spectra_of
from firmtouch.thermal.sensor import HeldPower, HeldTemperature, Scenario, Sensor, Temperatures

C, H, AIR = 2.0, 5e3, 10.0  # J/m2K, W/m2K, W/m2K
GAIN, LAG, DELAY = 4e4, 2e-4, 5e-5  # W/m2K, s, s
AT = Temperatures(object=290.0, face=310.0, base=310.0, ambient=290.0)


def film(drive=None) -> Sensor:
    """A film alone, on a contact with a body that keeps its temperature: theta = h/(h + s C)."""
    stack = Stack((Film(C),), sensed=0, backing=Adiabatic())
    touches = (("low", H / 2), ("nominal", H))
    scenarios = tuple(Scenario("body", level, Touch(Base(), h)) for level, h in touches)
    return Sensor(stack, 0, drive or HeldPower(), AT, scenarios, front=Air(AIR))


def loop_film(dead_time: float = DELAY) -> Sensor:
    return film(HeldTemperature(Loop(GAIN, 0, sensor_lag=LAG, dead_time=dead_time)))


def test_a_film_is_a_low_pass_of_one_pole_in_the_usual_contact():
    spectra = spectra_of(film(), 0.1)
    (signal,) = spectra.signals
    exact = H / (H + 1j * spectra.omega * C)
    assert signal.magnitude == pytest.approx(np.abs(exact), rel=1e-12)  # closed form, a few roundings
    assert signal.phase == pytest.approx(np.angle(exact), abs=1e-12)
    assert signal.bandwidth == pytest.approx(H / C, rel=1e-3)  # 30 frequencies a decade, interpolated
    assert spectra.loops == ()


def L_of(omega: float, h: float) -> complex:
    s = 1j * omega
    return GAIN * np.exp(-s * DELAY) / ((h + s * C) * (1 + s * LAG))


@pytest.mark.parametrize(("place", "h"), [(0, AIR), (1, H)])
def test_a_loops_margins_are_those_of_its_closed_form(place, h):
    found = spectra_of(loop_film(), 0.1).loops[place]
    assert found.object == (None if place == 0 else "body")
    cross = brentq(lambda w: abs(L_of(w, h)) - 1, 1e2, 1e6)
    turned = brentq(lambda w: math.atan(w * C / h) + math.atan(w * LAG) + w * DELAY - math.pi, 1e2, 6e4)
    near = min(abs(1 + L_of(w, h)) for w in np.geomspace(3e2, 3e5, 20001))
    # linear and logarithmic interpolation between 30 frequencies a decade, 8 % apart: some (0.08)^2/8 of the curvature
    assert found.crossover == pytest.approx(cross, rel=2e-3)
    assert found.phase_margin == pytest.approx(math.pi + np.angle(L_of(cross, h)), rel=5e-3)
    assert found.gain_margin == pytest.approx(1 / abs(L_of(turned, h)), rel=5e-3)
    # |1 + L|^2 = m^2 + (v d)^2, with v = |dL/d ln omega| about 1, m >= 0.017, and a distance d of ln omega: at most
    # 4e-4 after two zooms, and 3e-4 of these 20001 frequencies
    assert found.modulus_margin == pytest.approx(near, rel=5e-4)


def test_a_loop_without_delay_has_no_limit_of_its_gain():
    found = spectra_of(loop_film(dead_time=0.0), 0.1).loops[1]
    assert found.gain_margin == math.inf
    assert 0 < found.phase_margin < math.pi


def test_the_power_of_a_loop_begins_at_minus_a_half_turn():
    (signal,) = spectra_of(loop_film(), 0.1).signals
    assert signal.unit == "W/m^2/K"
    assert signal.phase[0] == pytest.approx(-math.pi, abs=0.05)  # at rest a warmer object saves power
    assert (np.diff(signal.phase) < 0).all()


def test_a_rational_model_errs_no_more_than_it_says_and_leaves_the_dead_time_out():
    (model,) = rational_models(feel(film(), 0.01))
    t = np.geomspace(model.reduction.earliest, model.reduction.window, 237)
    error = np.abs(model.reduction.step(t) - (1 - np.exp(-t * H / C))).max()
    assert error <= 1.05 * model.reduction.error  # the error was measured at other times
    assert model.unit == "K/K"
    assert model.dead_time == 0
    (late,) = rational_models(feel(loop_film(), 0.01))
    (prompt,) = rational_models(feel(loop_film(dead_time=0.0), 0.01))
    assert late.dead_time == DELAY
    assert late.reduction.window == pytest.approx(0.01 - DELAY, rel=1e-12)
    assert (prompt.reduction.poles < 0).all()
