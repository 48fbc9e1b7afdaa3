"""Robots made of text, the shipped arms, and their functions of numbers."""

from pathlib import Path
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest

from firmtouch.mechanics import tree as trees
from firmtouch.modelfile.urdf import parse_urdf, read_urdf

ROOT = Path(__file__).parents[3]


def link(name, mass=None, com="0 0 0", inertia=(1, 1, 1)):
    if mass is None:
        return f'<link name="{name}"/>'
    ixx, iyy, izz = inertia
    tensor = f'<inertia ixx="{ixx!r}" ixy="0" ixz="0" iyy="{iyy!r}" iyz="0" izz="{izz!r}"/>'
    return f'<link name="{name}"><inertial><origin xyz="{com}"/><mass value="{mass!r}"/>{tensor}</inertial></link>'


def joint(name, kind, parent, child, *at, limits=(-10, 10), extra=""):
    xyz, axis, rpy = (*at, *("0 0 0", "0 0 1", "0 0 0")[len(at) :])
    return (
        f'<joint name="{name}" type="{kind}"><origin xyz="{xyz}" rpy="{rpy}"/><parent link="{parent}"/><child link="{child}"/>'
        f'<axis xyz="{axis}"/><limit lower="{limits[0]}" upper="{limits[1]}" velocity="1" effort="1"/>{extra}</joint>'
    )


def functions(tree, frame=None, inertias=None):
    """Give M, theta, P, K and a frame of a tree (its last one, if none is named) as functions of numbers."""
    q, qdot = ca.SX.sym("q", tree.n), ca.SX.sym("qdot", tree.n)
    P = trees.potential_energy(tree, q, inertias)
    outputs = {
        "M": trees.mass_matrix(tree, q, inertias),
        "theta": trees.theta(tree, q, qdot, inertias),
        "P": P,
        "P_q": ca.gradient(P, q),
        "K": trees.kinetic_energy(tree, q, qdot, inertias),
    }
    frame = frame or list(tree.frames)[-1]
    p, R = trees.frame_pose(tree, frame, q)
    outputs |= {"p": p, "R": R, "J": trees.frame_jacobian(tree, frame, q)}
    made = {name: ca.Function(name, [q, qdot], [ca.densify(each)]) for name, each in outputs.items()}

    def call(name):
        shape = {"P": (), "K": ()}.get(name, (-1,) if name in ("theta", "P_q", "p") else made[name].size_out(0))
        return lambda x, v=None: made[name](x, np.zeros(tree.n) if v is None else v).full().reshape(shape)

    return SimpleNamespace(**{name: call(name) for name in made})


@pytest.fixture(scope="session")
def say():
    """Write pieces of a robot, and read it."""

    def robot(*pieces):
        return parse_urdf(f'<robot name="r">{"".join(pieces)}</robot>'.encode(), file="r.urdf")

    return SimpleNamespace(robot=robot, link=link, joint=joint, functions=functions)


@pytest.fixture(scope="session", params=["ur5e", "panda"])
def arm(request):
    return trees.build_tree(read_urdf(ROOT / "models" / "urdf" / f"{request.param}.urdf"), tool="flange")


@pytest.fixture(scope="session")
def branched(say):
    """Two fingers on a sliding, turning hand, one following the other; skew axes everywhere; and a loose second arm."""
    return say.robot(
        say.link("ground"), say.link("base", 9.0),
        say.joint("mount", "fixed", "ground", "base", "0.1 0.2 0.3", "0 0 1", "0.3 -0.2 0.5"),
        say.link("arm", 3.0, "0.1 -0.05 0.2", (0.3, 0.4, 0.5)),
        say.joint("swing", "revolute", "base", "arm", "0 0.1 0.4", "1 2 -0.5", "0.2 0.4 -0.3"),
        say.link("slide", 2.0, "0.02 0.03 0.1", (0.1, 0.2, 0.15)),
        say.joint("push", "prismatic", "arm", "slide", "0.3 0 0.1", "0.2 -1 0.4", "1.1 0.3 0.2"),
        say.link("plate", 0.5, "0.01 0 0.02", (0.02, 0.02, 0.03)),
        say.joint("bolt", "fixed", "slide", "plate", "0.1 0.1 0", "0 0 1", "0.5 0 1"),
        say.link("left", 0.4, "0 0.05 0.1", (0.01, 0.02, 0.02)),
        say.joint("left_finger", "continuous", "plate", "left", "0.05 0.02 0", "0 1 1"),
        say.link("right", 0.4, "0 -0.05 0.1", (0.01, 0.02, 0.02)),
        say.joint("right_finger", "revolute", "plate", "right", "-0.05 0.02 0", "1 1 0.3", limits=(-1, 3), extra='<mimic joint="left_finger" multiplier="-2" offset="0.3"/>'),
        say.link("tip"), say.joint("end", "fixed", "right", "tip", "0 0 0.2", "0 0 1", "0 1 0"),
        say.link("other", 1.0), say.joint("elsewhere", "revolute", "base", "other", "1 0 0"),
    )  # fmt: skip
