"""What is reached of what is asked: margins and their signs, and that the worst scenario is the worst."""

import math
from dataclasses import replace

import numpy as np
import pytest

from firmtouch.thermal import Metric, object_crosstalk, rise_time
from firmtouch.thermal.analysis import Outcome, analyse, feel, heat, recovery_times, tell_pairs
from firmtouch.thermal.analysis.outcomes import grades, outcomes, sampling_of
from firmtouch.thermal.sensorfile import parse_sensor
from firmtouch.thermal.sensorfile.build import sensor_of
from firmtouch.thermal.signals import response

FILE = """\
schema: firmtouch.sensor/1
title: made
stack:
  - {material: parylene_c, thickness: 2 um}
  - {film: {material: platinum, thickness: 100 nm, resistance: 100 ohm, coefficient: 0.385 %/K}, sensed: true}
  - {material: kapton, thickness: 5 um}
  - {material: foam_backing, thickness: 1 mm}
backing: base
contact: {low: 5e3, nominal: 1e4, high: 2e4}
objects: [softwood, glass, steel_304, copper]
temperatures: {object: 22 degC, sensor: 36 degC, prior: 0.02 K}
pad: {radius: 0.5 mm, pitch: 2 mm, rows: 4, columns: 5}
electronics: {sampling: 1 kHz, bridge_voltage: 0.2 V, noise_density: 10 nV/sqrt(Hz)}
requirements:
  rise_time: {at_most: 10 ms, metric: 10-90}
  discrimination: {pairs: [[copper, glass], [steel_304, glass], [glass, softwood]], time: 10 ms}
  range: {least: 100, most: 1e4, time: 10 ms}
  crosstalk: 5 %
  surface_temperature: 43 degC
  power: {pad: 0.2 W, array: 2 W}
  self_heating: 0.1 K
  feedback: 5 %
  loop_margin: 0.5
  recovery: 1 s
  pitch: 2 mm
  thickness: 2 mm
"""
LOOP = "drive: {mode: constant_temperature, loop_gain: 5e4, sensor_lag: 0.2 ms}\n"


def read(text):
    return parse_sensor(text.encode(), name="made")


def reached(text):
    file = read(text)
    sensor = sensor_of(file.spec, file.catalogue)
    felt = feel(sensor, file.spec.window)
    return file.spec.requirements, felt, {each.name: each for each in outcomes(file.spec.requirements, felt)}


@pytest.fixture(scope="module", params=["", LOOP], ids=["power", "loop"])
def case(request):
    return reached(FILE + request.param)


@pytest.mark.parametrize(
    ("outcome", "margin", "met", "shortfall"),
    [
        (Outcome("rise_time", 10e-3, 8e-3, "s"), 2e-3, True, 0),
        (Outcome("rise_time", 10e-3, 10e-3, "s"), 0, True, 0),
        (Outcome("rise_time", 10e-3, 20e-3, "s"), -10e-3, False, math.log(2)),
        (Outcome("rise_time", 10e-3, math.inf, "s"), -math.inf, False, math.inf),
        (Outcome("discrimination", 5.0, 10.0, "1", at_most=False), 5, True, 0),
        (Outcome("discrimination", 5.0, 2.5, "1", at_most=False), -2.5, False, math.log(2)),
        (Outcome("discrimination", 5.0, 0.0, "1", at_most=False), -5, False, math.inf),
        (Outcome("discrimination", 5.0, math.inf, "1", at_most=False), math.inf, True, 0),
        (Outcome("loop_margin", 0.5, 0.0, "1", at_most=False), -0.5, False, math.inf),
        (Outcome("surface_temperature", 316.0, 321.0, "K"), -5, False, 0.5),
        (Outcome("self_heating", 0.1, 0.4, "K"), -0.3, False, math.log(4)),
        (Outcome("crosstalk", 0.0, 0.1, "1"), -0.1, False, math.inf),
        (Outcome("power_pad", 0.2, -0.1, "W"), 0.3, True, 0),
    ],
)
def test_margins(outcome, margin, met, shortfall):
    assert outcome.margin == pytest.approx(margin)
    assert outcome.met is met
    assert outcome.shortfall == pytest.approx(shortfall)


def test_what_is_no_number_is_not_met():
    assert not Outcome("rise_time", 10e-3, math.nan, "s").met


def test_there_is_one_for_each_requirement_in_order(case):
    asked, _, found = case
    expected = [name for each in asked.asked for name in (["power_pad", "power_array"] if each == "power" else [each])]
    assert list(found) == expected


def test_the_worst_rise_time(case):
    _, felt, found = case
    each = [
        rise_time(response(felt.sensor, x.touch), felt.window, per_decade=12).seconds for x in felt.sensor.scenarios
    ]
    worst = int(np.argmax(each))
    assert found["rise_time"].reached == pytest.approx(each[worst], rel=2e-5)  # of the fine grid
    assert found["rise_time"].where == felt.sensor.scenarios[worst].words


def test_the_worst_pair(case):
    asked, felt, found = case
    spec, sampling = asked.discrimination, sampling_of(felt.sensor)
    each = [tell_pairs(felt.sensor, [pair], sampling, at=spec.time) for pair in spec.pairs]
    worst = min((x for found in each for x in found), key=lambda x: x.d_prime)
    # One call for all, or one for each, choose other scenarios to compute together: rounding over a step of 1e-3.
    assert found["discrimination"].reached == pytest.approx(worst.d_prime, rel=1e-6)
    assert found["discrimination"].where == f"{worst.first} and {worst.second}, {worst.level} h"


