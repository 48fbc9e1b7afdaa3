"""The mechanism at q_d with its surfaces and contact forces, in the plane or in space."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from firmtouch.mechanics import Array, Scene
from firmtouch.mechanics.arrays import frozen
from firmtouch.mechanics.scene import ContactForce
from firmtouch.report.figures.canvas import (
    ARM,
    FORCE,
    HALO,
    INK,
    MUTED,
    SURFACE,
    SURFACE_EDGE,
    as_svg,
    new_figure,
    styled,
)
from firmtouch.report.figures.extent import NOTHING, extent, force_label, shown_forces
from firmtouch.report.figures.space import picture_in_space

HEAD: Final = "-|>,head_width=0.45,head_length=0.9"
ARROW: Final = 0.2
"""Length of the longest force arrow, as a part of the picture."""


def mechanism_picture(scene: Scene) -> str:
    """Draw a scene."""
    with styled():
        return picture_in_space(scene) if scene.dimension == 3 else _in_plane(scene)


def _in_plane(scene: Scene) -> str:
    low, high = extent(scene)
    span = float(np.max(high - low))
    for force in shown_forces(scene):  # room for the arrow that comes out of the surface
        tail = force.point - 1.35 * ARROW * span * force.force / np.linalg.norm(force.force)
        low, high = np.minimum(low, tail), np.maximum(high, tail)
    width = 5.6
    height = float(np.clip(width * (high[1] - low[1]) / (high[0] - low[0]), 3.0, 6.4))
    figure = new_figure(width, height)
    axes = figure.subplots()
    axes.set_aspect("equal")
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    _draw_surfaces(axes, scene, span)
    for ghost in scene.ghosts:
        for line in ghost:
            axes.plot(
                *line.T, color=ARM, alpha=0.16, linewidth=5, solid_capstyle="round", solid_joinstyle="round", zorder=2
            )
    for line in scene.lines:
        _draw_links(axes, line)
    _draw_bases(axes, scene, span)
    if len(scene.masses):
        _draw_masses(axes, scene.masses)
    for force in shown_forces(scene):
        _draw_force(axes, force, ARROW * span)
        if force.reaction_at is not None:
            _draw_arrow(axes, force.reaction_at, -force.force, ARROW * span)
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")
    return as_svg(figure, "scene")


def _draw_links(axes: Any, line: Array) -> None:  # noqa: ANN401  # matplotlib
    axes.plot(*line.T, color=HALO, linewidth=9, solid_capstyle="round", solid_joinstyle="round", zorder=4)
    axes.plot(*line.T, color=ARM, linewidth=6, solid_capstyle="round", solid_joinstyle="round", zorder=5)
    axes.plot(*line.T, "o", color=INK, markerfacecolor="white", markersize=7, markeredgewidth=1.4, zorder=7)


def _draw_bases(axes: Any, scene: Scene, span: float) -> None:  # noqa: ANN401  # matplotlib
    """Put a ground symbol under every line that starts at rest: there where the ghosts start too."""
    for i, line in enumerate(scene.lines):
        fixed = all(np.allclose(ghost[i][0], line[0], atol=1e-9) for ghost in scene.ghosts)
        if not fixed:
            continue
        size = 0.035 * span
        x, y = line[0]
        axes.fill([x, x - size, x + size], [y, y - 1.6 * size, y - 1.6 * size], color=MUTED, zorder=3, linewidth=0)
        axes.plot([x - 1.9 * size, x + 1.9 * size], [y - 1.6 * size] * 2, color=INK, linewidth=1.6, zorder=3)


def _draw_masses(axes: Any, masses: Array) -> None:  # noqa: ANN401  # matplotlib
    axes.plot(*masses.T, "o", color=INK, markerfacecolor="#f2c14e", markersize=6, markeredgewidth=1, zorder=8)


def _draw_surfaces(axes: Any, scene: Scene, span: float) -> None:  # noqa: ANN401  # matplotlib
    from matplotlib.patches import Circle, Polygon

    style = {"facecolor": SURFACE, "edgecolor": SURFACE_EDGE, "hatch": "////", "linewidth": 0, "zorder": 1}
    for wall in scene.walls:
        if float(np.linalg.norm(wall.solid)) > NOTHING:
            depth = 0.09 * span * wall.solid / np.linalg.norm(wall.solid)
            axes.add_patch(Polygon(np.vstack([wall.points, wall.points[::-1] + depth]), closed=True, **style))
        axes.plot(*wall.points.T, color=SURFACE_EDGE, linewidth=2.2, zorder=3)
    for each in scene.rounds:
        axes.add_patch(Circle((float(each.centre[0]), float(each.centre[1])), each.radius, **style))
        rim = Circle((float(each.centre[0]), float(each.centre[1])), each.radius, fill=False, ec=SURFACE_EDGE, lw=2.2)
        rim.set_zorder(3)
        axes.add_patch(rim)


def _draw_force(axes: Any, force: ContactForce, length: float) -> None:  # noqa: ANN401  # matplotlib
    """Draw the arrow with its head at the contact: the surface pushes the mechanism."""
    direction = force.force / np.linalg.norm(force.force)
    tail = _draw_arrow(axes, force.point, force.force, length)
    side = np.array([-direction[1], direction[0]])
    side = side if side[1] >= 0 else -side
    at = tail + 0.22 * length * direction + 0.3 * length * side
    axes.annotate(
        force_label(force), tuple(at), color=FORCE, ha="center", va="center", fontsize=10, fontweight="bold", zorder=10,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5, "alpha": 0.85},
    )  # fmt: skip


def _draw_arrow(axes: Any, head: Array, force: Array, length: float) -> Array:  # noqa: ANN401  # matplotlib
    tail = head - length * force / np.linalg.norm(force)
    axes.annotate(
        "", xy=tuple(head), xytext=tuple(tail), zorder=9,
        arrowprops={"arrowstyle": HEAD, "color": FORCE, "linewidth": 2.6, "shrinkB": 3},
    )  # fmt: skip
    return frozen(tail)
