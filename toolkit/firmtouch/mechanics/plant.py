"""The constrained mechanism of Eqs. (1)-(4) as functions of (q, q', p), derived by CasADi."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from firmtouch.mechanics.arm import arm_of
from firmtouch.mechanics.arrays import Array, Vector, call, call_vector, frozen, symmetric
from firmtouch.mechanics.constraints import constraints_of
from firmtouch.mechanics.equations import equations_of
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile import ModelSpec


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
    """Derive Eqs. (1)-(4) for a specification, at its nominal parameters.

    Raises
    ------
    InputError
        If a robot cannot be built as asked; a `ModelFileError` where its file is to blame.
    """
    symbols = Symbols(spec)
    q, qdot, p = symbols.q, symbols.qdot, symbols.p
    arm = arm_of(spec, symbols)
    motion, Phi = equations_of(spec, symbols, arm), constraints_of(spec, symbols, arm)
    J, P_q = ca.jacobian(Phi, q), ca.gradient(motion.P, q)
    outputs = {
        "K": motion.K,
        "M": motion.M,
        "theta": motion.theta,
        "Jdot_qdot": ca.jtimes(J @ qdot, q, qdot),
        "P": motion.P,
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
