"""The PDF report: the same bytes each time, readable as text, and nothing that runs off its pages."""

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from firmtouch.report import render_pdf
from firmtouch.report.contents.operating_point import LONGEST_COLUMN
from firmtouch.report.document import Code, Document, Equation, Math, Paragraph, Section, Strong, Table
from firmtouch.report.numbers import number

DPI = 50
MILLIMETRE = DPI / 25.4
EDGE = 8  # mm that office printers cannot print on
HOSTILE = (
    r"""<script>alert(1)</script> $x^2$ #import "a.typ" 'single' \ *bold* _under_ """
    r"""@ref `raw` // no /* comment */ λ Ünïcødé"""
)


@pytest.fixture(scope="module")
def pdf(report, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("pdf") / "report.pdf"
    path.write_bytes(report.pdf)
    return path


@pytest.fixture(scope="module")
def text(pdf, run) -> str:
    """The words of all pages, without white space: where lines break does not matter."""
    return squeezed(run("pdftotext", "-enc", "UTF-8", pdf, "-"))


@pytest.fixture(scope="module")
def pages(pdf, run) -> list[np.ndarray]:
    """The pages as grey values from 0 (black) to 255."""
    run("pdftoppm", "-r", str(DPI), "-gray", pdf, pdf.with_name("page"))
    return [np.asarray(Image.open(each)) for each in sorted(pdf.parent.glob("page*.pgm"))]


def squeezed(text: str) -> str:
    return "".join(text.split())


def test_two_renderings_are_identical_to_the_byte(report):
    assert render_pdf(report.document) == report.pdf


def test_it_is_a_whole_pdf_file(report):
    assert report.pdf.startswith(b"%PDF-")
    assert report.pdf.rstrip().endswith(b"%%EOF")


def test_it_has_a_few_a4_pages_and_a_title(report, pdf, run):
    told = dict(re.findall(r"^([A-Z][\w ]*):\s+(.*)$", run("pdfinfo", pdf), re.MULTILINE))
    assert 2 <= int(told["Pages"]) <= 12
    assert "A4" in told["Page size"]
    assert told["Title"] == report.model.spec.title
    assert told["Encrypted"] == "no"
    assert "CreationDate" not in told  # the same model gives the same file


def test_every_page_has_ink_and_none_near_its_edges(pages):
    edge = round(EDGE * MILLIMETRE)
    for i, page in enumerate(pages, start=1):
        assert page.shape == pytest.approx((297 * MILLIMETRE, 210 * MILLIMETRE), abs=2)
        inked = page < 160
        assert inked.mean() > 0.002, f"page {i} is empty"  # a single line of text covers 0.1 %
        border = inked.copy()
        border[edge:-edge, edge:-edge] = False
        assert not border.any(), f"page {i} is printed within {EDGE} mm of its edge"


def test_no_page_but_the_last_is_mostly_blank(pages):
    for i, page in enumerate(pages[:-1], start=1):
        lines = np.flatnonzero((page < 160)[: round(270 * MILLIMETRE)].any(axis=1))
        assert lines[-1] > 0.5 * page.shape[0], f"page {i} is left blank below the middle"


def test_it_tells_the_verdict_and_the_sections(text):
    assert "Certified:" in text
    for heading in (
        "Operatingpoint",
        "Gains",
        "Poles",
        "Positivity",
        "Steady-stateerrors",
        "Certificate",
        "Modelchecks",
    ):
        assert heading in text


def test_it_holds_the_numbers_that_one_looks_for(report, text):
    design = report.design
    loop = design.loop
    wanted = {
        "largest stiffness": number(float(np.linalg.norm(loop.gains.W, 2)), 3),
        "least eigenvalue of (14)": number(float(loop.full.K[0]), 3),
        "settling time": number(-4 / max(pole.real for pole in design.achieved), 3),
        "worst position error": number(design.steady_state.force.worst_position.value, 3),
        "first multiplier": number(float(loop.operating_point.lambda_d[0])),
    }
    n = report.model.spec.n
    figures = 4 if n <= LONGEST_COLUMN else 3
    wanted |= {f"W[{i}, {i}]": number(float(loop.gains.W[i, i]), figures) for i in range(n)}
    assert {name: each for name, each in wanted.items() if squeezed(each) not in text} == {}


def test_it_names_the_file_that_it_was_made_from(report, text):
    assert report.model.sha256 in text
    assert report.model.name in text


def test_no_markup_is_left_in_its_text(text):
    for stray in ('upright("', "dot.double", "delta q", "#strong", "#raw", "0x", "array(", "Matrix("):
        assert squeezed(stray) not in text


@pytest.mark.parametrize("place", ["title", "description", "label"])
def test_what_a_file_says_is_shown_literally(pendulum_with, run, tmp_path, place):
    sections = {"coordinates": {"x": {"unit": "m", "label": HOSTILE}}} if place == "label" else {place: HOSTILE}
    path = tmp_path / "report.pdf"
    path.write_bytes(pendulum_with(**sections).pdf)
    assert squeezed(HOSTILE) in squeezed(run("pdftotext", "-enc", "UTF-8", path, "-"))


def test_a_document_made_by_hand_shows_text_as_text_everywhere(run, tmp_path):
    told = r'#panic() [ ] ( ) { } " \ $ * _ ~ @ <x> -- ... \u{41}'
    table = Table((("#heading",),), (((told,),), ((Strong("*" + told),),), ((Code("`" + told),),)), frozenset(), ())
    blocks = (Paragraph((told, Math("x"), Code(told))), Equation("x = 1", "#(1)"), table)
    path = tmp_path / "report.pdf"
    path.write_bytes(render_pdf(Document(told, told, told, (Section("= #" + told, blocks),))))
    text = squeezed(run("pdftotext", "-enc", "UTF-8", path, "-"))
    assert text.count(squeezed(told)) >= 6
