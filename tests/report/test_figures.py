"""The pictures: SVG that stands beside other SVG on one page, the same each time, and with all that it should show."""

import re
from collections import Counter
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from firmtouch.mechanics import Scene
from firmtouch.regulation.closed_loop import Positivity
from firmtouch.report.figures import eigenvalue_chart, mechanism_picture, nyquist_picture, s_plane, stiffness_picture
from firmtouch.report.figures.canvas import ARM, FORCE, SURFACE_EDGE

SVG = "{http://www.w3.org/2000/svg}"
XLINK = "{http://www.w3.org/1999/xlink}href"


def parsed(svg: str) -> ET.Element:
    root = ET.fromstring(svg)
    assert root.tag == f"{SVG}svg"
    return root


def ids(svg: str) -> list[str]:
    return [each.get("id") for each in parsed(svg).iter() if each.get("id")]


def words(svg: str) -> list[str]:
    """What is written in the picture: letters are outlines, with the text as a comment before them."""
    return [each.strip() for each in re.findall(r"<!--(.*?)-->", svg)]


def markers(svg: str, colour: str) -> np.ndarray:
    """Where the markers of a colour stand, in the picture's points."""
    found = [
        (float(each.get("x")), float(each.get("y")))
        for group in parsed(svg).iter(f"{SVG}g")
        for each in group.findall(f"{SVG}use")
        if f"stroke: {colour}" in (each.get("style") or "") and each.get("x")
    ]
    return np.array(found).reshape(-1, 2)


def frame(svg: str) -> tuple[np.ndarray, np.ndarray]:
    """The corners of the rectangle outside of which nothing is drawn."""
    rectangle = parsed(svg).find(f".//{SVG}clipPath/{SVG}rect")
    x, y, width, height = (float(rectangle.get(name)) for name in ("x", "y", "width", "height"))
    return np.array([x, y]), np.array([x + width, y + height])


def test_every_figure_is_well_formed_and_refers_to_what_it_holds(report):
    for figure in report.figures:
        known = set(ids(figure.svg))
        references = [each.get(XLINK) or each.get("href") for each in parsed(figure.svg).iter(f"{SVG}use")]
        references += [f"#{each}" for each in re.findall(r"url\(#([^)]+)\)", figure.svg)]
        assert references
        assert {each[1:] for each in references} <= known


def test_ids_are_unique_across_the_figures_of_a_report(report):
    counted = Counter(each for figure in report.figures for each in ids(figure.svg))
    assert [each for each, count in counted.items() if count > 1] == []


def test_a_figure_has_a_caption_a_name_and_a_view_box_to_be_scaled_by(report):
    for figure in report.figures:
        assert figure.alt
        assert figure.caption
        assert 0.3 < figure.width <= 1
        x, y, width, height = map(float, parsed(figure.svg).get("viewBox").split())
        assert (x, y) == (0, 0)
        assert 0.3 < height / width < 1.5


def test_two_drawings_are_identical_to_the_byte(report):
    design = report.design
    again = [
        mechanism_picture(design.scene),
        s_plane(design.achieved, design.requested),
        eigenvalue_chart(design.loop.full, design.loop.tangent),
    ]
    force = design.force_loop
    if force.given:
        gains, modulus = [each.gain for each in force.loops], force.asked.modulus
        again.append(nyquist_picture(force.path, gains, modulus))
        again.append(stiffness_picture(force.sweep, "N/m", force.contact.poles.stiffness.tolist()))
    assert again == [figure.svg for figure in report.figures]


def test_the_mechanism_is_drawn_with_its_links_surfaces_and_forces(report):
    scene, svg = report.design.scene, report.figures[0].svg
    written = words(svg)
    assert {"x, m", "y, m"} <= set(written)
    assert ("z, m" in written) == (scene.dimension == 3)
    sizes = [f"{np.linalg.norm(each.force):.3g} N" for each in scene.forces if np.linalg.norm(each.force) > 1e-9]
    assert sizes
    assert set(sizes) <= set(written)
    assert svg.count(f"stroke: {ARM}") >= len(scene.lines)
    assert FORCE in svg
    if scene.walls or (scene.rounds and scene.dimension == 2):
        assert f"stroke: {SURFACE_EDGE}" in svg


