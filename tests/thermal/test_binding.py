"""What binds a sensor that misses a requirement, where the answer is known in closed form."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from firmtouch.thermal import (
    RTD,
    Adiabatic,
    Base,
    Bridge,
    Contact,
    ContactEvent,
    Disc,
    Film,
    HalfSpace,
    Layer,
    Loop,
    Material,
    Stack,
    Touch,
    object_crosstalk,
    rise_time,
)
from firmtouch.thermal.analysis import feel
from firmtouch.thermal.analysis.binding import binding_of
from firmtouch.thermal.analysis.outcomes import outcomes
from firmtouch.thermal.analysis.terms import TERMS_OF
from firmtouch.thermal.readout import Readout
from firmtouch.thermal.sensor import (
    HeldPower,
    HeldTemperature,
    Pad,
    Scenario,
    Sensor,
    Temperatures,
)
from firmtouch.thermal.sensorfile.requirements import (
    CrosstalkSpec,
    PowerSpec,
    RequirementsSpec,
    RiseTimeSpec,
)

RUBBER = Material("rubber", 0.2, 1000.0, 2000.0)
COPPER = Material("copper", 401.0, 8933.0, 385.0)
ONE_POLE, DEPTH = math.log(9), 31.664059 - 0.184806
"""t_10-90 by tau, and by x^2/alpha of a half-space's depth."""
WITHIN = 0.01
"""The bisection ends at 0.5 % of the factor, and the coarse grid is good to 0.1 % of a time."""


def asking(**given):
    return RequirementsSpec.model_construct(**given)


def fast(at_most, window):
    return asking(rise_time=RiseTimeSpec.model_construct(at_most=at_most, metric="10-90", signal=None, window=window))


def made(stack, touch, *, drive=None, at=None, **more):
    at = at or Temperatures(290.0, 310.0, 310.0, 310.0)
    return Sensor(stack, stack.sensed, drive or HeldPower(), at, (Scenario("it", "nominal", touch),), **more)


def binds(asked, sensor, window):
    missed = [each for each in outcomes(asked, feel(sensor, window)) if not each.met]
    return binding_of(asked, missed, sensor, window)


def reliefs(found):
    return {each.term: each for each in found}


class TestOnePole:
    """A film of C'' that meets a body which holds its temperature, through h: t_10-90 = ln 9 C''/h."""

    C, h, asked = 40.0, 1e3, 10e-3
    sensor = made(Stack((Film(C),), 0, Adiabatic()), Touch(Base(), h))

    def test_it_needs_more_contact_or_less_film(self):
        found = binds(fast(self.asked, 5.0), self.sensor, 5.0)
        assert found.outcome.reached == pytest.approx(ONE_POLE * self.C / self.h, rel=1e-4)
        alone = reliefs(found.alone)
        assert set(alone) == {"contact conductance", "film capacity"}
        assert found.together == ()
        assert alone["contact conductance"].needed == pytest.approx(ONE_POLE * self.C / self.asked, rel=WITHIN)
        assert alone["film capacity"].needed == pytest.approx(self.asked * self.h / ONE_POLE, rel=WITHIN)
        for each in found.alone:
            assert each.factor == pytest.approx(ONE_POLE * self.C / self.h / self.asked, rel=WITHIN)
            assert self.asked * (1 - WITHIN) < each.reached <= self.asked

    def test_a_loop_needs_more_gain(self):
        """In the loop it is ln 9 C''/(h + K), for the power too."""
        K = 5e3
        sensor = made(self.sensor.stack, Touch(Base(), self.h), drive=HeldTemperature(Loop(K, 0)))
        found = binds(fast(self.asked, 5.0), sensor, 5.0)
        alone = reliefs(found.alone)
        assert alone["loop gain"].needed == pytest.approx(ONE_POLE * self.C / self.asked - self.h, rel=WITHIN)
        assert alone["film capacity"].needed == pytest.approx(self.asked * (K + self.h) / ONE_POLE, rel=WITHIN)
        assert found.term == "film capacity"  # the smallest change

    def test_nothing_binds_what_misses_nothing(self):
        asked = fast(0.1, 5.0)
        assert binds(asked, self.sensor, 5.0) is None


