"""The force loop: its Nyquist curves [T8], and the poles over the contact's stiffness [T9]."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.regulation.force_loop import ForcePath, StiffnessSweep
from firmtouch.report.figures.canvas import ARM, FAINT, FORCE, GOOD, INK, MUTED, as_svg, new_figure, styled
from firmtouch.report.numbers import number

MOST_CURVES: Final = 4
"""More loops than this make a picture that nobody reads: then the weakest and the strongest are drawn."""
FARTHEST: Final = 3.0
"""No more of a curve is shown, so that -1 stays in sight."""
_STYLES: Final = ("-", "--", "-.", ":")
UNSTABLE: Final = "#f7e3e0"


def nyquist_picture(path: ForcePath, gains: Sequence[float], modulus: float | None = None) -> str:
    """Draw g L for each different g, with -1, the unit circle, and the disc that the modulus margin keeps free."""
    different = sorted({round(float(g), 12) for g in gains}, reverse=True)
    drawn = different if len(different) <= MOST_CURVES else [different[0], different[-1]]
    with styled():
        figure = new_figure(4.4, 3.9)
        axes = figure.subplots()
        axes.axhline(0, color=MUTED, linewidth=0.8)
        axes.axvline(0, color=MUTED, linewidth=0.8)
        angle = np.linspace(0, 2 * np.pi, 181)
        axes.plot(np.cos(angle), np.sin(angle), color=FAINT, linewidth=1.2)
        if modulus is not None:
            axes.plot(
                modulus * np.cos(angle) - 1, modulus * np.sin(angle), "--", color=GOOD, linewidth=1.0,
                label=f"modulus margin asked: {modulus:.3g}",
            )  # fmt: skip
        L = path.response(_frequencies(path))
        for g, style in zip(drawn, _STYLES, strict=False):
            axes.plot(g * L.real, g * L.imag, style, color=ARM, linewidth=1.5, label=f"g L for g = {g:.4g}")
        axes.plot([-1], [0], "+", color=FORCE, markersize=10, markeredgewidth=2, label="−1")
        reach = min(max(1.0, drawn[0]), FARTHEST)
        left = -max(1.15, 1.15 + (modulus or 0), min(0.6 * reach, FARTHEST))
        axes.set_aspect("equal")
        axes.set_xlim(left, 1.1 * reach)
        axes.set_ylim(-1.1 * reach, 1.1 * reach)
        axes.set_xlabel("real part")
        axes.set_ylabel("imaginary part")
        figure.legend(loc="outside upper center", ncols=2, fontsize=8)
        return as_svg(figure, "nyquist")


def _frequencies(path: ForcePath) -> Array:
    """Choose frequencies that draw the curve smoothly, from 0 to where nothing new comes."""
    if path.sample:
        return np.linspace(0, path.highest, 241)
    if path.delay:
        return np.linspace(0, 4 * np.pi / path.delay, 361)
    return np.concatenate([[0.0], np.geomspace(1e-2, 1e3, 160) / path.lag]) if path.lag else np.zeros(1)


def stiffness_picture(
    sweep: StiffnessSweep, unit: str, stated: Sequence[float] = (), *, decay: float | None = None
) -> str:
    """Draw the real parts of all poles over the contact's stiffness; `stated` are the file's, drawn as a line."""
    k, rigid = sweep.stiffness, np.array([s.real for s in sweep.rigid])
    linear, bottom = float(np.min(np.abs(rigid))) or 1.0, 8 * float(np.min(rigid))
    top = max(linear, *(float(each.poles[0].real) for each in sweep.points))
    with styled():
        figure = new_figure(5.6, 3.2)
        axes = figure.subplots()
        axes.set_xscale("log")
        axes.set_yscale("symlog", linthresh=linear, linscale=0.8)
        for span in sweep.unstable:
            axes.axvspan(max(span.low, k[0]), min(span.high, k[-1]), color=UNSTABLE, zorder=0)
        axes.axhline(0, color=MUTED, linewidth=1.0)
        for value in np.unique(np.round(rigid, 9)):
            axes.axhline(value, color=ARM, linewidth=0.8, linestyle=":", zorder=1)
        if decay is not None:
            axes.axhline(-decay, color=GOOD, linewidth=1.2, zorder=1, label="decay rate asked")
        for each in dict.fromkeys(stated):
            axes.axvline(each, color=INK, linewidth=1.0, linestyle="--", label="contact of the file", zorder=1)
        x, y, tangent = _all_poles(sweep)
        for which, colour, words in (
            ((y < 0) & (tangent == 0), MUTED, "contact and force loop"),
            ((y < 0) & (tangent == 1), ARM, "poles of (38)"),
            (y >= 0, FORCE, "unstable"),
        ):
            if np.any(which):
                axes.plot(x[which], y[which], ".", color=colour, markersize=4, label=words)
        axes.set_xlim(k[0], k[-1])
        axes.set_ylim(bottom, 2 * top)
        axes.set_xlabel(f"stiffness of the contact, {unit}", fontsize=8)
        axes.set_ylabel("real part, 1/s", fontsize=8)
        axes.tick_params(which="both", labelsize=8)
        axes.minorticks_off()
        # words instead of matplotlib's own 10^k, which is formula type and takes half of the drawing's time
        decades = 10.0 ** np.arange(np.ceil(np.log10(linear)), 9)
        heights = [*-decades[decades <= -bottom][::-1], 0.0, *decades[decades <= 2 * top]]
        axes.set_yticks(heights, [number(each) for each in heights])
        powers = 10.0 ** np.arange(np.ceil(np.log10(k[0] * 0.999)), np.floor(np.log10(k[-1] * 1.001)) + 1)
        axes.set_xticks(powers, [_power(each) for each in powers])
        handles, labels = axes.get_legend_handles_labels()
        once = dict(zip(labels, handles, strict=True))
        figure.legend(once.values(), once.keys(), loc="outside upper center", ncols=4, fontsize=8)
        return as_svg(figure, "stiffness")


def _power(value: float) -> str:
    return number(value).replace("1×", "") if value >= 1e5 else number(value)


def _all_poles(sweep: StiffnessSweep) -> tuple[Array, Array, Array]:
    """List stiffness, real part, and 1 or 0 for whether it belongs to (38), of every pole."""
    rows = [
        (k, s.real, s in each.tangent)
        for k, each in zip(sweep.stiffness, sweep.points, strict=True)
        for s in each.poles
    ]  # fmt: skip
    x, y, tangent = np.array(rows, dtype=float).T
    return x, y, tangent
