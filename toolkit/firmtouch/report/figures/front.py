"""A Pareto front: how much of one objective another one costs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from firmtouch.report.figures.canvas import ARM, FORCE, INK, as_svg, new_figure, styled

if TYPE_CHECKING:
    from firmtouch.synthesis.region.front import Front


def front_chart(front: Front, prefix: str = "front") -> str:
    """Draw a front with its two ends named, and the design itself where it lies on it; there must be a point."""
    xs, ys = (np.array([getattr(each, axis) for each in front.points]) for axis in ("x", "y"))
    with styled():
        figure = new_figure(5.0, 3.2)
        axes = figure.subplots()
        axes.plot(xs, ys, "-", color=ARM, linewidth=1.3, zorder=2)
        axes.plot(xs[1:-1], ys[1:-1], "o", color=ARM, markersize=4, zorder=3)
        axes.plot(xs[[0, -1]], ys[[0, -1]], "s", color=ARM, markersize=6, zorder=3)
        if front.chosen is not None:
            axes.plot(
                [front.chosen.x], [front.chosen.y], "o", markersize=11, markerfacecolor="none", markeredgecolor=FORCE,
                markeredgewidth=1.8, label="this design", zorder=4,
            )  # fmt: skip
            figure.legend(loc="outside upper right", fontsize=8)
        axes.margins(0.12, 0.18)
        _name_end(axes, front, 0, f"{_best(xs[0], xs[-1])} {front.x}")
        _name_end(axes, front, -1, f"{_best(ys[-1], ys[0])} {front.y}")
        axes.set_xlabel(_axis(front.x, front.x_unit), fontsize=8)
        axes.set_ylabel(_axis(front.y, front.y_unit), fontsize=8)
        axes.tick_params(labelsize=8)
        return as_svg(figure, prefix)


def _name_end(axes, front: Front, end: int, words: str) -> None:  # type: ignore[no-untyped-def]  # noqa: ANN001  # matplotlib
    """Write beside an end of the front, towards the middle of the picture and off the curve."""
    x, y = front.points[end].x, front.points[end].y
    middle = [np.mean([getattr(each, axis) for each in (front.points[0], front.points[-1])]) for axis in ("x", "y")]
    right, up = x <= middle[0], y >= middle[1]
    axes.annotate(
        words, (x, y), xytext=(9 if right else -9, 8 if up else -8), textcoords="offset points", fontsize=8,
        color=INK, ha="left" if right else "right", va="bottom" if up else "top",
    )  # fmt: skip


def _best(best: float, other: float) -> str:
    return "least" if best <= other else "greatest"


def _axis(words: str, unit: str) -> str:
    return f"{words}, {unit}" if unit else words
