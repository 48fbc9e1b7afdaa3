"""[T8]: bounds and margins of the scalar force loops, against closed forms, polynomials and python-control."""

import math

import control
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from firmtouch.modelfile.sections.force_path import ForceMargins
from firmtouch.regulation.force_loop import (
    ForcePath,
    admissible_gain,
    as_control_system,
    loop_margins,
    stability_bound,
)
from firmtouch.regulation.force_loop.margins import crossing

MS = 1e-3
LATE = ForcePath(delay=1 * MS, lag=2 * MS)
TIMES = st.floats(1e-4, 1e-2)
CONTINUOUS = st.builds(ForcePath, delay=TIMES, lag=TIMES)
SAMPLED = st.builds(lambda T, k, lag: ForcePath(delay=k * T, lag=lag, sample=T), TIMES, st.integers(0, 6), TIMES)
PATHS = st.one_of(CONTINUOUS, SAMPLED)
PART = st.floats(0.05, 0.95)


def polynomial(path, g):
    """z^steps (z - a) + g (1 - a), from its definition."""
    a = math.exp(-path.sample / path.lag) if path.lag else 0.0
    coefficients = np.zeros(path.steps + 2)
    coefficients[:2] = 1, -a
    coefficients[-1] += g * (1 - a)
    return coefficients


def radius(path, g):
    return float(np.max(np.abs(np.roots(polynomial(path, g)))))


def test_the_known_case_of_a_lag_and_a_delay():
    """tau = 1 ms, tau_f = 2 ms: w_c = 1836.597 rad/s, g < 3.80688, as [T8] states to its digits."""
    assert crossing(LATE, math.pi) == pytest.approx(1836.597, abs=5e-4)
    assert stability_bound(LATE) == pytest.approx(3.80688, abs=5e-6)


@pytest.mark.parametrize(
    "path",
    [
        ForcePath(delay=1 * MS),
        ForcePath(sample=1 * MS),
        ForcePath(sample=1 * MS, delay=3 * MS),
        ForcePath(sample=1 * MS, lag=1e-7),  # so short a lag that nothing of it is left at the sample
    ],
)
def test_without_a_low_pass_the_bound_is_one_and_the_modulus_margin_what_is_left(path):
    assert stability_bound(path) == 1
    found = loop_margins(path, 0.8)
    assert (found.gain_margin, found.delay_margin) == (1.25, np.inf)
    assert found.modulus_margin == pytest.approx(0.2, rel=1e-12)  # rounding of exp at a phase of pi
    assert found.stable
    assert not loop_margins(path, 1.0).stable
    assert loop_margins(path, 1.0).modulus_margin == loop_margins(path, 1.0).delay_margin == 0


def test_with_a_low_pass_alone_every_gain_is_stable_and_a_delay_has_its_closed_form():
    path, g = ForcePath(lag=2 * MS), 1000.0
    found, w = loop_margins(path, g), math.sqrt(g**2 - 1) / path.lag
    assert (found.bound, found.gain_margin, found.modulus_margin) == (np.inf, np.inf, 1.0)
    assert found.delay_margin == pytest.approx((math.pi - math.atan(w * path.lag)) / w, rel=1e-12)  # rounding


def test_an_ideal_path_bears_every_gain_but_no_delay_from_one_on():
    assert loop_margins(ForcePath(), 1000.0).stable
    assert loop_margins(ForcePath(), 0.9).delay_margin == np.inf
    assert loop_margins(ForcePath(), 1.0).delay_margin == 0
    assert loop_margins(ForcePath(), 3.0).modulus_margin == 4.0


def test_a_loop_without_feedback_has_every_margin():
    found = loop_margins(LATE, 0.0)
    assert (found.gain_margin, found.delay_margin) == (np.inf, np.inf)
    assert found.modulus_margin == pytest.approx(1.0, rel=1e-12)  # rounding


@given(TIMES, TIMES)
def test_a_sampled_low_pass_without_further_delay_has_a_closed_form(T, lag):
    """z = a - g (1 - a) > -1."""
    a = math.exp(-T / lag)
    # 1 - a loses digits where T << lag: 1e-4/1e-2 leaves 14 of 16.
    assert stability_bound(ForcePath(lag=lag, sample=T)) == pytest.approx((1 + a) / (1 - a), rel=1e-12)


@settings(max_examples=60)
@given(SAMPLED)
def test_the_sampled_bound_is_where_the_polynomials_roots_leave_the_unit_circle(path):
    bound = stability_bound(path)
    # A root's size changes by at least 1e-6 / (steps + 1) of it; `roots` is good to 1e-12 for simple roots of degree 8.
    assert radius(path, bound * (1 - 1e-6)) < 1 < radius(path, bound * (1 + 1e-6))


@settings(max_examples=40)
@given(CONTINUOUS)
def test_at_the_continuous_bound_a_root_stands_on_the_axis_and_none_did_before(path):
    w, bound = crossing(path, math.pi), stability_bound(path)
    s = 1j * w
    assert abs(1 + bound * np.exp(-s * path.delay) / (1 + s * path.lag)) < 1e-12  # rounding
    assert 0 < w < math.pi / path.delay
    assert bound == pytest.approx(math.sqrt(1 + (w * path.lag) ** 2), rel=1e-14)
    lower = np.linspace(0, w, 400)[1:-1]
    assert np.all(path.phase(lower) < math.pi)


