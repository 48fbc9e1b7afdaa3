"""The regulation point and the plant there."""

from __future__ import annotations

import numpy as np

from firmtouch.design import Design
from firmtouch.mechanics import Array
from firmtouch.report.document import Block, Equation, Line, Math, Matrices, Matrix, Paragraph, Section, Table
from firmtouch.report.mathematics import symbol
from firmtouch.report.numbers import matrix, number


def section(design: Design) -> Section:
    """Write the operating point."""
    op = design.loop.operating_point
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
        Paragraph(("There the plant has",)),
        Matrices(
            (
                as_matrix("M", op.M),
                as_matrix("J", op.J),
                as_matrix("g = P_q", op.g),
                as_matrix("P_(q q)", op.P_qq),
                *(as_matrix(name, H) for name, H in zip(hessian_names(design), op.constraint_hessians, strict=True)),
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
    return Matrix(Math(name), matrix(values), unit)


def hessian_names(design: Design) -> list[str]:
    """Name the constraint Hessians."""
    names = list(design.model.spec.constraints)
    return ["phi''"] if len(names) == 1 else [f"phi''_{j + 1}" for j in range(len(names))]


def _configuration(design: Design) -> Table:
    op, spec = design.loop.operating_point, design.model.spec
    rows = []
    for i, (name, each) in enumerate(spec.coordinates.items()):
        degrees = f"{number(float(np.degrees(op.q_d[i])), 4)}°" if each.unit == "rad" else ""
        effort = "N m" if each.unit == "rad" else "N"
        texts = (number(float(op.q_d[i]), 6), each.unit, degrees, f"{number(float(op.f_d[i]))} {effort}")
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
