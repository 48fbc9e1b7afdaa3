"""The report of a thermal study: what it says is what was found, and it can be read."""

import functools
import io
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmtouch.report import render_html, render_pdf, study_document, study_verdict
from firmtouch.report.document import Callout, Document, Figure, Section, Table
from firmtouch.report.figures.canvas import styled
from firmtouch.report.figures.front import Axis, Tradeoff, front_chart
from firmtouch.report.figures.thermal import (
    Band,
    BodeCurve,
    BodePanel,
    Curve,
    Panel,
    Plane,
    StackView,
    bode_picture,
    draw_stack,
    responses_picture,
    stack_picture,
)
from firmtouch.report.figures.thermal.heights import readable_heights
from firmtouch.report.thermal.stack_view import stack_view
from firmtouch.report.thermal.words import quantity
from firmtouch.thermal.analysis import analyse
from firmtouch.thermal.sensorfile import parse_sensor
from firmtouch.thermal.study import Study, study_sensor

MODELS = Path(__file__).parents[2] / "models" / "thermal"
ROUNDED = 6e-3  # three figures: at most 5e-3 of 1.00
ALWAYS = [
    "",
    "Requirements",
    "The sensor",
    "Step responses",
    "Frequency response",
    "Heat",
    "Tolerances",
    "Parts and materials",
]
LOOP = """
schema: firmtouch.sensor/1
title: TITLE
stack:
  - {name: cover, material: parylene_c, thickness: 2 um}
  - {name: film, film: {material: platinum, thickness: 100 nm, resistance: 100 ohm, coefficient: 0.4 %/K}, sensed: true}
  - {name: foam, material: foam_backing, thickness: 1 mm, heated: true}
backing: base
contact: 1e4 W/m^2/K
objects: [softwood, copper]
temperatures: {object: 22 degC, sensor: 36 degC}
pad: {radius: 0.5 mm, pitch: 2 mm}
"""
ELECTRONICS = """
electronics: {bridge_voltage: 0.2 V, noise_density: 10 nV/sqrt(Hz), sampling: 1 kHz}
requirements:
  rise_time: {at_most: 100 ms, metric: 10-90, window: 0.5 s}
  discrimination: {pairs: [[copper, softwood]], time: 10 ms}
  crosstalk: 10 %
"""
SEARCH = """
search:
  stack: {cover: {thickness: [1 um, 12 um]}}
  drive: {mode: [constant_power, constant_temperature], loop_gain: [10 kW/m^2/K, 100 kW/m^2/K]}
  objective: rise_time
  front: [rise_time, power, discrimination]
  evaluations: 60
"""


def study_of(text: str, title: str = "A sensor") -> Study:
    return study_sensor(parse_sensor(text.replace("TITLE", title).encode(), name="sensor"))


@functools.cache
def shipped(name: str) -> Study:
    return Study(analyse(parse_sensor((MODELS / f"{name}.yaml").read_bytes(), name=name)))


@functools.cache
def looped() -> Study:
    in_place = LOOP.replace("thickness: 1 mm, heated: true", "thickness: 1 mm")
    return study_of(in_place + "drive: {mode: constant_temperature, loop_gain: 3e4 W/m^2/K}" + ELECTRONICS)


@functools.cache
def document_of(study: Study) -> Document:
    return study_document(study)


def titles(study: Study) -> list[str]:
    return [each.title for each in document_of(study).sections]


def section(study: Study, title: str) -> Section:
    return next(each for each in document_of(study).sections if each.title == title)


def text_of(line) -> str:
    return "".join(getattr(each, "text", getattr(each, "typst", each)) for each in line)


def tables(found: Section) -> list[list[list[str]]]:
    return [[[text_of(cell) for cell in row] for row in each.rows] for each in found.blocks if isinstance(each, Table)]


PREFIX = {"G": 1e9, "M": 1e6, "k": 1e3, "m": 1e-3, "µ": 1e-6, "n": 1e-9, "p": 1e-12}
POWERS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")


def read(text: str, unit: str) -> float:
    """Read a size as it is written, by other means than those that wrote it."""
    number, _, its_unit = text.strip("+≤≥ ").replace("−", "-").partition(" ")
    mantissa, _, power = number.partition("×10")
    scale = 1.0 if its_unit == unit else 0.01 if its_unit == "%" else PREFIX[its_unit.removesuffix(unit)]
    return float(mantissa) * 10 ** int(power.translate(POWERS) or 0) * scale


