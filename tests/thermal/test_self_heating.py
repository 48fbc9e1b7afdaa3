"""A thermometer's own heat: the linear feedback and the exact steady state, against the nonlinear equation."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from firmtouch.thermal import (
    FEEDBACK_LIMIT,
    NTC,
    RTD,
    Bias,
    RunawayError,
    SteinhartHart,
    ThermalValueError,
    self_heating,
    steady_rise,
)

ROOM, DELTA, CAPACITY = 298.15, 1e-3, 1e-4
OXIDE, METAL = NTC(1e4, 3435), RTD(100, 3.85e-3)
CURVE = SteinhartHart(1.009249522e-3, 2.378405444e-4, 2.019202697e-7)
SPAN = np.array([0.0, 0.1, 0.2, 0.5]) * CAPACITY / DELTA


def fed(thermometer, bias, power, at):
    """Give P(T) of a source that gives `power` at a temperature, from Ohm's law."""
    R = float(thermometer.resistance(at))
    V, current = math.sqrt(power * R), math.sqrt(power / R)
    return {
        Bias.VOLTAGE: lambda T: V**2 / thermometer.resistance(T),
        Bias.CURRENT: lambda T: current**2 * thermometer.resistance(T),
        Bias.HALF_BRIDGE: lambda T: (2 * V / (R + thermometer.resistance(T))) ** 2 * thermometer.resistance(T),
    }[bias]


def warm(source, start, t, *, ambient=ROOM, burnt=200.0):
    """Integrate C T' = P(T) - delta (T - T_a) until it has risen by `burnt`."""

    def event(_, T):
        return T[0] - ambient - burnt

    event.terminal = True
    found = solve_ivp(
        lambda _, T: (source(T) - DELTA * (T - ambient)) / CAPACITY,
        (0, t[-1]),
        [start],
        method="LSODA",
        t_eval=t,
        events=event,
        rtol=1e-10,
        atol=1e-10,
    )
    return SimpleNamespace(rise=found.y[0] - ambient, burnt=bool(found.t_events[0].size))


def test_figures_of_a_bias():
    """1 mW on 10 mW/K at -4 %/K: the feedback is 0.04 mW/K."""
    at_voltage, at_current, in_bridge = (
        self_heating(1e-3, 1e-2, coefficient=-0.04, bias=bias)
        for bias in (Bias.VOLTAGE, Bias.CURRENT, Bias.HALF_BRIDGE)
    )
    assert at_voltage.effective_conductance == pytest.approx(9.96e-3, rel=1e-14)
    assert at_current.effective_conductance == pytest.approx(10.04e-3, rel=1e-14)
    assert in_bridge.effective_conductance == 1e-2
    assert at_voltage.rise == pytest.approx(1 / 9.96, rel=1e-14)
    for each in (at_voltage, at_current, in_bridge):
        assert each.feedback_ratio == pytest.approx(4e-3, rel=1e-14)
    assert at_voltage.runaway_power == pytest.approx(0.25)
    assert at_current.runaway_power == in_bridge.runaway_power == math.inf
    metal = self_heating(1e-3, 1e-2, coefficient=0.004, bias=Bias.CURRENT)
    assert metal.runaway_power == pytest.approx(2.5)


@pytest.mark.parametrize("bias", Bias)
@pytest.mark.parametrize("thermometer", [OXIDE, METAL], ids=repr)
def test_the_effective_conductance_is_the_sources(thermometer, bias):
    """delta - dP/dT, with the derivative of the source's power taken numerically at the operating point."""
    at, power, h = 320.0, 3e-3, 1e-3
    source = fed(thermometer, bias, power, at)
    slope = float(source(at + h) - source(at - h)) / (2 * h)
    found = self_heating(power, 1e-3, coefficient=float(thermometer.coefficient(at)), bias=bias)
    # Rounding 1e-16 P/h, and h^2 P |alpha_R|^3 of the difference.
    assert found.effective_conductance == pytest.approx(1e-3 - slope, abs=1e-11)


def test_equal_arms_take_the_most_that_a_half_bridge_gives():
    """dP/dR = 0 there, and P falls as 1 - (dR/R)^2/4 on both sides: own heat changes it in second order only."""
    source, at = fed(OXIDE, Bias.HALF_BRIDGE, 1e-3, ROOM), ROOM
    e = 1e-3
    for R in (1e4 * (1 - e), 1e4 * (1 + e)):
        lost = 1 - float(source(OXIDE.temperature(R))) / float(source(at))
        assert lost == pytest.approx(e**2 / 4, rel=2 * e)


