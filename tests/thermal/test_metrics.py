"""Rise times of closed forms to 1e-6 and better, of the worked designs."""

import math

import numpy as np
import pytest
from scipy.special import erfc, erfcx

from firmtouch.thermal import (
    ContactEvent,
    HalfSpace,
    Metric,
    NoResponseError,
    ThermalValueError,
    Touch,
    rise_time,
)

WINDOW = 0.5


@pytest.mark.parametrize(
    ("f", "crossings"),
    [
        (lambda t: erfc(0.5 / np.sqrt(t)), (0.184806, 31.664059, 2.181538)),
        (lambda t: 1 - erfcx(np.sqrt(t)), (0.0092696, 30.8534244, 1.5618235)),
        (lambda t: 1 - np.exp(-t) * (1 + t), (0.531812, 3.889720, 2.146193)),
    ],
)
def test_closed_forms(f, crossings):
    """A half-space never reaches its end value, so it is put at the window's end, as if time went on from there."""

    def ended(t):
        return np.where(t >= 1e5, 1.0, f(t))

    found, sixty_three = rise_time(ended, 1e5), rise_time(ended, 1e5, Metric.SIXTY_THREE)
    assert (found.start, found.end, sixty_three.seconds) == pytest.approx(crossings, rel=3e-6)  # digits recorded
    assert found.seconds == found.end - found.start
    assert found.monotone


def test_a_response_that_decays_again_is_measured_by_its_extremum():
    """f = e^{-t} - e^{-9t}, of either sign: its extremum is at ln(9)/8."""
    for sign in (1, -1):
        found = rise_time(lambda t, sign=sign: sign * (np.exp(-t) - np.exp(-9 * t)), 20.0)
        top = math.log(9) / 8
        assert found.extremum_time == pytest.approx(top, rel=1e-6)  # a maximum is flat: 1e-12 of value, 1e-6 of time
        assert found.end_value == pytest.approx(sign * (math.exp(-top) - math.exp(-9 * top)), rel=1e-12)
        assert not found.monotone
        reached = np.exp(-found.end) - np.exp(-9 * found.end)
        assert reached == pytest.approx(0.9 * abs(found.end_value), rel=1e-10)
        assert found.start < found.end < top


@pytest.mark.parametrize("shift", np.linspace(0, 1, 7))
def test_a_peak_between_samples_is_found(shift):
    """Wherever a narrow peak lies between two samples, its height and its crossings are the same."""
    place = 0.1 * 10 ** (shift / 50)
    found = rise_time(lambda t: np.exp(-((np.log(t / place) / 0.2) ** 2)), 1.0)
    assert found.end_value == pytest.approx(1, abs=1e-12)
    assert found.start / place == pytest.approx(math.exp(-0.2 * math.sqrt(math.log(10))), rel=1e-10)
    assert found.end / place == pytest.approx(math.exp(-0.2 * math.sqrt(-math.log(0.9))), rel=1e-6)


def test_few_samples_are_as_exact(m, designs):
    """They only bracket what root finding then finds on the exact response."""
    f = ContactEvent(designs.D3, Touch(HalfSpace(m.glass), 1e4), 14.0).temperature
    coarse, fine = (rise_time(f, WINDOW, per_decade=each) for each in (8, 50))
    assert (coarse.start, coarse.end) == pytest.approx((fine.start, fine.end), rel=1e-9)


def test_a_jump_starts_at_once():
    found = rise_time(lambda t: 0.5 + 0.5 * t, 1.0)
    assert (found.start, found.end) == pytest.approx((0, 0.8), abs=1e-12)


def test_nothing_has_no_rise_time():
    for nothing in (np.zeros_like, lambda t: np.full_like(t, np.nan)):
        with pytest.raises(NoResponseError, match="nothing is felt within 1 s"):
            rise_time(nothing, 1.0)
    with pytest.raises(ThermalValueError, match="window"):
        rise_time(np.exp, 0.0)


@pytest.mark.parametrize(
    ("design", "h", "expected"),
    [
        ("D1", 1e4, {"copper": (43, 0.97), "glass": (67, 0.88), "pmma": (109, 0.74), "pine": (151, 0.60)}),
        ("D2", 1e4, {"copper": (16.4, 0.98), "glass": (21.7, None), "pmma": (31.3, None), "pine": (43, None)}),
        ("D3", 1e3, {"copper": (154, None), "glass": (148, None), "pmma": (138, None), "pine": (126, None)}),
        ("D3", 1e4, {"copper": (9.7, 0.98), "glass": (12.1, 0.91), "pmma": (16.4, 0.79), "pine": (21.9, 0.66)}),
        ("D3", 5e4, {"copper": (2.1, None), "glass": (3.7, None), "pmma": (7.7, None), "pine": (13.6, None)}),
        ("D4", 1e4, {"copper": (71, None), "glass": (54, None), "pmma": (36, None), "pine": (24, None)}),
        ("D5", 1e4, {"copper": (14.3, 0.046), "glass": (10.1, 0.03), "pmma": (8.3, 0.02), "pine": (7.5, 0.011)}),
    ],
)
def test_worked_designs(m, designs, design, h, expected):
    for name, (milliseconds, gain) in expected.items():
        event = ContactEvent(getattr(designs, design), Touch(HalfSpace(getattr(m, name)), h), 1.0)
        found = rise_time(event.temperature, WINDOW)
        assert 1e3 * found.seconds == pytest.approx(milliseconds, rel=0.025)  # two digits recorded
        if gain:
            assert found.end_value == pytest.approx(gain, abs=0.006)
