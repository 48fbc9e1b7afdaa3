"""Step responses over a logarithmic axis of time, each by its own end value, with the marks of the rise time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from firmtouch.report.figures.canvas import INK, MUTED, as_svg, new_figure, styled
from firmtouch.report.figures.line_styles import APART, ROW, Styles, draw_legend, legend_rows, styles_of
from firmtouch.report.figures.thermal.stack import WIDTH
from firmtouch.report.numbers import number

Array = NDArray[np.floating[Any]]
HEIGHT, ABOVE, BELOW = 2.1, 0.26, 0.4
"""Of a panel, and the room above and under it, in inches."""
FONT: Final = 7.8
SINGLE: Final = 4.4
"""Width of a picture of one panel, in inches."""
DEEPEST: Final = -1.0
"""How far a response is followed that begins the wrong way."""
BEFORE: Final = 0.15
"""Of the earliest mark: where the axis of time begins."""


@dataclass(frozen=True, slots=True)
class Curve:
    """A response: its share of the end value at the times t (s), and where it passes the levels `marks` (s, share)."""

    t: Array
    share: Array
    marks: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class Panel:
    """Responses under one title, in the order of the names."""

    title: str
    curves: tuple[Curve, ...]


def responses_picture(names: Sequence[str], panels: Sequence[Panel], asked: float | None = None) -> str:
    """Draw panels side by side; `asked` (s) is the rise time that is asked for, as a line."""
    styles = styles_of(names, APART)
    with styled():
        width = WIDTH if len(panels) > 1 else SINGLE
        below = BELOW + ROW * legend_rows(styles.keys, width) + 0.05
        height = ABOVE + HEIGHT + below
        figure = new_figure(width, height, layout=None)
        sides = {
            "left": 0.58 / width,
            "right": 1 - 0.22 / width,
            "top": 1 - ABOVE / height,
            "bottom": below / height,
            "wspace": 0.2,
        }
        drawn = figure.subplots(1, len(panels), squeeze=False, gridspec_kw=sides)[0]
        for axes, panel in zip(drawn, panels, strict=True):
            _panel(axes, panel, styles, asked)
        drawn[0].set_ylabel("share of its end value", fontsize=FONT)
        draw_legend(figure, styles.keys, width)
        return as_svg(figure, "responses")


def _panel(axes: Any, panel: Panel, styles: Styles, asked: float | None) -> None:  # noqa: ANN401  # matplotlib
    axes.set_xscale("log")
    for curve, style in zip(panel.curves, styles.lines, strict=True):
        axes.plot(curve.t, curve.share, color=style.colour, linestyle=style.dash, linewidth=1.3, zorder=3)
        for t, level in curve.marks:
            axes.plot([t], [level], "o", color=style.colour, markersize=3.6, zorder=4)
    marks = [t for each in panel.curves for t, _ in each.marks if t > 0]
    for level in sorted({level for each in panel.curves for _, level in each.marks}):
        axes.axhline(level, color=MUTED, linewidth=0.7, linestyle=":", zorder=1)
    end = max(float(each.t[-1]) for each in panel.curves)
    axes.set_xlim(BEFORE * min(marks, default=1e-3 * end), end)
    least = min(float(each.share.min()) for each in panel.curves)
    axes.set_ylim(max(min(-0.04, 1.06 * least), DEEPEST), 1.06)
    if asked is not None and axes.get_xlim()[0] < asked < end:
        axes.axvline(asked, color=INK, linewidth=0.9, linestyle="--", zorder=1)
    axes.set_title(panel.title, fontsize=FONT, loc="left", parse_math=False)
    axes.set_xlabel("time after the touch", fontsize=FONT)
    log_axis(axes.xaxis, axes.get_xlim(), time_words)
    axes.set_yticks([0, 0.1, 0.5, 0.9, 1], ["0", "10 %", "50 %", "90 %", "1"])
    axes.tick_params(labelsize=FONT)


def log_axis(axis: Any, ends: tuple[float, float], words: Any) -> None:  # noqa: ANN401  # matplotlib
    """Name decades in words, which is drawn sooner than 10^k and read sooner too; of many, every second or third."""
    powers = np.arange(np.ceil(np.log10(ends[0] * 0.999)), np.floor(np.log10(ends[1] * 1.001)) + 1)
    every = int(np.ceil(len(powers) / 6))
    shown = [10.0**each for each in powers[::-1][::every][::-1]]
    axis.set_ticks(shown, [words(each) for each in shown])
    axis.set_ticks([10.0**each for each in powers], minor=True)
    axis.set_tick_params(which="minor", labelbottom=False, labelleft=False)


def time_words(seconds: float) -> str:
    """Write a power of ten of a second: 10 ms."""
    for size, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns")):
        if seconds >= size * 0.999:
            return f"{number(round(seconds / size, 6))} {unit}"
    return f"{number(seconds)} s"
