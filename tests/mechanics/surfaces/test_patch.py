"""Patches: points of the surface, spread around the contact, and nothing where the surface is not given."""

import numpy as np
import pytest
from tests.mechanics.surfaces.given import SURFACES, SYMBOLS, Measured, P, measured

from firmtouch.mechanics.surfaces import patch

CLOSE = 1e-8  # a patch is as near as a billionth of its size, in the distance of first order


@pytest.mark.parametrize("name", SURFACES)
def test_its_points_are_on_the_surface(name):
    one = measured(name)
    at = one.onto([0.3, 0.35, 0.3])
    found = patch(one.spec, at, SYMBOLS, P, size=0.05, count=5)
    assert found.shape == (5, 5, 3)
    assert found[2, 2] == pytest.approx(at, abs=CLOSE)
    assert np.abs(one.many(found.reshape(-1, 3))).max() < CLOSE
    assert np.linalg.norm(found[4, 2] - found[0, 2]) == pytest.approx(0.05, rel=0.2)
    assert np.linalg.norm(found[2, 4] - found[2, 0]) == pytest.approx(0.05, rel=0.2)


def test_a_plane_is_a_square():
    wall = Measured("plane: {point: [0, 0, d], normal: [1, 0, 1]}")
    found = patch(wall.spec, [0, 0, 0.1], SYMBOLS, P, size=0.4, count=3)
    edges = [found[2, 0] - found[0, 0], found[0, 2] - found[0, 0]]
    assert np.array([[a @ b for a in edges] for b in edges]) == pytest.approx(np.diag([0.16, 0.16]), abs=1e-12)
    assert found[:, 1, 2] == pytest.approx([0.1, 0.1, 0.1])  # the first direction is level


def test_a_height_field_ends_with_its_grid():
    heights = [[0.01 * i * j for j in range(4)] for i in range(4)]
    wall = Measured(f"height_field: {{x: [0, 1], y: [0, 1], heights: {heights}}}")
    found = patch(wall.spec, wall.onto([0.9, 0.5, 0]), SYMBOLS, P, size=0.6, count=7)
    known = np.isfinite(found).all(axis=2)
    assert 0 < known.sum() < 49
    assert np.all(found[known][:, :2] >= 0)
    assert np.all(found[known][:, :2] <= 1)


def test_what_does_not_reach_the_surface_is_missing():
    """Beyond the rim of a hyperbola's cap there is nothing to project on."""
    wall = Measured('implicit: {expression: "z - exp(-1/(1 - x**2 - y**2))*exp(1)"}')
    found = patch(wall.spec, [0, 0, 1], SYMBOLS, P, size=6, count=7)
    values = found.reshape(-1, 3)
    there = np.isfinite(values).all(axis=1)
    assert there[24]
    assert np.abs(wall.many(values[there])).max() < 6 * CLOSE