def test_a_delayed_loop_decays_just_below_the_bound_and_grows_just_above():
    """y' = (v - y) / tau_f, v(t) = -g y(t - tau), by steps of a hundredth of the delay and Heun's rule."""

    def growth(g):
        h, steps = LATE.delay / 100, 40_000
        y = np.zeros(steps + 1)
        y[:101] = 1.0
        for i in range(100, steps):
            a, b = -g * y[i - 100], -g * y[i - 99]
            k = (a - y[i]) / LATE.lag
            y[i + 1] = y[i] + h / 2 * (k + (b - y[i] - h * k) / LATE.lag)
        peaks = np.abs(y).reshape(-1)[1:].reshape(10, -1).max(axis=1)
        return peaks[-1] / peaks[4]

    bound = stability_bound(LATE)
    # 2 % from the bound, |Re s| is about 10 1/s over 0.2 s; Heun's rule at h = tau/100 errs by 1e-5 of the gain.
    assert growth(0.98 * bound) < 0.3
    assert growth(1.02 * bound) > 3


FOREIGN = {
    "a lag and a delay": (LATE, 0.6),
    "hardly a lag": (ForcePath(delay=3 * MS, lag=0.5 * MS), 0.9),
    "mostly a lag": (ForcePath(delay=0.2 * MS, lag=9 * MS), 0.3),
    "sampled": (ForcePath(delay=2 * MS, lag=3 * MS, sample=MS), 0.7),
    "sampled slowly": (ForcePath(delay=5 * MS, lag=3 * MS, sample=5 * MS), 0.9),
}


@pytest.mark.parametrize(("path", "part"), FOREIGN.values(), ids=list(FOREIGN))
def test_python_control_finds_the_same_margins(path, part):
    """It is given L(z) itself, or the exact response of L(s) at 400 frequencies, between which it takes splines."""
    g = part * stability_bound(path)
    found = loop_margins(path, g)
    if path.sample:
        open_loop = g * as_control_system(path)
    else:
        w = np.geomspace(1e-2, 3, 400) * crossing(path, math.pi)
        open_loop = control.frd(g * path.response(w), w)
    gm, pm, sm, _, wp, _ = control.stability_margins(open_loop)
    # Splines of a curve over 400 points are good to 1e-7; control's own search for the least distance ends at 1e-5.
    assert gm == pytest.approx(found.gain_margin, rel=1e-5)
    assert sm == pytest.approx(found.modulus_margin, rel=1e-4)
    if g > 1:
        assert math.radians(pm) / wp == pytest.approx(found.delay_margin, rel=1e-5)
    else:
        assert found.delay_margin == np.inf


@settings(max_examples=40)
@given(SAMPLED, PART, st.integers(1, 3))
def test_further_whole_samples_of_delay_are_borne_up_to_the_delay_margin(path, part, more):
    g = part * stability_bound(path)
    margin, delay = loop_margins(path, g).delay_margin, more * path.sample
    assume(abs(margin - delay) > 1e-6 * delay)
    later = ForcePath(delay=path.delay + delay, lag=path.lag, sample=path.sample)
    assert (radius(later, g) < 1) == (delay < margin)


@pytest.mark.parametrize("path", [LATE, ForcePath(sample=MS, lag=3 * MS, delay=2 * MS)], ids=["continuous", "sampled"])
def test_the_system_for_python_control_has_the_response_of_the_path(path):
    w = np.array([1.0, 100.0, 1000.0])
    found = as_control_system(path)(np.exp(1j * w * path.sample) if path.sample else 1j * w)
    # A Padé approximant of order 6 errs by (w tau / 2)^13 / 13!, far below rounding at w tau = 1.
    np.testing.assert_allclose(found, path.response(w), rtol=1e-9)


MARGINS = st.builds(
    ForceMargins,
    gain=st.none() | st.floats(1, 10),
    delay=st.none() | TIMES,
    modulus=st.floats(0.05, 0.95),
)


def kept(path, g, margins):
    found = loop_margins(path, g)
    pairs = [(found.gain_margin, margins.gain), (found.delay_margin, margins.delay)]
    pairs.append((found.modulus_margin, margins.modulus))
    return found.stable and all(asked is None or has >= asked for has, asked in pairs)


@settings(max_examples=60)
@given(PATHS, MARGINS)
def test_the_admissible_gain_keeps_all_margins_and_a_little_more_does_not(path, margins):
    g = admissible_gain(path, margins)
    # Bisections end at neighbouring floats; a least value on a grid misses by the square of 2^-45.
    assert kept(path, g * (1 - 1e-9), margins)
    assert not kept(path, g * (1 + 1e-6), margins)


@settings(max_examples=40)
@given(PATHS, PART, PART)
def test_every_margin_falls_as_the_gain_grows(path, first, second):
    low, high = (loop_margins(path, part * stability_bound(path)) for part in sorted((first, second)))
    for name in ("gain_margin", "delay_margin", "modulus_margin"):
        assert getattr(low, name) >= getattr(high, name) * (1 - 1e-12)  # rounding


def test_what_nothing_limits_is_infinite():
    assert admissible_gain(ForcePath(lag=MS), ForceMargins(gain=3, modulus=0.9)) == np.inf
    assert admissible_gain(ForcePath(), ForceMargins(gain=3)) == np.inf
    assert admissible_gain(ForcePath(delay=MS), ForceMargins(delay=MS)) == 1  # and 1 itself bears none


def test_the_least_of_the_limits_is_taken():
    path = ForcePath(delay=MS)
    assert admissible_gain(path, ForceMargins(gain=2)) == 0.5
    assert admissible_gain(path, ForceMargins(modulus=0.7)) == pytest.approx(0.3, rel=1e-12)  # rounding
    assert admissible_gain(path, ForceMargins(gain=2, modulus=0.7)) == pytest.approx(0.3, rel=1e-12)