@pytest.mark.parametrize(("at_most", "window"), [(1e-6, 0.5), (1e-3, 5.0)])
def test_a_microsecond_through_a_millimetre_of_rubber(at_most, window):
    """A plane at depth x in rubber, whose face is held from the touch on: t_10-90 = 31.479 x^2/alpha (erfc, t -> inf)."""
    sensor = made(Stack((Layer(RUBBER, 1e-3),), 1, HalfSpace(RUBBER)), Touch(Base(), math.inf))
    found = binds(fast(at_most, window), sensor, window)
    depth = reliefs(found.alone)["depth diffusion"]
    assert (depth.now, depth.unit) == (1e-3, "m")
    # The window ends before infinity: x/sqrt(pi alpha W) is missing, 2e-4 and 2e-3 here, at 0.1 from the end.
    assert depth.needed == pytest.approx(math.sqrt(at_most * RUBBER.alpha / DEPTH), rel=2 * WITHIN)


def test_two_terms_that_only_help_together():
    """Rubber before a film on a bad contact: thinner rubber leaves ln 9 C''/h, less film leaves the rubber."""
    C, h, L, asked, window = 40.0, 1e3, 100e-6, 10e-3, 5.0

    def rise(C, h, L):
        stack = Stack((Layer(RUBBER, L), Film(C)), 1, Adiabatic())
        return rise_time(ContactEvent(stack, Touch(Base(), h), 1.0).temperature, window).seconds

    ideal = 1e5
    assert min(rise(C / ideal, h, L), rise(C, h * ideal, L), rise(C, h, L / ideal)) > asked
    sensor = made(Stack((Layer(RUBBER, L), Film(C)), 1, Adiabatic()), Touch(Base(), h))
    found = binds(fast(asked, window), sensor, window)
    assert found.alone == ()
    together = reliefs(found.together)
    assert set(together) == {"film capacity", "depth diffusion"}  # more contact would do instead of less film
    depth = brentq(lambda L: rise(C / ideal, h, L) - asked, L / ideal, L, rtol=1e-4)
    assert together["film capacity"].needed == pytest.approx(asked * h / ONE_POLE, rel=WITHIN)
    assert together["depth diffusion"].needed == pytest.approx(depth, rel=WITHIN)
    assert [each.factor for each in found.together] == sorted((each.factor for each in found.together), reverse=True)


def test_the_object_binds_where_nothing_of_the_sensor_does():
    """A face may not be warmer than 300 K, and the object is."""
    sensor = made(
        Stack((Film(40.0), Contact(1e3)), 0, Base()), Touch(Base(), 1e3), at=Temperatures(305.0, 310.0, 310.0, 300.0)
    )
    found = binds(asking(surface_temperature=300.0), sensor, 0.5)
    assert (found.alone, found.together, found.term) == ((), (), "the object")


def test_the_largest_shortfall_is_told():
    sensor = made(Stack((Layer(RUBBER, 4e-3), Film(40.0)), 1, Base()), Touch(Base(), 1e3), pad=Pad(1e-3, 3e-3))
    found = binds(asking(pitch=2e-3, thickness=1e-3), sensor, 0.5)  # 1.5 times too wide, 4 times too thick
    assert (found.outcome.name, found.term) == ("thickness", "thickness of the layers")
    assert found.alone[0].needed == pytest.approx(1e-3, rel=WITHIN)


