"""Robots as plants: payloads, chains against the same arms written by hand, and a foreign derivation."""

import json
import time
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
import sympy as sp

import firmtouch
from firmtouch.mechanics.arm import arm_of
from firmtouch.mechanics.equations import equations_of
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile.files import kept

UR5E = (Path(__file__).parents[2] / "models" / "urdf" / "ur5e.urdf").read_text(encoding="utf-8")
JOINTS = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]
ROUNDING = 1e-12  # relative to the largest entry: some thousand operations


def robot(urdf, joints, mechanism=None, **sections):
    """Read a robot on a rod from its root; the constraint does not matter here."""
    document = {
        "schema": "firmtouch.model/1",
        "title": "A robot made by a test",
        "mechanism": {"urdf": "arm.urdf"} | (mechanism or {}),
        "constraints": {"rod": {"distance": 0.5, "between": list(sections.pop("between"))}},
        "operating_point": {"guess": dict.fromkeys(joints, 0), "lambda_d": {"rod": 0}},
        "design": {"poles": [-4 - i for i in range(2 * len(joints) - 2)], "force_feedback": 0.5},
    }
    text = json.dumps(document | sections).encode()
    return firmtouch.parse_model(text, name="made", attached=kept({"arm.urdf": urdf.encode()})).spec


def motion(spec):
    """Give M and theta of a specification as functions of numbers, at its parameters' values."""
    symbols = Symbols(spec)
    equations = equations_of(spec, symbols, arm_of(spec, symbols))
    p = np.array([each.value.value for each in spec.parameters.values()])
    f = ca.Function("f", [symbols.q, symbols.qdot, symbols.p], [ca.densify(equations.M), ca.densify(equations.theta)])
    return lambda q, v: [each.full() for each in f(q, v, p)]


def close(got, wanted, rel=ROUNDING):
    assert got == pytest.approx(wanted, rel=0, abs=rel * np.abs(wanted).max())


def with_link(xyz, mass, inertia, rpy="0 0 0"):
    """Fix a body to the flange, in the file itself."""
    ixx, iyy, izz = inertia
    return UR5E.replace(
        "</robot>",
        f'<link name="load"><inertial><origin xyz="{xyz}"/><mass value="{mass}"/>'
        f'<inertia ixx="{ixx}" iyy="{iyy}" izz="{izz}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        f'<joint name="grip" type="fixed"><origin rpy="{rpy}"/><parent link="flange"/><child link="load"/></joint></robot>',
    )


@pytest.mark.parametrize("named", [True, False], ids=["its frame is named", "the tool carries it"])
def test_a_payload_of_parameters_is_a_link_that_is_fixed_there(named, rng):
    parameters = {"m": "2.5 kg", "h": "0.12 m", "I": "0.02 kg*m^2"}
    payload = {"mass": "m", "centre_of_mass": ["0.01 m", 0, "h"], "inertia": ["I", "1.5*I", "0.01 kg*m^2"]}
    carried = robot(
        UR5E,
        JOINTS,
        {"tool": "flange", "payload": payload | ({"frame": "flange"} if named else {})},
        between=["base", "flange"],
        parameters=parameters,
    )
    fixed = robot(
        with_link("0.01 0 0.12", 2.5, (0.02, 0.03, 0.01)), JOINTS, {"tool": "flange"}, between=["base", "flange"]
    )
    ours, theirs = motion(carried), motion(fixed)
    for q, v in rng.uniform(-2, 2, (5, 2, 6)):
        for got, wanted in zip(ours(q, v), theirs(q, v), strict=True):
            close(got, wanted)


def test_rotors_are_inertia_of_their_joints_alone(rng):
    bare = motion(robot(UR5E, JOINTS, {"tool": "flange"}, between=["base", "flange"]))
    geared = motion(
        robot(UR5E, JOINTS, {"tool": "flange", "rotors": {"wrist_3": "0.06 kg*m^2"}}, between=["base", "flange"])
    )
    q, qdot = rng.uniform(-1, 1, (2, 6))
    (M, theta), (bare_M, bare_theta) = geared(q, qdot), bare(q, qdot)
    np.testing.assert_allclose(M - bare_M, np.diag([0, 0, 0, 0, 0, 0.06]), atol=1e-14)  # one rounding
    np.testing.assert_array_equal(theta, bare_theta)


