"""The picture of the region of attraction: all starts are marked, by what became of them."""

from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest

import firmtouch
from firmtouch.certificate.attraction import find_attraction
from firmtouch.certificate.attraction.comparison import compare_attraction
from firmtouch.report.figures.attraction import attraction_picture
from firmtouch.report.figures.canvas import FORCE, MUTED

SVG = "{http://www.w3.org/2000/svg}"


@pytest.mark.parametrize("name", ["planar_2r_circle", pytest.param("spatial_3r_sphere", marks=pytest.mark.slow)])
def test_all_starts_are_marked(name, loop_of):
    loop = loop_of(firmtouch.read_model(Path(__file__).parents[2] / "models" / f"{name}.yaml"))
    found = find_attraction(loop, most_cells=150)
    comparison = compare_attraction(loop, found)
    svg = attraction_picture(found, comparison)
    assert svg == attraction_picture(found, comparison)
    root = ET.fromstring(svg)
    uses = [each.get("style") or "" for each in root.iter(f"{SVG}use")]
    fail = int(np.sum(comparison.converge == 0))
    assert fail > 0
    assert sum(f"stroke: {FORCE}" in each for each in uses) >= fail  # and the legend's, less those out of the frame
    assert sum(f"stroke: {MUTED}" in each for each in uses) > np.sum(comparison.converge > 0)
