"""Pads of finite size, contacts from pressure and roughness, and events that are not one step."""

import math

import numpy as np
import pytest

from firmtouch.thermal import (
    Adiabatic,
    ContactEvent,
    Disc,
    HalfSpace,
    Pulse,
    Roughness,
    Stack,
    ThermalValueError,
    Touch,
    contact_conductance,
    diffusion_length,
    disc_admittance,
    disc_centre_rise,
    disc_heat_flow,
    fin_crosstalk,
    fin_length,
    heater_transfer,
    object_crosstalk,
    object_impedance,
    object_temperature,
    point_source_rise,
    pulse_response,
    spreading_ratio,
    talbot,
    two_temperatures,
)
from firmtouch.thermal.pad import shoup_szabo

RADIUS = 0.5e-3


def test_disc_against_shoup_and_szabo():
    """The sum of both limits is at most 6.8 % too much between them, and right at either end."""
    tau = np.logspace(-6, 8, 400)
    sum_of_limits = math.sqrt(math.pi) / 2 / np.sqrt(tau) + 1
    excess = sum_of_limits / shoup_szabo(tau) - 1
    assert 0.067 < excess.max() < 0.068 + 5e-4
    assert excess.min() > -1e-3  # their own fit's error
    assert np.abs(excess[[0, -1]]).max() < 1e-3


def test_one_dimension_is_wrong_for_metals(m):
    assert spreading_ratio(m.copper, RADIUS, 10e-3) == pytest.approx(5.7, abs=0.05)
    assert spreading_ratio(m.pine, RADIUS, 10e-3) == pytest.approx(1.15, abs=0.005)


def test_disc_is_the_same_in_both_domains_and_as_an_object(m):
    t = np.array([1e-4, 1e-2, 1.0])
    flow = talbot(lambda s: disc_admittance(m.glass, RADIUS, s) / s, t)
    assert flow == pytest.approx(disc_heat_flow(m.glass, RADIUS, t), rel=1e-10)
    s = 1j * np.logspace(-2, 5, 8)
    expected = m.glass.effusivity * np.sqrt(s) + 4 * m.glass.conductivity / (math.pi * RADIUS)
    assert 1 / object_impedance(Disc(m.glass, RADIUS), s) == pytest.approx(expected, rel=1e-13)
    assert object_impedance(Disc(m.glass, 1e3), s[4:]) == pytest.approx(
        object_impedance(HalfSpace(m.glass), s[4:]), rel=1e-5
    )


@pytest.mark.parametrize(("t", "expected"), [(10e-3, 0.027), (0.1, 0.089), (1.0, 0.11)])
def test_crosstalk_goes_through_the_object(m, t, expected):
    assert object_crosstalk(m.copper, RADIUS, 2e-3, t) == pytest.approx(expected, abs=5e-3 if t == 1 else 6e-4)


def test_centre_of_an_evenly_heated_disc(m):
    """Short: the flux on a half-space, 2 q sqrt(t/pi)/e; long: q a/k. Its integral of erfc against quadrature between."""
    from scipy.integrate import quad
    from scipy.special import erfc

    area, k = math.pi * RADIUS**2, m.glass.conductivity
    assert disc_centre_rise(m.glass, RADIUS, 1e-5) * area == pytest.approx(
        2 * math.sqrt(1e-5 / math.pi) / m.glass.effusivity, rel=1e-12
    )
    assert disc_centre_rise(m.glass, RADIUS, 1e9) * area == pytest.approx(RADIUS / k, rel=1e-4)
    t = RADIUS**2 / m.glass.alpha / 3
    depth = math.sqrt(m.glass.alpha * t)
    ierfc = quad(erfc, RADIUS / (2 * depth), 12, epsabs=1e-14)[0]
    assert disc_centre_rise(m.glass, RADIUS, t) * area == pytest.approx(
        2 * depth / k * (1 / math.sqrt(math.pi) - ierfc), rel=1e-12
    )


def test_point_source_is_a_small_disc_far_away(m):
    """Superposed over its area, point sources give the disc's centre: the integral of 2 pi r dr."""
    from scipy.integrate import quad

    t = RADIUS**2 / m.glass.alpha
    found = quad(lambda r: 2 * math.pi * r * float(point_source_rise(m.glass, r, t)), 0, RADIUS)[0]
    assert found / (math.pi * RADIUS**2) == pytest.approx(float(disc_centre_rise(m.glass, RADIUS, t)), rel=1e-8)