@given(st.floats(1e-11, 9e8), st.sampled_from(["s", "m", "W", "K", "V", "J/m^2/K"]))
def test_a_quantity_reads_back_as_what_it_was(value, unit):
    words = quantity(value, unit)
    assert len(words) < 22
    assert read(words, {"J/m^2/K": "J/m²K"}.get(unit, unit)) == pytest.approx(value, rel=ROUNDED)


def test_sections_stand_in_their_order_and_only_where_there_is_something_to_say():
    assert titles(looped()) == [*ALWAYS[:5], "Telling objects apart", "Neighbours", *ALWAYS[5:], "How it is computed"]
    assert titles(shipped("fingertip_chip")) == [*ALWAYS[:2], "What binds", *ALWAYS[2:], "How it is computed"]


@pytest.mark.slow
def test_a_sensor_without_a_pitch_has_no_neighbours_and_one_that_is_asked_nothing_says_so():
    assert "Telling objects apart" in titles(shipped("biotac_like"))
    assert "Neighbours" not in titles(shipped("biotac_like"))
    bare = study_of(LOOP.replace(", heated: true", "").replace(", pitch: 2 mm", ""))
    assert titles(bare) == [*ALWAYS, "How it is computed"]
    assert "asks nothing" in str(section(bare, "Requirements").blocks)
    assert study_verdict(bare).startswith("Nothing is asked")


def test_the_requirements_table_says_what_the_outcomes_are():
    for study in (looped(), shipped("fingertip_chip")):
        (rows,) = tables(section(study, "Requirements"))
        assert len(rows) == len(study.analysis.outcomes)
        for row, each in zip(rows, study.analysis.outcomes, strict=True):
            assert row[4] == ("yes" if each.met else "no")
            assert row[1][0] == ("≤" if each.at_most else "≥")
            if each.name == "surface_temperature":
                assert read(row[2], "°C") == pytest.approx(each.reached - 273.15, abs=0.006)  # two decimals
            else:
                unit = "" if each.unit == "1" else each.unit
                assert read(row[1], unit) == pytest.approx(each.asked, rel=ROUNDED)
                assert read(row[2], unit) == pytest.approx(each.reached, rel=ROUNDED)
                assert read(row[3], unit) == pytest.approx(each.margin, rel=ROUNDED)


def test_the_responses_tables_say_what_the_responses_are():
    for study in (looped(), shipped("fingertip_chip")):
        rows = [row for table in tables(section(study, "Step responses")) for row in table]
        assert len(rows) == len(study.analysis.responses)
        for row, each in zip(rows, study.analysis.responses, strict=True):
            assert row[0] == each.scenario.object
            assert read(row[2], "") == pytest.approx(each.scenario.touch.conductance, rel=ROUNDED)
            for cell, value in ((row[3], each.rise_10_90), (row[4], each.rise_63), (row[7], each.recovery)):
                assert read(cell, "s") == pytest.approx(value, rel=ROUNDED)
            assert read(row[5], {"K": "K", "W/m^2": "W/m²"}[each.unit]) == pytest.approx(each.end_value, rel=ROUNDED)
            assert read(row[6], "") == pytest.approx(each.gain, rel=ROUNDED)


def test_margins_models_pairs_and_heat_are_those_of_the_analysis():
    analysis = looped().analysis
    _, margins, models = tables(section(looped(), "Frequency response"))
    assert [row[0] for row in margins] == ["nothing", "softwood", "copper"]
    for row, each in zip(margins, analysis.spectra.loops, strict=True):
        assert float(row[4]) == pytest.approx(each.modulus_margin, rel=ROUNDED)
        assert float(row[3].rstrip("°")) == pytest.approx(np.degrees(each.phase_margin), rel=ROUNDED)
    for row, each in zip(models, analysis.rational, strict=True):
        assert int(row[1]) == each.reduction.poles.size
        assert read(row[4], "") == pytest.approx(each.reduction.error, rel=0.06)  # two figures
    pairs, _ = tables(section(looped(), "Telling objects apart"))
    assert read(pairs[0][2], "") == pytest.approx(analysis.discrimination[0].d_prime, rel=ROUNDED)
    (heat,) = tables(section(looped(), "Heat"))
    by_name = {row[0]: row[1] for row in heat}
    assert read(by_name["most power by area"], "W/m²") == pytest.approx(analysis.heat.most, rel=ROUNDED)
    assert read(by_name["power that holds the face, by area"], "W/m²") == pytest.approx(analysis.heat.hold, rel=ROUNDED)


