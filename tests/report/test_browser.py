"""The HTML report as a browser shows it: on a phone, on a desk and on paper."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace

import pytest

pytestmark = pytest.mark.browser

PHONE, DESK, PAPER = 390, 1280, 794  # CSS pixels; the last is the width of A4 at 96 to the inch
SMALLEST_TEXT = 9  # px of font size: what is smaller cannot be read without zooming
SMALLEST_LABEL = 6.5  # px, of the small print in pictures on a phone, where one can zoom into them

# What a script in the page finds; every list is empty on a good page.
LOOK = """
() => {
  const width = document.documentElement.clientWidth;
  const words = each => (each.getAttribute("aria-label") ?? each.textContent ?? "").trim().slice(0, 40);
  const name = each => `${each.tagName}.${each.getAttribute("class") ?? ""} ${words(each)}`;
  const box = each => each.getBoundingClientRect();
  const outermost = [...document.querySelectorAll("body *")].filter(each => !each.parentElement.closest("svg"));
  const shown = outermost.filter(each => !each.closest(".glyphs"));
  const texts = shown.filter(each => [...each.childNodes].some(node => node.nodeType === 3 && node.data.trim()));
  const maths = [...document.querySelectorAll("svg.math")];
  const pictures = [...document.querySelectorAll("figure .picture > svg")];
  const ids = [...document.querySelectorAll("[id]")].map(each => each.id);
  const known = new Set(ids);
  const scale = svg => Math.hypot(svg.getScreenCTM().a, svg.getScreenCTM().b);
  return {
    overflow: document.scrollingElement.scrollWidth - document.scrollingElement.clientWidth,
    outside: shown.filter(each => !each.closest(".scroll") || each.matches(".scroll"))
      .filter(each => box(each).width && (box(each).right > width + 1 || box(each).left < -1)).map(name),
    flat: [...maths, ...pictures].filter(each => box(each).width < 3 || box(each).height < 3).map(name),
    empty: [...maths, ...pictures].filter(each => !(each.getBBox().width > 0 && each.getBBox().height > 0)).map(name),
    invisible: [...maths, ...pictures].filter(each => !each.checkVisibility()).map(name),
    dangling: [...document.querySelectorAll("use")]
      .map(each => each.getAttribute("href") ?? each.getAttribute("xlink:href"))
      .filter(each => !each.startsWith("#") || !known.has(each.slice(1))),
    repeated: ids.filter((each, i) => ids.indexOf(each) !== i),
    small: texts.filter(each => parseFloat(getComputedStyle(each).fontSize) < SMALLEST).map(name),
    narrow: texts.filter(each => box(each).width === 0 || box(each).height === 0).map(name),
    shrunk: maths.filter(each => parseFloat(getComputedStyle(each).fontSize)
      * box(each).width / (parseFloat(each.style.width) * parseFloat(getComputedStyle(each).fontSize)) < SMALLEST)
      .map(each => each.getAttribute("aria-label")),
    labels: pictures.flatMap(svg => [...svg.querySelectorAll("g[id*='text_'] g[transform*='scale']")].map(each =>
      100 * parseFloat(each.getAttribute("transform").match(/scale\\\\(([0-9.]+)/)[1]) * scale(svg))),
    unnamed: [...maths, ...document.querySelectorAll("figure [role=img], img")]
      .filter(each => !(each.getAttribute("aria-label") ?? each.alt ?? "").trim()).map(name),
    headings: [...document.querySelectorAll("h1, h2, h3, h4, h5, h6")].map(each => Number(each.tagName[1])),
    maths: maths.length,
    pictures: pictures.length,
    fonts: [...document.fonts].length,
  };
}
"""


@dataclass
class Visit:
    """A page that was opened, and what it did meanwhile."""

    page: SimpleNamespace
    file: str
    requests: list[str] = field(default_factory=list)
    complaints: list[str] = field(default_factory=list)

    def look(self) -> SimpleNamespace:
        return SimpleNamespace(**self.page.evaluate(LOOK.replace("SMALLEST", str(SMALLEST_TEXT)).replace("\\\\", "\\")))


@pytest.fixture(scope="module")
def file(report, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("html") / "report.html"
    path.write_text(report.html, encoding="utf-8")
    return path


def opened(browser, path: Path, width: int) -> Iterator[Visit]:
    context = browser.new_context(viewport={"width": width, "height": 844}, device_scale_factor=1)
    visit = Visit(context.new_page(), path.as_uri())
    visit.page.on("request", lambda request: visit.requests.append(request.url))
    visit.page.on("console", lambda message: visit.complaints.append(f"{message.type}: {message.text}"))
    visit.page.on("pageerror", lambda error: visit.complaints.append(str(error)))
    visit.page.goto(visit.file, wait_until="load")
    yield visit
    context.close()


@pytest.fixture(scope="module", params=[PHONE, DESK], ids=["phone", "desk"])
def visit(browser, file, request) -> Iterator[Visit]:
    yield from opened(browser, file, request.param)


@pytest.fixture(scope="module")
def seen(visit) -> SimpleNamespace:
    return visit.look()


def test_no_request_leaves_and_nothing_is_complained_of(visit, seen):
    assert [each for each in visit.requests if each != visit.file and not each.startswith("data:")] == []
    assert visit.complaints == []


def test_nothing_overflows_the_width(seen):
    assert seen.outside == []
    assert seen.overflow <= 0


def test_every_formula_and_every_picture_is_visible(seen, report):
    assert seen.maths > 20
    assert seen.pictures == report.pictures
    assert seen.flat == []
    assert seen.empty == []
    assert seen.invisible == []


def test_every_glyph_that_is_used_exists_once(seen):
    assert seen.dangling == []
    assert seen.repeated == []


def test_text_and_formulas_are_large_enough_to_read(seen):
    assert seen.small == []
    assert seen.narrow == []
    assert seen.shrunk == []


def test_labels_in_pictures_are_large_enough_to_read(visit, seen):
    assert len(seen.labels) > 20
    assert min(seen.labels) >= (SMALLEST_LABEL if visit.page.viewport_size["width"] == PHONE else SMALLEST_TEXT)


def test_pictures_and_formulas_have_names_and_headings_are_in_order(seen):
    assert seen.unnamed == []
    assert seen.headings[0] == 1
    assert seen.headings.count(1) == 1
    assert all(below - above <= 1 for above, below in zip(seen.headings, seen.headings[1:], strict=False))


def test_tables_that_are_too_wide_scroll_and_are_no_narrower_than_the_page(visit):
    scrolled = visit.page.evaluate(
        "() => [...document.querySelectorAll('.scroll')].filter(each => each.scrollWidth > each.clientWidth + 1)"
        ".map(each => getComputedStyle(each).overflowX)"
    )
    assert set(scrolled) <= {"auto", "scroll"}


@pytest.fixture(scope="module")
def printed(browser, file) -> Iterator[Visit]:
    for visit in opened(browser, file, PAPER):
        visit.page.emulate_media(media="print")
        yield visit


def test_nothing_is_cut_off_in_print(printed):
    seen = printed.look()
    assert seen.overflow <= 0
    assert seen.outside == []
    assert seen.flat == []
    clipped = "() => [...document.querySelectorAll('.scroll')].filter(e => e.scrollWidth > e.clientWidth + 1).length"
    assert printed.page.evaluate(clipped) == 0


def test_a_report_of_hostile_texts_runs_nothing_and_shows_them(browser, pendulum_with, tmp_path):
    hostile = "<img src=x onerror=\"document.title='run'\"><script>document.title='run'</script> " + "W" * 300
    path = tmp_path / "report.html"
    path.write_text(pendulum_with(title=hostile, description=hostile).html, encoding="utf-8")
    for visit in opened(browser, path, PHONE):
        assert visit.page.title() == hostile
        assert visit.page.inner_text("h1") == hostile
        assert visit.requests == [visit.file]
        assert visit.complaints == []
        assert visit.look().overflow <= 0
