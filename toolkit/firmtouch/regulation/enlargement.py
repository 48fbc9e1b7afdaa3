"""How much larger a polytope is than the hull of what occurs, for its reader; no proof rests on it."""

from __future__ import annotations

import math
from typing import Final

import casadi as ca
import numpy as np

from firmtouch.mechanics import Array
from firmtouch.regulation.dependence import Axis, Control, evaluate

SAMPLES: Final = 600
"""How many parameter values stand for all of them in `enlargement`."""
CONSTANT: Final = 1e-12
"""What changes by less than this part of itself is constant but for rounding."""


def enlargement_of(response: ca.Function | None, axes: tuple[Axis, ...], controls: list[Control]) -> float:
    """Measure the parameters' part: 1 + 2 (farthest distance of a control point) / (diameter of what occurs)."""
    from scipy.spatial.distance import pdist

    beyond = [control for control in controls if control.untaken]
    if response is None or not beyond:
        return 1.0
    size = controls[0].M.size
    occurring = evaluate(response, _grid(axes))[:, : 2 * size]
    points = np.array([np.concatenate([control.M.ravel(), control.P_qq.ravel()]) for control in beyond])
    occurring, points = _scaled(occurring, points, size)
    diameter = float(np.max(pdist(occurring), initial=0.0))
    if diameter == 0:
        return 1.0
    return 1 + 2 * max(_distance(point, occurring) for point in points) / diameter


def _grid(axes: tuple[Axis, ...]) -> list[Array]:
    """Sample the parameters: the ends where the hull is that of the ends, and a grid where there are curves."""
    curves = sum(axis.degree > 1 for axis in axes)
    corners = math.prod(len(axis.nodes) for axis in axes if axis.degree == 1)
    count = max(3, int((SAMPLES / corners) ** (1 / curves)))
    return [np.linspace(axis.nodes[0], axis.nodes[-1], count) if axis.degree > 1 else axis.nodes for axis in axes]


def _scaled(occurring: Array, points: Array, size: int) -> tuple[Array, Array]:
    """Measure M and P_qq each by its own range, in coordinates of as few directions as they need."""
    scale = np.zeros(2 * size)
    for part in (slice(0, size), slice(size, 2 * size)):
        reach = float(np.linalg.norm(np.ptp(occurring[:, part], axis=0)))
        if reach > CONSTANT * float(np.max(np.abs(occurring[:, part]))):
            scale[part] = 1 / reach
    both = (np.vstack([occurring, points]) - occurring[0]) * scale
    _, values, directions = np.linalg.svd(both, full_matrices=False)
    both = both @ directions[values > CONSTANT * values[0]].T
    return both[: len(occurring)], both[len(occurring) :]


def _distance(point: Array, cloud: Array) -> float:
    """Give the distance of a point from the convex hull of others (of size one)."""
    from scipy.optimize import nnls

    weights, _ = nnls(np.vstack([cloud.T, np.full(len(cloud), 100.0)]), np.append(point, 100.0))
    return float(np.linalg.norm(cloud.T @ weights / np.sum(weights) - point))
