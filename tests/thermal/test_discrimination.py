"""What makes two objects distinct, and how well an effusivity is known: the worked design, and linear algebra."""

import math
from dataclasses import replace

import numpy as np
import pytest

from firmtouch.thermal import (
    Base,
    ContactEvent,
    HalfSpace,
    Material,
    Nuisance,
    Sampling,
    ThermalValueError,
    Touch,
    conductance_sensitivity,
    discriminability,
    effusivity_sensitivity,
    effusivity_spread,
    time_to_discriminate,
)

WINDOW, SAMPLING = 0.5, Sampling(noise=20e-3, rate=1e3)


@pytest.fixture
def event(m, designs):
    return lambda name: ContactEvent(designs.D3, Touch(HalfSpace(getattr(m, name)), 1e4), 14.0)


@pytest.fixture
def felt(event):
    return lambda name: event(name).temperature


@pytest.mark.parametrize(
    ("pair", "expected"),
    [
        (("copper", "aluminium"), 4.7),
        (("aluminium", "steel"), 29),
        (("steel", "glass"), 137),
        (("glass", "pmma"), 247),
        (("pmma", "pine"), 255),
    ],
)
def test_the_worked_design(felt, pair, expected):
    assert discriminability(*map(felt, pair), 10e-3, SAMPLING) == pytest.approx(
        expected, rel=0.02
    )  # two digits recorded


@pytest.mark.parametrize(
    ("name", "known", "prior"),
    [("copper", 0.116, 0.252), ("steel", 0.024, 0.053), ("glass", 0.0062, 0.014), ("pine", 0.0024, 0.0055)],
)
def test_effusivity_of_the_worked_design(event, name, known, prior):
    """Two digits recorded; metals are the hard end, and not to know the contact costs a factor of two."""
    assert effusivity_spread(event(name), 10e-3, SAMPLING) == pytest.approx(known, rel=0.025)
    found = effusivity_spread(event(name), 10e-3, SAMPLING, conductance_spread=0.3)
    assert found == pytest.approx(prior, rel=0.025)


def test_sensitivities_are_derivatives(m, event):
    t, here, d = np.array([1e-3, 1e-2, 0.1]), event("steel"), 1e-4
    k, rho, c = m.steel.conductivity, m.steel.density, m.steel.heat_capacity

    def central(changed):
        return (changed(d).temperature(t) - changed(-d).temperature(t)) / (2 * d)

    def other_material(x):
        return replace(
            here, touch=replace(here.touch, object=HalfSpace(Material("other", k * math.exp(2 * x), rho, c)))
        )

    def other_contact(x):
        return replace(here, touch=replace(here.touch, conductance=1e4 * math.exp(x)))

    # 14 K times d^2 of a central difference, and Talbot's 1e-12 over d.
    assert effusivity_sensitivity(here)(t) == pytest.approx(central(other_material), abs=1e-6)
    assert conductance_sensitivity(here)(t) == pytest.approx(central(other_contact), abs=1e-6)


def test_a_nuisance_is_a_covariance(rng):
    """Against the inverse of noise^2 I + spread^2 g g^T, written out."""
    D, g = rng.normal(size=(2, 12))
    sampling, at = Sampling(noise=0.3, rate=10.0), lambda values: lambda t: values[: t.size]
    for n in (1, 5, 12):
        covariance = 0.09 * np.eye(n) + 0.49 * np.outer(g[:n], g[:n])
        expected = math.sqrt(D[:n] @ np.linalg.solve(covariance, D[:n]))
        found = discriminability(at(D), np.zeros_like, n / 10, sampling, nuisances=[Nuisance(at(g), 0.7)])
        assert found == pytest.approx(expected, rel=1e-12)


def test_time_to_discriminate_is_the_first_sample_that_suffices(felt):
    pair = felt("copper"), felt("aluminium")
    found = time_to_discriminate(*pair, WINDOW, SAMPLING)
    assert discriminability(*pair, found, SAMPLING) >= 5 > discriminability(*pair, found - 1e-3, SAMPLING)
    assert time_to_discriminate(felt("copper"), felt("copper"), WINDOW, SAMPLING) == math.inf
    assert time_to_discriminate(*pair, 5e-4, SAMPLING) == math.inf  # before the first sample
    assert discriminability(*pair, 5e-4, SAMPLING) == 0


def test_a_constant_difference():
    """d' of a difference D in n samples is D sqrt(n) / sigma."""
    sampling = Sampling(noise=0.5, rate=100)
    assert discriminability(np.ones_like, np.zeros_like, 0.25, sampling) == pytest.approx(2 * 5, rel=1e-14)
    assert time_to_discriminate(np.ones_like, np.zeros_like, 1.0, sampling) == pytest.approx(0.07)  # n = 6.25


def test_refusals(designs):
    with pytest.raises(ThermalValueError, match="half-space"):
        effusivity_sensitivity(ContactEvent(designs.D3, Touch(Base(), 1e4), 14.0))
    with pytest.raises(ThermalValueError, match="noise is 0"):
        Sampling(noise=0.0, rate=1e3)
    with pytest.raises(ThermalValueError, match="spread"):
        Nuisance(np.ones_like, -0.1)
