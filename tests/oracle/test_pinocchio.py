"""Pinocchio reads the same files by code that shares nothing with ours."""

from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from firmtouch.mechanics.tree import build_tree, frame_jacobian, frame_pose, mass_matrix, potential_energy, theta
from firmtouch.modelfile.urdf import read_urdf

ROOT = Path(__file__).parents[2]
STATES = 1000
AGREE = 1e-10
"""Of the largest entry, the bound that the derivation promises; measured: 6e-15."""

pytestmark = pytest.mark.pinocchio


@pytest.fixture(scope="module", params=sorted((ROOT / "models" / "urdf").glob("*.urdf")), ids=lambda path: path.stem)
def both(request):
    """Give the same arm here and there."""
    pin = pytest.importorskip("pinocchio")
    tree = build_tree(read_urdf(request.param), tool="flange")
    model = pin.buildModelFromUrdf(str(request.param))
    assert list(model.names)[1:] == [each.name for each in tree.coordinates]
    return pin, model, model.createData(), tree


def test_dynamics_and_frames_agree_at_random_states(both, rng):
    pin, model, data, tree = both
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
