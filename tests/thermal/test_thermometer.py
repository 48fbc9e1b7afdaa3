"""Resistance over temperature and back: tabled values, inverses, derivatives, and where a curve has no answer."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from firmtouch.thermal import NTC, RTD, SteinhartHart, ThermalValueError

T = np.linspace(233.15, 398.15, 34)
TEN_K = SteinhartHart(1.009249522e-3, 2.378405444e-4, 2.019202697e-7)
THERMOMETERS = [NTC(1e4, 3435), TEN_K, SteinhartHart(1.13e-3, 2.34e-4, -5e-8), RTD(100, 3.85e-3, at=273.15)]

oxides = st.builds(NTC, st.floats(1, 7).map(lambda x: 10**x), st.floats(1500, 6000), st.floats(250, 400))
metals = st.builds(RTD, st.floats(0, 4).map(lambda x: 10**x), st.floats(1e-3, 4e-3), st.floats(250, 320))
curves = st.builds(SteinhartHart, st.floats(2e-4, 2.2e-3), st.floats(5e-5, 4e-4), st.floats(0, 1e-6))
temperatures = st.floats(220, 420)


def test_a_10k_thermistor():
    ntc = NTC(1e4, 3435)
    assert ntc.coefficient(298.15) == pytest.approx(-3.86e-2, abs=5e-5)
    assert ntc.coefficient(310.15) == pytest.approx(-3.57e-2, abs=5e-5)
    assert ntc.resistance(310.15) / 1e4 == pytest.approx(0.6403, abs=5e-5)
    assert ntc.resistance(298.15) == pytest.approx(1e4, rel=1e-14)


def test_a_pt100_has_less_than_its_coefficient_above_freezing():
    """100 ohm and 0.385 %/K are those at 0 degrees: at 25 it is 0.00385 / 1.09625, at 100 it has 138.5 ohm."""
    pt100 = RTD(100, 3.85e-3, at=273.15)
    assert pt100.coefficient([273.15, 298.15]) == pytest.approx([3.85e-3, 3.85e-3 / 1.09625], rel=1e-14)
    assert pt100.resistance(373.15) == pytest.approx(138.5, rel=1e-14)


@given(st.one_of(oxides, metals, curves), temperatures)
def test_a_temperature_is_read_back(thermometer, at):
    R = thermometer.resistance(at)
    # A rounding of ln R, up to 40, moves T by T/|alpha_R T| < 2 of it for oxides, by 3 T/alpha for metals.
    assert thermometer.temperature(R) == pytest.approx(at, rel=2e-14)


@pytest.mark.parametrize("thermometer", THERMOMETERS, ids=repr)
def test_the_coefficient_is_the_derivative_of_ln_r(thermometer):
    h = 1e-5 * T
    slope = (np.log(thermometer.resistance(T + h)) - np.log(thermometer.resistance(T - h))) / (2 * h)
    # Some h^2/T^2 = 1e-10 of a central difference, and 1e-15 of ln R over 2 h alpha_R > 2e-5.
    assert thermometer.coefficient(T) == pytest.approx(slope, rel=1e-9)
    assert (np.sign(slope) == (1 if isinstance(thermometer, RTD) else -1)).all()


@given(st.floats(2e-4, 2.2e-3), st.floats(5e-5, 4e-4), st.floats(-2e-8, 1e-6), temperatures)
def test_the_closed_form_solves_the_forward_formula(a, b, c, at):
    """Also for c < 0, where it is refused or right."""
    curve = SteinhartHart(a, b, c)
    try:
        x = math.log(curve.resistance(at))
    except ThermalValueError:
        assert c < 0
        assert 1.5 * math.sqrt(3 * -c / b) * abs(1 / at - a) / b > 1 - 1e-12
        return
    assert a + b * x + c * x**3 == pytest.approx(1 / at, abs=1e-14 * (a + b * abs(x) + abs(c * x**3)))
    assert b + 3 * c * x**2 > 0


def test_the_closed_form_is_cardanos():
    """As it is mostly written: R = exp(cbrt(y - x/2) - cbrt(y + x/2)), y = sqrt((b/3c)^3 + x^2/4)."""
    x = (TEN_K.a - 1 / T) / TEN_K.c
    y = np.sqrt((TEN_K.b / (3 * TEN_K.c)) ** 3 + x**2 / 4)
    # Two cube roots of 15 to 27, whose rounding is that formula's own, and R's by the exponential.
    assert TEN_K.resistance(T) == pytest.approx(np.exp(np.cbrt(y - x / 2) - np.cbrt(y + x / 2)), rel=1e-13)


@pytest.mark.parametrize("c", [0.0, 1e-300, 1e-20, -1e-20])
def test_without_its_third_coefficient_it_is_an_ntc(c):
    ntc = NTC(1e4, 3435)
    curve = SteinhartHart(1 / 298.15 - math.log(1e4) / 3435, 1 / 3435, c)
    assert curve.resistance(T) == pytest.approx(ntc.resistance(T), rel=1e-11)  # 3 c ln^2 R / b = 1e-14, times B/T
    assert curve.coefficient(T) == pytest.approx(ntc.coefficient(T), rel=1e-12)


def test_through_three_points_of_a_calculator():
    """25, 10 and 4 kohm at 5, 25 and 45 degrees: what a maker of laboratory instruments publishes as its example."""
    found = SteinhartHart.through(((278.15, 25e3), (298.15, 10e3), (318.15, 4e3)))
    assert found.a == pytest.approx(2.108508173e-3, abs=5e-13)
    assert found.b == pytest.approx(0.7979204727e-4, abs=5e-15)
    assert found.c == pytest.approx(6.535076315e-7, abs=5e-17)


@given(curves, st.permutations([258.15, 298.15, 353.15]))
def test_through_its_own_points_a_curve_comes_back(curve, at):
    """At the points, and between and beside them; the order of the points is of no matter."""
    R = curve.resistance(at)
    assume(abs(np.log(R).sum()) > 1)
    found = SteinhartHart.through(tuple(zip(at, R, strict=True)))
    others = curve.resistance([240.0, 275.0, 330.0, 370.0])
    for each in (R, others):
        # Second differences of 1/T from its rounding: 1e-16 by the distance's square, some 10 times.
        assert found.temperature(each) == pytest.approx(curve.temperature(each), rel=1e-13)


def test_arrays_keep_their_shape():
    grid = np.linspace(250, 350, 6).reshape(2, 3)
    for thermometer in THERMOMETERS:
        assert thermometer.resistance(grid).shape == thermometer.coefficient(grid).shape == (2, 3)
        assert thermometer.temperature(thermometer.resistance(grid)) == pytest.approx(grid, rel=1e-13)
        assert float(thermometer.resistance(300)) == thermometer.resistance([300])[0]


@pytest.mark.parametrize("thermometer", THERMOMETERS, ids=repr)
@pytest.mark.parametrize("of", ["resistance", "temperature", "coefficient"])
@pytest.mark.parametrize("wrong", [0.0, -1.0, math.nan, math.inf])
def test_what_is_not_positive_is_refused_by_its_value(thermometer, of, wrong):
    name = "resistance" if of == "temperature" else "temperature"
    with pytest.raises(ThermalValueError, match=f"{name} is {wrong:g}") as refused:
        getattr(thermometer, of)([300.0, wrong])
    assert refused.value.value == pytest.approx(wrong, nan_ok=True)


@pytest.mark.parametrize(
    ("make", "named"),
    [
        (lambda: NTC(0.0, 3435), "R25"),
        (lambda: NTC(1e4, -1.0), "B"),
        (lambda: NTC(1e4, 3435, at=0.0), "reference temperature"),
        (lambda: RTD(100, 0.0), "alpha"),
        (lambda: RTD(math.nan, 3.85e-3), "R0"),
        (lambda: SteinhartHart(1e-3, 0.0, 1e-7), "b"),
        (lambda: SteinhartHart(1e-3, -1e-5, 1e-6), "b"),
        (lambda: SteinhartHart(math.inf, 2e-4, 1e-7), "a"),
        (lambda: SteinhartHart(1e-3, 2e-4, math.nan), "c"),
        (lambda: SteinhartHart.through(((278.15, 1e4), (298.15, 1e4), (318.15, 4e3))), "resistance"),
        (lambda: SteinhartHart.through(((278.15, 1e4), (298.15, 5e3), (0.0, 4e3))), "temperature"),
        (lambda: SteinhartHart.through(((278.15, 2.0), (298.15, 1.0), (318.15, 0.5))), "sum of ln R"),
        (lambda: SteinhartHart.through(((278.15, 4e3), (298.15, 1e4), (318.15, 25e3))), "b"),  # it rises
        (lambda: NTC(1e4, 3435).resistance(1.0), "temperature"),  # e^3400
        (lambda: NTC(1e4, 3435).temperature(0.09), "resistance"),  # 0.0993 at infinity
        (lambda: TEN_K.temperature(1e-6), "resistance"),  # 1/T < 0
        (lambda: RTD(100, 3.85e-3, at=273.15).resistance(13.0), "temperature"),  # zero at 13.4 K
        (lambda: RTD(100, 3.0e-3, at=273.15).temperature(10.0), "resistance"),  # at -26.9 K
    ],
)
def test_refusals_name_what_is_wrong(make, named):
    with pytest.raises(ThermalValueError) as refused:
        make()
    assert refused.value.name == named


def test_a_curve_that_turns_is_refused_where_it_does_not_fall():
    """With c < 0 the greatest 1/T is a + (2/3) b ln R at |ln R| = sqrt(b/(3|c|)): colder, it has no answer."""
    curve = SteinhartHart(1e-3, 2e-4, -2e-7)
    top = math.sqrt(2e-4 / 6e-7)
    coldest = 1 / (1e-3 + 2 / 3 * 2e-4 * top)
    assert curve.resistance(coldest + 1e-3) < math.exp(top)
    assert math.log(curve.resistance(coldest + 1e-6)) == pytest.approx(top, rel=1e-3)  # it arrives like a square root
    for ask in (
        lambda: curve.resistance([300.0, coldest - 1e-3]),
        lambda: curve.coefficient(coldest - 1e-3),
        lambda: curve.temperature(math.exp(1.001 * top)),
    ):
        with pytest.raises(ThermalValueError, match="falls"):
            ask()
    with pytest.raises(ThermalValueError, match="falls"):
        SteinhartHart.through(tuple((1 / (1e-3 + 2e-4 * x - 2e-7 * x**3), math.exp(x)) for x in (5.0, 10.0, 20.0)))
