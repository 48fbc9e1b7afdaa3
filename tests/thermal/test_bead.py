"""Heat in a sphere, and through a slab after a flash."""

import numpy as np
import pytest
from scipy.optimize import brentq

from firmtouch.thermal import Adiabatic, Layer, Material, Stack, heater_transfer, rise_time, step, talbot
from firmtouch.thermal.bead import diffusion_floor, sphere_transfer

OXIDE = Material("NTC oxide", 2.5, 5000, 750)


@pytest.mark.parametrize(("part", "crossings"), [("centre", (0.0661098, 0.3035185)), ("mean", (0.0009216, 0.1829854))])
def test_sphere_with_a_stepped_surface(part, crossings):
    a = 0.14e-3
    unit = a**2 / OXIDE.alpha
    found = rise_time(lambda t: step(lambda s: getattr(sphere_transfer(OXIDE, a, s), part), t), 5 * unit)
    assert (found.start / unit, found.end / unit) == pytest.approx(crossings, abs=6e-8)
    if part == "mean":
        assert diffusion_floor(OXIDE, a) == pytest.approx(found.seconds, rel=1e-6)
        assert 1e3 * found.seconds == pytest.approx(5.4, abs=0.1)


def test_sphere_at_any_s():
    """The series and the closed form meet; nothing overflows; at rest all is the surface's."""
    a = 1e-4
    unit = OXIDE.alpha / a**2
    below, above = (sphere_transfer(OXIDE, a, unit * (each * 0.1) ** 2 * 1j) for each in (1 - 1e-13, 1 + 1e-13))
    assert np.array(below) == pytest.approx(np.array(above), abs=1e-13)  # 3 (x coth x - 1)/x^2 loses 2 of 16 digits
    with np.errstate(all="raise", under="ignore"):
        assert np.array(sphere_transfer(OXIDE, a, [0.0, 1e300, 1e300j])) == pytest.approx(
            np.array([[1, 0, 0], [1, 0, 0]]), abs=1e-100
        )


def test_parker_flash(m):
    """The far face of an insulated slab has half of its final rise at 0.1387853 L^2/alpha after a flash on the near."""
    L = 0.3e-3
    stack, unit = Stack((Layer(m.pmma, L),), sensed=1, backing=Adiabatic()), L**2 / m.pmma.alpha
    final = 1 / (m.pmma.volumetric_capacity * L)

    def rise(t):
        return talbot(lambda s: heater_transfer(stack, Adiabatic(), s, heater=0), np.array([t]))[0] / final

    assert brentq(lambda t: rise(t) - 0.5, 0.05 * unit, unit, xtol=1e-12 * unit) / unit == pytest.approx(
        0.1387853, abs=6e-8
    )
    assert rise(20 * unit) == pytest.approx(1, abs=1e-10)
