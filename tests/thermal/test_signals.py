"""Signals of many touches at once against those of one, rise times of many against those of one, and a reading's noise."""

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy.signal

from firmtouch.thermal import (
    RTD,
    Adiabatic,
    Air,
    Base,
    Bridge,
    Contact,
    Disc,
    Film,
    HalfSpace,
    Layer,
    Loop,
    Material,
    Metric,
    Pulse,
    Slab,
    Stack,
    Touch,
    contact_transfer,
    heater_transfer,
    power_transfer,
    rise_time,
)
from firmtouch.thermal.analysis import feel, loop_margin
from firmtouch.thermal.analysis.felt import COARSE, FINE
from firmtouch.thermal.metrics import measure, rises, sample
from firmtouch.thermal.readout import Readout, own_heat
from firmtouch.thermal.sensor import (
    HeldPower,
    HeldTemperature,
    Pulsed,
    Scenario,
    Sensor,
    Temperatures,
    TwoFaces,
)
from firmtouch.thermal.signals import response, responses, scale, signal_noise

WINDOW = 0.5
T = WINDOW * np.logspace(-6, 0, 31)
LOOP = Loop(gain=3e4, heater=1, sensor_lag=2e-4)
DRIVES = {
    "power": HeldPower(),
    "loop": HeldTemperature(LOOP),
    "loop's temperature": HeldTemperature(LOOP, reads_power=False),
    "integral": HeldTemperature(replace(LOOP, integral_gain=1e6)),
    "dead time": HeldTemperature(Loop(gain=3e3, heater=1, dead_time=1e-3)),
    "dead time's temperature": HeldTemperature(Loop(gain=3e3, heater=1, dead_time=1e-3), reads_power=False),
    "pulse": Pulsed(Pulse(2e3, 1)),
    "short pulse": Pulsed(Pulse(2e3, 1, 3e-3)),
    "two faces": TwoFaces(318.0),
}


@pytest.fixture(scope="module")
def touches(m):
    things = HalfSpace(m.copper), Slab(m.glass, 1e-3), Disc(m.steel, 5e-4), HalfSpace(m.pine), Base()
    return tuple(Touch(each, h) for each, h in zip(things, (1e4, 3e3, 2e4, math.inf, 1e4), strict=True))


@pytest.fixture(scope="module")
def sensor(m, touches):
    stack = Stack(
        (Layer(m.parylene, 2e-6), Film(1.0), Contact(1e6), Layer(m.kapton, 5e-6), Layer(m.foam, 1e-3)), 1, Base()
    )
    scenarios = tuple(Scenario(f"object {i}", "nominal", each) for i, each in enumerate(touches))
    return Sensor(stack, 1, HeldPower(), Temperatures(295.0, 310.0, 310.0, 295.0), scenarios)


