"""The report of a region design: what was asked and reached, for which plants, with which margins, in all formats."""

import math
import re
import subprocess
import sys
from dataclasses import replace
from html.parser import HTMLParser
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from firmtouch.report import design_document, render_html, render_pdf, verdict
from firmtouch.report.contents.specification import tradeoff
from firmtouch.report.document import Code, Document, Figure, Math, Matrices, Paragraph, Section, Strong, Table
from firmtouch.report.figures import front_chart, region_plane
from firmtouch.report.figures.canvas import ARM, FORCE, GOOD
from firmtouch.report.numbers import number
from firmtouch.synthesis.region.front import Front, FrontPoint
from firmtouch.synthesis.region.margins import Interval
from firmtouch.synthesis.region.programme import Status

SVG = "{http://www.w3.org/2000/svg}"
REGION = {"decay": 4, "damping": 0.6, "bandwidth": "30 rad/s"}
COST = {"position": "0.05 rad", "torque": "10 N*m", "start_position": "0.1 rad", "start_velocity": "0.5 rad/s"}
FORCES = {"lambda_d": {"box": {"pipe": "5 N"}}}


@pytest.fixture(scope="module")
def full(arm_in_region):
    return arm_in_region(REGION, front=("gains", "margin"))


@pytest.fixture(scope="module")
def diagonal(arm_in_region):
    return arm_in_region(REGION | {"structure": "diagonal"})


@pytest.fixture(scope="module")
def alone(arm_in_region):
    """One plant, structured gains, and a cost that is made small without a bound."""
    region = {"cost": COST, "objective": "cost", "structure": {"banded": 1}, "uncertainty": {"parameters": []}}
    return arm_in_region(region)


@pytest.fixture(scope="module")
def shaped(arm_in_region):
    """Free normal blocks, D instead of a number, and forces that vary."""
    stiffness = {"q1": "5 N*m/rad", "q2": "4 N*m/rad", "q3": "2 N*m/rad"}
    region = REGION | {"positivity": stiffness, "uncertainty": {"parameters": ["m3"], **FORCES}}
    return arm_in_region(region, normal_blocks="free")


@pytest.fixture(params=["full", "diagonal", "alone", "shaped"])
def any_report(request):
    return request.getfixturevalue(request.param)


def section(report, title: str) -> Section:
    return next(each for each in report.document.sections if each.title == title)


def titles(document: Document) -> list[str]:
    return [each.title for each in document.sections]


def plain(line) -> str:
    """The text of a line, with formulas as they are written."""
    return "".join(
        each.typst if isinstance(each, Math) else each.text if isinstance(each, Strong | Code) else each
        for each in line
    ).replace("\u00a0", " ")


def tables(report, title: str) -> list[list[list[str]]]:
    blocks = [each for each in section(report, title).blocks if isinstance(each, Table)]
    return [[[plain(cell) for cell in row] for row in (each.headings, *each.rows)] for each in blocks]


def words_of(report, title: str) -> str:
    return " ".join(plain(each.line) for each in section(report, title).blocks if isinstance(each, Paragraph))


def in_frame(svg: str, colour: str) -> list[tuple[float, float]]:
    """Where markers of a colour stand within the axes; those of the legend stand above them."""
    root = ET.fromstring(svg)
    rectangle = root.find(f".//{SVG}clipPath/{SVG}rect")
    x, y, width, height = (float(rectangle.get(name)) for name in ("x", "y", "width", "height"))
    drawn = [
        (float(each.get("x")), float(each.get("y")))
        for group in root.iter(f"{SVG}g")
        for each in group.findall(f"{SVG}use")
        if f"stroke: {colour}" in (each.get("style") or "") and each.get("x")
    ]
    return [(a, b) for a, b in drawn if x < a < x + width and y < b < y + height]


def written(svg: str) -> list[str]:
    return [each.strip() for each in re.findall(r"<!--(.*?)-->", svg)]


def test_the_sections_stand_in_the_order_in_which_one_reads(full):
    wanted = ["", "Model", "Operating point", "Specification", "Gains", "Poles", "Positivity", "Uncertainty", "Margins"]
    assert titles(full.document) == [*wanted, "Force loop", "Steady-state errors", "Certificate", "Model checks"]


