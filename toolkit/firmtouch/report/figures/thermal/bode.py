"""Bode diagrams: magnitude over phase, for several curves, in columns side by side."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from firmtouch.report.figures.canvas import FORCE, INK, MUTED, as_svg, new_figure, styled
from firmtouch.report.figures.line_styles import (
    APART,
    ROW,
    Key,
    Style,
    draw_legend,
    legend_rows,
    styles_of,
)
from firmtouch.report.figures.thermal.responses import SINGLE, Array, log_axis
from firmtouch.report.figures.thermal.stack import WIDTH
from firmtouch.report.numbers import number

FONT: Final = 7.8
MAGNITUDE, PHASE, ABOVE, BELOW, BETWEEN = 1.7, 1.15, 0.26, 0.4, 0.14
"""Heights, in inches."""
STEPS: Final = (15, 30, 45, 90, 180, 360, 720, 1800)
"""Between the phase's ticks, in degrees."""
DEEPEST: Final = 540.0
"""Degrees: how far a dead time's phase is followed."""


@dataclass(frozen=True, slots=True)
class BodeCurve:
    """Magnitude and phase (degrees) at frequencies f (Hz); the one of `None` is of nothing touched."""

    name: str | None
    f: Array
    magnitude: Array
    phase: Array


@dataclass(frozen=True, slots=True)
class BodePanel:
    """Curves under one title; `unity` draws the lines |L| = 1 and -180 degrees."""

    title: str
    curves: tuple[BodeCurve, ...]
    unity: bool = False


def bode_picture(names: Sequence[str], panels: Sequence[BodePanel]) -> str:
    """Draw panels side by side; the names give the lines' styles, the same in all panels."""
    found = styles_of(names, APART)
    styles: dict[str | None, Style] = dict(zip(names, found.lines, strict=True))
    keys = found.keys
    if any(each.name is None for panel in panels for each in panel.curves):
        styles[None] = Style(INK, (0, (1.2, 1.1)))
        keys = (*keys, Key("nothing touched", styles[None]))
    with styled():
        width = WIDTH if len(panels) > 1 else SINGLE
        below = BELOW + ROW * legend_rows(keys, width) + 0.05
        height = ABOVE + MAGNITUDE + BETWEEN + PHASE + below
        figure = new_figure(width, height, layout=None)
        sides: dict[str, Any] = {
            "left": 0.67 / width,
            "right": 1 - 0.22 / width,
            "wspace": 0.27,
            "height_ratios": [MAGNITUDE, PHASE],
        }
        sides |= {"top": 1 - ABOVE / height, "bottom": below / height, "hspace": 2 * BETWEEN / (MAGNITUDE + PHASE)}
        drawn = figure.subplots(2, len(panels), squeeze=False, sharex="col", gridspec_kw=sides)
        for column, panel in enumerate(panels):
            _panel(drawn[0][column], drawn[1][column], panel, styles)
        drawn[0][0].set_ylabel("magnitude", fontsize=FONT)
        drawn[1][0].set_ylabel("phase", fontsize=FONT)
        draw_legend(figure, keys, width)
        return as_svg(figure, "bode")


def _panel(above: Any, below: Any, panel: BodePanel, styles: dict[str | None, Style]) -> None:  # noqa: ANN401  # matplotlib
    for axes in (above, below):
        axes.set_xscale("log")
        axes.tick_params(labelsize=FONT)
    above.set_yscale("log")
    for curve in panel.curves:
        style = styles[curve.name]
        line = {"color": style.colour, "linestyle": style.dash, "linewidth": 1.3}
        above.plot(curve.f, curve.magnitude, **line)
        below.plot(curve.f, curve.phase, **line)
    if panel.unity:
        above.axhline(1.0, color=FORCE, linewidth=0.9, linestyle="--", zorder=1)
        below.axhline(-180.0, color=FORCE, linewidth=0.9, linestyle="--", zorder=1)
    ends = float(panel.curves[0].f[0]), float(panel.curves[0].f[-1])
    above.set_xlim(*ends)
    log_axis(below.xaxis, ends, frequency_words)
    above.tick_params(labelbottom=False)
    least, most = _span(panel)
    above.set_ylim(least, most)
    log_axis(above.yaxis, (least, most), _power)
    _degrees(below, panel)
    above.set_title(panel.title, fontsize=FONT, loc="left", parse_math=False)
    below.set_xlabel("frequency", fontsize=FONT)
    for axes in (above, below):
        axes.yaxis.label.set_color(MUTED)


def _span(panel: BodePanel) -> tuple[float, float]:
    """Give whole decades about the magnitudes, a half decade apart from them at most."""
    sizes = np.concatenate([each.magnitude for each in panel.curves])
    low, high = float(sizes[sizes > 0].min()), float(sizes.max())
    return max(low, 1e-6 * high) / 1.6, 1.6 * max(high, 1.0 if panel.unity else 0.0)


def _degrees(axes: Any, panel: BodePanel) -> None:  # noqa: ANN401  # matplotlib
    phases = np.concatenate([each.phase for each in panel.curves])
    low, high = max(float(phases.min()), -DEEPEST), float(phases.max())
    if panel.unity:
        low = min(low, -190.0)
    step = next((each for each in STEPS if (high - low) / each <= 5), STEPS[-1])
    ticks = [step * i for i in range(math.floor(low / step), math.ceil(high / step) + 1)]
    axes.set_yticks(ticks, [f"{number(each)}°" for each in ticks])
    axes.set_ylim(low - 0.08 * (high - low), high + 0.08 * (high - low))


def frequency_words(hertz: float) -> str:
    """Write a power of ten of a hertz: 10 kHz."""
    for size, unit in ((1e6, "MHz"), (1e3, "kHz"), (1.0, "Hz"), (1e-3, "mHz"), (1e-6, "µHz")):
        if hertz >= size * 0.999:
            return f"{number(round(hertz / size, 6))} {unit}"
    return f"{number(hertz)} Hz"


def _power(value: float) -> str:
    return number(value).replace("1×", "") if value >= 1e5 or value < 1e-3 else number(value)
