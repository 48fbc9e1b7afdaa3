"""The mechanism at q_d in space, with its surfaces, what it holds, and the contact forces."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from firmtouch.mechanics import Array, Scene
from firmtouch.mechanics.arrays import frozen
from firmtouch.mechanics.scene import Base, ContactForce, Held, Patch, Round
from firmtouch.report.figures.canvas import ARM, FORCE, HALO, INK, MUTED, SURFACE, SURFACE_EDGE, as_svg, new_figure
from firmtouch.report.figures.extent import extent, force_label, shown_forces
from firmtouch.report.figures.labels import Labels
from firmtouch.report.figures.view import View, best_view

ARROW: Final = 0.2
"""Length of a force arrow, as a part of the picture."""
NARROWEST: Final = 0.45
"""Least width of the picture's box in a direction, as a part of its greatest."""
HEAD: Final = 0.3
"""Length of an arrow's head, as a part of the arrow."""
BASE: Final = 0.075
"""Radius of a base, as a part of the picture."""
BULK: Final = 0.6
"""Height and depth of what is held, as a part of its length, and at most of the picture."""
TICKS: Final = 5
SHADE: Final = 0.28
"""How much darker a surface is where it is seen from the side."""
MESH: Final = 4
"""Each which line of a surface's grid is drawn."""
UNDER, SURFACES, GHOSTS, ARMS, FORCES, WORDS = 1, 2, 3, 5, 8, 10
"""What lies over what; links among each other by their distance."""


def picture_in_space(scene: Scene) -> str:
    """Draw a scene in space."""
    low, high = _box(scene)
    span, view = float(np.max(high - low)), best_view(scene)
    figure = new_figure(6.2, 5.2, layout=None)
    axes: Any = figure.add_axes((0.0, 0.02, 0.98, 0.98), projection="3d", computed_zorder=False)
    axes.set_proj_type("persp", focal_length=1.2)
    axes.view_init(elev=view.elevation, azim=view.azimuth)
    _set_axes(axes, low, high)
    for each in scene.rounds:
        _draw_ball(axes, each, view)
    for patch in scene.patches:
        _draw_patch(axes, patch, view)
    for rail in scene.rails:
        within = np.all((rail >= low) & (rail <= high), axis=1)
        axes.plot(
            *np.where(within[:, None], rail, np.nan).T,
            color=SURFACE_EDGE,
            linewidth=3,
            zorder=SURFACES,
            solid_capstyle="round",
        )
    for held in scene.held:
        _draw_held(axes, held, BULK * span / 2, view)
    for base in scene.bases:
        _draw_base(axes, base, BASE * span)
    for ghost in scene.ghosts:
        for line in ghost:
            axes.plot(*line.T, color=ARM, alpha=0.16, linewidth=4, zorder=GHOSTS, solid_capstyle="round")
    _draw_links(axes, scene, low[2], view)
    if len(scene.masses):
        axes.plot(
            *scene.masses.T, "o", color=INK, markerfacecolor="#f2c14e", markersize=5, markeredgewidth=0.9, zorder=7
        )
    labels = Labels(figure, axes, scene)
    for patch in scene.patches:
        _draw_normal(axes, patch, ARROW * span, labels)
    for force in shown_forces(scene):
        _draw_force(axes, scene, force, ARROW * span, labels)
    return as_svg(figure, "scene", within=labels.bounds(low, high))


def _box(scene: Scene) -> tuple[Array, Array]:
    """Give the corners of the picture's box, not too flat in any direction, with room for the arrows."""
    low, high = extent(scene)
    span = float(np.max(high - low))
    for force in shown_forces(scene):
        if not scene.held:
            tail = force.point - 1.1 * ARROW * span * force.force / np.linalg.norm(force.force)
            low, high = np.minimum(low, tail), np.maximum(high, tail)
    lacking = np.maximum(0.0, NARROWEST * span - (high - low)) / 2
    return frozen(low - lacking), frozen(high + lacking)


