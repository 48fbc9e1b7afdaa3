"""How long arms' equations take at one state, called from Python, against Pinocchio's CRBA and RNEA on the same states.

Ours are one compiled function through an `Evaluator`, with a new q and q' for each call; Pinocchio is called as its
users call it: `crba` and `rnea`, each on the arrays. Both take turns in one run. `M, theta` is what both compute; `all`
is ours with what a constrained arm needs besides: J and J'q' of a plane that the tool touches, and N_0 = P_qq - lambda
phi''. Without a C compiler CasADi's virtual machine takes several times as long, and the figures say so.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np
import pinocchio as pin
from tests.benchmarks.measure import ROOT, Figure, seconds

from firmtouch.mechanics import Array
from firmtouch.mechanics.compiled import compiled, find_compiler
from firmtouch.mechanics.evaluation import build_evaluator
from firmtouch.mechanics.tree import (
    KinematicTree,
    build_tree,
    frame_pose,
    mass_matrix,
    planar_chain,
    potential_energy,
    theta,
)
from firmtouch.modelfile.urdf import read_urdf

ARM = ROOT / "models" / "urdf" / "panda.urdf"
LINKS = (2, 3, 5, 7, 10, 15, 20, 25, 30)
LENGTH, MASS, LAMBDA = 0.1, 0.5, 20.0
NORMAL = np.array([0.6, -0.8, 0.0])
STATES, ROUNDS = 500, 20
SLOWER, SLOWER_WITH_ALL, EXPONENT, DERIVED = 2, 5, 3, 3
AGREE = 1e-10
"""Of the largest entry: thirty links leave some thousand roundings."""


@dataclass(frozen=True)
class Arm:
    """The same arm here and there."""

    tree: KinematicTree
    model: pin.Model


def expressions(tree: KinematicTree) -> tuple[list[ca.SX], dict[str, ca.SX]]:
    """Derive what is measured, of (q, q')."""
    q, qdot = ca.SX.sym("q", tree.n), ca.SX.sym("qdot", tree.n)
    position, _ = frame_pose(tree, list(tree.frames)[-1], q)
    phi = ca.dot(ca.DM(NORMAL), position)
    J = ca.jacobian(phi, q)
    return [q, qdot], {
        "M": mass_matrix(tree, q),
        "theta": theta(tree, q, qdot),
        "J": J,
        "Jdot_qdot": ca.jtimes(J @ qdot, q, qdot),
        "N0": ca.hessian(potential_energy(tree, q) - LAMBDA * phi, q)[0],
    }


def fused(tree: KinematicTree, *names: str) -> ca.Function:
    """Make one function of some outputs, or of all; what they share is computed once."""
    inputs, outputs = expressions(tree)
    chosen = names or tuple(outputs)
    return ca.Function("fused", inputs, ca.cse([ca.densify(outputs[name]) for name in chosen]))


def panda() -> Arm:
    return Arm(build_tree(read_urdf(ARM), tool="flange"), pin.buildModelFromXML(ARM.read_text(encoding="utf-8")))


def chain(n: int) -> Arm:
    """Write the chain down for Pinocchio too."""
    model, parent = pin.Model(), 0
    about_centre = np.diag([0.0, 1.0, 1.0]) * MASS * LENGTH**2 / 12
    rod = pin.Inertia(MASS, np.array([LENGTH / 2, 0, 0]), about_centre)
    for i in range(n):
        place = pin.SE3(np.eye(3), np.array([LENGTH if i else 0.0, 0, 0]))
        parent = model.addJoint(parent, pin.JointModelRZ(), place, f"q{i + 1}")
        model.appendBodyToJoint(parent, rod, pin.SE3.Identity())
    model.gravity.linear = np.array([0.0, -9.81, 0.0])
    return Arm(planar_chain(n, length=LENGTH, mass=MASS), model)


def microseconds(arm: Arm, *functions: ca.Function) -> tuple[float, list[float]]:
    """Give the least mean time of a call: Pinocchio's, and that of each of ours, who all take turns."""
    rng, n = np.random.default_rng(7), arm.tree.n
    states = [(q, qdot) for q, qdot in rng.uniform(-2, 2, (STATES, 2, n))]
    model, data, rest = arm.model, arm.model.createData(), np.zeros(n)

    def theirs(q: Array, qdot: Array) -> tuple[Array, Array]:
        return pin.crba(model, data, q), pin.rnea(model, data, q, qdot, rest)

    ours = [build_evaluator(compiled({"f": each})["f"]) for each in functions]
    for q, qdot in states[:20]:
        M, bias = theirs(q, qdot)
        for wanted, got in zip(
            (np.triu(M), bias), (np.triu(ours[0](q, qdot)[0]), ours[0].results[1][:, 0]), strict=True
        ):
            np.testing.assert_allclose(got, wanted, rtol=0, atol=AGREE * np.abs(wanted).max())

    def sweep(call: Callable[[Array, Array], object]) -> float:
        start = time.perf_counter()
        for q, qdot in states:
            call(q, qdot)
        return 1e6 * (time.perf_counter() - start) / STATES

    times = [[sweep(call) for call in (theirs, *ours)] for _ in range(ROUNDS)]
    first, *others = (min(each) for each in zip(*times, strict=True))
    return first, others


def against_pinocchio(name: str, arms: dict[str, Arm]) -> list[Figure]:
    """Compare on some arms; the figure is of the worst."""
    ratios: dict[str, list[tuple[float, str]]] = {"M, theta": [], "all": []}
    for label, arm in arms.items():
        theirs, ours = microseconds(arm, fused(arm.tree, "M", "theta"), fused(arm.tree))
        for found, each in zip(ratios.values(), ours, strict=True):
            found.append((each / theirs, f"{label}{each:.2f} us against {theirs:.2f}"))
    slow = "" if find_compiler() else "without a C compiler! "
    bounds = {"M, theta": SLOWER, "all": SLOWER_WITH_ALL}
    return [
        Figure(
            f"{name}: {what} / Pinocchio",
            max(found)[0],
            "<=",
            bounds[what],
            "",
            slow + "; ".join(words for _, words in found),
        )
        for what, found in ratios.items()
    ]


def growth() -> Figure:
    """Fit the exponent of the evaluation time, in CasADi's virtual machine: it spends the same on every instruction."""
    sizes = [n for n in LINKS if n >= 5]
    evaluators = [build_evaluator(fused(planar_chain(n, length=LENGTH, mass=MASS))) for n in sizes]
    times = [
        min(seconds(lambda each=each: [each(1.0, 1.0) for _ in range(20)]) for _ in range(ROUNDS)) / 20
        for each in evaluators
    ]
    exponent = float(np.polyfit(np.log(sizes), np.log(times), 1)[0])
    detail = ", ".join(f"n = {n}: {1e6 * each:.0f} us" for n, each in zip(sizes, times, strict=True))
    return Figure("planar chains: time of all ~ n^", exponent, "<=", EXPONENT, "", f"in the virtual machine; {detail}")


def derivation() -> Figure:
    n = LINKS[-1]
    found = seconds(lambda: fused(planar_chain(n, length=LENGTH, mass=MASS)))
    return Figure(f"{n} links derived", found, "<=", DERIVED, "s", "all expressions, and one function of them")


def figures() -> list[Figure]:
    return [
        *against_pinocchio("7-joint arm", {"": panda()}),
        *against_pinocchio("planar chains", {f"n = {n}: ": chain(n) for n in LINKS}),
        growth(),
        derivation(),
    ]
