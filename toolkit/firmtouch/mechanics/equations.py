"""The equations of motion, Eqs. (2)-(4), from what a file says of its mechanism, as CasADi expressions."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from firmtouch.mechanics import rigid_bodies
from firmtouch.mechanics.arm import Arm
from firmtouch.mechanics.symbols import Symbols
from firmtouch.mechanics.tree import kinetic_energy, mass_matrix, potential_energy, theta
from firmtouch.modelfile import ModelSpec
from firmtouch.modelfile.sections.mechanism import Bodies, Energies


@dataclass(frozen=True, slots=True)
class Equations:
    """M (n x n), theta (n), and the energies K and P, in terms of q, q' and p."""

    K: ca.SX
    P: ca.SX
    M: ca.SX
    theta: ca.SX


def equations_of(spec: ModelSpec, symbols: Symbols, arm: Arm | None) -> Equations:
    """Derive them: for a robot by recursion over its tree, otherwise from the energies by Eq. (3)."""
    mechanism, q, qdot = spec.mechanism, symbols.q, symbols.qdot
    if arm is not None:
        rotors = ca.DM(arm.rotors)
        return Equations(
            kinetic_energy(arm.tree, q, qdot, arm.inertias) + ca.dot(rotors, qdot**2) / 2,
            potential_energy(arm.tree, q, arm.inertias),
            mass_matrix(arm.tree, q, arm.inertias) + ca.diag(ca.SX(rotors)),
            theta(arm.tree, q, qdot, arm.inertias),
        )
    if isinstance(mechanism, Bodies):
        M = rigid_bodies.mass_matrix(mechanism, symbols)
        K, P = ca.dot(qdot, M @ qdot) / 2, rigid_bodies.potential_energy(mechanism, symbols)
    else:
        assert isinstance(mechanism, Energies)
        K, P = symbols.scalar(mechanism.kinetic_energy), symbols.scalar(mechanism.potential_energy)
        # The Hessian of K in q' at rest, so that K may be tested against it.
        M = ca.substitute(ca.hessian(K, qdot)[0], qdot, ca.SX.zeros(spec.n))
    return Equations(K, P, M, lagrange(M, K, P, symbols))


def lagrange(M: ca.SX, K: ca.SX, P: ca.SX, symbols: Symbols) -> ca.SX:
    """Give theta of Eq. (4) from the energies: (M q')_q q' - K_q + P_q."""
    q, qdot = symbols.q, symbols.qdot
    return ca.jtimes(M @ qdot, q, qdot) - ca.gradient(K, q) + ca.gradient(P, q)