def test_what_binds_is_said_in_words():
    told = str(section(shipped("fingertip_chip"), "What binds").blocks)
    relief = shipped("fingertip_chip").analysis.binding.together[0]
    assert relief.term == "film capacity"
    assert (
        f"Film capacity: 3080 J/m²K now; {quantity(relief.needed, 'J/m^2/K')} would do, the others being ideal" in told
    )


def test_the_verdict_is_one_sentence_and_sets_the_mood():
    cases = (
        (looped(), "All 3 requirements are met", "good"),
        (shipped("fingertip_chip"), "Not met: 1 of 2", "warning"),
    )
    for study, start, mood in cases:
        words = study_verdict(study)
        assert words.startswith(start)
        assert words.endswith(".")
        assert ". " not in words
        callout = document_of(study).sections[0].blocks[0]
        assert callout == Callout(mood, (words,))


def bands(count: int) -> tuple[Band, ...]:
    name = "A_NAME_OF_32_WIDE_LETTERS_WWWWWW"
    sizes = [3e-7, 2e-6, 1e-3, 5e-5, 8e-6]
    return tuple(
        Band(name, name[::-1], sizes[i % 5], quantity(sizes[i % 5], "m"), "layer")
        if i % 4 != 2
        else Band(name, "", None, "0.285 J/m²K", "film")
        for i in range(count)
    )


def view_of(count: int, sensed: Plane, heated: Plane | None, backing: str = "base") -> StackView:
    touched = ", ".join(["steel_304"] * 100)
    return StackView(touched, "contact, h = 3 kW/m²K to 30 kW/m²K", bands(count), sensed, heated, "x" * 90, backing)


VIEWS = {
    "one layer": view_of(1, Plane(0, inner=True), Plane(0, inner=True), "air"),
    "neighbouring planes": view_of(4, Plane(2, inner=False), Plane(1, inner=True), "adiabatic"),
    "thirty": view_of(30, Plane(2, inner=False), Plane(3, inner=True), "half_space"),
    "thirty, one plane": view_of(30, Plane(29, inner=True), None),
}


@pytest.mark.parametrize("name", [*VIEWS, "fingertip_chip"])
def test_words_of_a_stacks_picture_meet_neither_each_other_nor_its_edge(name):
    from matplotlib.backends.backend_svg import RendererSVG

    view = VIEWS.get(name) or stack_view(shipped(name).analysis)
    with styled():
        figure = draw_stack(view)
        figure.set_dpi(72)
        renderer = RendererSVG(*figure.bbox.size, io.StringIO(), image_dpi=72)  # as it is written, without hinting
        boxes = [each.get_window_extent(renderer) for each in figure.axes[0].texts]
    assert len(boxes) >= 4 + 2 * len(view.bands)
    inside = figure.bbox
    for i, a in enumerate(boxes):
        assert inside.x0 <= a.x0
        assert a.x1 <= inside.x1
        assert inside.y0 <= a.y0
        assert a.y1 <= inside.y1
        assert not any(a.overlaps(b) for b in boxes[i + 1 :])


@given(st.lists(st.one_of(st.none(), st.floats(1e-8, 1e-1)), min_size=1, max_size=30))
def test_heights_are_to_one_scale_but_for_what_is_said_to_be_cut_or_raised(thicknesses):
    row = 0.17
    room = max(2.3, 1.02 * row * len(thicknesses))
    found = readable_heights(thicknesses, room, row)
    assert sum(found.heights) <= room * (1 + 1e-9)
    assert min(found.heights) >= row * (1 - 1e-9)
    assert not found.cut & found.raised
    for i, (height, thickness) in enumerate(zip(found.heights, thicknesses, strict=True)):
        if i in found.cut:
            assert height < thickness * found.scale
        elif i in found.raised:
            assert height == pytest.approx(row)
        else:
            assert height == pytest.approx(thickness * found.scale, rel=1e-6)  # bisection


HOSTILE = '<script>alert(1)</script> $ \\frac{1 #eval("1") *bold* `raw` & \\u{1}'


def test_hostile_texts_are_shown_as_they_are():
    text = LOOP.replace(", heated: true", "") + "\n".join(  # noqa: FLY002
        [
            "drive: constant_power",
            "materials:",
            "  evil_: {title: 'TITLE', k: 1 W/m/K, rho: 1000 kg/m^3, c: 1000 J/kg/K, tolerance: 9 %, source: 'TITLE'}",
        ]
    ).replace("TITLE", HOSTILE)
    text = text.replace("title: TITLE", f"title: '{HOSTILE}'").replace("[softwood, copper]", "[evil_, copper]")
    document = study_document(study_of(text))
    html = render_html(document)
    assert "<script" not in html
    assert html.count("&lt;script&gt;") >= 4  # title and heading, title and source of the material
    assert document.title == HOSTILE
    assert render_pdf(document).startswith(b"%PDF")


