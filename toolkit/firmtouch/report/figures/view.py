"""From where a scene in space is looked at, so that the arm is seen at its length and the contacts are not hidden."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from firmtouch.mechanics import Array, Scene
from firmtouch.mechanics.arrays import frozen

AZIMUTHS: Final = tuple(each for each in range(-180, 180, 15) if each % 90)
"""None along an axis, of which nothing would be seen then."""
ELEVATIONS: Final = (-35, -22, -12, 12, 22, 35, 48)
USUAL: Final = 22
"""Degrees above the floor from which things are usually looked at."""
FACING: Final = 0.35
"""The least cosine between the way to the eye and a surface's normal with which the surface is seen well."""
STEEPEST: Final = 0.75
"""The greatest one: nothing is seen of a force that points at the eye."""
NEAR: Final = 0.05
"""What comes nearer to a contact than this part of the mechanism's size hides it."""
HIDDEN: Final = 3.0
CROSSING: Final = 0.25
COVERED: Final = 0.6
FROM_AFAR: Final = 0.3
"""What these faults count, where links seen at their full length count 1."""


@dataclass(frozen=True, slots=True)
class View:
    """Azimuth and elevation in degrees, as matplotlib has them; the eye is along `towards` (3), far away."""

    azimuth: float
    elevation: float

    @property
    def towards(self) -> Array:
        """The direction to the eye."""
        a, e = np.radians([self.azimuth, self.elevation])
        return frozen([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])

    def flat(self, points: Array) -> Array:
        """Project points (k x 3) along the view, k x 2: to the right and up."""
        a = np.radians(self.azimuth)
        right = np.array([-np.sin(a), np.cos(a), 0.0])
        return frozen(points @ np.column_stack([right, np.cross(self.towards, right)]))


def best_view(scene: Scene) -> View:
    """Choose the view from which most is seen."""
    views = [View(azimuth, elevation) for elevation in ELEVATIONS for azimuth in AZIMUTHS]
    return max(views, key=lambda view: round(_worth(scene, view), 9))  # rounding must not choose between equals


def facing_surfaces(scene: Scene) -> Iterator[tuple[Array, Array]]:
    """List each contact with a surface, and the normal of the surface there, towards the mechanism."""
    for patch in scene.patches:
        yield patch.contact, patch.normal
    for force in scene.forces:
        for each in scene.rounds:
            away = force.point - each.centre
            if abs(float(np.linalg.norm(away)) - each.radius) < NEAR * each.radius:
                yield force.point, frozen(away / np.linalg.norm(away))


def _worth(scene: Scene, view: View) -> float:
    lines = [view.flat(each) for each in scene.lines]
    starts, ends = _segments(lines)
    size = float(np.max(np.ptp(np.vstack(scene.lines), axis=0)))
    seen = sum(map(_length, lines)) / (sum(map(_length, scene.lines)) or 1.0)
    worth = seen - FROM_AFAR * abs(view.elevation - USUAL) / 45 - CROSSING * _crossings(starts, ends)
    worth += 0.5 * _moved(scene, view) / size
    for contact, normal in facing_surfaces(scene):
        facing = float(normal @ view.towards)
        worth -= HIDDEN * (max(0.0, FACING - facing) + max(0.0, facing - STEEPEST))
        worth -= HIDDEN * _behind_its_surface(scene, view, contact, size)
        worth -= COVERED * _behind_the_arm(lines, view.flat(contact[None, :])[0], size)
    for held in scene.held:
        worth += _length(view.flat(held.ends)) / _length(held.ends)
    for rail in scene.rails:
        worth += 0.3 * _length(view.flat(rail)) / (_length(rail) or 1.0)
    return worth


def _length(line: Array) -> float:
    return float(np.sum(np.linalg.norm(np.diff(line, axis=0), axis=1)))


def _segments(lines: list[Array]) -> tuple[Array, Array]:
    return (
        frozen(np.vstack([each[:-1] for each in lines])),
        frozen(np.vstack([each[1:] for each in lines])),
    )


def _moved(scene: Scene, view: View) -> float:
    """Say how far the ghosts' ends are seen from the mechanism's, on average."""
    gaps = [
        float(np.linalg.norm(view.flat((ghost[-1] - line[-1])[None, :])))
        for each in scene.ghosts
        for ghost, line in zip(each, scene.lines, strict=True)
    ]
    return float(np.mean(gaps)) if gaps else 0.0


def _crossings(starts: Array, ends: Array) -> int:
    """Count the pairs of links that cross each other in the picture."""

    def side(a: Array, b: Array, c: Array) -> Array:
        return frozen(
            (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])
        )

    one, other = np.triu_indices(len(starts), k=1)
    a, b, c, d = starts[one], ends[one], starts[other], ends[other]
    return int(np.sum((side(a, b, c) * side(a, b, d) < 0) & (side(c, d, a) * side(c, d, b) < 0)))


def _behind_its_surface(scene: Scene, view: View, contact: Array, size: float) -> bool:
    """Tell whether a piece of surface is between a contact and the eye."""
    for patch in scene.patches:
        away = patch.points.reshape(-1, 3) - contact
        away = away[np.all(np.isfinite(away), axis=1)]
        ahead = away @ view.towards
        beside = np.linalg.norm(away - np.outer(ahead, view.towards), axis=1)
        if np.any((ahead > NEAR * size) & (beside < NEAR * size / 2)):
            return True
    for each in scene.rounds:
        from_centre = contact - each.centre
        before = -float(from_centre @ view.towards)
        if before > 0 and float(from_centre @ from_centre) - before**2 < each.radius**2 * (1 - NEAR):
            return True
    return False


def _behind_the_arm(lines: list[Array], contact: Array, size: float) -> float:
    """Say how much of the near of a contact is covered by links that do not end there."""
    covered = 0.0
    for line in lines:
        for i in range(len(line) - 1):
            if np.linalg.norm(line[i + 1] - contact) < 1e-6 * size:
                continue
            gap = distance_to_segment(contact, line[i], line[i + 1])
            touches = i + 2 < len(line) and np.linalg.norm(line[i + 2] - contact) < 1e-6 * size
            covered += 0.0 if touches else max(0.0, 1 - gap / (NEAR * size))
    return min(covered, 1.0)


def distance_to_segment(point: Array, start: Array, end: Array) -> float:
    """Give the distance of a point from a piece of a line."""
    along = end - start
    share = float((point - start) @ along) / (float(along @ along) or 1.0)
    return float(np.linalg.norm(point - start - np.clip(share, 0.0, 1.0) * along))
