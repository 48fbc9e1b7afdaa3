"""Known answers W1..W8: closed forms where there are, and figures of 30 digits elsewhere."""

import math

import numpy as np
import pytest
from scipy.special import erfcx

from firmtouch.thermal import (
    Adiabatic,
    Base,
    ConstantTemperature,
    ContactEvent,
    HalfSpace,
    Layer,
    Metric,
    OnePole,
    Pulse,
    Stack,
    Touch,
    TwoNode,
    pulse_response,
    rise_time,
)

PERFECT = math.inf
DECADES = np.array([1e-3, 1e-2, 1e-1, 1.0])


def half_space(material):
    return Stack((), sensed=0, backing=HalfSpace(material))


@pytest.mark.parametrize(
    ("own", "touched", "temperatures", "expected"),
    [
        ("skin", "copper", (33, 22), "22.337742"),
        ("skin", "pmma", (33, 22), "29.392362"),
        ("pdms", "glass", (37, 23), "26.173"),
        ("pdms", "steel", (37, 23), "23.834"),
        ("pdms", "copper", (37, 23), "23.177"),
    ],
)
def test_w1_two_half_spaces_meet_at_their_effusivities_mean(m, own, touched, temperatures, expected):
    sensor, thing = temperatures
    event = ContactEvent(half_space(getattr(m, own)), Touch(HalfSpace(getattr(m, touched)), PERFECT), thing - sensor)
    found = sensor + event.temperature(DECADES)
    e_s, e_o = getattr(m, own).effusivity, getattr(m, touched).effusivity
    closed = (e_s * sensor + e_o * thing) / (e_s + e_o)
    assert found == pytest.approx(np.full(4, closed), rel=1e-12)  # Talbot's 24 points
    assert f"{closed:.{len(expected) - 3}f}" == expected
    assert thing + event.object_face(DECADES) == pytest.approx(
        found, rel=1e-12
    )  # a perfect contact has one temperature


def test_w2_depth_under_a_held_face(m):
    stack = Stack((Layer(m.kapton, 25e-6),), sensed=1, backing=HalfSpace(m.kapton))
    found = ContactEvent(stack, Touch(Base(), PERFECT), 1.0).temperature(DECADES)
    assert found == pytest.approx([0.0446786265, 0.5255065267, 0.8408809559, 0.9493778956], abs=6e-11)


def test_w3_half_spaces_through_a_contact(m):
    event = ContactEvent(half_space(m.pdms), Touch(HalfSpace(m.glass), 5000), 23.0 - 37.0)
    face, other, flux = 37 + event.temperature(DECADES), 23 + event.object_face(DECADES), -event.flux(DECADES)
    # Half a unit of the last digit that the reference gives.
    assert face == pytest.approx([33.243774, 29.916466, 27.555924, 26.620246], abs=6e-7)
    assert other == pytest.approx([24.100746, 25.075800, 25.767546, 26.041743], abs=6e-7)
    assert flux == pytest.approx([45715.14, 24203.33, 8941.89, 2892.52], abs=6e-3)
    b = 5000 * (1 / m.pdms.effusivity + 1 / m.glass.effusivity)
    assert b == pytest.approx(13.617075, abs=6e-7)
    assert flux == pytest.approx(5000 * 14 * erfcx(b * np.sqrt(DECADES)), rel=1e-11)


def test_w4_insulated_slab(m):
    L = 100e-6
    stack = Stack((Layer(m.kapton, L),), sensed=1, backing=Adiabatic())
    Fo = np.array([0.05, 0.1, 0.2, 0.5, 1.0])
    found = ContactEvent(stack, Touch(Base(), PERFECT), 1.0).temperature(Fo * L**2 / m.kapton.alpha)
    assert found == pytest.approx([0.0031308045, 0.0506946373, 0.2276883931, 0.6292225702, 0.8920229556], abs=6e-11)


@pytest.fixture
def w5(m, designs, oracle):
    return lambda design, touched: (getattr(designs, design), HalfSpace(getattr(m, touched)), oracle)


