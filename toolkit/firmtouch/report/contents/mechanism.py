"""The model: coordinates, parameters, and its equations in closed form where these are short enough to read."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Final

from firmtouch.design import Design
from firmtouch.mechanics.symbolic import SymbolicPlant
from firmtouch.report.contents.robot import is_robot, recursion, robot
from firmtouch.report.document import Block, Code, Equation, Line, Math, Paragraph, Section, Table
from firmtouch.report.mathematics import formula, symbol, tidy
from firmtouch.report.numbers import number, unit

MOST_ENTRIES: Final = 9
"""Entries up to which a matrix is written out."""


def section(design: Design) -> Section:
    """Write the model."""
    spec = design.model.spec
    blocks: list[Block] = [
        Paragraph(
            (
                f"The mechanism has {spec.n} generalised coordinates and is held by {spec.m} "
                f"constraint{'s' if spec.m > 1 else ''}, so that {spec.n - spec.m} "
                f"direction{'s are' if spec.n - spec.m > 1 else ' is'} free:",
            )
        ),
        Equation("M(q) dot.double(q) + theta(q, dot(q)) = J(q)^T lambda + u, quad Phi(q) = 0", "(4), (1)"),
        Paragraph(
            (
                Math("lambda_j > 0"),
                " pushes the mechanism towards growing ",
                Math("phi_j"),
                ". All numbers are in SI units.",
            )
        ),
        *(robot(design) if is_robot(design) else (_coordinates(design),)),
    ]
    if spec.parameters:
        blocks.append(_parameters(design))
    blocks += [recursion(design)] if is_robot(design) else _equations(design)
    return Section("Model", tuple(blocks))


def _coordinates(design: Design) -> Table:
    spec = design.model.spec
    rows: list[tuple[Line, ...]] = [
        ((Math(symbol(name)),), (unit(each.unit),), (each.label or "",)) for name, each in spec.coordinates.items()
    ]
    rows += [
        (
            (Math(f"phi_({_text(name)})"),),
            (unit(each.unit),),
            (each.label or "", " " if each.label else "", Code(each.written)),
        )
        for name, each in spec.constraints.items()
    ]
    return Table((("symbol",), ("unit",), ("coordinates and constraints",)), tuple(rows), wide=frozenset({2}))


def _parameters(design: Design) -> Table:
    rows: list[tuple[Line, ...]] = []
    for name, each in design.model.spec.parameters.items():
        interval = "" if each.interval is None else " to ".join(number(end.value) for end in each.interval)
        rows.append(
            ((Math(symbol(name)),), (number(each.value.value),), (unit(each.unit),), (interval,), (each.label or "",))
        )
    headings: tuple[Line, ...] = (("parameter",), ("value",), ("unit",), ("interval",), ("",))
    return Table(headings, tuple(rows), frozenset({1}), wide=frozenset({4}))


def _equations(design: Design) -> Iterator[Block]:
    if design.symbolic is None:
        yield Paragraph(("The equations are too long to be written out; their values at the operating point follow.",))
        return
    for group in _groups(design.symbolic):
        yield from group.blocks()


@dataclass(frozen=True, slots=True)
class _Group:
    """One derived quantity: its name in words and symbols, and its entries that are not zero."""

    words: str
    name: str
    entries: tuple[tuple[str, Any], ...]
    rates: frozenset[str]

    def blocks(self) -> Iterator[Block]:
        """Write the entries that can be read, and the size of the others."""
        few = len(self.entries) <= MOST_ENTRIES
        tidied = [(symbol_, entry, tidy(entry) if few else None) for symbol_, entry in self.entries]
        tidied = [each for each in tidied if each[2] != 0]
        if not tidied:
            yield Paragraph((f"{self.words} ", Math(self.name), " vanishes identically."))
            return
        readable = [(symbol_, short) for symbol_, _, short in tidied if short is not None]
        sizes = [entry.count_ops() for _, entry, short in tidied if short is None]
        if not readable:
            entries = f"{len(sizes)} entries of up to " if len(sizes) > 1 else ""
            yield Paragraph(
                (f"{self.words} ", Math(self.name), f": {entries}{max(sizes)} operations, not written out.")
            )
            return
        rest = (
            f" ({len(sizes)} of {len(tidied)} entries, of up to {max(sizes)} operations, are left out)" if sizes else ""
        )
        yield Paragraph((f"{self.words} ", Math(self.name), f"{rest}:"))
        for symbol_, short in readable:
            yield Equation(f"{symbol_} = {formula(short, self.rates)}")


def _groups(s: SymbolicPlant) -> Iterator[_Group]:
    rates = frozenset(map(str, s.qdot))
    names = list(s.spec.constraints)
    numbered = len(names) > 1
    phi = [f"phi_({_text(name)})" if numbered else "phi" for name in names]

    def group(words: str, name: str, entries: Iterable[tuple[str, Any]]) -> _Group:
        return _Group(words, name, tuple((each, entry) for each, entry in entries if entry != 0), rates)

    yield group("Potential energy", "P(q)", [("P", s.P)])
    yield group("Inertia matrix", "M(q)", _upper("M", s.M))
    yield group("Centrifugal, Coriolis and gravity forces", "theta(q, dot(q))", _column("theta", s.theta))
    yield group("Constraints", "Phi(q)", zip(phi, s.Phi, strict=True))
    yield group("Constraint Jacobian", "J(q)", _rectangle("J", s.J))
    yield group("Hessian of the potential", "P_(q q)(q)", _upper("P_(q q)", s.P_qq))
    for name, hessian in zip(phi, s.Phi_qq, strict=True):
        second = name.replace("phi", "phi''", 1)
        yield group("Constraint Hessian", f"{second}(q)", _upper(second, hessian))


def _upper(name: str, matrix: Any) -> Iterator[tuple[str, Any]]:  # noqa: ANN401  # SymPy has no types
    for i in range(matrix.shape[0]):
        for j in range(i, matrix.shape[1]):
            yield f"({name})_({i + 1} {j + 1})" if len(name) > 1 else f"{name}_({i + 1} {j + 1})", matrix[i, j]


def _rectangle(name: str, matrix: Any) -> Iterator[tuple[str, Any]]:  # noqa: ANN401  # SymPy has no types
    for i in range(matrix.shape[0]):
        for j in range(matrix.shape[1]):
            yield f"{name}_({i + 1} {j + 1})", matrix[i, j]


def _column(name: str, vector: Any) -> Iterator[tuple[str, Any]]:  # noqa: ANN401  # SymPy has no types
    for i, entry in enumerate(vector):
        yield f"{name}_{i + 1}", entry


def _text(name: str) -> str:
    return f'"{name.replace("_", " ")}"'
