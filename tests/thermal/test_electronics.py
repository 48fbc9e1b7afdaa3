"""What reading costs: the noise of the worked examples, and each source of it from another side."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmtouch.thermal import (
    NTC,
    RTD,
    Bridge,
    Reading,
    SteinhartHart,
    ThermalValueError,
    noise,
    thermodynamic_floor,
)

ROOM = 298.15
OXIDE, METAL = NTC(1e4, 3435), RTD(100, 3.85e-3)
CURVE = SteinhartHart(1.009249522e-3, 2.378405444e-4, 2.019202697e-7)
K_B = 1.380649e-23


def test_the_worked_thermistor():
    """10 kohm at 25 degrees, 1 V, 10 nV/sqrt(Hz), 500 Hz, 16 bits of 2.5 V; digits as recorded."""
    bridge, reading = Bridge(OXIDE, 1.0), Reading(10e-9, 500, adc_bits=16, adc_range=2.5)
    found = noise(bridge, reading, ROOM).netd
    assert 1e3 * found.johnson == pytest.approx(0.021, abs=5e-4)
    assert 1e3 * found.amplifier == pytest.approx(0.023, abs=5e-4)
    assert 1e3 * found.quantisation == pytest.approx(1.14, abs=5e-3)
    assert bridge.power(ROOM) == pytest.approx(25e-6, rel=1e-14)
    assert bridge.source_resistance(ROOM) == pytest.approx(5e3, rel=1e-14)


def test_the_worked_platinum():
    """100 ohm and 0.385 %/K, both at 25 degrees, 0.2 V: amplification is what its converter needs."""
    bridge = Bridge(METAL, 0.2)
    plain, amplified = (
        noise(bridge, Reading(10e-9, 500, gain=gain, adc_bits=16, adc_range=2.5), ROOM).netd for gain in (1.0, 100.0)
    )
    assert 1e3 * plain.johnson == pytest.approx(0.105, abs=5e-4)
    assert 1e3 * plain.amplifier == pytest.approx(1.16, abs=5e-3)
    assert 1e3 * plain.quantisation == pytest.approx(57, abs=0.5)
    assert 1e3 * amplified.quantisation == pytest.approx(0.57, abs=5e-3)
    assert amplified.johnson == plain.johnson


def test_a_platinum_told_at_freezing_reads_worse_at_25_degrees():
    """Its 0.385 %/K is at 0 degrees; at 25 it has 109.6 ohm and 0.351 %/K, and every figure grows by 5-10 %."""
    reading = Reading(10e-9, 500, adc_bits=16, adc_range=2.5)
    found = noise(Bridge(RTD(100, 3.85e-3, at=273.15), 0.2), reading, ROOM).netd
    expected = (0.1210, 1.273, 62.71)  # written out: v_n / (0.2 * 3.512e-3 / 4)
    assert 1e3 * np.array([found.johnson, found.amplifier, found.quantisation]) == pytest.approx(expected, rel=5e-4)


readings = st.tuples(st.floats(0, 1e-7), st.floats(1, 1e5), st.floats(1, 1e3), st.integers(4, 24))


@given(st.floats(1, 6).map(lambda x: 10**x), st.floats(0.05, 5), readings)
def test_noise_adds_by_squares(R25, V, reading):
    at, (e_n, B, gain, bits) = 310.15, reading
    found = noise(Bridge(NTC(R25, 3435), V), Reading(*reading, adc_range=2.5), at)
    R = R25 * math.exp(3435 * (1 / at - 1 / ROOM))
    squared = 4 * K_B * at * R / 2 * B + e_n**2 * B + (2.5 / 2**bits / gain) ** 2 / 12
    assert found.voltage.total == pytest.approx(math.sqrt(squared), rel=1e-12)
    assert found.netd.total == pytest.approx(4 * math.sqrt(squared) / (V * 3435 / at**2), rel=1e-12)


def test_johnsons_noise_is_the_energy_of_a_capacitor():
    """Of a source R/2 on a capacity C the noise bandwidth is 1/(4 (R/2) C), and v^2 = k_B T/C whatever R is."""
    for bridge in (Bridge(OXIDE, 1.0), Bridge(METAL, 0.2)):
        bandwidth = 1 / (4 * bridge.source_resistance(ROOM) * 1e-9)
        found = noise(bridge, Reading(0.0, float(bandwidth)), ROOM).voltage
        assert found.johnson == pytest.approx(math.sqrt(K_B * ROOM / 1e-9), rel=1e-13)
        assert (found.amplifier, found.quantisation) == (0.0, 0.0)
        assert found.total == found.johnson


def test_quantisation_is_what_rounding_does():
    reading = Reading(0.0, 500, gain=8.0, adc_bits=6, adc_range=2.0)
    volts = np.linspace(0, 0.2, 100_001)
    step = 2.0 / 64
    read = step * np.round(8.0 * volts / step) / 8.0
    # 51.2 steps are passed; the part of the last is a hundredth of the sum.
    assert noise(Bridge(OXIDE, 1.0), reading, ROOM).voltage.quantisation == pytest.approx(
        np.std(read - volts), rel=0.01
    )


@pytest.mark.parametrize("thermometer", [OXIDE, METAL, CURVE], ids=repr)
def test_sensitivity_is_that_of_the_divider(thermometer):
    """Numerically, with the other arm held at R(T)."""
    bridge, at, h = Bridge(thermometer, 0.7), 305.0, 1e-3
    held = float(thermometer.resistance(at))
    out = [0.7 * float(R) / (float(R) + held) for R in thermometer.resistance([at - h, at + h])]
    assert bridge.sensitivity(at) == pytest.approx(abs(out[1] - out[0]) / (2 * h), rel=1e-8)  # 1e-16 over alpha_R h
    assert bridge.power(at) == pytest.approx(0.35**2 / held, rel=1e-14)
    assert bridge.sensitivity([at, 310.0]).shape == (2,)


def test_the_floor_of_a_microjoule_per_kelvin():
    assert 1e6 * thermodynamic_floor(ROOM, 1e-6) == pytest.approx(1.1, abs=0.05)
    # From the other side: power noise 4 k_B T^2 G in the bandwidth G/(4C) of that capacity, by G; whatever G is.
    G, C = 3e-4, 2e-5
    assert thermodynamic_floor(310, C) == pytest.approx(math.sqrt(4 * K_B * 310**2 * G * G / (4 * C)) / G)


@pytest.mark.parametrize(
    ("make", "named"),
    [
        (lambda: Bridge(OXIDE, 0.0), "bridge voltage"),
        (lambda: Reading(-1e-9, 500), "amplifier noise"),
        (lambda: Reading(math.nan, 500), "amplifier noise"),
        (lambda: Reading(1e-8, 0.0), "bandwidth"),
        (lambda: Reading(1e-8, 500, gain=0.0), "gain"),
        (lambda: Reading(1e-8, 500, adc_bits=16), "bits and range"),
        (lambda: Reading(1e-8, 500, adc_range=2.5), "bits and range"),
        (lambda: Reading(1e-8, 500, adc_bits=0, adc_range=2.5), "adc bits"),
        (lambda: Reading(1e-8, 500, adc_bits=16, adc_range=-2.5), "adc range"),
        (lambda: noise(Bridge(OXIDE, 1.0), Reading(1e-8, 500), 0.0), "temperature"),
        (lambda: thermodynamic_floor(0.0, 1e-6), "temperature"),
        (lambda: thermodynamic_floor(ROOM, 0.0), "C"),
    ],
)
def test_refusals_name_what_is_wrong(make, named):
    with pytest.raises(ThermalValueError, match=named):
        make()
