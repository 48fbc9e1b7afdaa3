"""What tolerances do: exponents that dimensional analysis knows, and corners that are computed once more by hand."""

import math

import pytest

from firmtouch.thermal import Metric
from firmtouch.thermal.analysis import analyse, feel
from firmtouch.thermal.analysis.tolerances import tolerances_of
from firmtouch.thermal.sensorfile import parse_sensor
from firmtouch.thermal.sensorfile.build import sensor_of

SLAB = """\
title: A slab that is warmed from its face
materials:
  rubber: {k: 0.2 W/m/K, rho: 1000 kg/m^3, c: 1500 J/kg/K, tolerance: 10 %, source: chosen}
stack:
  - {material: rubber, thickness: 0.1 mm, sensed: true}
backing: adiabatic
contact: 1e9 W/m^2/K
objects: [copper]
temperatures: {object: 22 degC, sensor: 36 degC}
requirements: {rise_time: {at_most: AT_MOST, metric: 10-90, window: 2 s}}
"""
FILM = """\
title: A film on nothing
parts:
  chip: {kind: ntc, capacity: 1 mJ/K, size: [1 mm, 1 mm, 0.1 mm], tolerance: 30 %, source: chosen}
stack:
  - {name: chip, film: {part: chip}, sensed: true}
backing: adiabatic
contact: 1e3 W/m^2/K
objects: [copper]
temperatures: {object: 22 degC, sensor: 36 degC}
requirements: {rise_time: {at_most: 4 s, metric: 10-90, window: 20 s}}
"""


def file_of(text):
    return parse_sensor(text.encode(), name="made")


def found(text, metric=Metric.TEN_TO_NINETY):
    file = file_of(text)
    return tolerances_of(sensor_of(file.spec, file.catalogue), file.spec, file.catalogue, metric)


def test_a_slab_is_as_slow_as_its_diffusivity_says():
    """t = 0.901 L^2/alpha: exponents -1, 1, 1; copper and the contact add a little, 3 % of the exponents at most."""
    tolerances = found(SLAB.replace("AT_MOST", "1 s"))
    slopes = {each.quantity: each.slope for each in tolerances.effects}
    assert slopes == pytest.approx({"conductivity": -1, "density": 1, "heat capacity": 1}, abs=0.03)
    assert tolerances.nominal == pytest.approx(0.9009461 * 1e-8 / (0.2 / 1.5e6), rel=0.05)
    # The corner is 1.1^2/0.9, but for that 3 %; likely is sqrt(3) of 10 %.
    assert tolerances.worst / tolerances.nominal == pytest.approx(1.1**2 / 0.9, rel=0.02)
    assert tolerances.likely / tolerances.nominal == pytest.approx(1 + 0.1 * math.sqrt(3), rel=0.02)


def test_the_corner_is_a_sensor_of_its_own():
    tolerances = found(SLAB.replace("AT_MOST", "1 s"))
    slow = SLAB.replace("AT_MOST", "1 s").replace("k: 0.2", "k: 0.18").replace("rho: 1000", "rho: 1100")
    file = file_of(slow.replace("c: 1500", "c: 1650"))
    exact = feel(sensor_of(file.spec, file.catalogue), 2.0).rises(Metric.TEN_TO_NINETY).seconds.max()
    assert tolerances.worst == pytest.approx(exact, rel=1e-3)  # the coarse grid


def test_a_part_brings_its_own():
    """2.197 C''/h: an exponent of 1 of the capacity, 30 % of which is the whole effect; copper adds its 1/e."""
    tolerances = found(FILM)
    (effect,) = tolerances.effects
    assert (effect.of, effect.tolerance) == ("chip (chip)", 0.3)
    assert effect.slope == pytest.approx(1, abs=0.02)
    assert tolerances.worst == pytest.approx(1.3 * tolerances.nominal, rel=0.01)


def test_what_has_no_tolerance_has_no_effect():
    assert found(FILM.replace("part: chip", "capacity: 1 kJ/m^2/K")) is None


@pytest.mark.parametrize(("at_most", "warned"), [("80 ms", True), ("200 ms", False), ("50 ms", False)])
def test_a_promise_that_only_the_tables_keep_is_told(at_most, warned):
    """70 ms by the tables and 91 ms at worst; what is missed anyway needs no such warning."""
    told = [each for each in analyse(file_of(SLAB.replace("AT_MOST", at_most))).warnings if "tolerances" in each]
    assert bool(told) == warned
