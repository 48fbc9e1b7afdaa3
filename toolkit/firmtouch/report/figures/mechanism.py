"""The mechanism at q_d with its surfaces and contact forces, in the plane or in space."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Final

import numpy as np

from firmtouch.mechanics import Array, Scene
from firmtouch.mechanics.arrays import frozen
from firmtouch.mechanics.scene import ContactForce, Patch
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
from firmtouch.report.numbers import number

NOTHING: Final = 1e-9
HEAD: Final = "-|>,head_width=0.45,head_length=0.9"
SURFACE_PART: Final = 0.4
"""How far the picture follows a round surface beyond the mechanism, as a part of its size."""
ARROW: Final = 0.2
"""Length of the longest force arrow, as a part of the picture."""


def mechanism_picture(scene: Scene) -> str:
    """Draw a scene."""
    with styled():
        return _in_space(scene) if scene.dimension == 3 else _in_plane(scene)


def shown_forces(scene: Scene) -> tuple[ContactForce, ...]:
    """List the contact forces that are not zero."""
    return tuple(each for each in scene.forces if float(np.linalg.norm(each.force)) > NOTHING)


def force_label(force: ContactForce) -> str:
    """Write the size of a force."""
    return f"{number(float(np.linalg.norm(force.force)), 3)} N"


def _extent(scene: Scene) -> tuple[Array, Array]:
    """Find the box of what must be seen: the mechanism, its ghosts and its contacts, not all of a large sphere."""
    points = np.vstack([*scene.lines, *(line for ghost in scene.ghosts for line in ghost), *_contacts(scene)])
    points = np.vstack([points, *(each.points.reshape(-1, 3) for each in scene.patches)])
    points = points[np.all(np.isfinite(points), axis=1)]
    low, high = points.min(axis=0), points.max(axis=0)
    reach = SURFACE_PART * float(np.max(high - low))
    for each in scene.rounds:
        low = np.maximum(np.minimum(low, each.centre - each.radius), low - reach)
        high = np.minimum(np.maximum(high, each.centre + each.radius), high + reach)
    margin = 0.12 * float(np.max(high - low)) or 0.1
    return low - margin, high + margin


def _contacts(scene: Scene) -> Iterator[Array]:
    for each in scene.forces:
        yield each.point[None, :]


def _in_plane(scene: Scene) -> str:
    low, high = _extent(scene)
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


def _in_space(scene: Scene) -> str:
    low, high = _extent(scene)
    span = float(np.max(high - low))
    figure = new_figure(5.8, 5.2)
    axes: Any = figure.add_subplot(projection="3d", computed_zorder=False)
    axes.set_proj_type("persp", focal_length=0.4)
    for each in scene.rounds:
        _draw_ball(axes, each.centre, each.radius)
    for patch in scene.patches:
        _draw_patch(axes, patch, ARROW * span)
    for ghost in scene.ghosts:
        for line in ghost:
            axes.plot(*line.T, color=ARM, alpha=0.16, linewidth=4, zorder=3, solid_capstyle="round")
    for line in scene.lines:
        floor = line.copy()
        floor[:, 2] = low[2]
        axes.plot(*floor.T, color=MUTED, alpha=0.35, linewidth=3, zorder=1, solid_capstyle="round")
        axes.plot(*line.T, color=ARM, linewidth=5, zorder=5, solid_capstyle="round")
        axes.plot(*line.T, "o", color=INK, markerfacecolor="white", markersize=6, markeredgewidth=1.3, zorder=6)
    if len(scene.masses):
        axes.plot(
            *scene.masses.T, "o", color=INK, markerfacecolor="#f2c14e", markersize=5, markeredgewidth=0.9, zorder=7
        )
    for force in shown_forces(scene):
        direction = force.force / np.linalg.norm(force.force)
        tail = force.point + 1.3 * ARROW * span * direction
        axes.quiver(*force.point, *(tail - force.point), color=FORCE, linewidth=2.4, arrow_length_ratio=0.25, zorder=9)
        axes.text(
            *(tail + 0.06 * span * direction),
            force_label(force),
            color=FORCE,
            fontweight="bold",
            fontsize=10,
            zorder=10,
        )
    centre = (low + high) / 2
    for setter, c, bottom in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), centre, low, strict=True):
        setter(c - span / 2, c + span / 2) if bottom is not low[2] else setter(low[2], low[2] + span)
    axes.set_box_aspect((1, 1, 1))
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")
    axes.set_zlabel("z, m")
    axes.view_init(elev=22, azim=_best_azimuth(scene))
    return as_svg(figure, "scene")


def _best_azimuth(scene: Scene) -> float:
    """Look across the mechanism: at right angles to where it mainly reaches, a little from the front."""
    points = np.vstack(scene.lines)
    reach = points[np.argmax(np.linalg.norm(points[:, :2] - points[0, :2], axis=1)), :2] - points[0, :2]
    return float(np.degrees(np.arctan2(reach[1], reach[0]))) - 62


def _draw_patch(axes: Any, patch: Patch, length: float) -> None:  # noqa: ANN401  # matplotlib
    """Draw a surface around a contact, its tangent plane there as a dashed square, and its normal."""
    x, y, z = np.moveaxis(patch.points, 2, 0)
    axes.plot_surface(
        x, y, z, color=SURFACE, alpha=0.75, linewidth=0, antialiased=False, zorder=2, shade=True, rstride=1, cstride=1
    )
    axes.plot_wireframe(x, y, z, color=SURFACE_EDGE, linewidth=0.35, alpha=0.6, zorder=2, rstride=4, cstride=4)
    square = np.vstack([patch.tangent, patch.tangent[:1]])
    axes.plot(*square.T, color=INK, linewidth=1.1, linestyle=(0, (4, 2)), zorder=4)
    head = patch.contact + length * patch.normal
    axes.plot(*np.vstack([patch.contact, head]).T, color=INK, linewidth=1.1, linestyle=(0, (4, 2)), zorder=4)
    axes.text(*(patch.contact + 1.12 * length * patch.normal), "n", color=INK, fontsize=10, style="italic", zorder=10)


def _draw_ball(axes: Any, centre: Array, radius: float) -> None:  # noqa: ANN401  # matplotlib
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 49), np.linspace(0, np.pi, 25))
    x, y, z = np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)
    axes.plot_surface(
        centre[0] + radius * x, centre[1] + radius * y, centre[2] + radius * z,
        color=SURFACE, alpha=0.75, linewidth=0, antialiased=False, zorder=2, shade=True, rstride=1, cstride=1,
    )  # fmt: skip
    axes.plot_wireframe(
        centre[0] + radius * x, centre[1] + radius * y, centre[2] + radius * z,
        color=SURFACE_EDGE, linewidth=0.35, alpha=0.6, zorder=2, rstride=4, cstride=4,
    )  # fmt: skip
