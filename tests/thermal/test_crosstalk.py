"""What neighbours do to a whole sensor: the engine's figures for its pads, and what an array and a drive make of them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from firmtouch.thermal import ContactEvent, Disc, array_crosstalk, neighbour_response, object_crosstalk
from firmtouch.thermal.analysis.crosstalk import crosstalk_of
from firmtouch.thermal.sensor import HeldPower, Pad
from firmtouch.thermal.sensorfile import read_sensor
from firmtouch.thermal.sensorfile.build import sensor_of

AT = 10e-3


@pytest.fixture(scope="module")
def array():
    file = read_sensor("models/thermal/array_20x20.yaml")
    return sensor_of(file.spec, file.catalogue)


@pytest.fixture(scope="module")
def told(array):
    return {each.object: each for each in crosstalk_of(array, AT)}


def test_of_each_object(array, told):
    assert list(told) == ["softwood", "pmma", "window_pane", "steel_304", "copper"]
    copper = next(each.touch.object for each in array.scenarios if each.object == "copper")
    t = np.array([AT])
    assert told["copper"].neighbour == pytest.approx(0.027, rel=0.02)  # two digits recorded
    assert told["copper"].neighbour == object_crosstalk(copper.material, 0.5e-3, 2e-3, t)[0]
    assert told["copper"].array == array_crosstalk(copper.material, 0.5e-3, 2e-3, t, rows=20, columns=20)[0]
    assert told["pmma"].neighbour == told["pmma"].array == told["pmma"].signal == 0  # 66 um of diffusion, 2 mm of pitch


def test_a_plate_keeps_its_heat(array, told):
    """A sheet of copper passes more on than a block."""
    sheet = tuple(
        replace(each, touch=replace(each.touch, object=replace(each.touch.object, thickness=0.3e-3)))
        for each in array.scenarios
        if each.object == "copper"
    )
    (thin,) = crosstalk_of(replace(array, scenarios=sheet), AT)
    assert thin.neighbour > 2 * told["copper"].neighbour
    assert thin.signal > 2 * told["copper"].signal


def test_the_signal_at_constant_power_is_the_engines(array):
    quiet = replace(array, drive=HeldPower())
    best = {each.object: each.touch for each in array.scenarios}["copper"]
    found = next(each for each in crosstalk_of(quiet, AT) if each.object == "copper")
    other = neighbour_response(array.stack, best, 2e-3, array.pad.area, AT)
    own = ContactEvent(array.stack, best, 1.0).temperature(AT)
    assert found.signal == pytest.approx(float(other / own), rel=1e-9)


def test_a_loop_draws_more_and_so_disturbs_more(array, told):
    quiet = next(each for each in crosstalk_of(replace(array, drive=HeldPower()), AT) if each.object == "copper")
    assert told["copper"].signal > 2 * quiet.signal


def test_pads_alone_have_no_neighbours(array):
    assert crosstalk_of(replace(array, pad=Pad(0.5e-3)), AT) == ()
    assert crosstalk_of(replace(array, pad=None), AT) == ()


def test_pads_that_meet_share_their_layers(array):
    (first, *_) = crosstalk_of(replace(array, pad=Pad(1e-3, 2e-3, 1, 2)), AT)
    assert first.substrate == 1.0
    assert isinstance(array.scenarios[0].touch.object, Disc)
    assert math.isfinite(first.signal)
