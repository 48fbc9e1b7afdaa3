"""A 6R arm in space (a UR5e) with its tool on a plane, derived and linearised by firmtouch and by SymPy in one run.

firmtouch: M, theta, J, J'q' and N_0, evaluated at the operating point and split into tangent and normal coordinates.
SymPy: Lagrange's equations with the constraint, and A and B as expressions of the operating point; it is not asked for
numbers. It gets the same numbers for lengths, masses and inertias, and no symbols but the coordinates.

SymPy takes minutes, so it is stopped after LIMIT seconds: the ratio is then a lower bound, and the detail says so.
"""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import casadi as ca
import numpy as np
from tests.benchmarks.measure import ROOT, Figure, best_of
from tests.benchmarks.tree_speed import NORMAL, expressions

from firmtouch.mechanics.tree import KinematicTree, build_tree, kinetic_energy
from firmtouch.modelfile.urdf import read_urdf
from firmtouch.regulation import split_directions

ARM = ROOT / "models" / "urdf" / "ur5e.urdf"
GUESS = (0.3, -1.2, 1.4, -1.0, -1.3, 0.2)
RATES = (0.5, -0.3, 0.8, 1.1, -0.6, 0.4)
LIMIT = 40
TIMES, MILLISECONDS = 1000, 40
REPETITIONS = 15


class StoppedError(BaseException):
    """Nothing on the way may take it for an error of its own."""


@contextmanager
def stopped_after(limit: float) -> Iterator[None]:
    def stop(*_: object) -> None:
        raise StoppedError

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, limit)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def by_firmtouch(tree: KinematicTree) -> dict[str, Any]:
    """Derive and linearise at the operating point."""
    inputs, outputs = expressions(tree)
    function = ca.Function("linearised", inputs, [ca.densify(each) for each in outputs.values()])
    values = dict(zip(outputs, (each.full() for each in function(GUESS, np.zeros(tree.n))), strict=True))
    split = split_directions(values["J"])
    return values | {"blocks of M": split.blocks(values["M"]), "blocks of N0": split.blocks(values["N0"])}


def energies(tree: KinematicTree) -> tuple[Any, Any, Any, list[Any], list[Any], Any]:
    """Write K, P and phi of the tree down in SymPy; gives the coordinates and their velocities too, and the world."""
    import sympy as sp
    from sympy.physics.mechanics import ReferenceFrame, dynamicsymbols

    q = list(dynamicsymbols(f"q1:{tree.n + 1}"))
    qdot = [each.diff() for each in q]
    poses: list[tuple[Any, Any]] = []
    K, P = sp.Integer(0), sp.Integer(0)
    axes: list[tuple[Any, Any]] = []
    for joint, angle, rate in zip(tree.joints, q, qdot, strict=True):
        R, p = poses[joint.parent] if joint.parent >= 0 else (sp.eye(3), sp.zeros(3, 1))
        a = sp.Matrix(joint.axis).applyfunc(sp.nsimplify)
        cross = sp.Matrix([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
        turn = a * a.T + sp.cos(angle) * (sp.eye(3) - a * a.T) + sp.sin(angle) * cross
        p = p + R * sp.Matrix(joint.placement.p)
        R = R * sp.Matrix(joint.placement.R).applyfunc(exact) * turn
        poses.append((R, p))
        axes.append((R * a, rate))
        m, c = joint.inertia.mass, sp.Matrix(joint.inertia.moment / joint.inertia.mass)
        C = np.array([[0, -c[2], c[1]], [c[2], 0, -c[0]], [-c[1], c[0], 0]], dtype=float)
        about_centre = sp.Matrix(joint.inertia.tensor + m * C @ C)
        centre = p + R * c
        v = centre.diff(dynamicsymbols._t)
        w = R.T * sum((axis * each for axis, each in axes), sp.zeros(3, 1))  # a chain: every joint before turns it
        K += m * v.dot(v) / 2 + (w.T * about_centre * w)[0] / 2
        P -= m * sp.Matrix(tree.gravity).dot(centre)
    frame = tree.frames[list(tree.frames)[-1]]
    R, p = poses[frame.body]
    phi = sp.Matrix(NORMAL).dot(p + R * sp.Matrix(frame.placement.p))
    return K, P, phi, q, qdot, ReferenceFrame("N")


def exact(entry: Any) -> Any:
    """Write the zeros and ones of a rotation by right angles as such: they cost SymPy nothing then."""
    return round(entry) if abs(entry - round(entry)) < 1e-12 else entry


def by_sympy(tree: KinematicTree) -> tuple[float, str]:
    """Form Lagrange's equations and linearise them; give the seconds, and how far it came."""
    import sympy as sp
    from sympy.physics.mechanics import LagrangesMethod

    start, done = time.perf_counter(), "stopped while it wrote the energies down"
    try:
        with stopped_after(LIMIT):
            K, P, phi, q, qdot, world = energies(tree)
            done = "stopped while it formed the equations"
            same_energy(tree, K, q, qdot)
            method = LagrangesMethod(K - P, q, frame=world, hol_coneqs=[phi])
            method.form_lagranges_equations()
            done = "stopped while it linearised"
            linearizer = method.to_linearizer(q_ind=q[1:], qd_ind=qdot[1:], q_dep=q[:1], qd_dep=qdot[:1])
            linearizer.linearize()
            done = "finished"
    except StoppedError:
        sp.core.cache.clear_cache()
    return time.perf_counter() - start, done


def same_energy(tree: KinematicTree, K: Any, q: list[Any], qdot: list[Any]) -> None:
    """Check that both are about the same arm."""
    import sympy as sp

    theirs = sp.lambdify([[*qdot, *q]], K, cse=True)([*RATES, *GUESS])
    x, v = ca.SX.sym("q", tree.n), ca.SX.sym("qdot", tree.n)
    ours = float(ca.Function("K", [x, v], [kinetic_energy(tree, x, v)])(GUESS, RATES))
    assert abs(theirs - ours) < 1e-9 * ours  # a file's pi / 2 has as many digits as it has


def figures() -> list[Figure]:
    tree = build_tree(read_urdf(ARM), tool="flange")
    first = best_of(1, lambda: by_firmtouch(tree))
    ours = best_of(REPETITIONS, lambda: by_firmtouch(tree))
    reading = best_of(3, lambda: build_tree(read_urdf(ARM), tool="flange"))
    values = by_firmtouch(tree)
    assert np.linalg.eigvalsh(values["M"])[0] > 0
    theirs, done = by_sympy(tree)
    finished = done == "finished"
    detail = f"SymPy {done} after {theirs:.1f} s{'' if finished else ': a lower bound'}; {1e3 * ours:.1f} ms here"
    warm = f"the first time {1e3 * first:.1f} ms; reading the URDF file takes another {1e3 * reading:.1f} ms"
    return [
        Figure("spatial 6R on a plane: SymPy / firmtouch", theirs / ours, ">=", TIMES, "", detail),
        Figure("spatial 6R derived and linearised", 1e3 * ours, "<=", MILLISECONDS, "ms", warm),
    ]