@pytest.mark.parametrize("bias", Bias)
@pytest.mark.parametrize("thermometer", [OXIDE, METAL, CURVE], ids=repr)
def test_a_disturbance_decays_by_the_effective_conductance(thermometer, bias):
    """Integrated about a risen operating point; half the difference of both signs has no even powers."""
    rise = 15.0
    source = fed(thermometer, bias, DELTA * rise, ROOM + rise)
    above, below = (warm(source, ROOM + rise + sign * 0.01, SPAN).rise for sign in (1, -1))
    coefficient = float(thermometer.coefficient(ROOM + rise))
    found = self_heating(DELTA * rise, DELTA, coefficient=coefficient, bias=bias)
    expected = np.exp(-found.effective_conductance / CAPACITY * SPAN)
    # The integrator's 1e-10 of 300 K in each of many steps, by 0.02 K; the third order is (0.01 K alpha_R)^2 = 1e-7.
    assert (above - below) / 0.02 == pytest.approx(expected, abs=2e-5)


FOLD = 3435 / 2 * (1 - math.sqrt(1 - 4 * ROOM / 3435))
"""The T that solves (T - T_a) B = T^2, in K: a rise of 31.7 K."""


def test_the_linear_limit_is_where_an_operating_point_stops_holding():
    """At P |alpha_R| = delta of its own T and P: 2 K before, the nonlinear equation returns; 2 K behind, it leaves."""
    at_fold = DELTA * (FOLD - ROOM) * abs(float(OXIDE.coefficient(FOLD))) / DELTA
    assert at_fold == pytest.approx(1, rel=1e-12)
    t = np.array([0.0, 60.0])  # 600 C/delta, 35 times that of delta_eff
    for T, holds in ((FOLD - 2, True), (FOLD + 2, False)):
        power = DELTA * (T - ROOM)
        source, coefficient = fed(OXIDE, Bias.VOLTAGE, power, T), float(OXIDE.coefficient(T))
        above, below = (warm(source, T + sign * 0.01, t) for sign in (1, -1))
        if holds:
            assert self_heating(power, DELTA, coefficient=coefficient, bias=Bias.VOLTAGE).effective_conductance > 0
            # The integrator's 1e-10 of 300 K, by delta/delta_eff.
            assert above.rise[-1] == pytest.approx(T - ROOM, abs=1e-6)
            assert not above.burnt
        else:
            with pytest.raises(RunawayError) as refused:
                self_heating(power, DELTA, coefficient=coefficient, bias=Bias.VOLTAGE)
            assert refused.value.limit == pytest.approx(DELTA / abs(coefficient))
            assert above.burnt
            cold = float(source(ROOM))
            first = steady_rise(OXIDE, cold, DELTA, ambient=ROOM, bias=Bias.VOLTAGE)
            assert below.rise[-1] == pytest.approx(first, abs=1e-6)
            assert first < FOLD - ROOM - 1


def test_switched_on_cold_a_thermistor_runs_away_at_two_fifths_of_the_linear_limit():
    """x^2 e^-x of delta/|alpha_R(T_a)| with x = T/T_a at the fold, 0.405: the nonlinear equation on both sides of it."""
    x = FOLD / ROOM
    linear = DELTA / abs(float(OXIDE.coefficient(ROOM)))
    limit = x**2 * math.exp(-x) * linear
    assert limit / linear == pytest.approx(0.4048, abs=5e-5)
    with pytest.raises(RunawayError, match="half-bridge") as refused:
        steady_rise(OXIDE, 1.01 * limit, DELTA, ambient=ROOM, bias=Bias.VOLTAGE)
    assert refused.value.limit == pytest.approx(limit, rel=1e-12)
    t = np.array([0.0, 20.0])  # 200 C/delta, 28 times that of delta_eff
    for factor in (0.99, 1.01):
        found = warm(fed(OXIDE, Bias.VOLTAGE, factor * limit, ROOM), ROOM, t)
        assert found.burnt == (factor > 1)
    settled = warm(fed(OXIDE, Bias.VOLTAGE, 0.99 * limit, ROOM), ROOM, t).rise[-1]
    assert settled == pytest.approx(steady_rise(OXIDE, 0.99 * limit, DELTA, ambient=ROOM, bias=Bias.VOLTAGE), abs=1e-6)
    near = steady_rise(OXIDE, (1 - 1e-10) * limit, DELTA, ambient=ROOM, bias=Bias.VOLTAGE)
    assert near == pytest.approx(FOLD - ROOM, abs=1e-2)  # sqrt(1e-10) of some 50 K: both roots meet like a parabola's
    steep = NTC(1e4, 1e7)  # 1/e of the linear limit for large B
    with pytest.raises(RunawayError) as refused:
        steady_rise(steep, 1.0, DELTA, ambient=ROOM, bias=Bias.VOLTAGE)
    assert refused.value.limit * 1e7 / ROOM**2 / DELTA == pytest.approx(math.exp(-1), rel=1e-4)


@given(st.sampled_from([OXIDE, METAL, CURVE]), st.sampled_from(Bias), st.floats(1e-6, 0.35), st.floats(250, 350))
def test_a_steady_rise_is_the_first_balance(thermometer, bias, ratio, ambient):
    power = ratio * DELTA / abs(float(thermometer.coefficient(ambient)))
    try:
        rise = steady_rise(thermometer, power, DELTA, ambient=ambient, bias=bias)
    except RunawayError as refused:  # metals at a current become too hot first
        assert isinstance(thermometer, RTD)
        assert power >= refused.limit
        return
    source = fed(thermometer, bias, power, ambient)
    assert float(source(ambient + rise)) == pytest.approx(DELTA * rise, rel=1e-9)  # 1e-13 K in 300 K, of 1e-5 K
    before = np.linspace(0, rise, 200, endpoint=False)
    assert (source(ambient + before) > DELTA * before).all()


