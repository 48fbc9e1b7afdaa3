"""The heat of a sensor: a network of resistances, finite volumes whose boundary changes at the release, and one film."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from firmtouch.thermal import (
    Adiabatic,
    Air,
    Base,
    Contact,
    Film,
    HalfSpace,
    Layer,
    Loop,
    Pulse,
    Stack,
    ThermalValueError,
    Touch,
    power_response,
)
from firmtouch.thermal.analysis import feel, heat, hold_power, recovery_times, release
from firmtouch.thermal.analysis.felt import COARSE, FINE
from firmtouch.thermal.metrics import Metric
from firmtouch.thermal.sensor import (
    HeldPower,
    HeldTemperature,
    Pulsed,
    Scenario,
    Sensor,
    Temperatures,
    TwoFaces,
)
from firmtouch.thermal.signals import responses

AIR, WINDOW, COLD, WARM = 10.0, 0.5, 290.0, 310.0
SINCE = np.array([1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0])


def sensor_of(stack, drive, touches, *, heater, temperatures=None):
    scenarios = tuple(Scenario(f"object {i}", "nominal", each) for i, each in enumerate(touches))
    at = temperatures or Temperatures(object=COLD, face=WARM, base=WARM, ambient=WARM)
    return Sensor(stack, heater, drive, at, scenarios, front=Air(AIR))


@pytest.fixture(scope="module")
def film(m):
    """A film of 2 J/m2K between parylene and Kapton on foam, sensed and heated."""
    return Stack(
        (Layer(m.parylene, 5e-6), Film(2.0), Layer(m.kapton, 10e-6), Layer(m.foam, 1e-3)), sensed=1, backing=Base()
    )


def ladder(stack, heater, at, power):
    """Solve for the temperatures of all planes at rest: a matrix of conductances from air to base, one of each element."""
    R = [
        each.thickness / each.material.conductivity if isinstance(each, Layer) else 1 / each.conductance
        for each in stack.elements
    ]
    n = len(R) + 1
    G, q = np.zeros((n, n)), np.zeros(n)
    for i, r in enumerate(R):
        G[i : i + 2, i : i + 2] += np.array([[1, -1], [-1, 1]]) / r
    G[0, 0] += AIR
    q[0] += AIR * at.ambient
    q[heater] += power
    match stack.backing:
        case Base():
            G[-1, -1] += 1e15  # of the largest conductance here, 1e5
            q[-1] += 1e15 * at.base
        case Air(conductance=h):
            G[-1, -1] += h
            q[-1] += h * at.base
    return np.linalg.solve(G, q)


@pytest.mark.parametrize("backing", [Base(), Air(25.0), Adiabatic()])
@pytest.mark.parametrize("heater", [0, 1, 2, 3])
def test_the_held_power_is_that_of_a_network_of_resistances(m, backing, heater):
    if heater == 3 and isinstance(backing, Base):
        heater = 2  # a heater on the base heats nothing
    layers = Layer(m.parylene, 50e-6), Contact(1e4), Layer(m.foam, 1e-3)
    at = Temperatures(object=280.0, face=310.0, base=303.0, ambient=291.0)
    sensor = sensor_of(Stack(layers, 1, backing), HeldPower(), [], heater=heater, temperatures=at)
    # An ideal base is 1e15 W/m2K there: 1e-10 of what the face's resistances are.
    assert ladder(sensor.stack, heater, at, hold_power(sensor))[0] == pytest.approx(310.0, abs=1e-6)


def test_a_heater_on_the_base_holds_nothing(film):
    with pytest.raises(ThermalValueError, match="heater's plane is 4"):
        hold_power(sensor_of(film, HeldPower(), [], heater=4))


class Volumes:
    """A film sensor and an object, cut in cells; the states are temperatures, solved by eigenvalues: exact in time.

    Cells of the object, from its depth to its face, are before those of the stack; a film is a cell of its own.
    """

    def __init__(self, sensor, touch):
        self.sensor, self.touch = sensor, touch
        cells = []
        for each in sensor.stack.elements:
            match each:
                case Layer(material=material, thickness=L):
                    sizes = np.full(30, L / 30) if L < 1e-4 else grown(L, 80, 6.0)
                    half = sizes / material.conductivity / 2
                    cells += [*zip(sizes * material.volumetric_capacity, half, strict=True)]
                case Film(areal_capacity=C):
                    self.film = len(cells)
                    cells.append((C, 0.0))
        body = touch.object.material
        sizes = grown(8 * math.sqrt(body.alpha * WINDOW), 150, 9.0)[::-1]  # erfc(4): 2e-8
        self.object = [*zip(sizes * body.volumetric_capacity, sizes / body.conductivity / 2, strict=True)]
        self.stack = cells

    def follow(self, cells, start, times, *, front, power):
        """Give the film's temperature, the heater's power, and the last state; `front` is the object, or the air."""
        C, half = np.array(cells).T
        n, film = len(C), self.film + (len(self.object) if front == "object" else 0)
        resistance = half[:-1] + half[1:]
        if front == "object":
            resistance[len(self.object) - 1] += 1 / self.touch.conductance
        A, b = np.zeros((n, n)), np.zeros(n)
        i = np.arange(n - 1)
        G = 1 / resistance
        for row, column, sign in ((i, i, -1), (i, i + 1, 1), (i + 1, i + 1, -1), (i + 1, i, 1)):
            np.add.at(A, (row, column), sign * G)
        ends = [(n - 1, 1 / half[-1], self.sensor.temperatures.base)]
        if front == "air":
            ends.append((0, 1 / (1 / AIR + half[0]), self.sensor.temperatures.ambient))
        for cell, g, T in ends:
            A[cell, cell] -= g
            b[cell] += g * T
        b[film] += power
        if isinstance(self.sensor.drive, HeldTemperature):
            gain = self.sensor.drive.loop.gain
            A[film, film] -= gain
            b[film] += gain * WARM
        A, b = A / C[:, np.newaxis], b / C
        rest = -np.linalg.solve(A, b)
        root = np.sqrt(C)  # makes A symmetric
        values, V = np.linalg.eigh(root[:, np.newaxis] * A / root)
        parts = V.T @ (root * (start - rest))
        T = rest[film] + (V[film] / root[film] * parts) @ np.exp(np.outer(values, times))
        return T, rest + V @ (np.exp(values * times[-1]) * parts) / root

    def touch_and_release(self, *, pulse=0.0, duration=WINDOW):
        """Give the film's deviations at the release and after it; a pulse begins with the touch."""
        state = np.concatenate([np.full(len(self.object), COLD), np.full(len(self.stack), WARM)])
        both = [*self.object, *self.stack]
        at, state = self.follow(both, state, np.array([min(duration, WINDOW)]), front="object", power=pulse)
        if duration < WINDOW:
            at, state = self.follow(both, state, np.array([WINDOW - duration]), front="object", power=0.0)
        after, _ = self.follow(self.stack, state[len(self.object) :], SINCE, front="air", power=0.0)
        return at[0] - WARM, after - WARM


