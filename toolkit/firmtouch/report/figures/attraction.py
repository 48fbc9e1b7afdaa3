"""The proven region of attraction beside what simulation finds, for one or two free directions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.report.figures.canvas import ARM, FORCE, GOOD, INK, MUTED, as_svg, new_figure, styled

if TYPE_CHECKING:
    from firmtouch.certificate.attraction import Attraction
    from firmtouch.certificate.attraction.comparison import Comparison

PROVEN: Final = "#e4f2e9"
HIGHEST: Final = 2.2
"""How far above the level the curve is drawn, in levels."""


def attraction_picture(attraction: Attraction, comparison: Comparison, prefix: str = "attraction") -> str:
    """Draw the proven region and the simulated starts at rest, over the free coordinates x2 in rad or m.

    With one of them, over it stands P_cd along the surface; with two, the border of {P_cd < c}.
    """
    with styled():
        figure = new_figure(5.0, 3.2 if attraction.chart.free == 1 else 3.8)
        axes = figure.subplots()
        if attraction.chart.free == 1:
            _draw_line(axes, comparison)
        else:
            _draw_plane(axes, comparison)
        axes.tick_params(labelsize=8)
        figure.legend(loc="outside upper center", ncols=2, fontsize=8, handlelength=1.8)
        return as_svg(figure, prefix)


def _draw_line(axes, comparison: Comparison) -> None:  # type: ignore[no-untyped-def]  # noqa: ANN001  # matplotlib
    """Draw p along the only free direction with the level, and the starts on the curve."""
    x, p = comparison.line.T
    level = comparison.level
    axes.axvspan(*_around_zero(x, p, level), facecolor=PROVEN, edgecolor="none", zorder=0, label="proven to converge")
    axes.plot(x, p, "-", color=ARM, linewidth=1.3, zorder=2, label="$P_{cd}$ along the surface")
    axes.axhline(level, color=GOOD, linewidth=1.0, linestyle="--", zorder=1)
    axes.annotate(
        f"c = {level:.3g} J", (1, level), xycoords=("axes fraction", "data"), xytext=(-3, 3),
        textcoords="offset points", ha="right", fontsize=8, color=GOOD,
    )  # fmt: skip
    starts = comparison.starts[:, 0]
    _mark_starts(axes, starts, np.interp(starts, x, p), comparison)
    shown = p[np.isfinite(p)]
    lowest = max(float(shown.min()), -0.8 * level)
    axes.set_ylim(lowest - 0.12 * level, min(float(shown.max()), HIGHEST * level) + 0.12 * level)
    axes.margins(x=0.04)
    axes.set_xlabel("distance along the free direction at $q_d$, rad or m", fontsize=8)
    axes.set_ylabel("$P_{cd}$, J", fontsize=8)


def _around_zero(x: Array, p: Array, level: float) -> tuple[float, float]:
    """Give the ends of the run of points around x = 0 where p < level."""
    outside = x[np.logical_not(p < level)]
    left, right = outside[outside < 0], outside[outside > 0]
    low, high = left.max() if left.size else x[0], right.min() if right.size else x[-1]
    run = x[(x > low) & (x < high)] if left.size or right.size else x
    return float(run.min()), float(run.max())


def _draw_plane(axes, comparison: Comparison) -> None:  # type: ignore[no-untyped-def]  # noqa: ANN001  # matplotlib
    """Draw the border of the region in both free directions."""
    x, y = comparison.line.T
    label = f"proven to converge: $P_{{cd}}$ < {comparison.level:.3g} J"
    axes.fill(x, y, facecolor=PROVEN, edgecolor=GOOD, linewidth=1.2, zorder=1, label=label)
    axes.plot([0], [0], "+", color=INK, markersize=8, markeredgewidth=1.3, zorder=4, label="$q_d$")
    _mark_starts(axes, comparison.starts[:, 0], comparison.starts[:, 1], comparison)
    for limit, set_limit in zip(comparison.window, (axes.set_xlim, axes.set_ylim), strict=True):
        set_limit(-1.06 * limit, 1.06 * limit)
    axes.set_xlabel("along the softest free direction at $q_d$, rad or m", fontsize=8)
    axes.set_ylabel("along the stiffer one, rad or m", fontsize=8)


def _mark_starts(axes, x, y, comparison: Comparison) -> None:  # type: ignore[no-untyped-def]  # noqa: ANN001  # matplotlib
    """Mark where a simulation started, by what became of it."""
    good = comparison.converge > 0
    axes.plot(x[good], y[good], "o", color=MUTED, markersize=3, zorder=3, label="simulated, converges")
    if not np.all(good):
        axes.plot(x[~good], y[~good], "x", color=FORCE, markersize=5, zorder=3, label="simulated, does not")