def test_a_point_mass_has_no_inertia_and_a_missing_payload_no_effect(rng):
    plain = motion(robot(UR5E, JOINTS, {"tool": "flange"}, between=["base", "flange"]))
    for mass, change in (("0 kg", False), ("1 kg", True)):
        loaded = motion(robot(UR5E, JOINTS, {"tool": "flange", "payload": {"mass": mass}}, between=["base", "flange"]))
        q, v = rng.uniform(-1, 1, (2, 6))
        same = np.allclose(loaded(q, v)[0], plain(q, v)[0], rtol=0, atol=ROUNDING)
        assert same != change


# Chains.

LENGTH, MASS = 0.4, 2.0
BY_HAND = {"l": f"{LENGTH} m", "c": f"{LENGTH / 2} m", "m": f"{MASS} kg", "I": f"{MASS * LENGTH**2 / 12!r} kg*m^2"}
BALL = {"cylinder": {"point": [0.9, 0.2, 0], "axis": [0, 0, 1], "radius": 0.25}}
WALL = {"plane": {"point": [0.55, 0, 0], "normal": [-1, 0, 0]}}
PAIRS = {
    "2 links on a wall": (2, WALL, "0.55 - x(p2)", [1.0, -0.9]),
    "3 links on a ball": (3, BALL, "norm(p3 - [0.9, 0.2]) - 0.25", [1.2, -0.9, -0.7]),
}


def chain(n, surface, guess):
    document = {
        "schema": "firmtouch.model/1",
        "title": "A chain",
        "mechanism": {"planar_chain": {"n": n, "length": LENGTH, "mass": MASS}},
        "constraints": {"touch": {"surface": surface}},
        "operating_point": {"guess": {f"q{i + 1}": each for i, each in enumerate(guess)}, "lambda_d": {"touch": 10}},
        "design": {"poles": [-(4.0 + i) for i in range(2 * (n - 1))], "force_feedback": 0.5},
    }
    return firmtouch.parse_model(json.dumps(document).encode(), name="chain")


@pytest.fixture(params=PAIRS)
def both(request, make_arm):
    n, surface, phi, guess = PAIRS[request.param]
    return chain(n, surface, guess), make_arm(n, {"touch": phi}, guess, parameters=BY_HAND)


def test_a_chain_is_the_arm_that_one_writes_by_hand(both, rng):
    ours, by_hand = (firmtouch.derive_plant(each.spec) for each in both)
    for q, v in rng.uniform(-1.5, 1.5, (5, 2, ours.n)):
        for name in ("M", "Phi", "J", "P_q", "P_qq", "Phi_qq"):
            close(getattr(ours, name)(q), getattr(by_hand, name)(q))
        close(ours.theta(q, v), by_hand.theta(q, v))
        close(ours.Jdot_qdot(q, v), by_hand.Jdot_qdot(q, v))


def test_the_same_poles_give_the_same_gains(both, loop_of):
    ours, by_hand = map(loop_of, both)
    for name in ("q_d", "N0", "J", "M", "f_d"):
        close(getattr(ours.operating_point, name), getattr(by_hand.operating_point, name))
    for name in ("W", "C", "G_f", "bias"):
        # With several modes W and C come out of a search for the least ||W||, which is flat at its end: half the digits.
        close(getattr(ours.gains, name), getattr(by_hand.gains, name), rel=1e-6 if ours.operating_point.n > 2 else 1e-9)
    # 1e-9: what the pencil's eigenvalues keep of the digits.
    assert np.array(ours.poles.pencil) == pytest.approx(np.array(by_hand.poles.pencil), rel=1e-9)


def test_thirty_links_are_derived_soon():
    model = chain(30, WALL, [0.3] + [-0.02] * 29)
    start = time.process_time()
    plant = firmtouch.derive_plant(model.spec)
    assert (plant.n, plant.m) == (30, 1)
    assert time.process_time() - start < 3  # it takes about half a second; by Lagrange's equations, minutes


# SymPy, from the energies, on an arm with skew axes.

AXES = [(0.2, -0.4, 0.9), (0.7, 0.1, -0.3), (-0.5, 0.6, 0.2)]
PLACES = [
    ((0.1, 0.2, 0.3), (0.3, -0.2, 0.5)),
    ((0.4, -0.1, 0.2), (-0.6, 0.4, 0.1)),
    ((0.2, 0.3, -0.1), (0.1, 0.9, -0.4)),
]
BODIES = [
    (2.0, (0.1, -0.2, 0.15), (0.5, -0.1, 0.2), (0.11, 0.09, 0.07)),
    (1.2, (0.3, 0.1, -0.05), (-0.3, 0.7, 0.0), (0.05, 0.06, 0.04)),
    (0.7, (-0.1, 0.05, 0.2), (0.2, 0.1, -0.9), (0.02, 0.03, 0.035)),
]
KINDS = ["revolute", "prismatic", "revolute"]
GRAVITY = (1.0, -2.0, -9.0)


