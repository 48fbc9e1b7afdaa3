"""`Document` -> one HTML file that asks no network: styles, formulas and figures are inside."""

from __future__ import annotations

from importlib.resources import files
from typing import Any

from firmtouch.report.document import Block, Code, Document, Line, Math, Strong, formulas
from firmtouch.report.typeset import Typeset, typeset


def render_html(document: Document) -> str:
    """Render a report as HTML."""
    from jinja2 import Environment, StrictUndefined
    from markupsafe import Markup, escape

    set_ = typeset(formulas(document))

    def drawn(formula: Typeset, label: str) -> Markup:
        style = f"width:{formula.width:.3f}em;vertical-align:{-formula.depth:.3f}em"
        opening = f'<svg class="math" role="img" aria-label="{escape(label)}" style="{style}"'
        return Markup(formula.svg.replace("<svg", opening, 1))  # noqa: S704  # typst's own SVG

    def line(spans: Line) -> Markup:
        return Markup("").join(span(each) for each in spans)

    def span(each: Any) -> Markup:  # noqa: ANN401  # a Span
        match each:
            case Math(typst=source):
                return drawn(set_.formulas[each], source)
            case Strong(text=text):
                return Markup("<strong>{}</strong>").format(text)
            case Code(text=text):
                return Markup("<code>{}</code>").format(text)
            case _:
                return escape(each)

    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters["line"] = line
    environment.filters["safe_svg"] = Markup  # matplotlib's own SVG
    environment.filters["drawn"] = lambda equation: drawn(set_.formulas[equation], equation.typst)
    environment.tests["kind"] = _is_kind
    resources = files("firmtouch.report")
    template = environment.from_string((resources / "report.html.jinja").read_text(encoding="utf-8"))
    style = (resources / "report.css").read_text(encoding="utf-8")
    return template.render(document=document, style=Markup(style), glyphs=Markup(set_.glyphs))  # noqa: S704  # ours


def _is_kind(block: Block, kind: str) -> bool:
    return type(block).__name__ == kind
