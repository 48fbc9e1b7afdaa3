"""What is asked and what is reached; and, where something is missed, what binds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from firmtouch.report.document import Block, Line, Paragraph, Section, Strong, Table
from firmtouch.report.thermal.words import (
    margin_words,
    outcome_words,
    percent,
    place_words,
    quantity,
    requirement_words,
)
from firmtouch.thermal.analysis import Analysis, Binding, Relief


@dataclass(frozen=True, slots=True)
class RequirementRow:
    """A requirement in words, for the report and for the terminal."""

    name: str
    asked: str
    reached: str
    margin: str
    where: str
    met: bool


def requirement_rows(analysis: Analysis) -> tuple[RequirementRow, ...]:
    """Write what is asked and what is reached."""
    return tuple(
        RequirementRow(
            name=requirement_words(each, analysis.spec),
            asked=("≤ " if each.at_most else "≥ ") + outcome_words(each, each.asked),
            reached=outcome_words(each, each.reached),
            margin=margin_words(each),
            where=place_words(each.where) or "–",
            met=each.met,
        )
        for each in analysis.outcomes
    )


def section(analysis: Analysis) -> Section:
    """Hold what is reached against what is asked."""
    if not analysis.outcomes:
        return Section("Requirements", (Paragraph(("The file asks nothing of this sensor.",)),))
    headings: tuple[Line, ...] = (
        ("requirement",), ("asked",), ("reached",), ("margin",), ("met",), ("where it is worst",)
    )  # fmt: skip
    rows: list[tuple[Line, ...]] = [
        ((each.name,), (each.asked,), (each.reached,), (each.margin,), ("yes" if each.met else Strong("no"),),
         (each.where,))
        for each in requirement_rows(analysis)
    ]  # fmt: skip
    blocks: list[Block] = [Table(headings, tuple(rows), frozenset({1, 2, 3}), wide=frozenset({5}))]
    rise = analysis.spec.requirements.rise_time
    if rise is not None and rise.metric != "d_prime":
        blocks.append(Paragraph((_metric(rise.metric, rise.window),)))
    return Section("Requirements", tuple(blocks))


def _metric(metric: str, window: float) -> str:
    """Say in words how a rise time is measured."""
    what = "from 10 % to 90 %" if metric == "10-90" else "from the touch to 63 % (1 − 1/e)"
    return (
        f"The rise time is the time {what} of the end value, and the end value is the extremum of the signal within "
        f"{quantity(window, 's')} after the touch: an object that is deep lets a response decay again later."
    )


def binding_section(analysis: Analysis) -> Section | None:
    """Say what binds, where something is missed."""
    binding = analysis.binding
    return None if binding is None else Section("What binds", tuple(_binding(binding, analysis)))


def _binding(binding: Binding, analysis: Analysis) -> Iterator[Block]:
    missed = f"The {requirement_words(binding.outcome, analysis.spec)} is missed most"
    if binding.alone:
        yield Paragraph((f"{missed}. Each of these changes would meet it by itself, the others staying as they are:",))
        yield _reliefs(binding.alone, binding)
    elif binding.together:
        yield Paragraph(
            (
                f"{missed}, and no change of one thing alone would meet it. All of these must change; what each needs "
                "is said for the others being ideal, so that in truth it is more:",
            )
        )
        yield _reliefs(binding.together, binding)
        yield Paragraph((" ".join(binding_lines(binding)),))
    else:
        yield Paragraph((f"{missed}, and nothing about the sensor would meet it: what is touched binds.",))


def binding_lines(binding: Binding) -> tuple[str, ...]:
    """Say in words what would do: `Film capacity: 3080 J/m²K now; 5 J/m²K would do, the others being ideal.`."""
    if not binding.alone and not binding.together:
        return ("Nothing about the sensor would do: what is touched binds.",)
    others = "alone" if binding.alone else "the others being ideal"
    return tuple(
        f"{each.term[0].upper()}{each.term[1:]}: {_size(each, each.now)} now; {_size(each, each.needed)} would do, "
        f"{others}."
        for each in (binding.alone or binding.together)
    )


def _size(relief: Relief, value: float) -> str:
    return percent(value) if relief.term == "knowledge of the contact" else quantity(value, relief.unit)


def _reliefs(reliefs: tuple[Relief, ...], binding: Binding) -> Table:
    headings: tuple[Line, ...] = (("what",), ("now",), ("would do",), ("factor",), ("then reached",))
    rows: list[tuple[Line, ...]] = [
        (
            (each.term,),
            (_size(each, each.now),),
            (_size(each, each.needed),),
            (quantity(each.factor, "1"),),
            (outcome_words(binding.outcome, each.reached),),
        )
        for each in reliefs
    ]
    return Table(headings, tuple(rows), frozenset({1, 2, 3, 4}))
