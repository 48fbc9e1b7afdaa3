"""A run over time: position error, constraint force, and what the drives do, with the linear prediction behind."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.modelfile.vector_units import units_of
from firmtouch.regulation import OperatingPoint
from firmtouch.report.figures.canvas import FORCE, MUTED, as_svg, new_figure, styled

if TYPE_CHECKING:
    from firmtouch.simulation.trial import Run

FORCES: Final = ("#c2382b", "#e08a3c", "#7a1f5c", "#b5a642", "#3f3f74")
COLOURS: Final = ("#2b5c8a", "#c07a1f", "#2f7d4f", "#8a3f8f", "#1b9aaa", "#8c5a4a", "#5a6f8c", "#7c6f2c")
MOST_DRAWN: Final = 1200
"""Instants that a line is drawn through."""
MOST_COLUMNS: Final = 7
HEIGHT: Final = 2.4


def run_picture(run: Run, op: OperatingPoint, prefix: str) -> str:
    """Draw a run, in three panels."""
    trajectory, spec = run.trajectory, op.plant.spec
    units = units_of(spec)
    names, constraints = list(spec.coordinates), list(spec.constraints)
    with styled():
        entries = len(names) + len(constraints) + 1
        figure = new_figure(7.0, HEIGHT, layout=None)
        below = 0.2 if entries <= MOST_COLUMNS else 0.26
        sides = {"left": 0.075, "right": 0.985, "top": 0.9, "bottom": below + 0.11, "wspace": 0.28}
        position, force, drive = figure.subplots(1, 3, gridspec_kw=sides)
        predicted = (run.prediction.t, run.prediction.q - op.q_d)
        _lines(position, trajectory.t, trajectory.q - op.q_d, COLOURS, behind=predicted)
        _name(position, "position error", units.coordinate or "rad or m")
        _draw_force(force, run, op, units.multiplier or "N or N m")
        limits = trajectory.scenario.feedback.limits
        if limits is None:
            _lines(drive, trajectory.t, trajectory.u, COLOURS)
            _name(drive, "joint force u", units.joint_force or "N m or N")
        else:
            _lines(drive, trajectory.t, 100 * trajectory.u / limits, COLOURS)
            for side in (-100, 100):
                drive.axhline(side, color=FORCE, linewidth=0.9, linestyle=(0, (5, 2)))
            _name(drive, "joint force", "% of its limit")
        for axes in (position, force, drive):
            axes.set_xlabel("time, s", fontsize=7.5)
            axes.tick_params(labelsize=7)
            axes.margins(x=0.01)
        _legend(figure, names, constraints)
        return as_svg(figure, prefix)


def _draw_force(axes: Any, run: Run, op: OperatingPoint, unit: str) -> None:  # noqa: ANN401  # matplotlib
    """Draw the only contact force itself, or of several their errors, which are of one size."""
    behind, values = (run.prediction.t, run.prediction.lambda_), run.trajectory.lambda_
    if op.m > 1:
        _lines(axes, run.trajectory.t, values - op.lambda_d, FORCES, behind=(behind[0], behind[1] - op.lambda_d))
        _name(axes, "constraint-force error", unit)
        return
    axes.axhline(op.lambda_d[0], color=MUTED, linewidth=0.8, linestyle=":", zorder=1)
    _lines(axes, run.trajectory.t, values, FORCES, behind=behind)
    _name(axes, "constraint force", unit)


def _lines(
    axes: Any,  # noqa: ANN401  # matplotlib
    t: Array,
    values: Array,
    colours: Sequence[str],
    *,
    behind: tuple[Array, Array] | None = None,
) -> None:
    every = max(1, t.size // MOST_DRAWN)
    for i in range(values.shape[1]):
        colour = colours[i % len(colours)]
        if behind is not None:
            axes.plot(behind[0], behind[1][:, i], color=MUTED, alpha=0.45, linewidth=2.6, zorder=2)
        axes.plot(t[::every], values[::every, i], color=colour, linewidth=1.2, zorder=3)
    low, high = float(np.min(values)), float(np.max(values))
    if behind is not None:
        low, high = min(low, float(np.min(behind[1]))), max(high, float(np.max(behind[1])))
    least = 1e-6 * max(1.0, abs(low), abs(high))
    if high - low < least:  # a line that rests is no noise to be magnified
        axes.set_ylim(low - 1e3 * least, high + 1e3 * least)


def _name(axes: Any, title: str, unit: str) -> None:  # noqa: ANN401  # matplotlib
    axes.set_title(f"{title}, {unit}", fontsize=8, loc="left")


def _legend(figure: Any, names: list[str], constraints: list[str]) -> None:  # noqa: ANN401  # matplotlib
    """Name the lines once for all panels."""
    from matplotlib.lines import Line2D

    def line(colour: str) -> Line2D:
        return Line2D([], [], color=colour, linewidth=1.4)

    handles = [line(COLOURS[i % len(COLOURS)]) for i in range(len(names))]
    handles += [line(FORCES[i % len(FORCES)]) for i in range(len(constraints))]
    handles.append(Line2D([], [], color=MUTED, alpha=0.45, linewidth=2.6))
    labels = [*names, *constraints, "linear prediction"]
    columns = min(len(labels), MOST_COLUMNS)
    figure.legend(handles, labels, loc="lower center", ncols=columns, fontsize=7.5, handlelength=1.6)
