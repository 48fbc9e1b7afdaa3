"""The constrained mechanism of Eqs. (1)-(4) as functions of (q, q', p), derived by CasADi."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from firmtouch.mechanics import rigid_bodies
from firmtouch.mechanics.arrays import Array, Vector, call, call_vector, frozen, symmetric
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile import ModelSpec
from firmtouch.modelfile.sections.mechanism import Bodies


@dataclass(frozen=True, slots=True)
class Plant:
    """M(q) q'' + theta(q, q') = J(q)^T lambda + u with Phi(q) = 0, Eqs. (1)-(4).

    lambda_j > 0 pushes the mechanism towards growing phi_j. All in SI; `p` are the parameters' values.
    The methods evaluate at numbers; `functions` holds the CasADi functions themselves, each of (q, p) or of
    (q, q', p): `K`, `P`, `Phi`, `J`, `M`, `theta`, `Jdot_qdot`, `P_q`, `P_qq` (n x n), `Phi_qq` (n x nm: the
    constraint Hessians side by side).
    """

    spec: ModelSpec
    p: Array
    functions: dict[str, ca.Function]

    @property
    def n(self) -> int:
        """The number of coordinates."""
        return self.spec.n

    @property
    def m(self) -> int:
        """The number of constraints."""
        return self.spec.m

    def with_parameters(self, p: Vector) -> Plant:
        """Give the same mechanism with other parameter values."""
        return replace(self, p=frozen(p))

    def M(self, q: Vector) -> Array:
        """Inertia matrix, n x n."""
        return symmetric(call(self.functions["M"], q, self.p))

    def theta(self, q: Vector, qdot: Vector) -> Array:
        """Centrifugal, Coriolis and gravity forces of Eq. (4), n."""
        return call_vector(self.functions["theta"], q, qdot, self.p)

    def Phi(self, q: Vector) -> Array:
        """Constraint functions of Eq. (1), m."""
        return call_vector(self.functions["Phi"], q, self.p)

    def J(self, q: Vector) -> Array:
        """Constraint Jacobian dPhi/dq, m x n."""
        return call(self.functions["J"], q, self.p)

    def Jdot_qdot(self, q: Vector, qdot: Vector) -> Array:
        """J' q', m: the part of Phi'' without q''."""
        return call_vector(self.functions["Jdot_qdot"], q, qdot, self.p)

    def K(self, q: Vector, qdot: Vector) -> float:
        """Kinetic energy."""
        return float(self.functions["K"](q, qdot, self.p))

    def P(self, q: Vector) -> float:
        """Potential energy."""
        return float(self.functions["P"](q, self.p))

    def P_q(self, q: Vector) -> Array:
        """Gradient of the potential energy, n."""
        return call_vector(self.functions["P_q"], q, self.p)

    def P_qq(self, q: Vector) -> Array:
        """Hessian of the potential energy, n x n."""
        return symmetric(call(self.functions["P_qq"], q, self.p))

    def Phi_qq(self, q: Vector) -> Array:
        """Constraint Hessians, m x n x n."""
        stacked = call(self.functions["Phi_qq"], q, self.p)
        return frozen(np.stack([symmetric(each) for each in np.hsplit(stacked, self.m)]))


def derive_plant(spec: ModelSpec) -> Plant:
    """Derive Eqs. (1)-(4) for a specification, at its nominal parameters."""
    symbols = Symbols(spec)
    q, qdot, p = symbols.q, symbols.qdot, symbols.p
    M, K, P = _energies(spec, symbols)
    Phi = ca.vertcat(*(symbols.scalar(each.expression) for each in spec.constraints.values()))
    J = ca.jacobian(Phi, q)
    K_q, P_q = ca.gradient(K, q), ca.gradient(P, q)
    momentum = M @ qdot
    outputs = {
        "K": K,
        "M": M,
        "theta": ca.jtimes(momentum, q, qdot) - K_q + P_q,  # Eq. (4)
        "Jdot_qdot": ca.jtimes(J @ qdot, q, qdot),
        "P": P,
        "P_q": P_q,
        "P_qq": ca.jacobian(P_q, q),
        "Phi": Phi,
        "J": J,
        "Phi_qq": ca.horzcat(*(ca.hessian(Phi[j], q)[0] for j in range(spec.m))),
    }
    moving = {"K", "theta", "Jdot_qdot"}
    functions = {
        name: ca.Function(name, [q, qdot, p] if name in moving else [q, p], [ca.densify(output)])
        for name, output in outputs.items()
    }
    return Plant(spec, frozen([each.value.value for each in spec.parameters.values()]), functions)


def _energies(spec: ModelSpec, symbols: Symbols) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Give M, K and P; of given energies, M is the Hessian of K in q' at rest, so that K may be tested against it."""
    mechanism, qdot = spec.mechanism, symbols.qdot
    if isinstance(mechanism, Bodies):
        M = rigid_bodies.mass_matrix(mechanism, symbols)
        return M, ca.dot(qdot, M @ qdot) / 2, rigid_bodies.potential_energy(mechanism, symbols)
    K = symbols.scalar(mechanism.kinetic_energy)
    at_rest = ca.substitute(ca.hessian(K, qdot)[0], qdot, ca.SX.zeros(spec.n))
    return at_rest, K, symbols.scalar(mechanism.potential_energy)
