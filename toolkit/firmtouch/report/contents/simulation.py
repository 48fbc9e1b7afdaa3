"""The nonlinear closed loop in time: what the poles and the table promise, tried out."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.metadata import version

import numpy as np

from firmtouch.design import Design
from firmtouch.modelfile import ModelFile
from firmtouch.modelfile.vector_units import units_of
from firmtouch.regulation import OperatingPoint
from firmtouch.report.contents.prose import prose
from firmtouch.report.document import Block, Callout, Document, Figure, Line, Paragraph, Section, Table
from firmtouch.report.figures.trajectory import run_picture
from firmtouch.report.numbers import number
from firmtouch.simulation.trajectory import Trajectory
from firmtouch.simulation.trial import Run


def section(design: Design) -> Section | None:
    """Write the usual scenarios, if they were simulated."""
    if design.trial is None:
        return None
    op = design.loop.operating_point
    intro = (
        "The nonlinear mechanism under controller (17), from the same equations as the design: a rigid contact, a "
        "force signal that comes at once unless its path is named, and the drives’ limits where the file has them. "
        "Grey behind each line is what the linear theory predicts."
    )
    return Section("Simulation", (Paragraph(prose(intro)), *runs_as_blocks(design.trial.runs, op, "run")))


def simulation_document(model: ModelFile, op: OperatingPoint, runs: tuple[Run, ...]) -> Document:
    """Write a report of simulations alone."""
    blocks: list[Block] = [
        Callout("warning", prose(f"{each.trajectory.scenario.title}: {each.trajectory.reason}."))
        for each in runs
        if not each.trajectory.outcome.good
    ]
    text = "Grey behind each line is what the linear theory predicts for controller (17) with an ideal force signal."
    blocks += [Paragraph(prose(text)), *runs_as_blocks(runs, op, "run")]
    return Document(
        title=model.spec.title,
        subtitle=f"Simulation of the nonlinear closed loop · model {model.name} · SHA-256 {model.sha256[:12]}…",
        footer=f"firmtouch {version('firmtouch')} · model file SHA-256 {model.sha256}",
        sections=(Section("", tuple(blocks)),),
    )


def runs_as_blocks(runs: tuple[Run, ...], op: OperatingPoint, prefix: str) -> Iterator[Block]:
    """Write a table of runs, and each one's picture."""
    yield _table(runs, op)
    for i, each in enumerate(runs):
        title, reason = each.trajectory.scenario.title, each.trajectory.reason
        caption = prose(f"{title}: {reason}.")
        alt = f"Position error, constraint force and joint forces over time: {title}"
        yield Figure(run_picture(each, op, f"{prefix}{i}"), caption, alt, panels=3)


def _table(runs: tuple[Run, ...], op: OperatingPoint) -> Table:
    units = units_of(op.plant.spec)
    limited = any(each.trajectory.scenario.feedback.limits is not None for each in runs)
    headings: tuple[Line, ...] = (
        ("scenario",), ("outcome",), (f"largest error{_in(units.coordinate)}",),
        _force_heading(op, units.multiplier), ("largest joint force",), ("drift off the surface",),
    )  # fmt: skip
    rows = tuple(_row(each, op, limited=limited) for each in runs)
    return Table(headings, rows, frozenset({2, 3, 4, 5}), wide=frozenset({0, 1}))


def _row(run: Run, op: OperatingPoint, *, limited: bool) -> tuple[Line, ...]:
    trajectory = run.trajectory
    far = float(np.max(np.abs(trajectory.q - op.q_d)))
    limits = trajectory.scenario.feedback.limits
    if limited and limits is not None:
        drive = f"{number(100 * float(np.max(np.abs(trajectory.u) / limits)), 3)} % of its limit"
    else:
        drive = f"{number(float(np.max(np.abs(trajectory.u))), 3)} {units_of(op.plant.spec).joint_force}".rstrip()
    return (
        prose(trajectory.scenario.title),
        (trajectory.outcome.value,),
        (number(far, 3),),
        (_force(trajectory, op),),
        (drive,),
        (number(float(np.max(np.abs(trajectory.Phi))), 1),),
    )


def _force_heading(op: OperatingPoint, unit: str) -> Line:
    return (f"contact force{_in(unit)}",) if op.m == 1 else (f"largest force error{_in(unit or 'N or N m')}",)


def _force(trajectory: Trajectory, op: OperatingPoint) -> str:
    """Write the range of the only contact force, or the largest error of several, which may differ in unit."""
    if op.m > 1:
        return number(float(np.max(np.abs(trajectory.lambda_ - op.lambda_d))), 3)
    return f"{number(float(np.min(trajectory.lambda_)), 4)} to {number(float(np.max(trajectory.lambda_)), 4)}"


def _in(unit: str) -> str:
    return f", {unit}" if unit else ""
