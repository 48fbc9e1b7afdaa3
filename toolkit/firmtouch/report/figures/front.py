"""A Pareto front: how much of one objective another one costs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from firmtouch.report.figures.canvas import ARM, FORCE, INK, as_svg, new_figure, styled
from firmtouch.report.numbers import number

WIDE: Final = 20.0
"""A ratio of an axis' ends from which it is logarithmic."""


@dataclass(frozen=True, slots=True)
class Axis:
    """What is told along an axis of a front: its words, its unit, and a value for each design."""

    words: str
    unit: str
    values: tuple[float, ...]

    @property
    def label(self) -> str:
        """Write it beside the axis."""
        return f"{self.words}, {self.unit}" if self.unit else self.words


@dataclass(frozen=True, slots=True)
class Tradeoff:
    """A front to be drawn: the first design is best in x alone, the last in y alone, if there are no colours.

    `chosen` is the design itself (x, y), if it lies on the front; `colour` is a third objective.
    """

    x: Axis
    y: Axis
    chosen: tuple[float, float] | None = None
    colour: Axis | None = None


def front_chart(front: Tradeoff, prefix: str = "front") -> str:
    """Draw a front with its two ends named, and the design itself where it lies on it; there must be a point.

    A front of three objectives is a surface, seen along the third, which is told by colours.
    """
    xs, ys = np.array(front.x.values), np.array(front.y.values)
    with styled():
        figure = new_figure(5.0, 3.2)
        axes = figure.subplots()
        if front.colour is None:
            axes.plot(xs, ys, "-", color=ARM, linewidth=1.3, zorder=2)
            axes.plot(xs[1:-1], ys[1:-1], "o", color=ARM, markersize=4, zorder=3)
            axes.plot(xs[[0, -1]], ys[[0, -1]], "s", color=ARM, markersize=6, zorder=3)
        else:
            _coloured(figure, axes, front)
        if front.chosen is not None:
            axes.plot(
                [front.chosen[0]], [front.chosen[1]], "o", markersize=11, markerfacecolor="none",
                markeredgecolor=FORCE, markeredgewidth=1.8, label="this design", zorder=4,
            )  # fmt: skip
            figure.legend(loc="outside upper right", fontsize=8)
        for values, scale, axis in ((xs, axes.set_xscale, axes.xaxis), (ys, axes.set_yscale, axes.yaxis)):
            if float(values.min()) > 0 and float(values.max() / values.min()) > WIDE:
                scale("log")
                _name_sizes(axis)
        axes.margins(0.12, 0.18)
        if front.colour is None:
            _name_end(axes, front, 0, f"{_best(xs[0], xs[-1])} {front.x.words}")
            _name_end(axes, front, -1, f"{_best(ys[-1], ys[0])} {front.y.words}")
        axes.set_xlabel(front.x.label, fontsize=8)
        axes.set_ylabel(front.y.label, fontsize=8)
        axes.tick_params(labelsize=8)
        return as_svg(figure, prefix)


def _name_sizes(axis: Any) -> None:  # noqa: ANN401  # matplotlib
    """Write sizes of 1, 2 and 5 along a logarithmic axis."""
    from matplotlib.ticker import LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(lambda value, _: number(value, 2))
    axis.set_minor_formatter(NullFormatter())


def _coloured(figure: Any, axes: Any, front: Tradeoff) -> None:  # noqa: ANN401  # matplotlib
    assert front.colour is not None
    drawn = axes.scatter(front.x.values, front.y.values, c=front.colour.values, cmap="viridis", s=30, zorder=3)
    bar = figure.colorbar(drawn, ax=axes)
    bar.solids.set_rasterized(False)
    bar.outline.set_visible(False)
    bar.ax.tick_params(labelsize=8)
    bar.set_label(front.colour.label, fontsize=8)


def _name_end(axes: Any, front: Tradeoff, end: int, words: str) -> None:  # noqa: ANN401  # matplotlib
    """Write beside an end of the front, towards the middle of the picture and off the curve."""
    x, y = front.x.values[end], front.y.values[end]
    middle = [np.mean([values[0], values[-1]]) for values in (front.x.values, front.y.values)]
    right, up = x <= middle[0], y >= middle[1]
    axes.annotate(
        words, (x, y), xytext=(9 if right else -9, 8 if up else -8), textcoords="offset points", fontsize=8,
        color=INK, ha="left" if right else "right", va="bottom" if up else "top",
    )  # fmt: skip


def _best(best: float, other: float) -> str:
    return "least" if best <= other else "greatest"
