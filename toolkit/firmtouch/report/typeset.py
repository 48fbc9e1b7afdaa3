"""Typst formulas -> SVG for the HTML report, all of a document in one run."""

from __future__ import annotations

import json
import re
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from firmtouch.report.document import Equation, Math

SIZE: Final = 11.0
"""Font size in points, at which the formulas are set; HTML scales them with its text."""
WIDEST: Final = 300.0
"""Displayed formulas that are wider (in points) break their lines, so that they can be read on a phone."""

_HEAD: Final = f"""
#set page(width: auto, height: auto, margin: 0pt, fill: none)
#set text(size: {SIZE}pt, top-edge: "bounds", bottom-edge: "bounds")
#set par(leading: 0.9em)
#let inline(e) = page(e)
#let display(e) = page(context {{
  if measure(e).width > {WIDEST}pt {{ block(width: {WIDEST}pt, e) }} else {{ e }}
}})
#let depth(e) = context {{
  let above = measure(text(bottom-edge: "baseline", e)).height
  [#metadata(measure(e).height.pt() - above.pt()) <depth>]
}}
"""
_SYMBOL: Final = re.compile(r'<symbol id="(g[0-9A-F]+)".*?</symbol>', re.DOTALL)


@dataclass(frozen=True, slots=True)
class Typeset:
    """A formula as SVG: width and height in em, and how far it reaches below the baseline."""

    svg: str
    width: float
    height: float
    depth: float


@dataclass(frozen=True, slots=True)
class TypesetFormulas:
    """The formulas of a document, and the glyphs that they share, to be put into the page once."""

    formulas: dict[Math | Equation, Typeset]
    glyphs: str


def typeset(formulas: Sequence[Math | Equation]) -> TypesetFormulas:
    """Set all formulas."""
    import typst

    if not formulas:
        return TypesetFormulas({}, "")
    bodies = [f"${each.typst}$" if isinstance(each, Math) else f"$#math.display(${each.typst}$)$" for each in formulas]
    pages = [
        f"#{'inline' if isinstance(f, Math) else 'display'}({_content(b)})"
        for f, b in zip(formulas, bodies, strict=True)
    ]
    depths = [f"#depth({_content(body)})" for body in bodies]
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "formulas.typ"
        source.write_text("\n".join([_HEAD, *pages]), encoding="utf-8")
        compiled = typst.compile(str(source), format="svg", ignore_system_fonts=True)
        source.write_text("\n".join([_HEAD, *depths]), encoding="utf-8")
        measured = json.loads(typst.query(str(source), "<depth>", field="value", ignore_system_fonts=True))
    # One page comes as bytes, several as a list of them, whatever the annotation says.
    pages_svg: Any = compiled
    pictures = [each.decode() for each in (pages_svg if isinstance(pages_svg, list) else [pages_svg])]
    glyphs = {match[1]: match[0] for picture in pictures for match in _SYMBOL.finditer(picture)}
    set_ = {each: _typeset(svg, depth) for each, svg, depth in zip(formulas, pictures, measured, strict=True)}
    return TypesetFormulas(set_, "".join(glyphs.values()))


def _content(body: str) -> str:
    return f"[{body}]"


def _typeset(svg: str, depth: float) -> Typeset:
    found = re.search(r'viewBox="0 0 ([0-9.]+) ([0-9.]+)"', svg)
    assert found is not None
    width, height = float(found[1]), float(found[2])
    body = _SYMBOL.sub("", svg).replace("<defs></defs>", "")
    body = re.sub(r' width="[0-9.]+pt" height="[0-9.]+pt"', "", body, count=1)
    body = body.replace('fill="#000000"', 'fill="currentColor"').replace('stroke="#000000"', 'stroke="currentColor"')
    return Typeset(body, width / SIZE, height / SIZE, depth / SIZE)
