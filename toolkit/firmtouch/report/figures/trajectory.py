"""A run over time: position error, constraint force, and what the drives do, with the linear prediction behind."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.modelfile.vector_units import units_of
from firmtouch.regulation import OperatingPoint
from firmtouch.report.figures.canvas import FORCE, MUTED, as_svg, new_figure, styled
from firmtouch.report.figures.line_styles import COLOURS, ROW, Key, Style, Styles, draw_legend, legend_rows, styles_of
from firmtouch.report.numbers import number

if TYPE_CHECKING:
    from firmtouch.simulation.trial import Run

FORCES: Final = ("#c2382b", "#e08a3c", "#7a1f5c", "#b5a642", "#3f3f74", "#1f7a8c")
PREDICTION: Final = Key("linear prediction", Style(MUTED))
MOST_DRAWN: Final = 1200
"""Instants that a line is drawn through."""
WIDTH, PANELS = 7.0, 1.66
"""Width of the picture and height of its panels, in inches."""
ABOVE, BELOW = 0.24, 0.36
"""Room for the titles, and for the numbers and names under the panels, in inches."""
SMALLEST_PLAIN, LARGEST_PLAIN = 1e-3, 1e5
"""Numbers beyond these are written with powers of ten."""


def run_picture(run: Run, op: OperatingPoint, prefix: str) -> str:
    """Draw a run, in three panels."""
    trajectory, spec = run.trajectory, op.plant.spec
    units = units_of(spec)
    names, constraints = list(spec.coordinates), list(spec.constraints)
    joints, forces = styles_of(names, COLOURS), styles_of(constraints, FORCES)
    keys = (*joints.keys, *forces.keys, PREDICTION)
    with styled():
        below = BELOW + ROW * legend_rows(keys, WIDTH) + 0.05
        height = ABOVE + PANELS + below
        figure = new_figure(WIDTH, height, layout=None)
        sides = {"left": 0.075, "right": 0.985, "top": 1 - ABOVE / height, "bottom": below / height, "wspace": 0.28}
        position, force, drive = figure.subplots(1, 3, gridspec_kw=sides)
        predicted = (run.prediction.t, run.prediction.q - op.q_d)
        _lines(position, trajectory.t, trajectory.q - op.q_d, joints, behind=predicted)
        _name(position, "position error", units.coordinate or "rad or m")
        _draw_force(force, run, op, forces, units.multiplier or "N or N m")
        limits = trajectory.scenario.feedback.limits
        if limits is None:
            _lines(drive, trajectory.t, trajectory.u, joints)
            _name(drive, "joint force u", units.joint_force or "N m or N")
        else:
            _lines(drive, trajectory.t, 100 * trajectory.u / limits, joints)
            for side in (-100, 100):
                drive.axhline(side, color=FORCE, linewidth=0.9, linestyle=(0, (5, 2)))
            _name(drive, "joint force", "% of its limit")
        for axes in (position, force, drive):
            axes.set_xlabel("time, s", fontsize=7.5)
            axes.tick_params(labelsize=7)
            axes.margins(x=0.01)
            _write_numbers_out(axes)
        draw_legend(figure, keys, WIDTH)
        return as_svg(figure, prefix)


def _draw_force(
    axes: Any,  # noqa: ANN401  # matplotlib
    run: Run,
    op: OperatingPoint,
    styles: Styles,
    unit: str,
) -> None:
    """Draw the only contact force itself, or of several their errors, which are of one size."""
    behind, values = (run.prediction.t, run.prediction.lambda_), run.trajectory.lambda_
    if op.m > 1:
        _lines(axes, run.trajectory.t, values - op.lambda_d, styles, behind=(behind[0], behind[1] - op.lambda_d))
        _name(axes, "constraint-force error", unit)
        return
    axes.axhline(op.lambda_d[0], color=MUTED, linewidth=0.8, linestyle=":", zorder=1)
    _lines(axes, run.trajectory.t, values, styles, behind=behind)
    _name(axes, "constraint force", unit)


def _lines(
    axes: Any,  # noqa: ANN401  # matplotlib
    t: Array,
    values: Array,
    styles: Styles,
    *,
    behind: tuple[Array, Array] | None = None,
) -> None:
    every = max(1, t.size // MOST_DRAWN)
    for i, style in enumerate(styles.lines):
        if behind is not None:
            axes.plot(behind[0], behind[1][:, i], color=MUTED, alpha=0.45, linewidth=2.6, zorder=2)
        axes.plot(t[::every], values[::every, i], color=style.colour, linestyle=style.dash, linewidth=1.2, zorder=3)
    low, high = float(np.min(values)), float(np.max(values))
    if behind is not None:
        low, high = min(low, float(np.min(behind[1]))), max(high, float(np.max(behind[1])))
    least = 1e-6 * max(1.0, abs(low), abs(high))
    if high - low < least:  # a line that rests is no noise to be magnified
        axes.set_ylim(low - 1e3 * least, high + 1e3 * least)


def _write_numbers_out(axes: Any) -> None:  # noqa: ANN401  # matplotlib
    """Put no common factor or summand above the axis, which would push the title out of the picture."""
    largest = max(abs(each) for each in axes.get_ylim())
    if SMALLEST_PLAIN <= largest < LARGEST_PLAIN:
        axes.ticklabel_format(axis="y", style="plain", useOffset=False)
    else:
        axes.yaxis.set_major_formatter(lambda value, _: number(value, 2))


def _name(axes: Any, title: str, unit: str) -> None:  # noqa: ANN401  # matplotlib
    axes.set_title(f"{title}, {unit}", fontsize=8, loc="left")