def grown(depth, count, towards):
    return np.diff(depth * np.expm1(towards * np.linspace(0, 1, count + 1)) / np.expm1(towards))


def interpolated(found):
    return np.exp(np.interp(np.log(SINCE), np.log(found.t), np.log(np.abs(found.values[0])))) * np.sign(
        found.values[0, 0]
    )


DRIVES = SimpleNamespace(
    open=HeldPower(),
    temperature=HeldTemperature(Loop(gain=2e3, heater=1), reads_power=False),
    power=HeldTemperature(Loop(gain=2e3, heater=1)),
    pulse=Pulsed(Pulse(2e3, 1)),
    short_pulse=Pulsed(Pulse(2e4, 1, 0.1)),
)


@pytest.mark.parametrize("drive", ["open", "temperature", "power", "pulse", "short_pulse"])
@pytest.mark.parametrize("thing", ["copper", "pine"])
def test_a_release_against_finite_volumes(m, film, thing, drive):
    """Touched for half a second and let go: the object's cells are taken away, and the air is there again.

    The volumes err by some 3e-4 of the signal, the flux's 81 intervals by as much as 1e-3; air and face have one
    temperature, so that closing the contact is exact without the air.
    """
    touch = Touch(HalfSpace(getattr(m, thing)), 1e4)
    sensor = sensor_of(film, getattr(DRIVES, drive), [touch], heater=1)
    pulse = getattr(sensor.drive, "pulse", None)
    options = {} if pulse is None else {"pulse": pulse.power, "duration": pulse.duration}
    at, after = Volumes(sensor, touch).touch_and_release(**options)
    if drive == "power":
        at, after = -2e3 * at, -2e3 * after
    signal = responses(sensor, [touch], np.array([WINDOW]))[0, 0]
    assert signal == pytest.approx(at, rel=1e-3)
    found = release(sensor, [touch], WINDOW)
    scale = max(abs(at), np.abs(after).max())
    assert interpolated(found) == pytest.approx(after, abs=1.5e-3 * scale)


def test_two_faces_recover_as_one(m, film):
    """Both pads' responses are one response, scaled by their differences from the object: shares do not depend on it."""
    touches = [Touch(HalfSpace(each), 1e4) for each in (m.copper, m.glass)]
    found = []
    for drive in (HeldPower(), TwoFaces(WARM + 3.0), TwoFaces(WARM - 8.0)):
        sensor = sensor_of(film, drive, touches, heater=1)
        ends = feel(sensor, WINDOW).rises(Metric.SIXTY_THREE).end_value
        found.append(recovery_times(sensor, touches, WINDOW, ends))
    assert found[1] == pytest.approx(found[0], rel=1e-9)
    assert found[2] == pytest.approx(found[0], rel=1e-9)


