"""What a sensor tells apart: linear algebra written out, analytic sensitivities, and detectors that are simulated."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import logsumexp
from scipy.stats import norm

from firmtouch.thermal import (
    Base,
    ContactEvent,
    Disc,
    HalfSpace,
    Layer,
    Loop,
    Material,
    Nuisance,
    Pulse,
    Sampling,
    Touch,
    conductance_sensitivity,
    discriminability,
    effusivity_spread,
    time_to_discriminate,
)
from firmtouch.thermal.analysis import grade, tell_pairs
from firmtouch.thermal.analysis.telling import spread_signals
from firmtouch.thermal.discrimination import d_primes
from firmtouch.thermal.sensor import (
    HeldPower,
    HeldTemperature,
    Pad,
    Pulsed,
    Scenario,
    Sensor,
    Temperatures,
    TwoFaces,
    Unknown,
)
from firmtouch.thermal.signals import response, responses

AT, RATE = 10e-3, 1e3
D3 = {"copper": (0.116, 0.252), "steel": (0.024, 0.053), "glass": (0.0062, 0.014), "pine": (0.0024, 0.0055)}


@pytest.fixture(scope="module")
def sensor(m, designs):
    """The worked design D3 with an object 14 K colder, h = 1e4 and what the reference table took as unknown: nothing."""
    names = ("copper", "aluminium", "steel", "glass", "pmma", "pine")
    scenarios = tuple(Scenario(each, "nominal", Touch(HalfSpace(getattr(m, each)), 1e4)) for each in names)
    return Sensor(designs.D3, 1, HeldPower(), Temperatures(296.0, 310.0, 310.0, 296.0), scenarios)


def with_unknown(sensor, ln_h=0.0, temperature=0.0):
    return replace(sensor, unknown=Unknown(ln_h, temperature))


@settings(max_examples=25)
@given(st.integers(0, 4), st.integers(1, 15), st.integers(0, 2**32 - 1))
def test_d_primes_are_those_of_the_whole_covariance(nuisances, n, seed):
    """Woodbury's formula against D^T (sigma^2 I + G^T G)^-1 D, for each number of samples."""
    rng = np.random.default_rng(seed)
    D, G, noise = rng.normal(size=n), rng.normal(size=(nuisances, n)), 0.1 + rng.random()
    found = d_primes(D, G, noise)
    for k in range(1, n + 1):
        covariance = noise**2 * np.eye(k) + G[:, :k].T @ G[:, :k]
        # Of up to 1e3 that cancels: 1e-13 of it, and its root.
        assert found[k - 1] ** 2 == pytest.approx(D[:k] @ np.linalg.solve(covariance, D[:k]), rel=1e-9)
    assert (np.diff(found) >= -1e-6 * found[-1]).all()  # more samples tell no less


class TestSpreads:
    def test_by_the_conductance_of_the_contact(self, sensor):
        seen = spread_signals(with_unknown(sensor, ln_h=0.3), sensor.touches, AT, RATE)
        for i, each in enumerate(sensor.touches):
            exact = conductance_sensitivity(ContactEvent(sensor.stack, each, -14.0))(seen.times)
            assert seen.spreads[0, i] == pytest.approx(0.3 * exact, rel=1e-6, abs=1e-8)  # the step's square

    @pytest.mark.parametrize(
        "drive", [HeldPower(), HeldTemperature(Loop(3e4, 1, sensor_lag=2e-4)), Pulsed(Pulse(1e3, 1))]
    )
    def test_by_the_objects_temperature(self, sensor, drive):
        """Signals are linear in T_o; a pulse's own part does not depend on it."""
        known = replace(sensor, drive=drive)
        seen = spread_signals(with_unknown(known, temperature=0.2), known.touches, AT, RATE)
        colder = replace(known, temperatures=replace(known.temperatures, object=286.0))
        changed = responses(known, known.touches, seen.times) - responses(colder, known.touches, seen.times)
        assert seen.spreads[0] == pytest.approx(0.2 * changed / 10, rel=1e-9)

    def test_two_faces_do_not_feel_it(self, sensor):
        two = with_unknown(replace(sensor, drive=TwoFaces(318.0)), temperature=0.2)
        assert spread_signals(two, two.touches, AT, RATE).spreads.shape == (0, 6, 10)

    def test_both_together(self, sensor):
        both = with_unknown(sensor, ln_h=0.3, temperature=0.2)
        assert spread_signals(both, both.touches, AT, RATE).spreads.shape == (2, 6, 10)

    @pytest.mark.parametrize(
        "drive",
        [
            HeldPower(),
            HeldTemperature(Loop(3e4, 1, sensor_lag=2e-4)),
            Pulsed(Pulse(1e3, 1)),
            Pulsed(Pulse(1e3, 1, 0.02)),
            Pulsed(Pulse(1e3, 1, 0.0305)),
        ],
    )
    def test_many_samples_are_interpolated_well(self, sensor, drive):
        """Half a second at 1 kHz: splines of 16 knots a decade against every sample; also where a pulse ends."""
        sensor = replace(sensor, drive=drive)
        seen = spread_signals(sensor, sensor.touches[::2], 0.5, RATE)
        exact = responses(sensor, sensor.touches[::2], seen.times)
        assert seen.values == pytest.approx(exact, abs=2e-6 * np.abs(exact).max())


