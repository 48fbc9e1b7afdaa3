"""What was searched, what was chosen, and what one objective costs of another."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from firmtouch.report.document import Block, Figure, Line, Paragraph, Section, Strong, Table
from firmtouch.report.figures.front import Axis, Tradeoff, front_chart
from firmtouch.report.numbers import number
from firmtouch.report.thermal.words import celsius, enumerated, quantity
from firmtouch.thermal.search.variables import LINEAR, Value, Variable
from firmtouch.thermal.study import Study

if TYPE_CHECKING:
    from firmtouch.thermal.search import Candidate, Front, SearchResult

WORDS: Final = {"rise_time": "rise time", "power": "power", "thickness": "thickness", "discrimination": "d′"}
AXES: Final = {"s": (1e3, "ms"), "W": (1e3, "mW"), "W/m^2": (1e-3, "kW/m²"), "m": (1e3, "mm"), "1": (1.0, "")}
"""Units of a front's axes, and how many of them go into those of its figures."""
MOST_COLUMNS: Final = 4
"""Of variables in the table of the front."""
AT: Final = 1e-6
"""Of a range: what is nearer to its end is at its bound."""


def section(study: Study) -> Section | None:
    """Write the search, where there was one."""
    return None if study.search is None else Section("Search", tuple(_blocks(study.search)))


def _blocks(found: SearchResult) -> Iterator[Block]:
    best = "largest" if found.spec.objective == "discrimination" else "least"
    met = f"{found.met} of them meet everything" if found.met else "none of them meets everything"
    what = "the chosen one has the " if found.found else "what is analysed here misses least; it was to have the "
    objective = f"{what}{best} {WORDS[found.spec.objective]}"
    yield Paragraph((f"{found.tried} designs were tried by differential evolution, and {met}; {objective}.",))
    yield _variables(found)
    at_bounds = [each.name for each in found.variables if _bound(each, found.chosen.values[each.path])]
    if at_bounds and found.found:
        yield Paragraph(("Where a value lies at a bound, a wider range may give a better design.",))
    if found.front is not None:
        yield from _front(found.front, found)
    elif found.spec.front:
        yield Paragraph(("There is no front to show, as no design meets everything.",))


def _variables(found: SearchResult) -> Table:
    headings: tuple[Line, ...] = (("variable",), ("searched",), ("chosen",), ("",))
    rows: list[tuple[Line, ...]] = []
    for each in found.variables:
        chosen = found.chosen.values[each.path]
        searched = (
            ", ".join(value_words(each, choice) for choice in each.choices)
            if each.choices
            else f"{value_words(each, each.low)} to {value_words(each, each.high)}"
        )
        rows.append(((each.name,), (searched,), (Strong(value_words(each, chosen)),), (_bound(each, chosen),)))
    return Table(headings, tuple(rows), wide=frozenset({1}))


def value_words(variable: Variable, value: Value) -> str:
    """Write a value of a variable."""
    if isinstance(value, str):
        return value
    if variable.choices:
        return number(value)
    return celsius(value) if variable.path[-1] in LINEAR else quantity(value, variable.unit)


def _bound(variable: Variable, value: Value) -> str:
    """Say where a size lies at the end of its range."""
    if variable.choices or not isinstance(value, (int, float)) or variable.high <= variable.low:
        return ""
    near = AT * (variable.high - variable.low)
    if value - variable.low <= near:
        return "at its lower bound"
    return "at its upper bound" if variable.high - value <= near else ""


def _front(front: Front, found: SearchResult) -> Iterator[Block]:
    names, count = front.objectives, len(front.designs)
    told = enumerated(WORDS[each] for each in names)
    if count < 2:
        yield Paragraph((f"One design is best in {told} at once, so that neither costs any of the other.",))
        return
    yield Paragraph(
        (f"What {told} cost of each other, among all designs that meet everything. In no other is one better without "
         "another being worse.",)
    )  # fmt: skip
    yield _chart(front)
    yield _designs(front, found)


def tradeoff(front: Front) -> Tradeoff:
    """Give a front as it is drawn; there must be a design."""
    named = tuple(zip(front.objectives, (AXES[each] for each in front.units), strict=True))
    x, y, *more = (
        Axis(WORDS[name], unit, tuple(factor * each.figures[name] for each in front.designs))
        for name, (factor, unit) in named
    )
    left, up = (factor * front.chosen.figures[name] for name, (factor, _) in named[:2])
    return Tradeoff(x, y, (left, up), more[0] if more else None)


def _shown(front: Front) -> tuple[Candidate, ...]:
    """List the designs of the front, and before them the chosen one, where rounding took it off the front."""
    on_front = any(each.x == front.chosen.x for each in front.designs)
    return front.designs if on_front else (front.chosen, *front.designs)


def _chart(front: Front) -> Figure:
    names = front.objectives
    ring = "; the ring is the chosen design"
    caption = f"The best {WORDS[names[1]]} for each {WORDS[names[0]]}{ring}."
    if len(names) > 2:
        caption = f"{WORDS[names[1]].capitalize()} against {WORDS[names[0]]}, with {WORDS[names[2]]} as colour{ring}."
    alt = f"Front of {', '.join(WORDS[each] for each in names)} with {len(front.designs)} designs"
    return Figure(front_chart(tradeoff(front), "search-front"), (caption,), alt, 0.7)


def _designs(front: Front, found: SearchResult) -> Table:
    designs = _shown(front)
    differ = [each for each in found.variables if len({value_words(each, d.values[each.path]) for d in designs}) > 1]
    shown = differ[:MOST_COLUMNS]
    headings: tuple[Line, ...] = (*((WORDS[each],) for each in front.objectives), *((each.name,) for each in shown))
    rows = tuple(tuple(_row(each, front, shown)) for each in designs)
    alike, more = len(found.variables) - len(differ), len(differ) - len(shown)
    words = ["Bold: the chosen design."]
    if alike:
        has = "variable has" if alike == 1 else "variables have"
        words.append(f"{alike} other {has} one value in all of these.")
    if more:
        words.append(f"{more} more {'variable differs' if more == 1 else 'variables differ'}.")
    numeric = set(range(len(front.objectives)))
    numeric |= {len(front.objectives) + i for i, each in enumerate(shown) if not each.choices}
    return Table(headings, rows, frozenset(numeric), (" ".join(words),))


def _row(design: Candidate, front: Front, shown: list[Variable]) -> Iterator[Line]:
    mark = Strong if design.x == front.chosen.x else str
    for name, unit in zip(front.objectives, front.units, strict=True):
        yield (mark(quantity(design.figures[name], unit)),)
    for each in shown:
        yield (mark(value_words(each, design.values[each.path])),)