@pytest.mark.parametrize("grid", [COARSE, FINE])
def test_one_film_recovers_in_ln_10_of_its_time_constant(grid):
    """A film of C'' on G'' to a base, let go in the open: theta falls as exp(-t (G'' + h_air)/C'')."""
    C, G = 40.0, 1e3
    film = Stack((Film(C), Contact(G)), sensed=0, backing=Base())
    touch = Touch(Base(), 1e4)
    sensor = sensor_of(film, HeldPower(), [touch], heater=0)
    end = responses(sensor, [touch], np.array([WINDOW]))[0]
    found = recovery_times(sensor, [touch], WINDOW, end, grid=grid)
    # Both grids are those in use; the flux is followed in steps.
    assert found[0] == pytest.approx(math.log(10) * C / (G + AIR), rel=2e-3)


def test_a_loop_shortens_one_films_recovery_by_its_gain():
    C, G, K = 40.0, 1e3, 9e3
    film, touch = Stack((Film(C), Contact(G)), sensed=0, backing=Base()), Touch(Base(), 1e4)
    for reads_power in (True, False):
        sensor = sensor_of(film, HeldTemperature(Loop(K, 0), reads_power=reads_power), [touch], heater=0)
        end = responses(sensor, [touch], np.array([WINDOW]))[0]
        found = recovery_times(sensor, [touch], WINDOW, end)
        assert found[0] == pytest.approx(math.log(10) * C / (G + AIR + K), rel=2e-3)


def test_what_does_not_come_back_in_time_never_does():
    """A film that only the air's 10 W/m2K warms again takes ln(10) C''/h_air, here 2e4 touches."""
    C = AIR * 1e4 / math.log(10)
    film, touch = Stack((Film(C),), sensed=0, backing=Adiabatic()), Touch(Base(), 1e9)
    for factor, expected in ((0.9 * WINDOW, 0.9e4 * WINDOW), (2 * WINDOW, math.inf)):
        sensor = sensor_of(replace(film, elements=(Film(C * factor),)), HeldPower(), [touch], heater=0)
        end = responses(sensor, [touch], np.array([WINDOW]))[0]
        assert recovery_times(sensor, [touch], WINDOW, end)[0] == pytest.approx(expected, rel=5e-3)


def test_the_most_power_is_the_peak_of_the_loops(m, film):
    """Against the checked response at other times, 106 a decade; both miss up to 1e-4 of a rounded peak."""
    touches = [Touch(HalfSpace(each), 1e4) for each in (m.pine, m.copper, m.glass)]
    loop = Loop(gain=5e4, heater=1, sensor_lag=2e-4)
    t = np.geomspace(1e-5, WINDOW, 500)
    difference = COLD - WARM
    peaks = [float((difference * power_response(film, each, loop, t)).max()) for each in touches]
    for reads_power in (True, False):
        sensor = sensor_of(film, HeldTemperature(loop, reads_power=reads_power), touches, heater=1)
        felt = feel(sensor, WINDOW)
        found = heat(sensor, felt.t, felt.values)
        assert found.most == pytest.approx(found.hold + max(peaks), rel=1e-4)
        assert found.most_in == sensor.scenarios[int(np.argmax(peaks))].words
        assert found.least == pytest.approx(found.hold, abs=1e-6)


def test_a_warmer_object_makes_a_loop_cool(m, film):
    """Signs: an object of 330 K on a face of 310 K leaves the heater less to do, below zero."""
    at = Temperatures(object=330.0, face=WARM, base=WARM, ambient=WARM)
    sensor = sensor_of(
        film,
        HeldTemperature(Loop(gain=5e4, heater=1)),
        [Touch(HalfSpace(m.copper), 1e4)],
        heater=1,
        temperatures=at,
    )
    felt = feel(sensor, WINDOW)
    found = heat(sensor, felt.t, felt.values)
    assert found.hold == pytest.approx(0, abs=1e-9)
    assert found.least == pytest.approx(felt.values.min(), rel=1e-12)
    assert found.least < -1e4 < found.most == pytest.approx(0, abs=1e-9)


def test_a_pulse_heats_the_untouched_face_most(m):
    """A heated film in the open on an insulated back: P'' (1 - exp(-t h/C''))/h on top of the face's own."""
    C, P = 40.0, 3e3
    film = Stack((Film(C),), sensed=0, backing=Adiabatic())
    for duration in (0.1, math.inf):
        sensor = sensor_of(film, Pulsed(Pulse(P, 0, duration)), [Touch(HalfSpace(m.pine), 1e4)], heater=0)
        felt = feel(sensor, WINDOW)
        found = heat(sensor, felt.t, felt.values)
        rise = P / AIR * -math.expm1(-min(duration, WINDOW) * AIR / C)
        assert (found.most, found.hottest) == pytest.approx((found.hold + P, WARM + rise), rel=1e-9)
