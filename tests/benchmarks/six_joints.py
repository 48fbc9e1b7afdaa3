"""A planar 6R arm on a wall, derived and linearised by firmtouch and by SymPy in the same run.

Both derive the equations of motion with all parameters as symbols and linearise them on the constraint. SymPy's result
is A and B as expressions of the operating point; firmtouch's is evaluated at it: M, theta, J, J' q', P_qq, each phi'',
N0, and the split into tangent and normal coordinates with the blocks of M and N0. SymPy is not asked for numbers, which
would take it longer still.
"""

from __future__ import annotations

import json
import math
import time
from typing import Any

import numpy as np
from tests.benchmarks.measure import Figure, best_of

import firmtouch
from firmtouch.regulation import split_directions

JOINTS = 6
LENGTH, CENTRE, MASS, INERTIA, GRAVITY = 0.3, 0.14, 2.0, 0.02, 9.81
GUESS = (1.3, -0.5, -0.4, -0.3, -0.2, -0.1)
REACH = LENGTH * sum(math.cos(sum(GUESS[: i + 1])) for i in range(JOINTS))
"""Where the wall stands, so that the guess touches it."""
REPETITIONS = 7


def model_text() -> bytes:
    """Write the model file: a chain of equal links whose tip touches x = d."""
    names = [f"q{i + 1}" for i in range(JOINTS)]
    parameters = {"d": f"{REACH!r} m", "g": f"{GRAVITY} m/s^2"}
    definitions, bodies, before = {}, {}, "[0*l1, 0*l1]"
    for i in range(1, JOINTS + 1):
        parameters |= {
            f"l{i}": f"{LENGTH} m",
            f"c{i}": f"{CENTRE} m",
            f"m{i}": f"{MASS} kg",
            f"I{i}": f"{INERTIA} kg*m^2",
        }
        angle = " + ".join(names[:i])
        definitions[f"along{i}"] = f"[cos({angle}), sin({angle})]"
        definitions[f"p{i}"] = f"{before} + l{i}*along{i}"
        bodies[f"link{i}"] = {
            "mass": f"m{i}",
            "inertia": f"I{i}",
            "centre_of_mass": f"{before} + c{i}*along{i}",
            "orientation": angle,
        }
        before = f"p{i}"
    document = {
        "schema": "firmtouch.model/1",
        "title": f"A planar {JOINTS}R arm on a wall",
        "parameters": parameters,
        "coordinates": dict.fromkeys(names, "rad"),
        "definitions": definitions,
        "mechanism": {"gravity": "[0, -g]", "bodies": bodies},
        "constraints": {"wall": {"expression": f"d - x({before})", "unit": "m"}},
        "operating_point": {"guess": dict(zip(names, GUESS, strict=True)), "lambda_d": {"wall": 40}},
        "design": {"poles": [-4 - i for i in range(2 * (JOINTS - 1))], "force_feedback": 0.5},
    }
    return json.dumps(document).encode()


def by_firmtouch(spec: firmtouch.ModelSpec) -> dict[str, Any]:
    """Derive and linearise at the operating point."""
    plant = firmtouch.derive_plant(spec)
    q = np.array(GUESS)
    M, J, P_qq, Phi_qq = plant.M(q), plant.J(q), plant.P_qq(q), plant.Phi_qq(q)
    N0 = P_qq - np.tensordot([40.0], Phi_qq, axes=1)
    split, rest = split_directions(J), np.zeros(JOINTS)
    return {
        "M": M,
        "N0": N0,
        "theta": plant.theta(q, rest),
        "Jdot_qdot": plant.Jdot_qdot(q, rest),
        "blocks of M": split.blocks(M),
        "blocks of N0": split.blocks(N0),
    }


def by_sympy() -> tuple[Any, Any, float, float]:
    """Form Lagrange's equations and linearise them; give the inertia matrix, A, and the seconds that each step took."""
    import sympy as sp
    from sympy.physics.mechanics import LagrangesMethod, ReferenceFrame, dynamicsymbols

    start = time.perf_counter()
    q, u = dynamicsymbols(f"q1:{JOINTS + 1}"), dynamicsymbols(f"u1:{JOINTS + 1}")
    qdot = [each.diff() for each in q]
    lengths, centres, masses, inertias = (sp.symbols(f"{name}1:{JOINTS + 1}", positive=True) for name in "lcmI")
    d, g = sp.symbols("d g", positive=True)
    world, energy, tip, torques = ReferenceFrame("N"), sp.Integer(0), sp.zeros(2, 1), []
    for i in range(JOINTS):
        angle, rate = sum(q[: i + 1]), sum(qdot[: i + 1])
        along = sp.Matrix([sp.cos(angle), sp.sin(angle)])
        centre = tip + centres[i] * along
        velocity = centre.diff(dynamicsymbols._t)
        energy += masses[i] * velocity.dot(velocity) / 2 + inertias[i] * rate**2 / 2 - masses[i] * g * centre[1]
        tip += lengths[i] * along
        link = ReferenceFrame(f"L{i}")
        link.set_ang_vel(world, rate * world.z)
        torques.append((link, (u[i] - (u[i + 1] if i + 1 < JOINTS else 0)) * world.z))
    method = LagrangesMethod(energy, q, forcelist=torques, frame=world, hol_coneqs=[d - tip[0]])
    method.form_lagranges_equations()
    formed = time.perf_counter()
    linearizer = method.to_linearizer(q_ind=q[1:], qd_ind=qdot[1:], q_dep=q[:1], qd_dep=qdot[:1])
    _, A, _ = linearizer.linearize()
    linearised = time.perf_counter()
    values = dict(zip(q, GUESS, strict=True)) | dict.fromkeys(qdot, 0) | {d: REACH, g: GRAVITY}
    for names, value in ((lengths, LENGTH), (centres, CENTRE), (masses, MASS), (inertias, INERTIA)):
        values |= dict.fromkeys(names, value)
    M = np.array(method.mass_matrix[:, :JOINTS].subs(values), dtype=float)
    return M, A, formed - start, linearised - formed


def figures() -> list[Figure]:
    text = model_text()
    spec = firmtouch.parse_model(text, name="arm").spec
    first = best_of(1, lambda: by_firmtouch(spec))
    ours = best_of(REPETITIONS, lambda: by_firmtouch(spec))
    parsing = best_of(REPETITIONS, lambda: firmtouch.parse_model(text, name="arm"))
    M, A, forming, linearising = by_sympy()
    assert A.shape[1] == 2 * (JOINTS - 1)  # the states that the wall leaves
    np.testing.assert_allclose(M, by_firmtouch(spec)["M"], atol=1e-12)  # the same mechanism: some hundred roundings
    theirs = forming + linearising
    detail = (
        f"{theirs:.1f} s ({forming:.1f} s to form, {linearising:.1f} s to linearise) against {1e3 * ours:.1f} ms "
        f"(the first time {1e3 * first:.1f} ms)"
    )
    with_parsing = f"{1e3 * (ours + parsing):.1f} ms, of which {1e3 * parsing:.1f} ms to read the file"
    return [
        Figure(f"{JOINTS}R arm on a wall: SymPy / firmtouch", theirs / ours, ">=", 300, "", detail),
        Figure("the same with reading the file", theirs / (ours + parsing), ">=", 300, "", with_parsing),
    ]
