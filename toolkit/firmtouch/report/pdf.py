"""`Document` -> PDF, typeset by Typst; the same document gives the same bytes."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from importlib.resources import files
from itertools import zip_longest
from pathlib import Path

from firmtouch.report.document import (
    Block,
    Callout,
    Cards,
    Code,
    Document,
    Equation,
    Figure,
    Line,
    Math,
    Matrices,
    Matrix,
    Paragraph,
    Strong,
    Table,
)


def render_pdf(document: Document) -> bytes:
    """Render a report as PDF."""
    import typst

    figures = [block for section in document.sections for block in section.blocks if isinstance(block, Figure)]
    names = {each: f"figure-{i}.svg" for i, each in enumerate(figures)}
    template = (files("firmtouch.report") / "report.typ").read_text(encoding="utf-8")
    source = "\n".join([template, *_document(document, names)])
    with tempfile.TemporaryDirectory() as folder:
        for figure, name in names.items():
            (Path(folder) / name).write_text(figure.svg, encoding="utf-8")
        main = Path(folder) / "report.typ"
        main.write_text(source, encoding="utf-8")
        return bytes(typst.compile(str(main), format="pdf", ignore_system_fonts=True))


def _document(document: Document, names: dict[Figure, str]) -> Iterator[str]:
    head = {"title": document.title, "subtitle": document.subtitle, "footer": document.footer}
    yield f"#show: report.with({', '.join(f'{key}: {_string(text)}' for key, text in head.items())})"
    for section in document.sections:
        if section.title:
            yield f"= #{_string(section.title)}"
        for block, after in zip_longest(section.blocks, section.blocks[1:]):
            # a paragraph that leads to something is not left alone on a page
            leads = isinstance(block, Paragraph) and isinstance(after, Table | Figure | Equation)
            yield f"#block(sticky: true)[{_block(block, names)}]" if leads else _block(block, names)
            yield ""


def _block(block: Block, names: dict[Figure, str]) -> str:
    match block:
        case Paragraph(line=line):
            return _line(line)
        case Callout(mood=mood, line=line):
            return f"#callout({_string(mood)}, [{_line(line)}])"
        case Equation(typst=body, source=source):
            return f"#displayed([$#math.display(${body}$)$], {_string(source)})"
        case Cards(cards=cards):
            listed = ", ".join(f"({_string(c.value)}, {_string(c.unit)}, {_string(c.label)})" for c in cards)
            return f"#cards(({listed},))"
        case Matrices(matrices=matrices):
            return f"#matrices(({', '.join(_matrix(each) for each in matrices)},))"
        case Table():
            return _table(block)
        case Figure(caption=caption, alt=alt, width=width):
            return f"#picture({_string(names[block])}, [{_line(caption)}], {_string(alt)}, {width})"


def _matrix(matrix: Matrix) -> str:
    rows = ", ".join("(" + ", ".join(_string(entry) for entry in row) + ",)" for row in matrix.rows)
    return f"(name: [${matrix.name.typst}$], rows: ({rows},), unit: {_string(matrix.unit)})"


def _table(table: Table) -> str:
    headings = ", ".join(f"[{_line(each)}]" for each in table.headings)
    rows = ", ".join(f"({', '.join(f'[{_line(cell)}]' for cell in row)},)" for row in table.rows)
    return (
        f"#data(({headings},), ({rows},), {_numbers(table.numeric)}, {_numbers(table.wide)}, [{_line(table.caption)}])"
    )


def _numbers(numbers: frozenset[int]) -> str:
    return "(" + "".join(f"{each}, " for each in sorted(numbers)) + ")"


def _line(line: Line) -> str:
    return "".join(_span(each) for each in line)


def _span(span: object) -> str:
    match span:
        case Math(typst=body):
            return f"#[${body}$]"
        case Strong(text=text):
            return f"#strong({_string(text)})"
        case Code(text=text):
            return f"#raw({_string(text)})"
        case _:
            return f"#{_string(str(span))}"


def _string(text: str) -> str:
    """Write a string literal: what is shown is never read as markup."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
