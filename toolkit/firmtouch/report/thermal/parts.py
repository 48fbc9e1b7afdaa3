"""The parts and materials that are used, with their numbers, tolerances and sources."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from firmtouch.report.document import Line, Paragraph, Section, Table
from firmtouch.report.numbers import number
from firmtouch.report.thermal.words import percent, quantity
from firmtouch.thermal.analysis import Analysis
from firmtouch.thermal.tables.values import Part

NONE: Final = "–"


def section(analysis: Analysis) -> Section:
    """Write the parts list."""
    catalogue, blocks = analysis.file.catalogue, []
    materials = [catalogue.materials[name] for name in _materials(analysis) if name in catalogue.materials]
    if materials:
        headings: tuple[Line, ...] = (
            ("material",), ("k, W/mK",), ("ρ, kg/m³",), ("c, J/kgK",), ("±",),
            ("what it is, and the source of its numbers",),
        )  # fmt: skip
        rows: list[tuple[Line, ...]] = [
            (
                (each.name,),
                (number(each.conductivity, 3),),
                (number(each.density),),
                (number(each.heat_capacity),),
                (percent(each.tolerance),),
                (f"{each.title}. {each.source}",),
            )
            for each in materials
        ]
        blocks.append(Table(headings, tuple(rows), frozenset({1, 2, 3, 4}), wide=frozenset({5})))
    parts = [catalogue.parts[name] for name in _parts(analysis)]
    if parts:
        blocks.append(_part_table(parts))
    marks = "In sources, [S] is read in the source named, [M] from memory of textbooks, [C] computed or chosen."
    return Section("Parts and materials", (*blocks, Paragraph((marks,))))


def _materials(analysis: Analysis) -> tuple[str, ...]:
    """List the materials in the order in which they are met, from the front."""
    spec = analysis.spec
    found = [each.material for each in spec.objects]
    found += [each.material or (each.film.material if each.film is not None else None) or "" for each in spec.stack]
    found.append(spec.backing.half_space or "")
    return tuple(dict.fromkeys(each for each in found if each))


def _parts(analysis: Analysis) -> tuple[str, ...]:
    found = (each.film.part for each in analysis.spec.stack if each.film is not None)
    return tuple(dict.fromkeys(each for each in found if each is not None))


def _part_table(parts: list[Part]) -> Table:
    headings: tuple[Line, ...] = (("part",), ("size",), ("value",))
    rows = [
        ((each.name if i == 0 else "",), (name,), (value,))
        for each in parts
        for i, (name, value) in enumerate(_rows(each))
    ]
    return Table(headings, tuple(rows), wide=frozenset({2}))


def _rows(part: Part) -> Iterator[tuple[str, str]]:
    yield "what it is", part.title
    if part.size is not None:
        yield "body", " × ".join(quantity(each, "m") for each in part.size)
    if part.footprint is not None:
        yield "footprint", f"{number(1e6 * part.footprint, 3)} mm²"
    if part.capacity is not None:
        yield "heat capacity", f"{number(1e3 * part.capacity.value, 3)} mJ/K, from {part.capacity.basis}"
    if part.dissipation is not None:
        yield "dissipation δ", f"{number(1e3 * part.dissipation.value, 3)} mW/K"
    if part.time_constant is not None:
        yield "time constant τ", quantity(part.time_constant.value, "s")
    if part.resistance is not None:
        yield "resistance", _between(part.resistance, "ohm")
    if part.B is not None:
        yield "B", _between(part.B, "K")
    if part.coefficient is not None:
        yield "coefficient", f"{number(1e6 * part.coefficient)} ppm/K"
    yield "tolerance", f"± {percent(part.tolerance)}"
    yield "source", part.source


def _between(ends: tuple[float, float], unit: str) -> str:
    low, high = (quantity(each, unit) for each in ends)
    return low if low == high else f"{low} to {high}"