def _set_axes(axes: Any, low: Array, high: Array) -> None:  # noqa: ANN401  # matplotlib
    from matplotlib.ticker import MaxNLocator

    size = high - low
    axes.set_box_aspect(tuple(size / np.max(size)), zoom=0.95)
    every = zip((axes.xaxis, axes.yaxis, axes.zaxis), "xyz", low, high, size, strict=True)
    for axis, name, start, end, length in every:
        getattr(axes, f"set_{name}lim")(float(start), float(end))
        getattr(axes, f"set_{name}label")(f"{name}, m", labelpad=-1 if name == "z" else 2)
        bins = max(2, round(TICKS * float(length / np.max(size))))
        axis.set_major_locator(MaxNLocator(bins, steps=[1, 2, 5, 10]))
        axis.set_pane_color((0.97, 0.975, 0.98, 1.0))
    axes.tick_params(labelsize=8.2, pad=0)


def _draw_links(axes: Any, scene: Scene, floor: float, view: View) -> None:  # noqa: ANN401  # matplotlib
    """Draw the chains with their joints, the farther links first, and their shadows on the floor."""
    style = {"solid_capstyle": "round", "solid_joinstyle": "round"}
    links = []
    for line in scene.lines:
        shadow = line.copy()
        shadow[:, 2] = floor
        axes.plot(*shadow.T, color=MUTED, alpha=0.3, linewidth=3, zorder=UNDER, **style)
        links += [line[i : i + 2] for i in range(len(line) - 1)]
    depths = [float(np.mean(each @ view.towards)) for each in links]
    for rank, i in enumerate(np.argsort(depths, kind="stable")):
        level = ARMS + rank / len(links)
        axes.plot(*links[i].T, color=HALO, linewidth=7.5, zorder=level, **style)
        axes.plot(*links[i].T, color=ARM, linewidth=5, zorder=level, **style)
        axes.plot(*links[i].T, "o", color=INK, markerfacecolor="white", markersize=6, markeredgewidth=1.3, zorder=level)


def _draw_base(axes: Any, base: Base, radius: float) -> None:  # noqa: ANN401  # matplotlib
    """Draw a flat disc that the first joint's axis stands on."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    first, second = np.linalg.svd(base.axis[None, :])[2][1:]
    turns = np.linspace(0, 2 * np.pi, 41)[:, None]
    rim = base.point + radius * (np.cos(turns) * first + np.sin(turns) * second)
    axes.add_collection3d(Poly3DCollection([rim], facecolor=MUTED, edgecolor=INK, linewidth=1.0, zorder=GHOSTS))


def _draw_held(axes: Any, held: Held, most: float, view: View) -> None:  # noqa: ANN401  # matplotlib
    """Draw a box between two hands, of a height and depth that only look well."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    along = held.ends[1] - held.ends[0]
    half = min(BULK * float(np.linalg.norm(along)), most) / 2
    third = np.cross(along / np.linalg.norm(along), held.across)
    corners = [(a * held.across + b * third) * half for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))]
    near, far = (np.array([end + each for each in corners]) for end in held.ends)
    sides = [np.array([near[i], near[i - 1], far[i - 1], far[i]]) for i in range(4)]
    faces = [near, far, *sides]
    axes.add_collection3d(
        Poly3DCollection(
            faces,
            facecolors=_shaded(faces, view, alpha=0.6),
            edgecolors=SURFACE_EDGE,
            linewidths=1.0,
            zorder=SURFACES,
        )
    )


def _draw_patch(axes: Any, patch: Patch, view: View) -> None:  # noqa: ANN401  # matplotlib
    """Draw a surface around a contact, and its tangent plane there as a dashed square."""
    _draw_sheet(axes, patch.points, view)
    square = np.vstack([patch.tangent, patch.tangent[:1]])
    axes.plot(*square.T, color=INK, linewidth=1.1, linestyle=(0, (4, 2)), zorder=GHOSTS + 0.5)