def test_names_in_pictures_are_no_formulas():
    name = r"$\frac{_"
    t = np.geomspace(1e-4, 1, 9)
    curve = Curve(t, 1 - np.exp(-10 * t), ((0.01, 0.1), (0.2, 0.9)))
    view = StackView(name, "h", (Band(name, name, 1e-3, name, "layer"),), Plane(0, inner=True), None, name, "base")
    bode = BodeCurve(name, t, t, -t)
    for svg in (
        stack_picture(view),
        responses_picture([name], [Panel(name, (curve,))], 0.1),
        bode_picture([name], [BodePanel(name, (bode,))]),
    ):
        assert r"$\frac{" in svg  # the words stand in a comment before their outlines


def test_the_page_asks_no_network_and_is_the_same_each_time():
    study = shipped("fingertip_chip")
    first, second = study_document(study), study_document(study)
    html = render_html(first)
    links = re.findall(r'(?:src|href|url)\s*[=(]\s*["\']?([^"\')\s>]+)', html)
    assert links
    assert all(each.startswith(("#", "data:")) for each in links)
    assert first == second
    assert html == render_html(second)
    assert render_pdf(first) == render_pdf(second)


def test_a_thermal_report_loads_nothing_of_mechanisms():
    code = (
        "import sys; from firmtouch.report import render_html, render_pdf, study_document, study_verdict;"
        "print(sorted({'casadi', 'sympy', 'cvxpy', 'firmtouch.mechanics', 'firmtouch.design'} & set(sys.modules)))"
    )
    found = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert found.stdout.strip() == "[]"


def test_a_front_of_three_objectives_is_told_by_colours():
    x, y = Axis("rise time", "ms", (0.2, 1.0, 9.0)), Axis("power", "mW", (90.0, 50.0, 40.0))
    svg = front_chart(Tradeoff(x, y, (0.2, 90.0), Axis("d′", "", (5.0, 7.0, 6.0))))
    words = re.findall(r"<!--(.*?)-->", svg)
    assert {" rise time, ms ", " power, mW ", " d′ ", " this design "} <= set(words)
    assert not any("least" in each for each in words)


@pytest.mark.slow
def test_a_search_says_what_was_chosen_and_what_it_costs():
    study = study_of(
        LOOP.replace(", heated: true", "")
        + ELECTRONICS.replace("crosstalk: 10 %", "")
        + "drive: {mode: constant_temperature, loop_gain: 3e4 W/m^2/K}\n"
        + SEARCH
    )
    found = study.search
    assert found is not None
    assert "Search" in titles(study)
    variables, designs = tables(section(study, "Search"))
    for row, each in zip(variables, found.variables, strict=True):
        value = found.chosen.values[each.path]
        assert row[0] == each.name
        if isinstance(value, str):
            assert row[2] == value
        else:
            assert read(row[2], {"m": "m", "W/m^2/K": "W/m²K"}[each.unit]) == pytest.approx(value, rel=ROUNDED)
            at = {each.low: "at its lower bound", each.high: "at its upper bound"}
            assert row[3] == at.get(value, "")
    assert study_verdict(study).startswith(f"{found.met} of {found.tried} designs")
    assert any(read(row[0], "s") == pytest.approx(found.chosen.figures["rise_time"], rel=ROUNDED) for row in designs)
    assert sum(isinstance(each, Figure) for each in section(study, "Search").blocks) == 1


@pytest.mark.slow
@pytest.mark.parametrize("name", ["fingertip_film", "array_20x20"])
def test_the_larger_models_are_reported_whole(name):
    document = document_of(shipped(name))
    assert {"Telling objects apart", "Neighbours"} <= set(titles(shipped(name)))
    assert render_html(document).count("<figure") == 3
    assert render_pdf(document).startswith(b"%PDF")


@pytest.mark.slow
@pytest.mark.browser
@pytest.mark.parametrize("width", [390, 1280])
def test_the_page_fits_a_phone_and_a_desk(browser, tmp_path, width):
    path = tmp_path / "report.html"
    path.write_text(render_html(document_of(looped())), encoding="utf-8")
    context = browser.new_context(viewport={"width": width, "height": 844})
    page = context.new_page()
    page.goto(path.as_uri(), wait_until="load")
    found = page.evaluate(
        "() => [document.scrollingElement.scrollWidth, document.querySelectorAll('figure svg').length]"
    )
    context.close()
    assert found[0] <= width
    assert found[1] == 3
