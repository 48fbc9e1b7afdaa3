"""What of a scene must be seen, and which of its forces."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from firmtouch.mechanics import Array, Scene
from firmtouch.mechanics.scene import ContactForce
from firmtouch.report.numbers import number

NOTHING: Final = 1e-9
SURFACE_PART: Final = 0.4
"""How far the picture follows a sphere or a rail beyond the mechanism, as a part of its size."""


def shown_forces(scene: Scene) -> tuple[ContactForce, ...]:
    """List the contact forces that are not zero."""
    return tuple(each for each in scene.forces if float(np.linalg.norm(each.force)) > NOTHING)


def force_label(force: ContactForce) -> str:
    """Write the size of a force."""
    return f"{number(float(np.linalg.norm(force.force)), 3)} N"


def extent(scene: Scene) -> tuple[Array, Array]:
    """Find the box of what must be seen: mechanism, ghosts and contacts, not all of a large sphere or rail."""
    points = np.vstack([*scene.lines, *(line for ghost in scene.ghosts for line in ghost), *_contacts(scene)])
    points = np.vstack([points, *(each.points.reshape(-1, 3) for each in scene.patches)])
    points = points[np.all(np.isfinite(points), axis=1)]
    low, high = points.min(axis=0), points.max(axis=0)
    reach = SURFACE_PART * float(np.max(high - low))
    wide = [(each.centre - each.radius, each.centre + each.radius) for each in scene.rounds]
    wide += [(each.min(axis=0), each.max(axis=0)) for each in scene.rails]
    for least, most in wide:
        low = np.maximum(np.minimum(low, least), low - reach)
        high = np.minimum(np.maximum(high, most), high + reach)
    margin = 0.12 * float(np.max(high - low)) or 0.1
    return low - margin, high + margin


def _contacts(scene: Scene) -> Iterator[Array]:
    for each in scene.forces:
        yield each.point[None, :]