def test_a_design_by_poles_has_none_of_these_sections_and_loads_no_solver(shipped_report):
    pendulum = shipped_report("pendulum_rod")
    assert pendulum.design.region is None
    assert {"Specification", "Uncertainty", "Margins"}.isdisjoint(titles(pendulum.document))
    code = "import sys, firmtouch.cli, firmtouch.report; assert 'cvxpy' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_the_specification_tells_of_every_term_what_was_asked_and_reached(any_report):
    region = any_report.design.region
    (head, *rows), *_ = tables(any_report, "Specification")
    assert head[:4] == ["", "asked", "reached", "margin"]
    assert [row[0] for row in rows] == [each.term.name for each in region.results]
    for row, result in zip(rows, region.results, strict=True):
        if result.term.name == "mixed blocks":
            assert row[1] == "as chosen"
            assert number(result.reached, 2) in row[2]
            assert row[3] == ""
        elif math.isinf(result.term.asked):
            assert (row[1], row[3]) == ("as small as possible", "")
        else:
            assert number(result.term.asked) in row[1]
            assert row[1][0] in ("≤" if result.term.at_most else "≥>")
            assert row[3].startswith(number(result.margin))
            assert row[2].startswith(number(result.reached))


def test_the_worst_vertex_is_named_where_there_are_several(full, alone):
    (head, *rows), *_ = tables(full, "Specification")
    assert head[4] == "worst at"
    vertices = full.design.region.problem.polytope.vertices
    for row, result in zip(rows, full.design.region.results, strict=True):
        assert row[4] == ("nominal plant" if result.term.nominal else str(vertices[result.worst_vertex]))
    (head, *_), *_ = tables(alone, "Specification")
    assert len(head) == 4


def test_only_the_inequalities_that_were_asked_for_are_written(full, alone):
    equations = [each for each in section(full, "Specification").blocks if type(each).__name__ == "Equation"]
    assert len(equations) == 1 + 3
    assert {each.source for each in equations} == {"[T4]"}
    assert not [each for each in section(alone, "Specification").blocks if type(each).__name__ == "Equation"]


def test_the_structure_is_shown_as_a_pattern_unless_the_matrices_are_full(full, diagonal, alone):
    assert not [each for each in section(full, "Specification").blocks if isinstance(each, Matrices)]
    for report in (diagonal, alone):
        (block,) = [each for each in section(report, "Specification").blocks if isinstance(each, Matrices)]
        shown = tuple(tuple(entry == "•" for entry in row) for row in block.matrices[0].rows)
        assert shown == report.design.region.problem.structure.pattern


def test_it_says_how_the_gains_were_found(full, diagonal):
    told, record = words_of(full, "Specification"), full.design.region.search
    assert record.stage == "convex"
    assert f"{number(record.epsilon)} 1/s" in told
    assert f"{record.solves} semidefinite programmes" in told
    assert "small gains" in told
    others = words_of(diagonal, "Specification")
    assert diagonal.design.region.search.stage == "alternation"
    assert "alternation" in others
    assert "not the best ones" in others
    assert "have no solution for any" in others


def test_the_words_fit_pole_assignment_as_a_rescue_too(full):
    region = full.design.region
    design = replace(full.design, region=replace(region, search=replace(region.search, stage="poles")))
    assert "pole assignment" in str(design_document(design).sections)
    trouble = replace(region.search, stage="poles", status=Status.TROUBLE)
    design = replace(full.design, region=replace(region, search=trouble))
    assert Status.TROUBLE.value in str(design_document(design).sections)


def test_the_uncertainty_lists_every_vertex_and_the_nominal_plant(full):
    region = full.design.region
    ranges, (_, *rows) = tables(full, "Uncertainty")
    assert ranges[1] == ["m_(3)", "2 to 3 kg", "2.4 kg", "mass of the hand with its tool"]
    loops = [*region.vertices, region.loop]
    assert [row[0] for row in rows] == ["m3 = 2", "m3 = 3", "nominal plant"]
    for row, loop in zip(rows, loops, strict=True):
        poles = np.array(loop.poles.pencil)
        figures = (np.min(-poles.real / np.abs(poles)), np.min(-poles.real), np.max(np.abs(poles)), loop.full.K[0])
        assert row[1:] == [number(float(each)) for each in figures]


def test_forces_that_vary_stand_beside_the_parameters(shaped):
    ranges, _ = tables(shaped, "Uncertainty")
    assert ranges[2][:3] == ["lambda_d of pipe", "25 to 35 N", "30 N"]
    assert "every m3 from 2 to 3 kg and lambda_d in its range" in verdict(shaped.design)


def test_of_many_vertices_the_least_damped_are_listed(full):
    region = full.design.region
    polytope = region.problem.polytope
    many = replace(
        region,
        problem=replace(region.problem, polytope=replace(polytope, vertices=polytope.vertices * 10, enlargement=1.5)),
        vertices=region.vertices * 10,
    )
    document = design_document(replace(full.design, region=many))
    uncertainty = next(each for each in document.sections if each.title == "Uncertainty")
    table = [each for each in uncertainty.blocks if isinstance(each, Table)][1]
    assert len(table.rows) == 12 + 1
    assert sum(plain(row[0]) == "m3 = 3" for row in table.rows) == 10  # the less damped of the two
    assert "Of the 20 vertices" in plain(table.caption)
    assert any("1.5" in plain(each.line) for each in uncertainty.blocks if isinstance(each, Paragraph))