def test_the_force_and_its_label_stay_within_the_picture(report):
    # Everything in the force's colour, as far as its path says: arrow, head and text anchors.
    svg = report.figures[0].svg
    _, _, width, height = map(float, parsed(svg).get("viewBox").split())
    coloured = [each for each in parsed(svg).iter(f"{SVG}path") if FORCE in (each.get("style") or "")]
    assert coloured
    for path in coloured:
        at = np.array(re.findall(r"(-?[0-9.]+) (-?[0-9.]+)", path.get("d")), dtype=float)
        assert np.all(at >= 0)
        assert np.all(at <= [width, height])
    for group in parsed(svg).iter(f"{SVG}g"):
        moved = re.match(r"translate\(([-0-9.]+) ([-0-9.]+)\)", group.get("transform") or "")
        if moved:
            x, y = map(float, moved.groups())
            assert -1 <= x <= width + 1
            assert -1 <= y <= height + 1


POLES = {
    "two real": [-6, -8],
    "a pair": [-4 + 2j, -4 - 2j],
    "hardly damped": [-0.1 + 20j, -0.1 - 20j],
    "far apart": [-1000, -0.01],
    "slow": [-1e-3 + 1e-3j, -1e-3 - 1e-3j],
    "fast": [-3e4, -4e4],
    "repeated": [-5, -5, -5, -5],
    "six": [-4 + 3j, -4 - 3j, -12, -7, -6 + 9j, -6 - 9j],
}


@pytest.mark.parametrize("poles", POLES.values(), ids=list(POLES))
def test_no_pole_is_cut_off_by_the_frame_of_the_plane(poles):
    svg = s_plane([complex(each) for each in poles], [complex(each) for each in poles])
    (left, top), (right, bottom) = frame(svg)
    for colour, radius in ((FORCE, 3.5), (ARM, 5.5)):  # half the size of crosses and rings, in points
        drawn = markers(svg, colour)
        drawn = drawn[(drawn[:, 1] > top) & (drawn[:, 1] < bottom)]  # not those of the legend, above the frame
        assert len(drawn) == len(poles)
        assert np.all(drawn >= [left + radius, top + radius])
        assert np.all(drawn <= [right - radius, bottom - radius])


def test_achieved_poles_far_from_the_requested_ones_are_within_the_frame_too():
    svg = s_plane([-20 + 30j, -20 - 30j], [-1 + 0j, -2 + 0j])
    (left, top), (right, bottom) = frame(svg)
    drawn = markers(svg, FORCE)
    drawn = drawn[drawn[:, 1] > top]
    assert len(drawn) == 2
    assert np.all((drawn > [left, top]) & (drawn < [right, bottom]))


def test_repeated_poles_are_counted_in_words():
    assert "4×" in words(s_plane([-5 + 0j] * 4, [-5 + 0j] * 4))
    assert not [each for each in words(s_plane([-5 + 0j, -6 + 0j], [-5 + 0j, -6 + 0j])) if "×" in each]


def test_crosses_stand_in_their_rings(report):
    svg = s_plane(report.design.achieved, report.design.requested)
    _, top = frame(svg)[0]
    crosses, rings = (sorted(map(tuple, m[m[:, 1] > top])) for m in (markers(svg, FORCE), markers(svg, ARM)))
    assert len(crosses) == len(rings) == len(report.design.requested)
    np.testing.assert_allclose(crosses, rings, atol=0.01)  # SVG holds six decimals of points; poles differ by 1e-6


def positivity(K, C, W, *, holds=True):
    return Positivity(holds, *(np.array(each, dtype=float) for each in (K, C, W)))


def test_every_positive_eigenvalue_has_its_dot_and_the_others_a_red_mark_at_the_edge():
    full = positivity([-2, 3, 40], [1, 5, 9], [0.1, 2, 30], holds=False)
    tangent = positivity([3, 40], [5, 9], [2, 30])
    svg = eigenvalue_chart(full, tangent)
    (left, top), (right, bottom) = frame(svg)
    bad = markers(svg, FORCE)
    assert len(bad) == 1
    inside = [each for each in markers(svg, ARM) if top < each[1] < bottom]
    assert len(inside) == 8 + 6
    assert np.all(np.array(inside)[:, 0] > left)
    assert np.all(np.array(inside)[:, 0] < right)


@pytest.mark.parametrize(
    "values", [[-1.0, -2.0], [1e-14, 1e9], [0.0, 1.0], [5.0, 5.0]], ids=["none", "wide", "zero", "equal"]
)
def test_a_chart_is_drawn_whatever_the_eigenvalues(values):
    level = positivity(values, values, values, holds=min(values) > 0)
    assert {"K", "C", "W"} <= set(words(eigenvalue_chart(level, level)))


def test_a_scene_without_surface_or_force_is_drawn():
    scene = Scene(2, (np.array([[0.0, 0.0], [1.0, 0.5]]),))
    assert "x, m" in words(mechanism_picture(scene))