class TestOtherRequirements:
    """One relief each, by a formula."""

    R = RTD(100.0, 3.85e-3)
    READOUT = Readout(1e3, 1e-3, 500.0, bridge=Bridge(R, 2.0), area=1e-6)
    FILM = Stack((Film(40.0), Contact(1e3)), 0, Base())

    def test_the_own_heat_grows_with_the_square_of_the_voltage(self):
        sensor = made(self.FILM, Touch(Base(), 1e3), readout=self.READOUT)
        found = binds(asking(self_heating=0.1), sensor, 0.5)
        R = 100.0 * (1 + 3.85e-3 * (310.0 - 298.15))
        voltage = 2 * math.sqrt(0.1 * R * 1010 * 1e-6)  # (V/2)^2/R = delta times the rise
        assert reliefs(found.alone)["bridge voltage"].needed == pytest.approx(voltage, rel=WITHIN)

    def test_a_warm_face_needs_a_smaller_difference(self):
        sensor = made(self.FILM, Touch(Base(), 1e3), at=Temperatures(290.0, 320.0, 320.0, 290.0))
        found = binds(asking(surface_temperature=316.0), sensor, 0.5)
        assert found.alone[0].needed == pytest.approx(26.0, rel=WITHIN)

    def test_pads_that_are_too_near(self):
        sensor = made(self.FILM, Touch(Disc(COPPER, 0.5e-3), 1e4), pad=Pad(0.5e-3, 1.2e-3))
        asked = asking(crosstalk=CrosstalkSpec.model_construct(at_most=0.02, time=10e-3))
        found = reliefs(binds(asked, sensor, 0.5).alone)
        t = np.array([10e-3])
        pitch = brentq(lambda p: object_crosstalk(COPPER, 0.5e-3, p, t)[0] - 0.02, 1.2e-3, 1e-2)
        radius = brentq(lambda a: object_crosstalk(COPPER, a, 1.2e-3, t)[0] - 0.02, 1e-5, 0.5e-3)
        assert found["pitch"].needed == pytest.approx(pitch, rel=WITHIN)
        assert found["pad radius"].needed == pytest.approx(radius, rel=WITHIN)

    def test_a_constant_power_is_by_area(self):
        """P'' is what holds 20 K over the air; a pad of less radius, or fewer kelvin, draw less."""
        at = Temperatures(290.0, 310.0, 310.0, 290.0)
        sensor = made(Stack((Film(40.0),), 0, Adiabatic()), Touch(Base(), 1e3), at=at, pad=Pad(1e-3))
        asked = asking(power=PowerSpec.model_construct(pad=1e-4, array=None))
        found = reliefs(binds(asked, sensor, 0.5).alone)
        assert found["pad radius"].needed == pytest.approx(math.sqrt(1e-4 / 200 / math.pi), rel=WITHIN)
        assert found["temperature difference"].needed == pytest.approx(1e-4 / (10 * math.pi * 1e-6), rel=WITHIN)

    def test_a_loop_near_its_limit_needs_less_gain_or_less_delay(self):
        """A film alone with a dead time: |1 + L| as a function of gain, by a fine grid of frequencies."""
        C, G, dead = 40.0, 1010.0, 1e-3
        drive = HeldTemperature(Loop(5e4, 0, dead_time=dead))
        sensor = made(self.FILM, Touch(Base(), 1e-3), drive=drive)
        s = 1j * np.geomspace(1e1, 1e5, 20001)
        margin = lambda K: np.abs(1 + K * np.exp(-s * dead) / (C * s + G)).min() - 0.5  # noqa: E731
        found = reliefs(binds(asking(loop_margin=0.5), sensor, 0.5).alone)
        gain = brentq(margin, 1e3, 5e4)
        assert found["loop gain"].needed == pytest.approx(gain, rel=2 * WITHIN)  # its grid has 30 a decade
        assert "dead time" in found

    def test_a_recovery_needs_less_film(self):
        """ln 10 C''/(G'' + h_air)."""
        sensor = made(self.FILM, Touch(Base(), 1e5))
        found = reliefs(binds(asking(recovery=20e-3), sensor, 0.5).alone)
        assert found["film capacity"].needed == pytest.approx(20e-3 * 1010 / math.log(10), rel=WITHIN)


def test_a_change_by_one_changes_nothing_and_directions_help():
    """Each term at f = 1 leaves its value, and at f = 2 makes it half or double."""
    stack = Stack((Layer(RUBBER, 1e-4), Film(40.0), Layer(RUBBER, 1e-3)), 1, HalfSpace(COPPER))
    loop = Loop(1e4, 1, sensor_lag=1e-4, dead_time=1e-5)
    sensor = made(
        stack,
        Touch(Disc(COPPER, 5e-4), 1e4),
        drive=HeldTemperature(loop),
        pad=Pad(5e-4, 2e-3),
        readout=TestOtherRequirements.READOUT,
    )
    terms = {id(each): each for found in TERMS_OF.values() for each in found}
    for each in terms.values():
        now = each.value(sensor)
        if not now:
            continue
        assert each.value(each.changed(sensor, 1.0)) == pytest.approx(now, rel=1e-12)
        twice = each.value(each.changed(sensor, 2.0)) if each.name != "pitch" else None
        assert twice is None or twice / now == pytest.approx(2, rel=1e-9) or now / twice == pytest.approx(2, rel=1e-9)
