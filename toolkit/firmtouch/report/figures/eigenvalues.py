"""The eigenvalues of K, C and W on both levels, on one logarithmic axis for each."""

from __future__ import annotations

import numpy as np

from firmtouch.regulation.closed_loop import Positivity
from firmtouch.report.figures.canvas import ARM, FORCE, INK, as_svg, new_figure, styled


def eigenvalue_chart(full: Positivity, tangent: Positivity) -> str:
    """Draw every eigenvalue of the three matrices; those that are not positive stand in red at the left edge."""
    with styled():
        figure = new_figure(5.6, 2.3)
        axes = figure.subplots()
        values = np.concatenate([each for level in (full, tangent) for each in (level.K, level.C, level.W)])
        positive = values[values > 0]
        left = 10 ** np.floor(np.log10(positive.min()) - 0.2) if positive.size else 1e-3
        names = ("K", "C", "W")
        for row, name in enumerate(names):
            for shift, level, marker, fill in ((-0.16, full, "o", ARM), (0.16, tangent, "s", "white")):
                eigenvalues = getattr(level, name)
                good = eigenvalues[eigenvalues > 0]
                y = row + shift
                axes.plot(good, np.full(good.size, y), marker, color=ARM, markerfacecolor=fill, markersize=6)
                bad = eigenvalues.size - good.size
                if bad:
                    axes.plot(np.full(bad, left), np.full(bad, y), "<", color=FORCE, markersize=7)
        axes.plot([], [], "o", color=ARM, label="full")
        axes.plot([], [], "s", color=ARM, markerfacecolor="white", label="tangent")
        axes.set_xscale("log")
        axes.set_yticks(range(len(names)), names, color=INK, fontsize=10)
        axes.set_ylim(len(names) - 0.5, -0.5)
        axes.set_xlabel("eigenvalue (K, W in N m/rad or N/m; C in N m s/rad or N s/m)", fontsize=8)
        axes.tick_params(axis="x", which="both", labelsize=8)
        figure.legend(loc="outside upper right", ncols=2, fontsize=8)
        return as_svg(figure, "eigen")