@pytest.mark.parametrize("name", DRIVES)
def test_many_touches_are_as_one_by_one(sensor, touches, name):
    """The fast way for many, unchecked, and the careful one for each compute the same sums: rounding alone."""
    sensor = replace(sensor, drive=DRIVES[name])
    found = responses(sensor, touches, T)
    assert found.shape == (len(touches), T.size)
    for row, each in zip(found, touches, strict=True):
        assert row == pytest.approx(response(sensor, each)(T), rel=1e-9, abs=1e-10 * np.abs(row).max())
    assert responses(sensor, touches[1:2], T) == pytest.approx(found[1:2], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("name", DRIVES)
def test_signals_are_linear_in_what_makes_them(sensor, touches, name):
    """Twice the differences and twice the power are twice the signal, and an object as warm as the face makes none."""
    here = sensor.temperatures
    once = replace(sensor, drive=DRIVES[name])
    doubled = replace(here, object=2 * here.object - here.face)
    drive = once.drive
    if isinstance(drive, Pulsed):
        drive = Pulsed(replace(drive.pulse, power=2 * drive.pulse.power))
    if isinstance(drive, TwoFaces):
        drive = TwoFaces(2 * drive.second - here.face)
    twice = replace(once, drive=drive, temperatures=doubled)
    assert responses(twice, touches, T) == pytest.approx(2 * responses(once, touches, T), rel=1e-12)
    assert scale(twice) == pytest.approx(2 * scale(once))
    none = replace(once, temperatures=replace(here, object=here.face))
    if isinstance(drive, Pulsed):
        expected = responses(once, touches, T) - responses(replace(sensor, drive=HeldPower()), touches, T)
        assert responses(none, touches, T) == pytest.approx(expected, abs=1e-10)
    elif not isinstance(drive, TwoFaces):
        assert not responses(none, touches, T).any()


def test_two_faces_do_not_feel_the_objects_temperature(sensor, touches):
    sensor = replace(sensor, drive=TwoFaces(318.0))
    warmer = replace(sensor, temperatures=replace(sensor.temperatures, object=350.0))
    assert responses(warmer, touches, T) == pytest.approx(responses(sensor, touches, T), rel=1e-14)


def test_nothing_is_felt_before_the_dead_time(sensor, touches):
    found = responses(replace(sensor, drive=DRIVES["dead time"]), touches, np.array([1e-4, 1e-3, 1.1e-3, 2e-3]))
    assert not found[:, :2].any()
    assert found[:, 2:].all()


def test_what_follows_the_dead_time_at_once(sensor, touches):
    """Nanoseconds later, where e^{s T_d} alone would overflow: the power is -K theta of the open network just after."""
    since, loop = np.array([1e-9, 1e-7, 1e-6, 1e-5]), DRIVES["dead time"].loop
    expected = -loop.gain * responses(sensor, touches, since)
    sensor = replace(sensor, drive=DRIVES["dead time"])
    assert responses(sensor, touches, loop.dead_time + since) == pytest.approx(expected, rel=1e-6, abs=1e-6)
    careful = response(sensor, touches[0])(loop.dead_time + since)
    assert careful == pytest.approx(expected[0], rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("s", [np.array(3.0 + 2j), np.array([1.0, 1e3j]), np.array([[1.0, 2j, 5 - 1j]] * 2)])
def test_transfers_have_an_axis_for_touches(sensor, touches, s):
    """Whatever the shape of s; an element that another touch does not have makes no difference."""
    stack = sensor.stack
    found = contact_transfer(stack, touches, s)
    heated = heater_transfer(stack, touches, s, heater=3, plane=1)
    powers = power_transfer(stack, touches, LOOP, s)
    for i, each in enumerate(touches):
        alone = contact_transfer(stack, each, s)
        for name in ("sensed", "face", "object_face", "flux"):
            assert getattr(found, name)[i] == pytest.approx(getattr(alone, name), rel=1e-13)
        assert heated[i] == pytest.approx(heater_transfer(stack, each, s, heater=3, plane=1), rel=1e-13)
        assert powers[i] == pytest.approx(power_transfer(stack, each, LOOP, s), rel=1e-13)
    assert heater_transfer(stack, [Air(10.0), Adiabatic()], s).shape == (2, *s.shape)


class TestRises:
    """Against closed forms and `rise_time`, on the grids in use: 50 times a decade over 8, and 12 over 5."""

    @pytest.mark.parametrize(("grid", "close"), [(FINE, 2e-5), (COARSE, 1e-3)])
    @pytest.mark.parametrize("name", ["power", "loop", "pulse"])
    def test_as_one_by_one(self, sensor, grid, close, name):
        sensor = replace(sensor, drive=DRIVES[name])
        felt = feel(sensor, WINDOW, grid)
        for i, each in enumerate(sensor.touches):
            sampled = sample(response(sensor, each), WINDOW, per_decade=12)
            for metric in Metric:
                found, expected = felt.rises(metric), measure(sampled, metric)
                assert found.seconds[i] == pytest.approx(expected.seconds, rel=close)
                assert found.end_value[i] == pytest.approx(expected.end_value, rel=close)
                assert found.end[i] == pytest.approx(expected.end, rel=close)

    def values(self, *functions, grid=FINE):
        t = grid.times(1.0)
        return t, np.array([f(t) for f in functions])

    @pytest.mark.parametrize("tau", [1e-3, 1e-2, 0.05])
    def test_one_pole(self, tau):
        t, values = self.values(lambda t: -np.expm1(-t / tau), lambda t: 7 * np.expm1(-t / tau))
        found = rises(t, values, Metric.TEN_TO_NINETY)
        assert found.seconds == pytest.approx(tau * math.log(9), rel=2e-5)
        assert found.end_value == pytest.approx([1, -7], rel=1e-8)
        assert rises(t, values, Metric.SIXTY_THREE).seconds == pytest.approx(tau, rel=2e-5)

    def test_it_decays_again(self):
        """f = e^{-t/T} - e^{-9 t/T}, of either sign: its extremum is at T ln(9)/8, and counts as the end value."""

        def f(t):
            return np.exp(-20 * t) - np.exp(-180 * t)

        t, values = self.values(f, lambda t: -f(t))
        found, expected = rises(t, values, Metric.TEN_TO_NINETY), rise_time(f, 1.0)
        assert found.seconds == pytest.approx(expected.seconds, rel=2e-5)
        assert found.end_value == pytest.approx(np.array([1, -1]) * expected.end_value, rel=1e-6)

    def test_it_first_goes_the_other_way(self):
        """An undershoot that is less than the extremum does not reach a level."""

        def f(t):
            return 1 - 1.2 * np.exp(-t / 0.02) * np.cos(t / 0.01) - 0.3 * np.exp(-t / 1e-3)

        t, values = self.values(f)
        found, expected = rises(t, values, Metric.TEN_TO_NINETY), rise_time(f, 1.0)
        assert (found.start[0], found.end[0]) == pytest.approx((expected.start, expected.end), rel=2e-5)

    def test_a_jump_at_once_starts_at_zero(self):
        t, values = self.values(lambda t: 0.5 + 0.5 * t, np.ones_like)
        found = rises(t, values, Metric.TEN_TO_NINETY)
        assert (found.start[0], found.end[0]) == (0, pytest.approx(0.8, rel=2e-5))
        assert (found.start[1], found.seconds[1]) == (0, 0)

    def test_a_later_jump_is_found_between_two_samples(self):
        """A step at 0.1 s: where it is, a sample decides, 4.7 % apart; its time is within that."""
        t, values = self.values(lambda t: np.where(t > 0.1, 1.0, 0.0))
        found = rises(t, values, Metric.TEN_TO_NINETY)
        assert found.end[0] == pytest.approx(0.1, rel=10 ** (1 / 50) - 1)
        assert found.seconds[0] < 0.1 * (10 ** (1 / 50) - 1)

    def test_nothing_takes_for_ever(self):
        t, values = self.values(
            np.zeros_like, lambda t: np.full_like(t, np.nan), lambda t: np.where(t < 0.1, t, np.inf)
        )
        found = rises(t, values, Metric.TEN_TO_NINETY)
        assert np.isinf(found.seconds).all()
        assert not found.end_value.any()


def lumped_sensor(loop, *, C=40.0, G=1e3, **more):
    """One film on a base: theta/P'' = 1/(C s + G + h_air) untouched."""
    film = Stack((Film(C), Contact(G)), 0, Base())
    return Sensor(film, 0, loop, Temperatures(290.0, 310.0, 310.0, 310.0), (), front=Air(10.0), **more)


class TestNoise:
    READOUT = Readout(rate=1e3, noise=2e-3, bandwidth=500.0)

    def test_of_temperatures(self, sensor):
        assert signal_noise(sensor) is None
        read = replace(sensor, readout=self.READOUT)
        assert signal_noise(read) == 2e-3
        assert signal_noise(replace(read, drive=TwoFaces(318.0))) == pytest.approx(2e-3 * math.sqrt(2))
        assert signal_noise(replace(read, drive=DRIVES["loop's temperature"])) == 2e-3

    @pytest.mark.parametrize("K", [1e2, 1e4, 1e6])
    def test_of_a_loop_of_one_pole(self, K):
        """|K/(1 + L)|^2 = K^2 (1 + (w/a)^2)/((1 + K/G)^2 + (w/a)^2), a = G/C, whose mean has an arctangent."""
        C, G, B = 40.0, 1010.0, 500.0
        a, c = G / C, 1 + K / G
        w = 2 * math.pi * B / a
        mean = K**2 * (1 + (1 - c**2) / (c * w) * math.atan(w / c))
        sensor = lumped_sensor(HeldTemperature(Loop(K, 0)), readout=self.READOUT)
        # The sum of 120 trapezia is within 1e-3 of the integral.
        assert signal_noise(sensor) == pytest.approx(2e-3 * math.sqrt(mean), rel=1e-3)

    def test_of_a_loop_with_a_lag_by_simulation(self):
        """A noise of 50 tones on what is read, behind the lag, in a simulation of film and lag: the power's rms.

        Tones in the middle of equal bands make the mean as the midpoint rule does; within 5e-3 together with it.
        """
        C, G, K, lag, B, count = 40.0, 1010.0, 2e4, 1e-3, 500.0, 50
        A = np.array([[-G / C, -K / C], [1 / lag, -1 / lag]])  # film's theta, and what the thermometer shows
        loop = scipy.signal.StateSpace(A, [[-K / C], [0.0]], [[0.0, -K]], [[-K]])
        period, rng = 2 * count / B, np.random.default_rng(1993)
        t = np.linspace(0, 3 * period, 24001)
        f, phase = B * (np.arange(count) + 0.5) / count, 2 * np.pi * rng.random(count)
        read = math.sqrt(2 / count) * np.cos(2 * np.pi * f * t[:, np.newaxis] + phase).sum(axis=1)
        power = scipy.signal.lsim(loop, read, t)[1][t.size // 3 : -1]
        sensor = lumped_sensor(HeldTemperature(Loop(K, 0, sensor_lag=lag)), readout=self.READOUT)
        assert signal_noise(sensor) == pytest.approx(2e-3 * np.sqrt((power**2).mean()), rel=5e-3)

    def test_the_object_that_makes_most_of_it_counts(self, sensor):
        read = replace(sensor, drive=DRIVES["loop"], readout=self.READOUT)
        alone = [signal_noise(replace(read, scenarios=(each,))) for each in read.scenarios]
        assert signal_noise(read) == max(alone)


def test_own_heat_of_one_film():
    """delta is (G'' + h_air) times the area of the film, and the rise P/delta with P = (V/2)^2/R."""
    area, V, thermometer = 1e-6, 0.2, RTD(100.0, 3.85e-3)
    readout = Readout(1e3, 1e-3, 500.0, bridge=Bridge(thermometer, V), area=area)
    film = Stack((Film(40.0), Contact(1e3)), 0, Base())
    found = own_heat(film, Air(10.0), readout, 310.0)
    R = 100.0 * (1 + 3.85e-3 * (310.0 - 298.15))
    assert found.effective_conductance == pytest.approx(1010 * area, rel=1e-12)
    assert found.rise == pytest.approx((V / 2) ** 2 / R / (1010 * area), rel=1e-12)
    assert own_heat(film, Air(10.0), replace(readout, area=None), 310.0) is None
    insulated = own_heat(Stack((Film(40.0),), 0, Adiabatic()), Air(10.0), readout, 310.0)
    assert insulated.effective_conductance == pytest.approx(10 * area, rel=1e-12)


class TestLoopMargin:
    def test_of_a_loop_with_a_lag(self):
        """The least |1 + L| of a film with a lag, on a grid of 1e5 frequencies; 30 a decade are within 1 %."""
        C, G, K, lag = 40.0, 1010.0, 1e5, 2e-3
        s = 1j * np.geomspace(1, 1e5, 100_001)
        expected = np.abs(1 + K / ((C * s + G) * (lag * s + 1))).min()
        found = loop_margin(lumped_sensor(HeldTemperature(Loop(K, 0, sensor_lag=lag))))
        assert found == pytest.approx(expected, rel=0.01)
        assert loop_margin(lumped_sensor(HeldPower())) == 1

    @pytest.mark.parametrize(("factor", "grows"), [(0.5, False), (0.99, False), (1.01, True), (1.9, True)])
    def test_a_loop_that_grows_has_none(self, factor, grows):
        """Film with a dead time: at 1.9 of the limiting gain L goes round -1 with |1 + L| > 0.6 everywhere."""
        C, G, dead = 40.0, 1010.0, 1e-3
        w = 1560.0
        for _ in range(50):  # atan(w C/G) + w T_d = pi
            w = (math.pi - math.atan(w * C / G)) / dead
        limit = G * math.hypot(1, w * C / G)
        found = loop_margin(lumped_sensor(HeldTemperature(Loop(factor * limit, 0, dead_time=dead))))
        assert (found == 0) is grows

    def test_a_sensor_apart_from_its_heater_may_grow(self, m):
        """Half a millimetre of rubber between both: diffusion turns L by far more than 180 degrees."""
        stack = Stack((Layer(m.pdms, 0.5e-3), Layer(m.pdms, 0.5e-3)), 1, Base())
        sensor = Sensor(stack, 0, HeldTemperature(Loop(1e6, 0)), Temperatures(290.0, 310.0, 310.0, 310.0), ())
        assert loop_margin(sensor) == 0


def test_a_sensor_of_other_size_is_the_same_at_another_time():
    """t -> x^2 t under L -> x L, h -> h/x and a -> x a without films: exactly, so that only rounding differs."""

    def made(x):
        rubber, metal = Material("rubber", 0.2, 1000, 1500), Material("metal", 50.0, 8000, 500)
        stack = Stack((Layer(rubber, 1e-5 * x), Layer(rubber, 1e-4 * x)), 1, Air(20.0 / x))
        objects = HalfSpace(metal), Slab(rubber, 1e-4 * x), Disc(metal, 1e-3 * x)
        touches = [Touch(each, 1e4 / x) for each in objects]
        return Sensor(stack, 1, HeldPower(), Temperatures(290.0, 310.0, 310.0, 310.0), ()), touches

    for x in (0.3, 7.0):
        expected = responses(*made(1.0), T)
        assert responses(*made(x), T * x**2) == pytest.approx(expected, rel=1e-11)
        with_loop = replace(made(1.0)[0], drive=HeldTemperature(Loop(1e4, 1, sensor_lag=1e-4)))
        scaled = replace(made(x)[0], drive=HeldTemperature(Loop(1e4 / x, 1, sensor_lag=1e-4 * x**2)))
        expected = responses(with_loop, made(1.0)[1], T)
        assert x * responses(scaled, made(x)[1], T * x**2) == pytest.approx(expected, rel=1e-6)  # Euler's sum
