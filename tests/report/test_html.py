"""The HTML report as text: well formed, complete in itself, and showing what a file says without reading it as HTML."""

import re
from collections import Counter
from html.parser import HTMLParser

import pytest

from firmtouch.report import render_html, verdict
from firmtouch.report.document import Document, Equation, Math, Paragraph, Section

VOID = {"meta", "link", "br", "hr", "img", "input", "wbr", "col"}
HOSTILE = (
    r"""<script>alert(1)</script> $x^2$ #import "a.typ" 'single' \ *bold* _under_ """
    r"""{{ 7*7 }} {% raw %} &amp; ]]> λ Ünïcødé"""
)


class Page(HTMLParser):
    """The elements of a page with their attributes, the text of each kind, and the tags that do not match."""

    def __init__(self, html: str) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.elements: list[tuple[str, dict[str, str]]] = []
        self.texts: list[tuple[str, str]] = []
        self.mismatched: list[str] = []
        self.feed(html)
        self.close()
        self.mismatched += [f"<{each}> is never closed" for each in self.open]

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if len(dict(attrs)) < len(attrs):
            self.mismatched.append(f"<{tag}> names an attribute twice")
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.mismatched.append(f"</{tag}> at {self.getpos()}")

    def handle_data(self, data):
        self.texts.append((self.open[-1] if self.open else "", data))

    def attributes(self, *names: str) -> list[str]:
        return [attributes[name] or "" for _, attributes in self.elements for name in names if name in attributes]

    def text(self, tag: str) -> list[str]:
        return [data for at, data in self.texts if at == tag and data.strip()]


@pytest.fixture(scope="module")
def page(report) -> Page:
    return Page(report.html)


@pytest.fixture(scope="module")
def hostile_report(pendulum_with):
    """Make the report of a model in which every text that a file can hold is a trap."""
    return pendulum_with(
        title=HOSTILE,
        description=HOSTILE,
        parameters={"length": {"value": "0.981 m", "label": HOSTILE}},
        coordinates={"x": {"unit": "m", "label": HOSTILE}},
        constraints={"rod": {"expression": "length - sqrt(x**2 + y**2)", "unit": "m", "label": HOSTILE}},
    )


def test_every_tag_is_closed_in_the_order_in_which_it_was_opened(page):
    assert page.mismatched == []


def test_the_document_says_what_it_is(report, page):
    assert report.html.startswith("<!doctype html>\n")
    assert report.html.rstrip().endswith("</html>")
    assert ("html", {"lang": "en"}) in page.elements
    assert ("meta", {"charset": "utf-8"}) in page.elements
    assert page.text("title") == page.text("h1") == [report.model.spec.title]


def test_ids_are_unique_and_every_reference_within_the_page_leads_somewhere(report, page):
    ids = page.attributes("id")
    assert [each for each, count in Counter(ids).items() if count > 1] == []
    references = {each[1:] for each in page.attributes("href", "xlink:href") if each.startswith("#")}
    references |= set(re.findall(r"url\(\s*['\"]?#([^)'\"]+)", report.html))
    assert references
    assert references <= set(ids)


def test_it_needs_no_other_file_and_no_network(report, page):
    outside = page.attributes("src", "href", "xlink:href", "srcset", "poster", "action", "data")
    assert [each for each in outside if not each.startswith(("#", "data:"))] == []
    without_namespaces = re.sub(r'\bxmlns(:\w+)?="[^"]*"', "", report.html)
    assert re.findall(r"https?://[^\s\"'<>)]+", without_namespaces) == []
    assert re.findall(r"url\(\s*['\"]?(?!#)[^)]*", report.html) == []
    assert "@import" not in report.html


def test_it_runs_nothing(page):
    assert [tag for tag, _ in page.elements if tag in {"script", "iframe", "object", "embed", "form"}] == []
    assert [name for _, attributes in page.elements for name in attributes if name.startswith("on")] == []


def test_the_verdict_is_a_sentence_at_the_top(report, page):
    said = "".join(data for tag, data in page.texts if tag in {"p", "strong", "code", "sub"})
    words = verdict(report.design).split()
    assert "".join(said.split()).find("".join(words[:4])) >= 0
    assert report.html.index("callout good") < report.html.index("<h2>")


def test_the_sections_are_those_of_a_design_report(page):
    wanted = {"Model", "Operating point", "Gains", "Poles", "Positivity", "Force loop", "Steady-state errors"}
    wanted |= {"Certificate", "Model checks"}
    assert wanted <= set(page.text("h2"))


def test_every_picture_and_every_formula_has_a_name(page):
    named = [attributes for _, attributes in page.elements if attributes.get("role") == "img"]
    assert len(named) > 20
    assert [each for each in named if not each.get("aria-label", "").strip()] == []
    assert [
        a for tag, a in page.elements if tag == "svg" and "math" in (a.get("class") or "") and "role" not in a
    ] == []


def test_there_are_pictures_of_the_mechanism_the_poles_the_eigenvalues_and_the_force_loop(report, page):
    assert sum(tag == "figure" for tag, _ in page.elements) == len(report.figures) == report.pictures
    assert sum(tag == "figcaption" for tag, _ in page.elements) == report.pictures


def test_two_renderings_are_identical(report):
    assert render_html(report.document) == report.html


def test_what_a_file_says_is_shown_and_not_read_as_html(hostile_report):
    page = Page(hostile_report.html)
    assert page.mismatched == []
    assert "script" not in {tag for tag, _ in page.elements}
    assert page.text("title") == page.text("h1") == [HOSTILE]
    assert HOSTILE in page.text("p")  # the description
    for name in ("length of parameter", "coordinate", "constraint"):
        assert sum(HOSTILE in text.strip() for text in page.text("td")) >= 3, name
    assert "49" not in page.text("h1")[0]


def test_a_document_made_by_hand_escapes_text_formulas_labels_and_captions():
    line = ('<b>&"', Math('op("<i>")'))
    html = render_html(Document(HOSTILE, "<sub>", "<foot>", (Section("<h>", (Paragraph(line), Equation('"<&>"'))),)))
    page = Page(html)
    assert page.mismatched == []
    assert {"b", "i", "sub", "foot", "h"}.isdisjoint({tag for tag, _ in page.elements})
    assert 'op("<i>")' in page.attributes("aria-label")
