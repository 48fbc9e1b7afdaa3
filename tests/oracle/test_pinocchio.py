"""Pinocchio reads the same files by code that shares nothing with ours."""

import sysconfig
from pathlib import Path
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from firmtouch.errors import FirmtouchError
from firmtouch.mechanics.tree import build_tree, frame_jacobian, frame_pose, mass_matrix, potential_energy, theta
from firmtouch.modelfile.urdf import parse_urdf

ROOT = Path(__file__).parents[2]
STATES = 1000
FEW_STATES = 20
AGREE = 1e-10
"""Of the largest entry, the bound that the derivation promises; measured: 1.7e-14."""

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
FOREIGN = Path(sysconfig.get_path("purelib"), "cmeel.prefix", "share", "example-robot-data", "robots")
"""Of the package `example-robot-data`, which is not asked for: 131 MB."""
REFUSED = {
    "alex_psyonic_hands": "has an inertia that no body has",
    "allegro_left_hand": "has an inertia that no body has",
    "allegro_right_hand": "has an inertia that no body has",
    "bolt": "has an inertia, but no mass",
    "finger_edu": "is not positive definite: principal moments 0,",
    "human": "has an `<inertial>`",
    "hyq_no_sensors": "is not positive definite",
    "icub": "has a mass of 0.1 kg, but no inertia",
    "icub_reduced": "has a mass of 0.1 kg, but no inertia",
    "iris_simple": "no joint is left that could move",
    "pr2": "has an inertia that no body has",
    "quadrotor_base": "no joint is left that could move",
    "romeo": "carries no mass",
    "romeo_laas_small": "is not positive definite",
    "romeo_small": "has an inertia that no body has",
    "tiago_dual": "101 joints move; at most 100 are taken",
    "ur3": "a robot without links",
}
"""Files of version 6.0.0 there that are not read, and why."""
ARM_JOINTS = 17
"""Of Baxter with both arms and grippers; what has more are humanoids and hands, which cost more than they tell."""


def both(text, name):
    """Give the same arm here and there; `S` gives the speeds of Pinocchio's joints for those of our coordinates.

    Pinocchio lets joints that follow others turn freely.
    """
    tree = build_tree(parse_urdf(text, file=name))
    model = pin.buildModelFromXML(text.decode())
    joints = [model.joints[model.getJointId(each.name)] for each in tree.joints]
    S = np.zeros((model.nv, tree.n))
    S[[each.idx_v for each in joints]] = tree.G
    assert sorted(each.idx_v for each in joints) == list(range(model.nv))
    offsets = np.array([each.offset for each in tree.joints])

    def configuration(q):
        x = np.zeros(model.nq)
        for joint, position in zip(joints, tree.G @ q + offsets, strict=True):
            circle = joint.nq == 2  # a joint without limits is a point of the unit circle there
            x[joint.idx_q : joint.idx_q + joint.nq] = [np.cos(position), np.sin(position)] if circle else position
        return x

    return SimpleNamespace(tree=tree, model=model, data=model.createData(), S=S, configuration=configuration)


@pytest.fixture(scope="module", params=ARMS)
def arm(request):
    return both(ARMS[request.param].encode(), request.param)


def assert_agree(arm, rng, states):
    """Compare M, theta, P, and of every frame the pose, J and J' q'."""
    tree, model, data, S = arm.tree, arm.model, arm.data, arm.S
    q, v = ca.SX.sym("q", tree.n), ca.SX.sym("v", tree.n)
    names = list(tree.frames)
    poses = [frame_pose(tree, each, q) for each in names]
    J = [frame_jacobian(tree, each, q) for each in names]
    outputs = [
        mass_matrix(tree, q),
        theta(tree, q, v),
        ca.vertcat(*(p for p, _ in poses)),
        ca.vertcat(*(R for _, R in poses)),
        ca.vertcat(*J),
        # The acceleration of constrained motion beside J q'': d/dt (J q') with q'' = 0.
        ca.vertcat(*(ca.jtimes(each @ v, q, v) for each in J)),
    ]
    ours = ca.Function("ours", [q, v], [ca.densify(each) for each in outputs], {"cse": True})
    potential = ca.Function("P", [q], [potential_energy(tree, q)])
    frames = [model.getFrameId(each, pin.FrameType.BODY) for each in names]
    aligned = pin.LOCAL_WORLD_ALIGNED
    offsets = []
    for x, speeds in rng.uniform(-3, 3, (states, 2, tree.n)):
        there, rates = arm.configuration(x), S @ speeds
        M = np.triu(pin.crba(model, data, there))
        bias = S.T @ pin.rnea(model, data, there, rates, np.zeros(model.nv))
        pin.computeJointJacobians(model, data, there)
        pin.forwardKinematics(model, data, there, rates, np.zeros(model.nv))
        pin.updateFramePlacements(model, data)
        places = [data.oMf[each] for each in frames]
        accelerations = [pin.getFrameClassicalAcceleration(model, data, each, aligned).vector for each in frames]
        theirs = [
            S.T @ (M + np.triu(M, 1).T) @ S,
            bias[:, None],
            np.concatenate([each.translation for each in places])[:, None],
            np.vstack([each.rotation for each in places]),
            np.vstack([pin.getFrameJacobian(model, data, each, aligned) for each in frames]) @ S,
            np.concatenate(accelerations)[:, None],
        ]
        for mine, other in zip(ours(x, speeds), theirs, strict=True):
            np.testing.assert_allclose(mine.full(), other, rtol=0, atol=AGREE * np.abs(other).max())
        offsets.append(float(potential(x)) - pin.computePotentialEnergy(model, data, there))
    # Both potentials are of the moving links alone here; they may differ by a constant at most.
    assert np.ptp(offsets) < AGREE * max(100, np.abs(tree.gravity[2]) * sum(each.inertia.mass for each in tree.joints))


def test_dynamics_and_all_frames_agree_at_random_states(arm, rng):
    assert_agree(arm, rng, STATES)


@pytest.mark.skipif(not FOREIGN.is_dir(), reason="the package example-robot-data is not installed")
def test_foreign_arms_agree(rng):
    """All files of the package: arms at as many states as ours, what has more joints at a few."""
    read, refused = {}, {}
    for path in sorted(FOREIGN.rglob("*.urdf")):
        text = path.read_bytes()
        try:
            arm = both(text, path.name)
        except FirmtouchError as error:
            refused[path.stem] = str(error)
            continue
        read[path.stem] = arm.tree.n
        assert_agree(arm, rng, STATES if arm.tree.n <= ARM_JOINTS else FEW_STATES)
    assert {"panda", "kinova", "ur5_robot", "ur10_robot", "xarm7", "z1", "so101", "baxter", "talos_left_arm"} <= set(
        read
    )
    assert sorted(refused) == sorted(REFUSED)
    assert [name for name, why in REFUSED.items() if why not in refused[name]] == []