class TestPairs:
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
    def test_the_worked_design(self, sensor, pair, expected):
        (found,) = tell_pairs(sensor, [pair], Sampling(20e-3, RATE), at=AT)
        assert found.d_prime == pytest.approx(expected, rel=0.02)  # two digits recorded
        assert (found.first, found.second, found.level, found.time) == (*pair, "nominal", AT)

    def test_with_all_unknown_it_is_the_mean_covariance(self, sensor):
        unknown = with_unknown(sensor, ln_h=0.3, temperature=0.05)
        sampling = Sampling(20e-3, RATE)
        pairs = list(itertools.combinations(["copper", "steel", "glass", "pine"], 2))
        found = tell_pairs(unknown, pairs, sampling, at=AT)
        seen = spread_signals(unknown, unknown.touches, AT, RATE)
        place = {each.object: i for i, each in enumerate(unknown.scenarios)}
        for pair, each in zip(pairs, found, strict=True):
            a, b = (place[name] for name in pair)
            D = seen.values[a] - seen.values[b]
            S = [sampling.noise**2 * np.eye(10) + seen.spreads[:, i].T @ seen.spreads[:, i] for i in (a, b)]
            assert each.d_prime == pytest.approx(math.sqrt(D @ np.linalg.solve((S[0] + S[1]) / 2, D)), rel=1e-7)

    def test_a_temperature_that_is_quite_unknown_leaves_the_shapes_alone(self, sensor):
        """D less what T_o of both touches could make of it: the projection off both responses, for an infinite spread."""
        unknown = with_unknown(sensor, temperature=1e4)
        (found,) = tell_pairs(unknown, [("steel", "glass")], Sampling(20e-3, RATE), at=AT)
        # D itself is a difference of both, so nothing is left of it.
        assert found.d_prime < 0.1
        (told,) = tell_pairs(sensor, [("steel", "glass")], Sampling(20e-3, RATE), at=AT)
        assert told.d_prime > 100

    def test_all_levels_and_times(self, sensor, m):
        """Each pair in each contact, each as by `discriminability` and `time_to_discriminate` of the exact responses."""
        scenarios = tuple(
            Scenario(name, level, Touch(HalfSpace(getattr(m, name)), h))
            for name in ("copper", "steel", "glass")
            for level, h in (("low", 3e3), ("high", 3e4))
        )
        sensor, sampling = replace(sensor, scenarios=scenarios), Sampling(0.1, RATE)
        pairs = [("glass", "copper"), ("steel", "copper")]
        found = tell_pairs(sensor, pairs, sampling, at=AT, until=0.2)
        assert [(each.first, each.second, each.level) for each in found] == [
            (*pair, level) for pair in pairs for level in ("low", "high")
        ]
        for each in found:
            first, second = (
                response(sensor, next(x.touch for x in scenarios if (x.object, x.level) == (name, each.level)))
                for name in (each.first, each.second)
            )
            assert each.d_prime == pytest.approx(discriminability(first, second, AT, sampling), rel=1e-5)
            assert each.told_after == time_to_discriminate(first, second, 0.2, sampling)

    def test_before_the_first_sample_nothing_is_told(self, sensor):
        (found,) = tell_pairs(sensor, [("steel", "glass")], Sampling(20e-3, RATE), at=0.5e-3)
        assert (found.d_prime, found.told_after) == (0, math.inf)

    @settings(max_examples=8)
    @given(st.floats(0, 2), st.floats(0, 5), st.floats(0.01, 10))
    def test_what_is_less_known_is_told_less(self, sensor, ln_h, temperature, noise):
        def d(sensor, noise):
            return tell_pairs(sensor, [("steel", "glass")], Sampling(noise, RATE), at=AT)[0].d_prime

        here = d(with_unknown(sensor, ln_h, temperature), noise)
        for worse in (
            d(with_unknown(sensor, ln_h + 0.1, temperature), noise),
            d(with_unknown(sensor, ln_h, temperature + 0.1), noise),
            d(with_unknown(sensor, ln_h, temperature), 1.1 * noise),
        ):
            assert worse <= here * (1 + 1e-9)


