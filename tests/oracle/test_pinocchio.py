"""Pinocchio reads the same files by code that shares nothing with ours."""

from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from firmtouch.mechanics.tree import build_tree, frame_jacobian, frame_pose, mass_matrix, potential_energy, theta
from firmtouch.modelfile.urdf import parse_urdf

ROOT = Path(__file__).parents[2]
STATES = 1000
AGREE = 1e-10
"""Of the largest entry, the bound that the derivation promises; measured: 1.2e-14."""

pytestmark = pytest.mark.slow  # a thousand states of eight arms


def random_tree(seed: int) -> str:
    """Write a tree of eight links, by all kinds of joints, with skew axes and frames; its last link is the flange."""
    rng = np.random.default_rng(seed)

    def words(*values: float) -> str:
        return " ".join(repr(float(each)) for each in values)

    text = '<robot name="r"><link name="l0"/>'
    for i in range(1, 10):
        half = rng.uniform(0.1, 0.5, 3)  # the sides of a box
        moments = (half @ half - half**2) * rng.uniform(0.3, 3)
        tensor = " ".join(f'i{a}{a}="{each!r}"' for a, each in zip("xyz", moments.tolist(), strict=True))
        last = i == 9
        kind = "fixed" if last or i == 4 else rng.choice(["revolute", "prismatic"])
        parent = 8 if last else 0 if i == 1 else rng.integers(1, i)
        name = "flange" if last else f"l{i}"
        text += (
            f'<link name="{name}"><inertial><origin xyz="{words(*rng.normal(size=3) / 5)}" rpy="{words(*rng.normal(size=3))}"/>'
            f'<mass value="{rng.uniform(0.5, 5)!r}"/><inertia {tensor} ixy="0" ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="j{i}" type="{kind}"><parent link="l{parent}"/><child link="{name}"/>'
            f'<origin xyz="{words(*rng.normal(size=3) / 2)}" rpy="{words(*rng.normal(size=3))}"/>'
            f'<axis xyz="{words(*rng.normal(size=3))}"/><limit lower="-9" upper="9" velocity="1" effort="1"/></joint>'
        )
    return text + "</robot>"


ARMS = {each.stem: each.read_text(encoding="utf-8") for each in sorted((ROOT / "models" / "urdf").glob("*.urdf"))}
ARMS |= {f"random {seed}": random_tree(seed) for seed in range(4)}


@pytest.fixture(scope="module", params=ARMS)
def both(request):
    """Give the same arm here and there, its coordinates in Pinocchio's order."""
    tree = build_tree(parse_urdf(ARMS[request.param].encode(), file=request.param), tool="flange")
    model = pin.buildModelFromXML(ARMS[request.param])
    order = [list(model.names)[1:].index(each.name) for each in tree.coordinates]
    joints = tuple(replace(each, coordinate=order[each.coordinate]) for each in tree.joints)
    assert sorted(order) == list(range(model.nv))
    return model, model.createData(), replace(tree, joints=joints)


def test_dynamics_and_frames_agree_at_random_states(both, rng):
    model, data, tree = both
    q, v = ca.SX.sym("q", tree.n), ca.SX.sym("v", tree.n)
    p, R = frame_pose(tree, "flange", q)
    outputs = [mass_matrix(tree, q), theta(tree, q, v), p, R, frame_jacobian(tree, "flange", q)]
    ours = ca.Function("ours", [q, v], [ca.densify(each) for each in outputs])
    potential = ca.Function("P", [q], [potential_energy(tree, q)])
    flange, n = model.getFrameId("flange"), tree.n
    offsets = []
    for x, speeds in rng.uniform(-3, 3, (STATES, 2, n)):
        M = np.triu(pin.crba(model, data, x))
        bias = pin.rnea(model, data, x, speeds, np.zeros(n))
        pin.computeJointJacobians(model, data, x)
        pin.updateFramePlacements(model, data)
        at = data.oMf[flange]
        J = pin.getFrameJacobian(model, data, flange, pin.LOCAL_WORLD_ALIGNED)
        theirs = [M + np.triu(M, 1).T, bias[:, None], at.translation[:, None], at.rotation, J]
        for mine, other in zip(ours(x, speeds), theirs, strict=True):
            np.testing.assert_allclose(mine.full(), other, rtol=0, atol=AGREE * np.abs(other).max())
        offsets.append(float(potential(x)) - pin.computePotentialEnergy(model, data, x))
    # Both potentials are of the moving links alone here; they may differ by a constant at most.
    assert np.ptp(offsets) < AGREE * 100  # J: the arms lift some hundred joules