def skew_urdf(n):
    def words(values):
        return " ".join(map(repr, values))

    pieces = ['<link name="l0"/>']
    for i, (axis, (xyz, rpy), (mass, com, turned, moments), kind) in enumerate(
        list(zip(AXES, PLACES, BODIES, KINDS, strict=True))[:n], 1
    ):
        ixx, iyy, izz = moments
        pieces.append(
            f'<link name="l{i}"><inertial><origin xyz="{words(com)}" rpy="{words(turned)}"/><mass value="{mass}"/>'
            f'<inertia ixx="{ixx}" iyy="{iyy}" izz="{izz}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="j{i}" type="{kind}"><origin xyz="{words(xyz)}" rpy="{words(rpy)}"/><parent link="l{i - 1}"/>'
            f'<child link="l{i}"/><axis xyz="{words(axis)}"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint>'
        )
    return f'<robot name="skew">{"".join(pieces)}</robot>'


def rotation(rpy):
    """Roll about x, pitch about y, yaw about z, all of them fixed axes."""
    r, p, y = map(sp.Float, rpy)
    return sp.rot_axis3(-y) @ sp.rot_axis2(-p) @ sp.rot_axis1(-r)


def by_hand(n):
    """Give the Jacobians of each body and P of the arm: poses, their derivatives, and nothing of ours."""
    q = sp.symbols(f"q1:{n + 1}")
    R, p = sp.eye(3), sp.zeros(3, 1)
    Jacobians, P = [], sp.Float(0)
    arm = zip(AXES, PLACES, BODIES, KINDS, strict=True)
    for x, (axis, (xyz, rpy), (mass, com, turned, _), kind) in zip(q, list(arm)[:n], strict=True):
        p = p + R @ sp.Matrix(xyz)
        R = R @ rotation(rpy)
        a = sp.Matrix(axis) / sp.sqrt(sum(each**2 for each in axis))
        if kind == "prismatic":
            p = p + R @ a * x
        else:
            A = sp.Matrix([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
            R = R @ (sp.eye(3) + sp.sin(x) * A + (1 - sp.cos(x)) * A @ A)
        centre, body = p + R @ sp.Matrix(com), R @ rotation(turned)
        Jv, Jw = centre.jacobian(q), sp.zeros(3, n)
        for i, each in enumerate(q):
            W = body.T @ body.diff(each)  # the angular velocity for q_i' = 1 in the body's axes, as a skew matrix
            Jw[:, i] = sp.Matrix([W[2, 1], W[0, 2], W[1, 0]])
        Jacobians.append(Jv.col_join(Jw))
        P -= mass * centre.dot(sp.Matrix(GRAVITY))
    return q, Jacobians, P


@pytest.mark.slow
@pytest.mark.parametrize("n", [2, 3])
def test_sympy_derives_the_same_arm_from_its_energies(n, rng):
    q, Jacobians, P = by_hand(n)
    rates = [[J.diff(each) for each in q] for J in Jacobians]
    f = sp.lambdify([q], [Jacobians, rates, [P.diff(each) for each in q]], modules="numpy", cse=True)
    inertias = [np.diag([mass] * 3 + list(moments)) for mass, _, _, moments in BODIES]
    spec = robot(skew_urdf(n), [f"j{i + 1}" for i in range(n)], {"gravity": list(GRAVITY)}, between=["l0", f"l{n}"])
    ours = motion(spec)
    for x, v in rng.uniform(-2, 2, (6, 2, n)):
        J, J_q, P_q = (np.asarray(each, dtype=float) for each in f(x))
        M_x = sum(A.T @ X @ A for A, X in zip(J, inertias[:n], strict=True))
        half = sum(A.T @ X @ A_q for A, A_q, X in zip(J, J_q, inertias[:n], strict=True))  # n x n x n, by q_k first
        M_q = half + half.transpose(0, 2, 1)
        # Eq. (4): theta = (dM/dt) q' - (q'^T M q' / 2)_q + P_q.
        theta_x = np.einsum("kij,k,j->i", M_q, v, v) - np.einsum("ijk,j,k->i", M_q, v, v) / 2 + P_q
        got_M, got_theta = ours(x, v)
        assert got_M == pytest.approx(M_x, rel=1e-10, abs=1e-10)
        assert got_theta[:, 0] == pytest.approx(theta_x, rel=1e-10, abs=1e-10)
