"""A report as a value: sections of blocks, from which HTML and PDF are rendered. Nothing here knows either format.

Mathematics is in Typst's notation, figures are SVG, numbers are text already.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Math:
    """A formula within a line, in Typst's notation."""

    typst: str


@dataclass(frozen=True, slots=True)
class Strong:
    """Emphasised text."""

    text: str


@dataclass(frozen=True, slots=True)
class Code:
    """A name as it stands in a file."""

    text: str


Span = str | Math | Strong | Code
Line = tuple[Span, ...]


@dataclass(frozen=True, slots=True)
class Paragraph:
    """Running text."""

    line: Line


@dataclass(frozen=True, slots=True)
class Equation:
    """A displayed formula, with the number of the equation in its source (empty: none)."""

    typst: str
    source: str = ""


@dataclass(frozen=True, slots=True)
class Matrix:
    """A named matrix or column of numbers, with its unit."""

    name: Math
    rows: tuple[tuple[str, ...], ...]
    unit: str


@dataclass(frozen=True, slots=True)
class Matrices:
    """Matrices that belong together, set side by side where there is room."""

    matrices: tuple[Matrix, ...]


@dataclass(frozen=True, slots=True)
class Table:
    """A table; columns in `numeric` are aligned to the right, those in `wide` share the room that the others leave."""

    headings: tuple[Line, ...]
    rows: tuple[tuple[Line, ...], ...]
    numeric: frozenset[int] = frozenset()
    caption: Line = ()
    wide: frozenset[int] = frozenset()


@dataclass(frozen=True, slots=True)
class Figure:
    """A picture with its words: `alt` says what is to be seen, to those who cannot see it.

    On a narrow screen each of its `panels`, which stand side by side, stays wide enough to be read.
    """

    svg: str
    caption: Line
    alt: str
    width: float = 1.0
    panels: int = 1


@dataclass(frozen=True, slots=True)
class Card:
    """A number that a reader looks for first."""

    value: str
    unit: str
    label: str


@dataclass(frozen=True, slots=True)
class Cards:
    """The numbers at the head of the report."""

    cards: tuple[Card, ...]


@dataclass(frozen=True, slots=True)
class Callout:
    """The verdict (`good`), or something to beware of (`warning`)."""

    mood: str
    line: Line


Block = Paragraph | Equation | Matrices | Table | Figure | Cards | Callout


@dataclass(frozen=True, slots=True)
class Section:
    """A titled part of the report; without a title, its head."""

    title: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True, slots=True)
class Document:
    """A whole report."""

    title: str
    subtitle: str
    footer: str
    sections: tuple[Section, ...]


def formulas(document: Document) -> tuple[Math | Equation, ...]:
    """List every formula of a document once, in its order."""
    found: dict[Math | Equation, None] = {}

    def take(line: Line) -> None:
        found.update((span, None) for span in line if isinstance(span, Math))

    for section in document.sections:
        for block in section.blocks:
            match block:
                case Paragraph(line=line) | Callout(line=line):
                    take(line)
                case Equation():
                    found[block] = None
                case Matrices(matrices=matrices):
                    found.update((each.name, None) for each in matrices)
                case Table(headings=headings, rows=rows, caption=caption):
                    for cell in (*headings, *(cell for row in rows for cell in row), caption):
                        take(cell)
                case Figure(caption=caption):
                    take(caption)
                case Cards():
                    pass
    return tuple(found)