class TestDetectors:
    """Which errors go with a d': detectors that are simulated on drawn noise and drawn ln h."""

    COUNT = 40_000

    def drawn(self, sensor, noise, rng, *, in_full=False):
        """Draw samples of both objects' touches; `in_full` by the true response to the h that is drawn."""
        seen = spread_signals(sensor, sensor.touches, AT, RATE)
        z = np.linspace(-4.5, 4.5, 301)
        found, curves = [], []
        for i, each in enumerate(sensor.touches):
            more = [replace(each, conductance=each.conductance * math.exp(sensor.unknown.ln_h * x)) for x in z]
            curve = responses(sensor, more, seen.times) if in_full else seen.values[i] + np.outer(z, seen.spreads[0, i])
            drawn = rng.normal(size=self.COUNT)
            signal = np.array([np.interp(drawn, z, column) for column in curve.T]).T
            found.append(signal + noise * rng.normal(size=signal.shape))
            curves.append(curve)
        return found, curves, z

    @staticmethod
    def best_errors(found, curves, z, noise):
        """Give how often the ratio of likelihoods, with ln h integrated out, is wrong: no detector errs less."""

        def likelihood(x, curve):
            y, c = x / noise, curve / noise
            return logsumexp(y @ c.T - (c**2).sum(axis=1) / 2 + norm.logpdf(z), axis=1)

        first, second = (likelihood(x, curves[0]) > likelihood(x, curves[1]) for x in found)
        return (1 - first.mean() + second.mean()) / 2

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("pair", "ln_h", "noise"),
        [
            (("steel", "glass"), 0.3, 0.3),
            (("steel", "glass"), 0.6, 0.5),
            (("copper", "steel"), 0.3, 0.3),
            (("copper", "aluminium"), 0.3, 0.02),
            (("pmma", "pine"), 0.6, 2.0),
        ],
    )
    def test_the_best_detector_errs_as_the_distance_says(self, sensor, rng, pair, ln_h, noise):
        """Phi(-d'/2) within 6 %, and less than Bhattacharyya's bound, for spreads that are linear in ln h.

        4e4 touches of each object tell an error of p to sqrt(p/8e4): 1 to 3 % here; three of these are allowed.
        """
        scenarios = tuple(each for each in sensor.scenarios if each.object in pair)
        sensor = with_unknown(replace(sensor, scenarios=scenarios), ln_h=ln_h)
        (told,) = tell_pairs(sensor, [pair], Sampling(noise, RATE), at=AT)
        errors = self.best_errors(*self.drawn(sensor, noise, rng), noise)
        expected = norm.sf(told.d_prime / 2)
        spread = math.sqrt(expected / (2 * self.COUNT))
        assert 1 < told.d_prime < 4.5
        assert errors == pytest.approx(expected, abs=0.06 * expected + 3 * spread)
        assert errors < math.exp(-(told.d_prime**2) / 8) / 2

    @pytest.mark.slow
    def test_a_contact_that_is_drawn_in_full_costs_more(self, sensor, rng):
        """What the docstring of `tell_pairs` says of steel and glass: 2.2 % instead of 1.5 %."""
        pair, noise = ("steel", "glass"), 0.3
        scenarios = tuple(each for each in sensor.scenarios if each.object in pair)
        sensor = with_unknown(replace(sensor, scenarios=scenarios), ln_h=0.3)
        (told,) = tell_pairs(sensor, [pair], Sampling(noise, RATE), at=AT)
        errors = self.best_errors(*self.drawn(sensor, noise, rng, in_full=True), noise)
        assert (told.d_prime, norm.sf(told.d_prime / 2)) == pytest.approx((4.34, 0.015), rel=0.01)
        assert errors == pytest.approx(0.022, abs=3 * math.sqrt(0.022 / (2 * self.COUNT)))