def test_one_plant_alone_has_no_uncertainty(alone):
    assert len(alone.design.region.vertices) == 1
    assert "Uncertainty" not in titles(alone.document)
    assert "for every" not in verdict(alone.design)


def test_the_margins_hold_the_numbers_of_the_value(full):
    margins = full.design.region.margins
    (_, *rows), (_, *edges) = tables(full, "Margins")
    borne = {row[0]: row[1] for row in rows}
    assert borne["(14): mu"] == f"{number(margins.mu)} N m/rad"
    assert borne["lambda_d"] == f"up to {number(margins.lambda_d)} N"
    assert borne["N_0"] == f"up to {number(100 * margins.N0)} %"
    tolerated = margins.parameters["m3"]
    assert borne["m_(3)"] in (f"{number(tolerated.low)} to {number(tolerated.high)} kg", "as asked, no more")
    assert "asked: 2 to 3 kg" in next(row[2] for row in rows if row[0] == "m_(3)")
    for row, edge in zip(edges, margins.edges, strict=True):
        assert row[0] == edge.term
        assert row[2].startswith(number(edge.slack))
        assert number(edge.pole.real) in row[3]
        assert row[4] == str(full.design.region.problem.polytope.vertices[edge.vertex])


@pytest.mark.parametrize(
    ("interval", "words"),
    [
        (Interval(0.5, 2.0), "0.5 to 2"),
        (Interval(0.5, math.inf), "from 0.5, no limit found up to 64"),
        (Interval(0.0, 2.0), "no limit found down to 1/64, up to 2"),
        (Interval(1.0, math.inf), "from 1, no limit found up to 64"),
        (Interval(1.0, 1.0), "1 alone"),
    ],
)
def test_limits_that_were_not_met_are_said_in_words(full, interval, words):
    region = full.design.region
    document = design_document(
        replace(full.design, region=replace(region, margins=replace(region.margins, W=interval)))
    )
    margins = next(each for each in document.sections if each.title == "Margins")
    table = next(each for each in margins.blocks if isinstance(each, Table))
    assert next(plain(row[1]) for row in table.rows if plain(row[0]) == "W") == words
    at_the_edge = any(
        "nothing left to spare" in plain(each.line) for each in margins.blocks if isinstance(each, Paragraph)
    )
    assert at_the_edge >= (words == "1 alone")


@pytest.mark.parametrize(
    ("interval", "words"),
    [
        (Interval(2.0, 3.0), "as asked, no more"),
        (Interval(-math.inf, math.inf), "no limit found"),
        (Interval(1.5, math.inf), "from 1.5 kg on, no upper limit found"),
        (Interval(-math.inf, 4.0), "up to 4 kg, no lower limit found"),
    ],
)
def test_a_parameter_without_a_limit_is_said_in_words(full, interval, words):
    region = full.design.region
    margins = replace(region.margins, parameters={"m3": interval})
    document = design_document(replace(full.design, region=replace(region, margins=margins)))
    assert f"'{words}'" in str(document.sections)


def test_margins_of_a_flat_surface_have_no_limit(full):
    region = full.design.region
    margins = replace(region.margins, lambda_d=math.inf)
    document = design_document(replace(full.design, region=replace(region, margins=margins)))
    assert "'no limit'" in str(document.sections)


def test_the_verdict_names_the_plants_the_region_and_the_slowest_pole(full):
    region, told = full.design.region, verdict(full.design)
    assert told.startswith("Certified: for every m3 from 2 to 3 kg the gains keep all poles in the asked region")
    assert "(decay rate ≥ 4 1/s, damping ratio ≥ 0.6, |s| ≤ 30 rad/s)" in told
    slowest = max(pole.real for loop in (region.loop, *region.vertices) for pole in loop.poles.pencil)
    assert f"within about {number(-4 / slowest, 2)} s" in told


def test_the_gains_tell_what_ties_their_blocks(full, diagonal, shaped):
    assert "tied to the tangent ones" in words_of(full, "Gains")
    assert "nominal plant" in words_of(full, "Gains")
    assert "structure of the matrices ties the mixed blocks" in words_of(diagonal, "Gains")
    assert "second stage" in words_of(shaped, "Gains")