@pytest.mark.parametrize(
    ("design", "touched", "expected"),
    [
        ("D1", "copper", [0.114976466, 0.421352019, 0.582933917, 0.888144912, 0.971894035]),
        ("D1", "glass", [0.105874414, 0.365084587, 0.495300104, 0.760773542, 0.878084861]),
        ("D1", "pine", [0.076319086, 0.221111619, 0.286839228, 0.450944544, 0.598238235]),
        ("D3", "copper", [0.491029188, 0.819110555, 0.885752555, 0.951418941, 0.982346536]),
        ("D3", "glass", [0.449545864, 0.737476677, 0.801797896, 0.871265995, 0.905274202]),
        ("D3", "pine", [0.318229334, 0.499711021, 0.551686725, 0.620647803, 0.658168401]),
    ],
)
def test_w5_full_stacks(w5, design, touched, expected):
    t = np.array([1, 5, 10, 50, 500]) * 1e-3
    stack, thing, oracle = w5(design, touched)
    found = ContactEvent(stack, Touch(thing, 1e4), 1.0).temperature(t)
    assert found == pytest.approx(expected, abs=6e-10)
    exact = [oracle(stack, thing, 1e4, each) for each in t[[0, 2, 4]]]
    assert found[[0, 2, 4]] == pytest.approx(exact, abs=5e-12)  # 24 points of Talbot in binary64


def test_w6_two_nodes():
    nodes = TwoNode(C_h=20e-6, G_a=1e-3, G_ht=20e-3, C_t=10e-6, G_c=5e-3)
    assert nodes.poles == pytest.approx([-185.778492, -3364.221508], abs=6e-7)
    assert np.array(nodes.power_transfer(0)) == pytest.approx([200, 160], rel=1e-13)
    assert np.array(nodes.object_transfer(0)) == pytest.approx([0.8, 0.84], rel=1e-13)
    assert nodes.step([5e-3])[0, 1, 0] == pytest.approx(93.107525, abs=6e-7)
    found = rise_time(lambda t: nodes.step(t)[:, 1, 0], 1.0)
    assert [1e3 * each for each in (found.start, found.end, found.seconds)] == pytest.approx(
        [0.85311, 12.70002, 11.84690], abs=6e-6
    )


def test_w7_flux_step(m):
    t = np.array([1e-3, 1e-2, 1e-1])
    heated = Pulse(power=1e4, heater=0)
    alone = pulse_response(half_space(m.pdms), Adiabatic(), heated, t)
    assert alone == pytest.approx([0.751545, 2.376594, 7.515450], abs=6e-7)
    between = pulse_response(half_space(m.pdms), Touch(HalfSpace(m.glass), PERFECT), heated, t)
    assert between == pytest.approx([0.170324, 0.538613, 1.703243], abs=6e-7)


@pytest.mark.parametrize(
    ("gain", "expected", "digit"), [(0, 87.89, 1e-2), (10, 7.990, 1e-3), (50, 1.723, 1e-3), (200, 0.437, 1e-3)]
)
def test_w8_constant_temperature(gain, expected, digit):
    loop = ConstantTemperature(C=40e-6, G=1e-3, K=gain * 1e-3)
    assert 1e3 * rise_time(loop.response, 1.0).seconds == pytest.approx(expected, abs=digit / 2)


def test_dimensionless_rise_times(m):
    """The same numbers for any size: they are what the metrics must give of the exact responses."""
    pole = OnePole(C=3e-5, G=2e-3)
    found = rise_time(pole.step, 60 * pole.time_constant)
    assert found.start / pole.time_constant == pytest.approx(0.105361, abs=6e-7)
    assert found.end / pole.time_constant == pytest.approx(2.302585, abs=6e-7)
    assert found.seconds / pole.time_constant == pytest.approx(2.197225, abs=6e-7)
    L = 50e-6
    slab = ContactEvent(Stack((Layer(m.pdms, L),), sensed=1, backing=Adiabatic()), Touch(Base(), PERFECT), 1.0)
    unit = L**2 / m.pdms.alpha
    found = rise_time(slab.temperature, 20 * unit)
    assert [found.start / unit, found.end / unit] == pytest.approx([0.1301589, 1.0311050], abs=6e-8)
    assert rise_time(slab.temperature, 20 * unit, Metric.SIXTY_THREE).seconds / unit == pytest.approx(
        0.5031806, abs=6e-8
    )