def test_substrates_hardly_conduct(m):
    assert diffusion_length(m.kapton, 10e-3) == pytest.approx(56e-6, abs=0.5e-6)
    loss = m.foam.conductivity / 1e-3 + 50  # some 100 W/m2K
    assert fin_length(m.kapton, 7e-6, loss) == pytest.approx(0.09e-3, abs=0.005e-3)
    assert fin_crosstalk(m.kapton, 7e-6, loss, 1e-3) < 1e-4


def test_overlapping_pads_are_refused(m):
    with pytest.raises(ThermalValueError, match=r"pitch is 0\.0009, but must be at least the pads' diameter"):
        object_crosstalk(m.copper, RADIUS, 0.9e-3, 0.01)


@pytest.mark.parametrize(("sigma", "gas"), [(1e-6, 6700), (0.3e-6, 18000), (10e-6, 730)])
def test_the_air_gap_rules_hard_contacts(m, sigma, gas):
    k = m.kapton.conductivity, m.aluminium.conductivity
    found = contact_conductance(50e3, Roughness(sigma, 0.15, 0.25e9), *k)
    assert found.gas == pytest.approx(gas, rel=0.03)  # one or two digits recorded
    assert found.total == found.spots + found.gas
    if sigma == 1e-6:
        assert found.spots == pytest.approx(14, abs=0.5)


def test_contacts_grow_with_pressure_as_their_exponents_say(m):
    rough = Roughness(1e-6, 0.15, 0.25e9)
    found = [contact_conductance(p, rough, 0.12, 237) for p in (1e4, 1e5)]
    assert found[1].spots / found[0].spots == pytest.approx(10**0.95, rel=1e-12)
    gaps = [rough.gas_conductivity / each.gas - rough.gas_jump for each in found]
    assert gaps[1] / gaps[0] == pytest.approx(10**-0.097, rel=1e-12)
    with pytest.raises(ThermalValueError, match=r"below a tenth of the hardness, 2\.5e\+07 Pa"):
        contact_conductance(3e7, rough, 0.12, 237)


def test_a_pulse_is_two_steps_and_decays(m):
    stack, touch = Stack((), 0, HalfSpace(m.pdms)), Touch(HalfSpace(m.glass), math.inf)
    e, t = m.pdms.effusivity + m.glass.effusivity, np.array([5e-3, 20e-3, 1.0])
    found = pulse_response(stack, touch, Pulse(1e4, heater=0, duration=10e-3), t)
    expected = 2e4 / e / math.sqrt(math.pi) * (np.sqrt(t) - np.sqrt(np.maximum(0, t - 10e-3)))
    assert found == pytest.approx(expected, rel=1e-9)
    with pytest.raises(ThermalValueError, match="pulse duration"):
        Pulse(1.0, 0, duration=0.0)


def test_a_pulse_tells_effusivities_without_a_temperature_difference(m, designs):
    """The better the object conducts, the less a film warms."""
    pulse, t = Pulse(1e3, heater=1), np.array([20e-3])
    rises = [
        pulse_response(designs.D3, front, pulse, t)[0]
        for front in (Adiabatic(), *(Touch(HalfSpace(each), 1e4) for each in (m.pine, m.glass, m.copper)))
    ]
    assert (np.diff(rises) < 0).all()


def test_two_temperatures_cure_the_ambiguity(m, designs):
    t, touch = np.array([1e-3, 1e-2, 0.1]), Touch(HalfSpace(m.glass), 1e4)
    both = [
        two_temperatures(designs.D3, touch, t, faces=(37.0, 30.0), object_temperature=each) for each in (23.0, 29.0)
    ]
    # One sensor sees 14 K on glass as it would see something else at another temperature; the difference does not care.
    assert both[0].difference == pytest.approx(both[1].difference, abs=1e-12)
    assert both[0].difference == pytest.approx(-7 * ContactEvent(designs.D3, touch, 1.0).temperature(t), abs=1e-12)
    assert object_temperature((37.0, 30.0), both[1][:2]) == pytest.approx(np.full(3, 29.0), rel=1e-11)
    with pytest.raises(ThermalValueError, match="second face"):
        two_temperatures(designs.D3, touch, t, faces=(37.0, 37.0), object_temperature=23.0)


def test_an_unheated_stack_and_its_event_are_linear(m, designs):
    touch, t = Touch(HalfSpace(m.steel), 3e3), np.array([1e-3, 1e-1])
    one, many = (ContactEvent(designs.D1, touch, dT) for dT in (1.0, -14.0))
    for of in ("temperature", "flux", "object_face"):
        assert getattr(many, of)(t) == pytest.approx(-14 * getattr(one, of)(t), rel=1e-14)
    assert heater_transfer(designs.D1, touch, 1.0).shape == ()