def test_the_table_of_poles_has_no_column_of_requested_ones(full):
    ((head, *rows),) = tables(full, "Poles")
    assert head[0] == "nominal pole, 1/s"
    assert len(rows) == len(full.design.achieved)
    assert "asked" not in words_of(full, "Poles")


def test_the_plane_holds_one_cross_for_each_pole_and_one_dot_for_each_of_a_vertex(any_report):
    region = any_report.design.region
    (figure,) = [each for each in section(any_report, "Poles").blocks if isinstance(each, Figure)]
    assert len(in_frame(figure.svg, FORCE)) == len(region.loop.poles.pencil)
    dots = sum(len(each.poles.pencil) for each in region.vertices) if len(region.vertices) > 1 else 0
    assert len(in_frame(figure.svg, ARM)) == dots


@pytest.mark.parametrize(
    "poles",
    [[-6, -8], [-4 + 2j, -4 - 2j], [-0.1 + 20j, -0.1 - 20j], [-1000, -0.01], [-3e4, -4e4], [-5] * 4],
    ids=["real", "pair", "hardly damped", "far apart", "fast", "repeated"],
)
def test_no_pole_is_cut_off_whatever_the_region(poles):
    vertices = [[1.5 * each for each in poles], [0.5 * each for each in poles]]
    for edges in ({}, {"decay": 0.01}, {"damping": 0.5}, {"decay": 0.005, "damping": 0.9, "bandwidth": 7e4}):
        svg = region_plane(poles, vertices, **edges)
        assert len(in_frame(svg, FORCE)) == len(poles)
        assert len(in_frame(svg, ARM)) == 2 * len(poles)
        assert (
            svg.count(f"stroke: {GOOD}") >= 2 * len(edges) - 2
        )  # in the axes and in the legend; discs may be far away


def test_a_disc_far_beyond_the_poles_is_told_of_and_not_drawn():
    poles = [-5 + 1j, -5 - 1j]
    assert "|s| ≤ 10 rad/s" in written(region_plane(poles, bandwidth=10))
    assert "|s| ≤ 100 rad/s" not in written(region_plane(poles, bandwidth=100))


def test_a_front_shows_its_points_its_ends_and_the_design(full):
    points = tuple(FrontPoint(x, 1 / x) for x in (1.0, 2.0, 3.0, 4.0))
    front = Front("size", "error", "N m/rad", "N", points, points[1])
    svg = front_chart(tradeoff(front))
    assert len(in_frame(svg, ARM)) == 4
    assert len(in_frame(svg, FORCE)) == 1
    assert {"least size", "least error", "size, N m/rad", "error, N", "this design"} <= set(written(svg))
    assert not in_frame(front_chart(tradeoff(replace(front, chosen=None))), FORCE)
    figures = [each for each in section(full, "Specification").blocks if isinstance(each, Figure)]
    assert len(figures) == 1
    assert len(in_frame(figures[0].svg, ARM)) == len(full.design.region.front.points)
    assert "greatest margin of (14)" in written(figures[0].svg)


def test_the_front_of_the_second_stage_is_shown_with_the_design_on_it(shaped):
    assert shaped.design.region.force_front is not None
    (figure,) = [each for each in section(shaped, "Specification").blocks if isinstance(each, Figure)]
    assert len(in_frame(figure.svg, FORCE)) == 1


def test_every_pole_and_every_figure_stays_the_same_when_drawn_again(full):
    assert design_document(full.design) == full.document


class Tags(HTMLParser):
    """The tags that are open at the end, in the wrong order, or twice with one id."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open, self.wrong, self.ids = [], [], []
        self.feed(html)

    def handle_starttag(self, tag, attrs):
        self.ids += [value for name, value in attrs if name == "id"]
        if tag not in {"meta", "link", "br", "hr", "img"}:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.ids += [value for name, value in attrs if name == "id"]

    def handle_endtag(self, tag):
        if self.open.pop() != tag:
            self.wrong.append(tag)


def test_the_page_is_well_formed_and_its_ids_are_unique(any_report):
    tags = Tags(any_report.html)
    assert (tags.open, tags.wrong) == ([], [])
    assert len(set(tags.ids)) == len(tags.ids)
    assert render_html(any_report.document) == any_report.html


def test_the_pdf_holds_the_figures_of_the_tables(any_report, run, tmp_path):
    path = tmp_path / "report.pdf"
    path.write_bytes(any_report.pdf)
    text = "".join(run("pdftotext", "-enc", "UTF-8", path, "-").split())
    region = any_report.design.region
    for result in region.results:
        if result.term.name != "mixed blocks":
            assert "".join(number(result.reached).split()) in text
    assert "".join(number(region.margins.mu).split()) in text
    assert render_pdf(any_report.document) == any_report.pdf
