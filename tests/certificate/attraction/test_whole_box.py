"""[T10] on boxes of all joint coordinates: bounds on the boundary hold, other equilibria are never inside."""

from pathlib import Path

import numpy as np
import pytest

import firmtouch
from firmtouch.certificate.attraction import NotProvenError, find_whole_box, prove_whole_box

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def shipped(loop_of):
    return lambda name: loop_of(firmtouch.read_model(ROOT / "models" / f"{name}.yaml"))


def energy(loop, q):
    dq, plant = q - loop.operating_point.q_d, loop.operating_point.plant
    return plant.P(q) - plant.P(loop.operating_point.q_d) - loop.gains.bias @ dq + dq @ loop.gains.W @ dq / 2


def on_the_boundary(loop, half_width, rng, count):
    """Points of the surface in the faces of a box, found by Newton's method within each face."""
    op, found = loop.operating_point, []
    for _ in range(count):
        q = op.q_d + rng.uniform(-half_width, half_width, op.n)
        i = rng.integers(op.n)
        q[i], free = op.q_d[i] + rng.choice([-half_width, half_width]), np.arange(op.n) != i
        for _ in range(15):
            q[free] -= np.linalg.lstsq(op.plant.J(q)[:, free], op.plant.Phi(q), rcond=None)[0]
        if np.max(np.abs(q - op.q_d)) <= half_width * (1 + 1e-12) and np.max(np.abs(op.plant.Phi(q))) < 1e-10:
            found.append(q)
    return found


@pytest.mark.parametrize(("name", "half_width", "least"), [("planar_2r_wall", 0.4, 4), ("planar_3r_circle", 0.2, 50)])
def test_the_bars_hold_and_p_on_the_boundary_is_not_below_the_level(name, half_width, least, shipped, rng):
    loop = shipped(name)
    found = prove_whole_box(loop, half_width)
    assert found.level > 0
    points = on_the_boundary(loop, half_width, rng, 300)
    assert len(points) >= least
    lowest = min(energy(loop, q) for q in points)
    assert 0.8 * lowest < found.level <= lowest


def test_another_equilibrium_ends_the_box(shipped):
    """It is 0.1589 rad away; see `test_other_equilibria_of_shipped_designs_are_outside`."""
    loop = shipped("planar_2r_circle")
    assert 0.14 < find_whole_box(loop, most_cells=1000).half_width < 0.1589
    with pytest.raises(NotProvenError, match="another equilibrium"):
        prove_whole_box(loop, 0.165, most_cells=1000)


def test_the_same_call_gives_the_same_answer_and_six_joints_are_refused(shipped):
    loop = shipped("planar_3r_wall")
    assert prove_whole_box(loop, 0.1) == prove_whole_box(loop, 0.1)
    with pytest.raises(NotProvenError, match="6 joint"):
        find_whole_box(shipped("two_arms_bar"))
