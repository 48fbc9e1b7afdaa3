"""What the face gave to the air, and gives no more under an object: a second step, against networks worked by hand."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmtouch.thermal import (
    Adiabatic,
    Air,
    Base,
    ContactEvent,
    Film,
    HalfSpace,
    Layer,
    Loop,
    Material,
    Stack,
    Touch,
    conductance_sensitivity,
    contact_transfer,
    effusivity_sensitivity,
    power_response,
)
from firmtouch.thermal.analysis import hold_power
from firmtouch.thermal.sensor import HeldPower, Scenario, Sensor, Temperatures, air_before

C, H, H_AIR = 20.0, 2e3, 400.0  # J/m2K and W/m2K: so much air that it counts
T = np.geomspace(1e-4, 1, 25)


def test_one_film():
    """C'' T' = P - h (T - T_o) with the power P = h_air (T_s - T_o) that held it: T_o + P/h, and not T_o, is the end."""
    touch = Touch(Base(), H, air=H_AIR)
    found = ContactEvent(Stack((Film(C),), 0, Adiabatic()), touch, -14.0).temperature(T)
    assert found == pytest.approx(-14 * (1 - H_AIR / H) * -np.expm1(-H * T / C), rel=1e-9)


def test_one_film_in_a_loop():
    """C'' T' = P + p - h (T - T_o), p = -K T: p goes to K (1 - h_air/h) h/(h + K) per kelvin."""
    touch, loop = Touch(Base(), H, air=H_AIR), Loop(gain=1e4, heater=0)
    found = power_response(Stack((Film(C),), 0, Adiabatic()), touch, loop, T)
    expected = -1e4 * (H - H_AIR) / (H + 1e4) * -np.expm1(-(H + 1e4) * T / C)
    assert found == pytest.approx(expected, rel=1e-6)


@given(
    ambient=st.floats(270, 330),
    thing=st.floats(270, 300),
    base=st.floats(290, 330),
    k=st.floats(0.02, 2),
    depth=st.floats(1e-4, 5e-3),
)
def test_both_ends_are_steady_states(ambient, thing, base, k, depth):
    """Long after the touch the heated face is where resistances put it, with the power that held it before."""
    at = Temperatures(thing, 310.0, base, ambient)
    material = Material("rubber", k, 965, 1460)
    stack = Stack((Film(1.0), Layer(material, depth)), 0, Base())
    touch = Touch(Base(), H, air_before(at))
    sensor = Sensor(stack, 0, HeldPower(), at, (Scenario("thing", "nominal", touch),), front=Air(10.0))
    power = hold_power(sensor)
    backwards = k / depth
    # P + h (T_o - T) + k/L (T_b - T) = 0
    after = (power + H * thing + backwards * base) / (H + backwards)
    late = 1e3 * depth**2 / material.alpha
    found = ContactEvent(stack, touch, at.difference).temperature(np.array([late]))
    assert found == pytest.approx([after - 310.0], abs=1e-6)


def test_heat_is_kept(m, designs):
    """What the object gives and what the air takes no more is what goes into the fingertip."""
    s = np.array([3.0 + 0j, 40 + 70j, 2e3 + 1e4j])
    touch = Touch(HalfSpace(m.pine), 1e4, air=H_AIR)
    found, pure = (contact_transfer(designs.D3, each, s) for each in (touch, replace(touch, air=0.0)))
    Z_s = pure.face / pure.flux
    assert found.face / Z_s == pytest.approx(found.flux - H_AIR, rel=1e-12)
    assert found.object_face == pytest.approx(-found.flux / (m.pine.effusivity * np.sqrt(s)), rel=1e-12)


def test_sensitivities_are_derivatives_with_it_too(m, designs):
    touch, d, t = Touch(HalfSpace(m.pine), 1e4, air=H_AIR), 1e-4, np.array([1e-3, 1e-2, 0.1])
    event = ContactEvent(designs.D3, touch, 14.0)

    def at(**changes):
        return replace(event, touch=replace(touch, **changes)).temperature(t)

    by_h = (at(conductance=1e4 * (1 + d)) - at(conductance=1e4 * (1 - d))) / (2 * d)
    more, less = (HalfSpace(replace(m.pine, conductivity=m.pine.conductivity * (1 + x) ** 2)) for x in (d, -d))
    by_e = (at(object=more) - at(object=less)) / (2 * d)
    # 14 K times d^2, and Talbot's 1e-12 over d.
    assert conductance_sensitivity(event)(t) == pytest.approx(by_h, abs=1e-6)
    assert effusivity_sensitivity(event)(t) == pytest.approx(by_e, abs=1e-6)


def test_of_a_sensor():
    assert air_before(Temperatures(295, 309, 309, 295)) == pytest.approx(10.0)  # the object is as warm as the air
    assert air_before(Temperatures(295, 309, 309, 302)) == pytest.approx(5.0)
    assert air_before(Temperatures(295, 309, 309, 309)) == 0
    assert air_before(Temperatures(309, 309, 309, 295)) == 0  # no difference to tell it by
    assert air_before(Temperatures(295, 309, 309, 302), second=True) == 10.0  # two faces differ by it, whatever the air
