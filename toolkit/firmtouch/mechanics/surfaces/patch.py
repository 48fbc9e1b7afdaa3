"""Surfaces in numbers: where they are known, and points of them around a contact."""

from __future__ import annotations

from typing import Final

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from firmtouch.mechanics.arrays import Array, Vector, frozen
from firmtouch.mechanics.surfaces import height_field
from firmtouch.mechanics.surfaces.surface import normal, signed_distance
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile.sections.surface import SurfaceSpec

STEPS: Final = 30
CLOSE: Final = 1e-9
"""How far a point of a patch may be from the surface, relative to the patch's size."""


def inside_domain(surface: SurfaceSpec, x: Vector, symbols: Symbols, p: Vector) -> bool:
    """Tell whether a surface is given at x (3, in m): not beyond the grid of a height field. `p` are the parameters."""
    return bool(_known(surface, np.asarray(x, dtype=np.float64)[:, None], symbols, p)[0])


def patch(surface: SurfaceSpec, at: Vector, symbols: Symbols, p: Vector, *, size: float, count: int) -> Array:
    """Give points of the surface around `at` (3), a point on or near it: count x count x 3, in m.

    A square grid of edge `size` in the tangent plane is moved along the normal by Newton's method. What does not reach
    the surface, or leaves a height field's grid, is nan. The first index goes along the first tangent direction.
    """
    x = ca.SX.sym("x", 3)
    outputs = ca.cse([ca.densify(each(surface, x, symbols)) for each in (signed_distance, normal)])
    function = ca.Function("surface", [x, symbols.p], outputs)
    centre = np.asarray(at, dtype=np.float64)
    first, second = _tangents(np.asarray(function(centre, p)[1].full()).ravel())
    steps = np.linspace(-size / 2, size / 2, count)
    points = centre[:, None] + np.outer(first, np.repeat(steps, count)) + np.outer(second, np.tile(steps, count))
    values = function.map(count**2)
    parameters = np.tile(np.asarray(p, dtype=np.float64)[:, None], count**2)
    with np.errstate(invalid="ignore", over="ignore"):
        for _ in range(STEPS):
            s, n = (np.asarray(each.full()) for each in values(points, parameters))
            on_it = np.abs(s[0]) <= CLOSE * size
            if np.all(on_it | ~np.isfinite(s[0])):
                break
            points = np.where(on_it, points, points - s * n)
    points[:, ~(on_it & _known(surface, points, symbols, p))] = np.nan
    return frozen(points.T.reshape(count, count, 3))


def _tangents(n: Array) -> tuple[Array, Array]:
    """Give two unit vectors across n and each other, of which the first is level where that is possible."""
    level = np.array([-n[1], n[0], 0.0])
    size = np.linalg.norm(level)
    first = level / size if size > CLOSE else np.array([1.0, 0.0, 0.0])
    second = np.cross(n, first)
    return first, second / np.linalg.norm(second)


def _known(surface: SurfaceSpec, points: Array, symbols: Symbols, p: Vector) -> NDArray[np.bool_]:
    if surface.height_field is None:
        return np.full(points.shape[1], fill_value=True)
    x = ca.SX.sym("x", 3)
    room = ca.Function("room", [x, symbols.p], [height_field.within(surface.height_field, x, symbols)])
    parameters = np.tile(np.asarray(p, dtype=np.float64)[:, None], points.shape[1])
    rooms = np.asarray(room.map(points.shape[1])(points, parameters).full(), dtype=np.float64)
    return np.asarray(rooms[0] >= 0)
