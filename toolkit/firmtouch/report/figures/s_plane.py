"""The linearised poles in the complex plane."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from firmtouch.report.figures.canvas import ARM, FAINT, FORCE, INK, MUTED, as_svg, new_figure, styled


def s_plane(achieved: Sequence[complex], requested: Sequence[complex]) -> str:
    """Draw achieved poles over requested ones, with lines of equal damping and equal frequency."""
    poles = np.array([*achieved, *requested])
    reach = 1.25 * float(np.max(np.abs(poles)))
    with styled():
        figure = new_figure(4.6, 3.6)
        axes = figure.subplots()
        axes.grid(visible=False)
        height = max(1.25 * float(np.max(np.abs(poles.imag))), 0.45 * reach)
        _draw_net(axes, reach, height)
        axes.axhline(0, color=MUTED, linewidth=0.8)
        axes.axvline(0, color=MUTED, linewidth=0.8)
        axes.plot(
            [s.real for s in requested], [s.imag for s in requested], "o", markersize=11, markerfacecolor="none",
            markeredgecolor=ARM, markeredgewidth=1.3, label="requested",
        )  # fmt: skip
        axes.plot(
            [s.real for s in achieved], [s.imag for s in achieved], "x", markersize=7, color=FORCE,
            markeredgewidth=1.8, label="achieved",
        )  # fmt: skip
        _mark_repeated(axes, achieved)
        axes.set_xlim(-reach, 0.12 * reach)
        axes.set_ylim(-height, height)
        axes.set_xlabel("real part, 1/s")
        axes.set_ylabel("imaginary part, rad/s")
        figure.legend(loc="outside upper center", ncols=2)
        return as_svg(figure, "splane")


def _draw_net(axes, reach: float, height: float) -> None:  # type: ignore[no-untyped-def]  # noqa: ANN001  # matplotlib
    """Draw rays of equal damping ratio and arcs of equal |s|."""
    for damping in (0.3, 0.5, 0.7, 0.9):
        slope = np.sqrt(1 - damping**2) / damping
        x = np.array([0, -2 * reach])
        for sign in (-1, 1):
            axes.plot(x, sign * slope * x, color=FAINT, linewidth=0.8, zorder=0)
        label = 0.92 * min(reach, height)
        axes.annotate(
            f"ζ = {damping:g}", (-label * damping, label * np.sqrt(1 - damping**2)),
            fontsize=7, color=MUTED, ha="center", va="center",
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.9},
        )  # fmt: skip
    angle = np.linspace(np.pi / 2, 3 * np.pi / 2, 181)
    step = _round_step(reach / 4)
    for radius in np.arange(step, 1.6 * reach, step):
        axes.plot(radius * np.cos(angle), radius * np.sin(angle), color=FAINT, linewidth=0.8, zorder=0)


def _round_step(value: float) -> float:
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * min((each for each in (1, 2, 5, 10) if each * power >= value), default=10))


def _mark_repeated(axes, poles: Sequence[complex]) -> None:  # type: ignore[no-untyped-def]  # noqa: ANN001  # matplotlib
    scale = max(abs(s) for s in poles)
    seen: list[complex] = []
    for pole in poles:
        if any(abs(pole - other) < 1e-3 * scale for other in seen):
            continue
        seen.append(pole)
        count = sum(abs(pole - other) < 1e-3 * scale for other in poles)
        if count > 1:
            axes.annotate(f"{count}×", (pole.real, pole.imag), xytext=(8, 7), textcoords="offset points", color=INK)