@pytest.mark.parametrize("bias", Bias)
def test_what_hardly_changes_with_temperature_rises_by_power_over_delta(bias):
    """Where P does not change in any digit the balance is at P/delta, wherever rounding puts it."""
    flat = RTD(100, 1e-12)
    for power in np.geomspace(1e-6, 1e-3, 40):
        rise = steady_rise(flat, power, DELTA, ambient=ROOM, bias=bias)
        assert rise == pytest.approx(power / DELTA, rel=1e-11)


def test_to_first_order_it_is_the_linear_rise():
    """At the design limit an NTC at a voltage rises by 0.12 % more than P/delta_eff; half of P leaves a quarter of it."""
    coefficient = float(OXIDE.coefficient(ROOM))
    errors = []
    for ratio in (FEEDBACK_LIMIT, FEEDBACK_LIMIT / 2):
        power = ratio * DELTA / abs(coefficient)
        linear = self_heating(power, DELTA, coefficient=coefficient, bias=Bias.VOLTAGE).rise
        errors.append(1 - linear / steady_rise(OXIDE, power, DELTA, ambient=ROOM, bias=Bias.VOLTAGE))
    assert errors[0] == pytest.approx(1.2e-3, abs=5e-5)
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)  # the next order is another 5 %


def test_a_metal_at_a_current_is_linear():
    """P grows in proportion to R, and R to T: P/delta_eff is exact."""
    power = 0.2 * DELTA / 3.85e-3
    linear = self_heating(power, DELTA, coefficient=3.85e-3, bias=Bias.CURRENT).rise
    assert steady_rise(METAL, power, DELTA, ambient=ROOM, bias=Bias.CURRENT) == pytest.approx(linear, rel=1e-12)


def test_without_a_fold_it_may_become_hot_but_is_refused_beyond_twice_the_ambient_temperature():
    """B < 4 T_a: theta |alpha_R| never reaches 1, and every power has one balance."""
    weak = NTC(1e4, 1000)
    scale = DELTA / abs(float(weak.coefficient(ROOM)))
    rises = [steady_rise(weak, ratio * scale, DELTA, ambient=ROOM, bias=Bias.VOLTAGE) for ratio in (0.1, 0.3, 0.5)]
    assert np.diff(rises).min() > 0
    assert rises[-1] > ROOM / 3
    with pytest.raises(RunawayError) as refused:
        steady_rise(weak, scale, DELTA, ambient=ROOM, bias=Bias.VOLTAGE)
    edge = steady_rise(weak, refused.value.limit * (1 - 1e-12), DELTA, ambient=ROOM, bias=Bias.VOLTAGE)
    assert edge == pytest.approx(ROOM, rel=1e-9)


def test_a_runaway_is_refused_at_its_limit_and_not_below():
    for coefficient, bias in ((-0.04, Bias.VOLTAGE), (0.004, Bias.CURRENT)):
        limit = DELTA / abs(coefficient)
        for factor in (1.0, 3.0):
            with pytest.raises(RunawayError, match="runs away") as refused:
                self_heating(factor * limit, DELTA, coefficient=coefficient, bias=bias)
            assert (refused.value.power, refused.value.limit) == (factor * limit, pytest.approx(limit))
        below = self_heating(0.999 * limit, DELTA, coefficient=coefficient, bias=bias)
        assert below.effective_conductance == pytest.approx(1e-3 * DELTA, rel=1e-9)
        other = Bias.CURRENT if bias is Bias.VOLTAGE else Bias.VOLTAGE
        for stable in (other, Bias.HALF_BRIDGE):
            assert self_heating(3 * limit, DELTA, coefficient=coefficient, bias=stable).rise > 0


@pytest.mark.parametrize(
    ("make", "named"),
    [
        (lambda: self_heating(0.0, DELTA, coefficient=-0.04, bias=Bias.VOLTAGE), "power"),
        (lambda: self_heating(1e-3, -DELTA, coefficient=-0.04, bias=Bias.VOLTAGE), "dissipation constant"),
        (lambda: self_heating(1e-3, DELTA, coefficient=math.nan, bias=Bias.VOLTAGE), "temperature coefficient"),
        (lambda: steady_rise(OXIDE, 1e-3, 0.0, ambient=ROOM, bias=Bias.VOLTAGE), "dissipation constant"),
        (lambda: steady_rise(OXIDE, 1e-3, DELTA, ambient=-1.0, bias=Bias.VOLTAGE), "ambient temperature"),
    ],
)
def test_refusals_name_what_is_wrong(make, named):
    with pytest.raises(ThermalValueError, match=named):
        make()
