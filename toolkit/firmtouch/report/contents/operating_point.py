"""The regulation point and the plant there."""

from __future__ import annotations

from typing import Final

import numpy as np

from firmtouch.design import Design
from firmtouch.mechanics import Array
from firmtouch.regulation import OperatingPoint
from firmtouch.report.contents.reached import configurations
from firmtouch.report.document import Block, Equation, Line, Math, Matrices, Matrix, Paragraph, Section, Table
from firmtouch.report.mathematics import symbol
from firmtouch.report.numbers import entries, matrix, number

LONGEST_COLUMN: Final = 8
"""Entries up to which a column is written as one, and up to which a row has all figures."""
FIGURES, FEWER_FIGURES = 4, 3


def section(design: Design) -> Section:
    """Write the operating point."""
    op = design.loop.operating_point
    if op.reached is not None:
        found = "found by inverse kinematics"
    else:
        found = f"the projection moved the given configuration by {number(op.moved, 2)}" if op.moved else "as given"
    blocks: list[Block] = [
        Paragraph(
            (
                "The mechanism shall rest at ",
                Math("q_d"),
                " and press with ",
                Math("f_d = J^T lambda_d"),
                f" ({found}):",
            )
        ),
        _configuration(design),
        _multipliers(design),
        *(configurations(op.reached, design.model.spec) if op.reached is not None else ()),
        Paragraph(("There, with ", Math("g = P_q"), ", the plant has")),
        Matrices(
            (
                as_matrix("M", op.M),
                as_matrix("J", op.J),
                as_vector("g", op.g),
                as_matrix("P_(q q)", op.P_qq),
                *curvatures(op),
                as_matrix("N_0", op.N0),
            )
        ),
        Equation("N_0 = P_(q q) - sum_j lambda_(d j) phi''_j"),
        Paragraph(
            (
                Math("N_0"),
                " is the stiffness that the plant brings by itself. The curvature of the constraints, weighted with "
                "the multipliers, is part of it: ",
                next(each.detail for each in design.checks.results if each.name == "lambda-Hessian"),
                ".",
            )
        ),
    ]
    return Section("Operating point", tuple(blocks))


def as_matrix(name: str, values: Array, unit: str = "") -> Matrix:
    """Make the block of a matrix of numbers."""
    columns = values.shape[1] if values.ndim > 1 else 1
    return Matrix(Math(name), matrix(values, FIGURES if columns <= LONGEST_COLUMN else FEWER_FIGURES), unit)


def as_vector(name: str, values: Array) -> Matrix:
    """Make the block of a column of numbers, laid on its side where it would be long."""
    if len(values) <= LONGEST_COLUMN:
        return as_matrix(name, values)
    plain = name.isalpha()
    return as_matrix(f"{name}^T" if plain else f"({name})^T", values[None, :])


def curvatures(op: OperatingPoint) -> tuple[Matrix, ...]:
    """Make the blocks of the constraint Hessians, or of many large ones that of their weighted sum in N_0."""
    if op.n > LONGEST_COLUMN and op.m > 1:
        weighted = np.tensordot(op.lambda_d, op.constraint_hessians, axes=1)
        return (as_matrix("sum_j lambda_(d j) phi''_j", weighted),)
    names = ["phi''"] if op.m == 1 else [f"phi''_{j + 1}" for j in range(op.m)]
    return tuple(as_matrix(name, each) for name, each in zip(names, op.constraint_hessians, strict=True))


def _configuration(design: Design) -> Table:
    op, spec = design.loop.operating_point, design.model.spec
    rows = []
    listed = zip(
        spec.coordinates.items(), entries(op.q_d, 6), entries(np.degrees(op.q_d)), entries(op.f_d), strict=True
    )
    for (name, each), q_d, degrees, f_d in listed:
        effort = "N m" if each.unit == "rad" else "N"
        texts = (q_d, each.unit, f"{degrees}°" if each.unit == "rad" else "", f"{f_d} {effort}")
        row: tuple[Line, ...] = ((Math(symbol(name)),), *((text,) for text in texts))
        rows.append(row)
    headings = (("coordinate",), (Math("q_d"),), ("unit",), ("",), (Math("f_d"),))
    return Table(headings, tuple(rows), frozenset({1, 3, 4}))


def _multipliers(design: Design) -> Table:
    op, spec = design.loop.operating_point, design.model.spec
    rows = []
    for value, (name, each) in zip(op.lambda_d, spec.constraints.items(), strict=True):
        unit = {"m": "N", "rad": "N m"}.get(each.unit, f"J/({each.unit})")
        rows.append(((name.replace("_", " "),), (number(float(value)),), (unit,), (each.label or "",)))
    return Table(
        (("constraint",), (Math("lambda_d"),), ("unit",), ("",)), tuple(rows), frozenset({1}), wide=frozenset({3})
    )
