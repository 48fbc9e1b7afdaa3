"""The cell of two arms is the one arm twice, at the places that its file states."""

from pathlib import Path

import numpy as np
import pytest

from firmtouch.mechanics.tree import build_tree
from firmtouch.modelfile.urdf import read_urdf

URDF = Path(__file__).parents[3] / "models" / "urdf"
ROUNDING = 1e-13
"""Of some ten products of numbers up to 10."""


@pytest.fixture(scope="module")
def cell():
    return read_urdf(URDF / "dual_ur5e.urdf")


def test_the_cell_is_one_arm_twice(cell, say, rng):
    both = say.functions(build_tree(cell))
    one = say.functions(build_tree(read_urdf(URDF / "ur5e.urdf"), tool="flange"))
    for q in rng.uniform(-3, 3, (5, 12)):
        v = rng.uniform(-2, 2, 12)
        M = np.zeros((12, 12))
        M[:6, :6], M[6:, 6:] = one.M(q[:6]), one.M(q[6:])
        assert both.M(q) == pytest.approx(M, abs=ROUNDING)
        forces = np.concatenate([one.theta(q[:6], v[:6]), one.theta(q[6:], v[6:])])
        assert both.theta(q, v) == pytest.approx(forces, abs=100 * ROUNDING)  # some hundred N m
    limits = [(each.lower, each.upper, each.velocity, each.effort) for each in build_tree(cell).coordinates]
    assert limits[:6] == limits[6:]
    assert limits[:6] == [
        (each.lower, each.upper, each.velocity, each.effort)
        for each in build_tree(read_urdf(URDF / "ur5e.urdf")).coordinates
    ]


def test_the_bases_face_each_other(cell, say, rng):
    left, right = (say.functions(build_tree(cell, tool=f"{side}_tool0"), f"{side}_tool0") for side in ("left", "right"))
    one = say.functions(build_tree(read_urdf(URDF / "ur5e.urdf"), tool="flange"), "flange")
    half_turn = np.diag([-1, -1, 1])
    for q in rng.uniform(-3, 3, (5, 6)):
        assert left.p(q) == pytest.approx(one.p(q) - np.array([0.5, 0, 0]), abs=ROUNDING)
        assert left.R(q) == pytest.approx(one.R(q), abs=ROUNDING)
        assert right.p(q) == pytest.approx(half_turn @ left.p(q), abs=ROUNDING)
        assert right.R(q) == pytest.approx(half_turn @ left.R(q), abs=ROUNDING)
