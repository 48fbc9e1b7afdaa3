"""Steady-state errors: what constant errors of the world do to position and force."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from firmtouch.design import Design
from firmtouch.mechanics import Array
from firmtouch.modelfile.vector_units import units_of
from firmtouch.regulation import SteadyStateError
from firmtouch.report.contents.operating_point import as_matrix
from firmtouch.report.document import Block, Equation, Line, Math, Matrices, Paragraph, Section, Table
from firmtouch.report.numbers import number, vector
from firmtouch.simulation.steady import EXACT, SimulatedError
from firmtouch.simulation.trajectory import Outcome

NO_BREAK: Final = "\N{NO-BREAK SPACE}"
LONGEST: Final = 7
"""Entries up to which a vector stands in a table whole."""
MANY: Final = 4
"""Semi-axes up to which all are told."""
LARGEST: Final = 4
"""Entries that are told of a longer one."""


def section(design: Design) -> Section:
    """Write the errors."""
    errors, m = design.steady_state, design.loop.operating_point.m
    blocks: list[Block] = [
        Paragraph(
            (
                "If the world differs from the model by a constant, the closed loop comes to rest a little off. "
                "These predictions are exact in first order.",
            )
        ),
        Equation("delta q = T d, quad delta lambda = -Lambda (J K^(-1) J^T)^(-1) J K^(-1) d", "(25), (26)"),
        Equation("T = V_2 K_22^(-1) V_2^T, quad Lambda = (I + G_f)^(-1)"),
        Equation(
            "delta q = K^(-1) J^T (J K^(-1) J^T)^(-1) Delta, quad delta lambda = Lambda (J K^(-1) J^T)^(-1) Delta",
            "(31), (32)",
        ),
        Equation("delta q = 0, quad delta lambda = -(R^T + G_f)^(-1) (R^T - I) lambda_d", "(35), (36)"),
        _worst(design),
    ]
    if m == 1:
        text = "With one constraint the paper's rotation R can only be ±1, so its row is empty; "
        blocks.append(Paragraph((text + "a real error of the surface's normal is the tilt.",)))
    blocks += [
        Paragraph(("Per unit of a constant force ", Math("d"), " and of an offset ", Math("Delta"), ":")),
        Matrices(
            (
                as_matrix("delta q slash d", errors.force.position),
                as_matrix("delta lambda slash d", errors.force.constraint_force),
                as_matrix("delta q slash Delta", errors.offset.position),
                as_matrix("delta lambda slash Delta", errors.offset.constraint_force),
            )
        ),
        Paragraph(
            (
                "Wrong gravity acts as the force ",
                Math("d = hat(g) - g"),
                ", a tilt ",
                Math("J -> J + E"),
                " as ",
                Math("d = E^T lambda_d"),
                ". Stiffer position gains help against forces and harm the contact force under offsets, "
                "which grows with ",
                Math("K"),
                "; force feedback divides every force error by ",
                Math("I + G_f"),
                ".",
            )
        ),
    ]
    return Section("Steady-state errors", tuple(blocks))


def _worst(design: Design) -> Table:
    errors, units = design.steady_state, units_of(design.model.spec)
    m = design.loop.operating_point.m
    simulated = design.trial.steady_state if design.trial is not None else None
    named: list[tuple[str, str, str, str]] = [
        ("force", "constant force", "d", units.joint_force),
        ("offset", "surface offset", "Delta", units.offset),
        ("tilt", "surface tilt", "E^T lambda_d", "rad"),
    ]
    if m > 1:
        named.append(("rotation", "rotation", "(R^T - I) lambda_d", "rad"))
    spec = design.model.spec
    names = {"coordinate": list(spec.coordinates), "constraint": list(spec.constraints)}
    rows: list[tuple[Line, ...]] = []
    for name, words, symbol, unit in named:
        error: SteadyStateError = getattr(errors, name)
        tried = getattr(simulated, name) if simulated is not None else (None, None)
        first: Line = (f"{words}, {_bound(error.bound, unit)}{'' if error.given else ' (no bound given)'}",)
        for effect, worst, of_effect, found in (
            ("delta q", error.worst_position, units.coordinate, tried[0]),
            ("delta lambda", error.worst_constraint_force, units.multiplier, tried[1]),
        ):
            if worst.value > 0:
                of_cause = names["constraint" if name == "offset" else "coordinate"]
                cause: Line = (Math(symbol), f" = {_direction(worst.cause, of_cause)}")
                value: Line = (f"{number(worst.value, 3)} {of_effect}".rstrip(),)
                of_rows = names["coordinate" if effect == "delta q" else "constraint"]
                cells = [first, (Math(f"abs({effect})"),), value, cause, (_direction(worst.effect, of_rows),)]
                if simulated is not None:
                    cells.insert(3, _simulated(found, of_effect))
                rows.append(tuple(cells))
                first = ("",)
    broad = {0} if spec.n > LONGEST else set()
    headings: list[Line] = [("cause, bound",), ("",), ("worst",), ("taken at",), ("where the effect is",)]
    caption = "Worst cases, with the direction in which they are taken."
    if simulated is None:
        return Table(tuple(headings), tuple(rows), frozenset({2}), (caption,), frozenset({3, 4, *broad}))
    headings.insert(3, ("simulated",))
    caption += (
        " Simulated: what the nonlinear loop came to rest with, how far that is from the prediction, relative to it, "
        "and the order with which this falls as the cause is halved twice: 1 where the prediction is exact in first "
        "order, and none where the deviation turns its direction meanwhile."
    )
    return Table(tuple(headings), tuple(rows), frozenset({2}), (caption,), frozenset({3, 4, 5, *broad}))


def _direction(values: Array, names: Sequence[str]) -> str:
    """Write a vector, or of a long one its largest entries with what they belong to."""
    if len(values) <= LONGEST or len(values) != len(names):
        return vector(values)
    largest = sorted(range(len(values)), key=lambda i: -abs(values[i]))[:LARGEST]
    told = ", ".join(f"{names[i].replace('_', ' ')} {number(float(values[i]), 3)}" for i in sorted(largest))
    return f"{told}; others smaller"


def _simulated(found: SimulatedError | None, unit: str) -> Line:
    if found is None:
        return ("",)
    whole = found.parts[0] == 1
    share = "" if whole else f" for {number(float(found.parts[0]), 2)} of it"
    if found.outcome is not Outcome.CONVERGED:
        return (f"{found.outcome.value}{share}",)  # where that happened is no effect of the kind that is predicted
    value = f"{number(float(np.linalg.norm(found.effects[0])), 3)}{NO_BREAK}{unit}".rstrip()
    off = number(100 * float(found.deviations[0]), 2) if found.deviations[0] > EXACT else "0"
    order = "" if np.isnan(found.order) else f", order{NO_BREAK}{number(found.order, 2)}"
    return (f"{value}{share}, {off}{NO_BREAK}%{NO_BREAK}off{order}",)


def _bound(bound: float | Array, unit: str) -> str:
    values = [bound] if isinstance(bound, float) else [float(each) for each in bound]
    if len(set(values)) == 1:
        return f"up to {number(values[0], 3)} {unit}"
    if len(values) > MANY:
        return f"semi-axes of {number(min(values), 3)} to {number(max(values), 3)}"
    return f"semi-axes {vector(values)}"
