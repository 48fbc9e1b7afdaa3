"""The linearised poles in the complex plane."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from firmtouch.report.figures.canvas import ARM, FAINT, FORCE, GOOD, INK, MUTED, as_svg, new_figure, styled

if TYPE_CHECKING:  # else CasADi would be loaded for every report
    from firmtouch.mechanics import Array

FARTHEST: Final = 2.5
"""A disc that reaches further than this beyond the poles is told of, but not drawn: it would make them small."""
ALLOWED: Final = "#e4f2e9"


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


def region_plane(
    achieved: Sequence[complex],
    vertices: Sequence[Sequence[complex]] = (),
    *,
    decay: float | None = None,
    damping: float | None = None,
    bandwidth: float | None = None,
) -> str:
    """Draw the region asked for, with the nominal poles and those of all vertices; `None` stands for no such edge."""
    others = np.array([s for poles in vertices for s in poles], dtype=complex)
    every = np.concatenate([np.array(achieved, dtype=complex), others])
    left, right, height = _frame(every, decay, bandwidth)
    with styled():
        figure = new_figure(4.6, 3.6)
        axes = figure.subplots()
        axes.grid(visible=False)
        reach = 2 * float(np.hypot(left, height))
        if (decay, damping, bandwidth) != (None, None, None):
            region = _outline(decay or 0.0, damping or 0.0, min(bandwidth or reach, reach))
            axes.fill(region.real, region.imag, facecolor=ALLOWED, edgecolor="none", zorder=0)
        axes.axhline(0, color=MUTED, linewidth=0.8)
        axes.axvline(0, color=MUTED, linewidth=0.8)
        _draw_edges(axes, reach, decay, damping, bandwidth if bandwidth and bandwidth < -left else None)
        axes.plot(others.real, others.imag, ".", markersize=4.5, color=ARM, label="poles at the vertices")
        axes.plot(
            [s.real for s in achieved], [s.imag for s in achieved], "x", markersize=7, color=FORCE,
            markeredgewidth=1.8, label="nominal poles" if others.size else "poles",
        )  # fmt: skip
        _mark_repeated(axes, achieved)
        axes.set_xlim(left, right)
        axes.set_ylim(-height, height)
        axes.set_aspect("equal")
        axes.set_xlabel("real part, 1/s")
        axes.set_ylabel("imaginary part, rad/s")
        lines = [each for each in axes.get_lines() if not str(each.get_label()).startswith("_")]
        shown = [each for each in lines if np.size(each.get_xdata())]
        figure.set_figheight(7.8 * height / (right - left) + 0.5 + 0.18 * ((len(shown) + 1) // 2))  # lines and legend
        figure.legend(handles=shown, loc="outside upper center", ncols=2, fontsize=8, handlelength=2.6)
        return as_svg(figure, "splane")


def _frame(poles: Array, decay: float | None, bandwidth: float | None) -> tuple[float, float, float]:
    """Find the left and right end and the half height that hold all poles and the edges that are not too far away."""
    farthest = float(np.max(np.abs(poles)))
    reach = max(1.2 * farthest, 1.3 * (decay or 0.0))
    if bandwidth is not None and bandwidth <= FARTHEST * farthest:
        reach = max(reach, 1.06 * bandwidth)
    height = max(1.25 * float(np.max(np.abs(poles.imag))), 0.42 * reach)
    left = -max(reach, 1.4 * height)
    return left, max(0.12 * -left, 1.25 * float(np.max(poles.real))), height


def _outline(decay: float, damping: float, radius: float) -> Array:
    """Walk around the region: along the arc, and back along the vertical edge or through the origin."""
    if decay >= radius:
        return np.array([], dtype=complex)
    widest = min(np.arccos(damping), np.arccos(decay / radius))
    angle = np.linspace(-widest, widest, 181)
    return -np.concatenate([radius * np.exp(1j * angle), (decay / np.cos(angle) * np.exp(1j * angle))[::-1]])


def _draw_edges(  # type: ignore[no-untyped-def]
    axes,  # noqa: ANN001  # matplotlib
    reach: float,
    decay: float | None,
    damping: float | None,
    bandwidth: float | None,
) -> None:
    """Draw each edge in a style of its own, with its name for the legend."""
    if decay is not None:
        axes.plot([-decay] * 2, [-reach, reach], color=GOOD, linewidth=1.2, label=f"decay rate ≥ {decay:.4g} 1/s")
    if damping is not None:
        x, y = np.array([-reach * damping, 0, -reach * damping]), reach * np.sqrt(1 - damping**2)
        label = f"damping ratio ≥ {damping:.4g}"
        axes.plot(x, [y, 0, -y], "--", color=GOOD, linewidth=1.2, label=label)
    if bandwidth is not None:
        arc = -bandwidth * np.exp(1j * np.linspace(-np.pi / 2, np.pi / 2, 181))
        axes.plot(arc.real, arc.imag, "-.", color=GOOD, linewidth=1.2, label=f"|s| ≤ {bandwidth:.4g} rad/s")


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
