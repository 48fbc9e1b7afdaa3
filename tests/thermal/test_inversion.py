"""Both inversions against closed forms and mpmath: what each is good for, and that it refuses the rest."""

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import erfc, erfcx

from firmtouch.thermal import Inversion, InversionError, ThermalValueError, euler, invert, step, talbot

T = np.logspace(-5, 0, 26)
PAIRS = [
    (lambda s: 1 / (s + 30), lambda t: np.exp(-30 * t)),
    (lambda s: np.exp(-0.1 * np.sqrt(s)) / s, lambda t: erfc(0.05 / np.sqrt(t))),
    (lambda s: 1 / (np.sqrt(s) * (np.sqrt(s) + 14)), lambda t: erfcx(14 * np.sqrt(t))),
    (lambda s: s**-1.5, lambda t: 2 * np.sqrt(t / np.pi)),
]


@pytest.mark.parametrize(("F", "f"), PAIRS)
@pytest.mark.parametrize(("method", "digits"), [(talbot, 2e-12), (euler, 2e-10)])
def test_known_pairs_over_five_decades(F, f, method, digits):
    """Rounding of 1e-16 grows by e^{0.4 N} = 1.5e4 in Talbot's sum and by 10^{M/3} = 2e5 in Euler's."""
    assert method(F, T) == pytest.approx(f(T), abs=digits)


def test_talbot_against_mpmath():
    """1/cosh has no elementary inverse; the oracle works with as many digits as it needs."""
    t = np.array([0.03, 0.3, 3.0])
    exact = [float(mpmath.invertlaplace(lambda s: 1 / (s * mpmath.cosh(mpmath.sqrt(s))), each)) for each in t]
    assert step(lambda s: 1 / np.cosh(np.sqrt(s)), t) == pytest.approx(exact, abs=1e-12)


def resonance(omega, zeta):
    def F(s):
        return omega**2 / (s * (s**2 + 2 * zeta * omega * s + omega**2))

    def f(t):
        damped = omega * np.sqrt(1 - zeta**2)
        return 1 - np.exp(-zeta * omega * t) * (np.cos(damped * t) + zeta * omega / damped * np.sin(damped * t))

    return F, f


def test_on_a_resonance_talbot_fails_and_says_so_where_euler_holds():
    F, f = resonance(1e3, 0.1)
    t = np.linspace(1e-3, 30e-3, 30)
    assert np.abs(talbot(F, t) - f(t)).max() > 1e-3
    with pytest.raises(InversionError, match=r"needs Inversion\.EULER") as failed:
        invert(F, t)
    assert failed.value.error > 1e-3
    assert invert(F, t, method=Inversion.EULER, tolerance=1e-6) == pytest.approx(f(t), abs=1e-6)


def test_euler_refuses_what_oscillates_too_long():
    F, _ = resonance(1e3, 0.01)
    with pytest.raises(InversionError, match="more damping"):
        invert(F, np.linspace(0.05, 0.3, 50), method=Inversion.EULER)


@pytest.mark.parametrize("method", [talbot, euler])
@pytest.mark.parametrize("t", [0.0, -1.0, np.nan, np.inf])
def test_only_positive_times(method, t):
    with pytest.raises(ThermalValueError, match="positive"):
        method(lambda s: 1 / s, [1.0, t])


@given(st.floats(1e-6, 1e6), st.floats(1e-6, 1e3))
def test_the_shape_is_kept_and_time_scales(rate, t):
    """L^-1 F(s/a)/a = f(a t), exactly in both sums up to rounding."""
    times = np.array([[t, 2 * t]])
    for method, tolerance in ((talbot, 1e-11), (euler, 1e-9)):
        found = method(lambda s: rate / (s * (s + rate)), times / rate)
        assert found.shape == (1, 2)
        assert found == pytest.approx(-np.expm1(-times), abs=tolerance)