def _draw_sheet(axes: Any, points: Array, view: View) -> None:  # noqa: ANN401  # matplotlib
    """Draw a grid of points (k x l x 3) as a surface; cells with a corner that is nan are left out."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    quads = np.stack([points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]], axis=2).reshape(-1, 4, 3)
    cells = list(quads[np.all(np.isfinite(quads), axis=(1, 2))])
    colours = _shaded(cells, view, alpha=0.85)
    axes.add_collection3d(
        Poly3DCollection(cells, facecolors=colours, edgecolors=colours, linewidths=0.3, zorder=SURFACES)
    )
    for lines in (points, points.swapaxes(0, 1)):
        for i in range(0, len(lines), MESH):
            edge = i in (0, len(lines) - 1)
            axes.plot(*lines[i].T, color=SURFACE_EDGE, linewidth=1.2 if edge else 0.4, alpha=0.8, zorder=SURFACES + 0.1)


def _draw_ball(axes: Any, ball: Round, view: View) -> None:  # noqa: ANN401  # matplotlib
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 49), np.linspace(0, np.pi, 25))
    unit = np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)], axis=2)
    turned_away = unit @ view.towards < -0.1
    points = ball.centre + ball.radius * unit
    points[turned_away] = np.nan  # what is behind would only be seen through the front
    _draw_sheet(axes, points, view)


def _shaded(faces: list[Array], view: View, *, alpha: float) -> Array:
    """Colour faces (corners x 3) of a surface, darker where they are turned away from the eye."""
    from matplotlib.colors import to_rgb

    colours = []
    for face in faces:
        normal = np.cross(face[2] - face[0], face[3] - face[1])
        facing = abs(float(normal @ view.towards)) / (float(np.linalg.norm(normal)) or 1.0)
        colours.append([*(np.array(to_rgb(SURFACE)) * (1 - SHADE * (1 - facing))), alpha])
    return frozen(colours)


def _draw_normal(axes: Any, patch: Patch, length: float, labels: Labels) -> None:  # noqa: ANN401  # matplotlib
    """Draw the normal at the corner of the tangent plane that is farthest from the arm, which covers the contact."""
    foot = labels.freest(patch.tangent)
    head = foot + 0.7 * length * patch.normal
    axes.plot(*np.vstack([foot, head]).T, color=INK, linewidth=1.2, zorder=FORCES)
    _draw_head(axes, foot, head, INK)
    labels.write("n", head, patch.normal, colour=INK, style="italic", weight="normal", zorder=WORDS)


def _draw_force(axes: Any, scene: Scene, force: ContactForce, length: float, labels: Labels) -> None:  # noqa: ANN401
    """Draw the arrow with its head at the contact, or those at two hands on the side of what they hold."""
    direction = force.force / np.linalg.norm(force.force)
    held = next((each for each in scene.held if each.constraint == force.constraint), None)
    if held is None:
        _draw_arrow(axes, force.point - length * direction, force.point)
        if force.reaction_at is not None:
            _draw_arrow(axes, force.reaction_at + length * direction, force.reaction_at)
        labels.write(force_label(force), force.point - length * direction, -direction, colour=FORCE, zorder=WORDS)
        return
    middle = held.ends.mean(axis=0)
    length = min(length, 0.42 * float(np.linalg.norm(held.ends[1] - held.ends[0])))
    for hand, push in zip(held.ends, (-direction, direction), strict=True):
        outwards = float(push @ (hand - middle)) >= 0
        tail, head = (hand - length * push, hand) if outwards else (hand, hand + length * push)
        _draw_arrow(axes, tail, head)
    labels.write(force_label(force), middle, held.across, colour=FORCE, zorder=WORDS)


def _draw_arrow(axes: Any, tail: Array, head: Array) -> None:  # noqa: ANN401  # matplotlib
    axes.plot(*np.vstack([tail, head]).T, color=HALO, linewidth=4.6, zorder=FORCES, solid_capstyle="butt")
    axes.plot(*np.vstack([tail, head]).T, color=FORCE, linewidth=2.6, zorder=FORCES + 0.1, solid_capstyle="butt")
    _draw_head(axes, tail, head, FORCE)


def _draw_head(axes: Any, tail: Array, head: Array, colour: str) -> None:  # noqa: ANN401  # matplotlib
    """Draw an arrow's head as a cone, which has a size in space as the arrow has."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    along = head - tail
    first, second = np.linalg.svd(along[None, :])[2][1:]
    turns = np.linspace(0, 2 * np.pi, 13)[:, None]
    radius = 0.3 * HEAD * float(np.linalg.norm(along))
    rim = head - HEAD * along + radius * (np.cos(turns) * first + np.sin(turns) * second)
    sides = [np.array([rim[i], rim[i + 1], head]) for i in range(len(rim) - 1)]
    axes.add_collection3d(
        Poly3DCollection([rim, *sides], facecolor=colour, edgecolor=colour, linewidth=0.3, zorder=FORCES + 0.2)
    )
