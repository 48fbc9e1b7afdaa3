"""Which pair of poles goes to which mode shape: the freedom that Steps 1-4 leave in S -> Q S."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
import scipy.linalg
import scipy.optimize

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.modelfile.sections.design import DesignSpec
from firmtouch.synthesis.normal_blocks import CLEARLY_POSITIVE
from firmtouch.synthesis.pairing import Mode, pairings

MOST_REFINED: Final = 8
"""Starts of the refinement of the mode shapes; further pairings keep the plant's shapes."""
WALL: Final = 4.0
"""What the refinement sees, relative to its start, where W is not positive though it must be (||W|| grows there)."""


def choose_mode_shapes(
    design: DesignSpec, natural: tuple[Array, Array], size: Callable[[tuple[Mode, ...], Array], float]
) -> tuple[tuple[Mode, ...], Array]:
    """Choose which pair of poles goes to which mode shape (the columns of Q, in mass-normalised coordinates).

    On the plant's own shapes, the stiffness nearest to the plant's gives its k_i in the order of the plant's values
    (Hoffman and Wielandt). It is also the order in which W22 > 0 if any order gives that (Weyl), so on the full level
    pairings with all k_i above the plant's values go first. `least_gain` then turns Q until ||W||_F is least, from the
    best of these starts.
    """
    assert design.poles is not None
    values, vectors = natural
    starts = []
    for modes in pairings(design.poles):
        ordered = tuple(sorted(modes, key=lambda each: (each.k, each.c)))
        excess = np.array([mode.k for mode in ordered]) - values
        refused = design.level == "full" and bool(np.min(excess) <= CLEARLY_POSITIVE * np.max(np.abs(values)))
        starts.append((refused, float(excess @ excess), ordered))
    starts.sort(key=lambda each: each[:2])
    usable = [modes for _, _, modes in starts[:MOST_REFINED] if np.isfinite(size(modes, vectors))]
    if design.modes == "plant" or len(values) == 1 or not usable:
        return starts[0][2], vectors
    _, modes, Q = min((_turned(modes, vectors, size) for modes in usable), key=lambda each: each[0])
    return modes, Q


def _turned(
    modes: tuple[Mode, ...], start: Array, size: Callable[[tuple[Mode, ...], Array], float]
) -> tuple[float, tuple[Mode, ...], Array]:
    """Minimise ||W||_F over Q = start expm(X), X skew, by a quasi-Newton method."""
    dimension = start.shape[0]
    below = np.tril_indices(dimension, -1)

    def turn(x: Array) -> Array:
        X = np.zeros((dimension, dimension))
        X[below] = x
        return frozen(start @ scipy.linalg.expm(X - X.T))

    scale = size(modes, start) or 1.0
    found = scipy.optimize.minimize(
        lambda x: min(size(modes, turn(x)) / scale, WALL), np.zeros(len(below[0])), method="BFGS"
    )
    return float(found.fun) * scale, modes, turn(found.x)