class TestGrades:
    @pytest.mark.parametrize("name", D3)
    @pytest.mark.parametrize("prior", [0.0, 0.3])
    def test_the_worked_design(self, sensor, m, name, prior):
        """As by the analytic derivative of one dimension, and as recorded: two digits."""
        e, sampling = getattr(m, name).effusivity, Sampling(20e-3, RATE)
        (found,) = grade(with_unknown(sensor, ln_h=prior), [e], sampling, at=AT)
        event = ContactEvent(sensor.stack, Touch(HalfSpace(getattr(m, name)), 1e4), -14.0)
        assert found.spread == pytest.approx(effusivity_spread(event, AT, sampling, conductance_spread=prior), rel=1e-5)
        assert found.spread == pytest.approx(D3[name][prior > 0], rel=0.025)

    def test_in_all_contacts_of_the_first_object(self, sensor, m):
        scenarios = tuple(
            Scenario(name, level, Touch(HalfSpace(getattr(m, name)), h))
            for name in ("glass", "pine")
            for level, h in (("low", 3e3), ("nominal", 1e4))
        )
        found = grade(replace(sensor, scenarios=scenarios), [100.0, 1e3], Sampling(20e-3, RATE), at=AT)
        assert [(each.effusivity, each.level) for each in found] == [
            (100.0, "low"), (100.0, "nominal"), (1e3, "low"), (1e3, "nominal"),
        ]  # fmt: skip

    def test_of_discs(self, sensor):
        """By a derivative of the exact responses of discs of k = e^2/(rho c), whose spreading counts too."""
        pad, sampling, e, d = Pad(5e-4), Sampling(20e-3, RATE), 1.5e3, 1e-4

        def disc(x):
            return Disc(Material("", (e * math.exp(x)) ** 2 / 2.5e6, 2500.0, 1000.0), pad.radius)

        touch = Touch(disc(0), 1e4)
        sensor = replace(sensor, pad=pad, scenarios=(Scenario("disc", "nominal", touch),))
        t = sampling.times(AT)
        slope = (response(sensor, Touch(disc(d), 1e4))(t) - response(sensor, Touch(disc(-d), 1e4))(t)) / (2 * d)
        g = conductance_sensitivity(ContactEvent(sensor.stack, touch, -14.0))
        told = discriminability(lambda _: slope, np.zeros_like, AT, sampling, nuisances=[Nuisance(g, 0.3)])
        (found,) = grade(with_unknown(sensor, ln_h=0.3), [e], sampling, at=AT)
        assert found.spread == pytest.approx(1 / told, rel=1e-4)  # its step is 1e-3

    def test_nothing_is_known_before_the_first_sample(self, sensor):
        (found,) = grade(sensor, [1e3], Sampling(20e-3, RATE), at=0.5e-3)
        assert found.spread == math.inf

    def test_a_held_face_tells_nothing(self, sensor, m):
        """On its base a sensed plane keeps its temperature, whatever is touched."""
        held = replace(sensor, stack=replace(sensor.stack, elements=(Layer(m.pdms, 1e-3),), sensed=1, backing=Base()))
        (found,) = grade(held, [1e3], Sampling(20e-3, RATE), at=AT)
        assert found.spread > 1e9
