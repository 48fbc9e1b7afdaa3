"""What the report and `design.json` tell of the force loop, and its two pictures."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from tests.report.test_figures import frame, markers, parsed, words

from firmtouch.regulation.force_loop import ForcePath, contact_stiffness_sweep
from firmtouch.report import verdict
from firmtouch.report.contents import force_loop
from firmtouch.report.document import Equation, Figure, Math, Paragraph, Table
from firmtouch.report.figures import nyquist_picture, stiffness_picture
from firmtouch.report.figures.canvas import ARM, FORCE, GOOD

MS = 1e-3
PATH = {"bandwidth": "500 rad/s", "delay": "1 ms", "margins": {"gain": 2, "delay": "1 ms", "modulus": 0.5}}


def text(line):
    return "".join(
        each if isinstance(each, str) else each.typst if isinstance(each, Math) else each.text for each in line
    )


def told(section):
    return " ".join(text(each.line) for each in section.blocks if isinstance(each, Paragraph))


@pytest.fixture(scope="module")
def late(pendulum_with):
    return pendulum_with(force_path=PATH | {"contact_stiffness": "10 kN/m"})


def test_without_a_force_path_the_section_is_short_and_says_what_to_give(shipped_report):
    report = shipped_report("pendulum_rod")
    section = force_loop.section(report.design)
    assert "only with" not in verdict(report.design)
    assert "[T7]" in told(section)
    assert "force_path" in told(section)
    assert "All poles are stable" in told(section)
    assert not [each for each in section.blocks if isinstance(each, Table | Figure)]


def test_the_table_tells_each_loop_against_what_is_asked(late):
    section, (loop,) = force_loop.section(late.design), late.design.force_loop.loops
    (table,) = (each for each in section.blocks if isinstance(each, Table))
    first, asked, kept = ([text(cell) for cell in row] for row in table.rows)
    assert first[:3] == ["1", "0.6", "3.807"]  # the bound of [T8]
    assert float(first[3]) == pytest.approx(loop.gain_margin, rel=5e-3)  # three figures
    assert first[4] == "any delay"  # below 1
    assert asked == ["asked", "", "", "≥ 2", "≥ 1 ms", "≥ 0.5"]
    assert kept == ["kept", "", "", "yes", "yes", "yes"]


def test_an_unstable_loop_is_told_as_such(pendulum_with):
    report = pendulum_with(force_path=PATH, design={"force_feedback": 5})
    (table,) = (each for each in force_loop.section(report.design).blocks if isinstance(each, Table))
    first, _, kept = ([text(cell) for cell in row] for row in table.rows)
    assert first[4:] == ["unstable", "unstable"]
    assert kept[3:] == ["NO", "NO", "NO"]
    assert any("The force loop is unstable" in each for each in report.design.warnings)
    assert "only with a force signal that came at once, after any small disturbance" in verdict(report.design)


@pytest.mark.parametrize(
    ("path", "formula", "sentence"),
    [
        (ForcePath(lag=2 * MS), "L(s) = 1 / (1 + s tau_f)", "a low-pass of 79.6 Hz (a lag of 2 ms)"),
        (ForcePath(delay=MS), "L(s) = e^(-s tau)", "a delay of 1 ms"),
        (ForcePath(sample=MS), "L(z) = z^(-1)", "samples every 1 ms"),
        (ForcePath(sample=MS, delay=2 * MS), "L(z) = z^(-3)", "a further delay of 2 ms (2 samples)"),
    ],
)
def test_the_path_is_told_in_words_and_as_a_formula(late, path, formula, sentence):
    section = force_loop.section(replace(late.design, force_loop=replace(late.design.force_loop, path=path)))
    assert formula in [each.typst for each in section.blocks if isinstance(each, Equation)]
    assert sentence in told(section)


def test_the_contact_is_told_with_its_unstable_stiffnesses_and_the_files_own(late):
    section, force = force_loop.section(late.design), late.design.force_loop
    (span,) = force.sweep.unstable
    assert f"The loop is unstable from {float(f'{span.low:.2e}'):.0f} to 7.93×10⁶ N/m." in told(section)
    assert span.high == pytest.approx(7.93e6, rel=1e-3)
    assert "For the contact of the file, 10000 N/m, the loop is unstable" in told(section)
    assert f"unstable from g = {force.contact.critical_gain:.4g} on" in told(section)
    assert any("contact_stiffness" in each for each in late.design.warnings)
    assert "only with a rigid contact, after any small disturbance" in verdict(late.design)


def test_the_figures_are_those_of_the_design(late):
    nyquist, stiffness = (each for each in force_loop.section(late.design).blocks if isinstance(each, Figure))
    assert {"g L for g = 0.6", "modulus margin asked: 0.5"} <= set(words(nyquist.svg))
    assert {"contact of the file", "unstable", "poles of (38)"} <= set(words(stiffness.svg))


def test_the_nyquist_curve_begins_at_g_and_crosses_the_axis_at_g_over_the_bound():
    svg = nyquist_picture(ForcePath(sample=MS, lag=2 * MS), [2.0])
    curve = next(
        each
        for each in parsed(svg).iter()
        if f"stroke: {ARM}" in (each.get("style") or "") and "clip-path" in each.attrib
    )
    points = np.array(re.findall(r"(-?[0-9.]+) (-?[0-9.]+)", curve.get("d")), dtype=float)
    (_, top), _ = frame(svg)
    ((x, y),) = (each for each in markers(svg, FORCE) if each[1] > top)  # -1, and not its sign in the legend
    one = (points[0, 0] - x) / 3  # from -1 to g = 2
    a = math.exp(-0.5)
    assert points[0, 1] == pytest.approx(y, abs=0.01)  # SVG holds six decimals of points
    assert (points[-1, 0] - x) / one - 1 == pytest.approx(-2 * (1 - a) / (1 + a), abs=1e-3)
    assert GOOD not in svg


@pytest.mark.parametrize(
    ("path", "gains"),
    [
        (ForcePath(), [0.0]),
        (ForcePath(lag=MS), [1000.0]),
        (ForcePath(delay=MS), [0.1 * i for i in range(1, 9)]),
        (ForcePath(sample=MS), [0.5, 0.5, 0.7]),
    ],
)
def test_a_nyquist_picture_is_drawn_whatever_the_gains_and_shows_minus_one(path, gains):
    svg = nyquist_picture(path, gains, 0.5)
    (left, top), (right, bottom) = frame(svg)
    inside = [each for each in markers(svg, FORCE) if left < each[0] < right and top < each[1] < bottom]
    assert len(inside) == 1
    assert len([each for each in words(svg) if each.startswith("g L")]) == min(
        len(set(gains)), 2 if len(gains) > 4 else 4
    )


def test_every_stiffness_has_its_poles_of_38_in_the_picture(shipped_report):
    loop = shipped_report("planar_2r_wall").design.loop
    sweep = contact_stiffness_sweep(loop, None)
    svg = stiffness_picture(sweep, "N/m", [1e4], decay=5.0)
    (left, top), (right, bottom) = frame(svg)
    drawn = [each for each in markers(svg, ARM) if top < each[1] < bottom]
    assert len(drawn) == 2 * len(sweep.points)
    assert all(left - 0.01 <= each[0] <= right + 0.01 for each in drawn)
    assert "decay rate asked" in words(svg)


def test_design_json_has_the_force_loop_in_plain_numbers(late):
    data, force = late.json["force_loop"], late.design.force_loop
    assert data["path"] == {"given": True, "delay": 1e-3, "lag": 2e-3, "sample": 0.0}
    (loop,) = data["loops"]
    assert loop["bound"] == pytest.approx(3.80688, abs=5e-6)
    assert loop["gain_margin"] == pytest.approx(loop["bound"] / loop["gain"], rel=1e-15)
    assert loop["delay_margin"] is None  # infinite
    assert data["asked"]["gain"] == {"asked": 2.0, "least": loop["gain_margin"], "kept": True}
    sweep = data["sweep"]
    assert len(sweep["stiffness"]) == len(sweep["poles"]) == len(sweep["stable"]) == len(force.sweep.points)
    for poles, stable in zip(sweep["poles"], sweep["stable"], strict=True):
        assert stable == (max(real for real, _ in poles) < 0)
    assert sweep["unstable"] == [[each.low, each.high] for each in force.sweep.unstable]
    assert data["contact"]["poles"]["stiffness"] == [1e4]
    assert data["contact"]["critical_gain"] == force.contact.critical_gain


def test_design_json_without_a_force_path_has_an_ideal_one(shipped_report):
    data = shipped_report("pendulum_rod").json["force_loop"]
    assert data["path"] == {"given": False, "delay": 0.0, "lag": 0.0, "sample": 0.0}
    assert data["admissible"] is None
    assert data["contact"] is None
    assert data["asked"] == {}