def test_the_worst_grade(case):
    asked, felt, found = case
    each = grades(asked, felt)
    assert len(each) == 7 * 3
    assert (each[0].effusivity, each[-1].effusivity) == pytest.approx((100, 1e4))
    assert found["range"].reached == max(x.spread for x in each)


def test_the_worst_neighbour(case):
    asked, felt, found = case
    pad = felt.sensor.pad
    each = {
        x.object: float(object_crosstalk(x.touch.object.material, pad.radius, pad.pitch, asked.rise_time.at_most))
        for x in felt.sensor.scenarios
    }
    assert (found["crosstalk"].where, found["crosstalk"].reached) == ("copper", pytest.approx(max(each.values())))
    assert max(each, key=each.get) == "copper"


def test_the_worst_recovery(case):
    _, felt, found = case
    ends = felt.rises(Metric.TEN_TO_NINETY).end_value
    each = [
        recovery_times(felt.sensor, [x.touch], felt.window, ends[i : i + 1])[0]
        for i, x in enumerate(felt.sensor.scenarios)
    ]
    worst = int(np.argmax(each))
    assert found["recovery"].reached == pytest.approx(each[worst], rel=1e-9)
    assert found["recovery"].where == felt.sensor.scenarios[worst].words


def test_the_most_power(case):
    _, felt, found = case
    each = [
        heat(replace(felt.sensor, scenarios=(x,)), felt.t, felt.values[i : i + 1]).most
        for i, x in enumerate(felt.sensor.scenarios)
    ]
    area = math.pi * 0.25e-6
    assert found["power_pad"].reached == pytest.approx(max(each) * area, rel=1e-12)
    assert found["power_array"].reached == pytest.approx(20 * max(each) * area, rel=1e-12)


def test_what_does_not_depend_on_the_touch(case):
    _, felt, found = case
    assert found["pitch"].reached == pytest.approx(2e-3)
    assert found["thickness"].reached == pytest.approx(1.007e-3)
    assert found["surface_temperature"].reached == pytest.approx(309.15)
    assert found["loop_margin"].reached == (
        1 if felt.sensor.drive.mode == "constant_power" else pytest.approx(0.9, abs=0.1)
    )


def test_a_rise_time_by_d_prime_is_the_slowest_pairs():
    text = FILE.replace("metric: 10-90", "metric: d_prime, window: 100 ms").replace("prior: 0.02 K", "prior: 0 K")
    asked, felt, found = reached(text)
    spec = asked.discrimination
    each = tell_pairs(felt.sensor, spec.pairs, sampling_of(felt.sensor), at=spec.time, until=0.1)
    assert found["rise_time"].reached == max(x.told_after for x in each)


def test_more_objects_and_contacts_never_make_a_worst_case_better():
    """Of every requirement: with all of both contacts and objects it is as bad as with some, or worse."""
    _, _, whole = reached(FILE)
    for text in (
        FILE.replace("contact: {low: 5e3, nominal: 1e4, high: 2e4}", "contact: 1e4 W/m^2/K"),
        FILE.replace("contact: {low: 5e3, nominal: 1e4, high: 2e4}", "contact: {nominal: 1e4, high: 2e4}"),
        FILE.replace("[softwood, glass, steel_304, copper]", "[softwood, glass, steel_304]").replace(
            "[copper, glass], ", ""
        ),
    ):
        _, _, some = reached(text)
        for name, each in some.items():
            # Rounding alone, where more is computed at once.
            assert whole[name].margin <= each.margin + 1e-9 * abs(each.reached), name


@pytest.mark.parametrize("drive", ["", LOOP], ids=["power", "loop"])
def test_an_analysis_holds_together(drive):
    """What it tells of each scenario is what its outcomes are the worst of."""
    file = read(FILE + drive)
    found = analyse(file)
    own = [each for each in found.responses if each.drive == file.spec.drive.mode]
    outcome = {each.name: each for each in found.outcomes}
    assert outcome["rise_time"].reached == max(each.rise_10_90 for each in own)
    assert outcome["recovery"].reached == pytest.approx(max(each.recovery for each in own), rel=1e-4)
    assert outcome["crosstalk"].reached == max(each.neighbour for each in found.crosstalk)
    # One is sampled until it is asked for, the other in the whole window, by splines: 1e-7 of signals, of differences.
    least = min(each.d_prime for each in found.discrimination)
    assert outcome["discrimination"].reached == pytest.approx(least, rel=1e-5)
    assert outcome["range"].reached == max(each.spread for each in found.range)
    assert outcome["power_pad"].reached == pytest.approx(found.heat.most * found.sensor.pad.area)
    assert outcome["self_heating"].reached == found.own_heat.rise
    assert outcome["feedback"].reached == found.own_heat.feedback_ratio
    assert outcome["loop_margin"].reached == found.loop_margin
    assert found.met is all(each.met for each in found.outcomes)
    assert (found.binding is None) is found.met
    for each in own:
        assert each.rise_10_90 == pytest.approx(each.end - each.start)
        assert each.end_value == pytest.approx(each.gain * -14.0)
    assert (found.open_loop is None) is (drive == "")
