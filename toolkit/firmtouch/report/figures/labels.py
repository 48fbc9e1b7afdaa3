"""Words in a picture in space, where they lie over no link and no other words."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from firmtouch.mechanics import Array, Scene
from firmtouch.mechanics.arrays import frozen
from firmtouch.report.figures.view import distance_to_segment

GAP: Final = 13.0
"""From a place to the middle of its words, in points."""
CLEAR: Final = 26.0
"""Farther from all else than this, in points, no place is better than another."""
INSIDE: Final = 24.0
"""Least distance from the picture's edge, in points."""
BORDER: Final = (56.0, 36.0)
"""Room for the numbers and names of the axes beside and below, in points."""
WAYS: Final = 16


class Labels:
    """Places for words, in points of the finished picture; what is written takes its place."""

    def __init__(self, figure: Any, axes: Any, scene: Scene) -> None:  # noqa: ANN401  # matplotlib
        self._figure, self._axes = figure, axes
        axes.apply_aspect()
        self._box = np.array(figure.get_size_inches()) * 72
        lines = [self._points(each) for each in scene.lines]
        self._segments = [(line[i], line[i + 1]) for line in lines for i in range(len(line) - 1)]
        self._taken: list[Array] = []

    def freest(self, places: Array) -> Array:
        """Give the one of some places (k x 3) that is farthest from the links."""
        room = [self._room(each) for each in self._points(places)]
        return frozen(places[int(np.argmax(np.round(room, 6)))])

    def write(self, text: str, at: Array, towards: Array, *, colour: str, zorder: int, **font: str) -> None:
        """Write beside a place, at best in a direction."""
        place, beyond = self._points(np.array([at, at + 1e-3 * towards]))
        wish = beyond - place
        wish = wish / (float(np.linalg.norm(wish)) or 1.0)
        angles = 2 * np.pi * np.arange(WAYS) / WAYS
        ways = np.column_stack([np.cos(angles), np.sin(angles)])
        half = 3.2 * len(text)  # points, of bold letters of this size
        spots = place + ways * np.array([GAP + half, GAP])
        worth = [min(self._room(spot), CLEAR) + 4 * float(way @ wish) for spot, way in zip(spots, ways, strict=True)]
        best = spots[int(np.argmax(np.round(worth, 6)))]
        self._taken.append(frozen(best))
        style = {"fontweight": "bold"} | {f"font{key}": value for key, value in font.items()}
        self._figure.text(
            *(best / self._box), text, color=colour, fontsize=10, ha="center", va="center", zorder=zorder,
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.2, "alpha": 0.8}, **style,
        )  # fmt: skip

    def bounds(self, low: Array, high: Array) -> tuple[float, float, float, float]:
        """Give left, bottom, right and top (inches) of a box in space with its numbers, and of what was written."""
        corners = np.stack(np.meshgrid(*zip(low, high, strict=True)), axis=-1).reshape(-1, 3)
        seen = np.vstack([self._points(frozen(corners)), *(each[None, :] for each in self._taken)])
        left, bottom = np.maximum(seen.min(axis=0) - BORDER, 0) / 72
        right, top = np.minimum(seen.max(axis=0) + BORDER, self._box) / 72
        return float(left), float(bottom), float(right), float(top)

    def _room(self, spot: Array) -> float:
        """Say how far a spot is from links, from words, and from leaving the picture."""
        gaps = [distance_to_segment(spot, *each) for each in self._segments]
        gaps += [float(np.linalg.norm(spot - each)) / 1.5 for each in self._taken]
        edge = float(np.min(np.minimum(spot, self._box - spot)))
        return min(gaps, default=np.inf) if edge > INSIDE else edge - INSIDE

    def _points(self, places: Array) -> Array:
        """Project places (k x 3) into the picture, k x 2."""
        from mpl_toolkits.mplot3d import proj3d

        x, y, _ = proj3d.proj_transform(*places.T, self._axes.get_proj())
        pixels = self._axes.transData.transform(np.column_stack([x, y]))
        return frozen(np.asarray(pixels) * 72 / self._figure.dpi)
