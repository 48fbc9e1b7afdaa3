"""The constrained mechanism of Eqs. (1)-(4) as functions of (q, q', p), derived by CasADi."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import casadi as ca
import numpy as np

from firmtouch.mechanics.arm import arm_of
from firmtouch.mechanics.arrays import Array, Vector, frozen, symmetric
from firmtouch.mechanics.compiled import compiled
from firmtouch.mechanics.constraints import constraints_of
from firmtouch.mechanics.equations import equations_of
from firmtouch.mechanics.evaluation import evaluator_of
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile import ModelSpec


@dataclass(frozen=True, slots=True)
class Plant:
    """M(q) q'' + theta(q, q') = J(q)^T lambda + u with Phi(q) = 0, Eqs. (1)-(4).

    lambda_j > 0 pushes the mechanism towards growing phi_j. All in SI; `p` are the parameters' values.
    The methods evaluate at numbers; `functions` holds the CasADi functions themselves, each of (q, p) or of
    (q, q', p): `K`, `P`, `Phi`, `J`, `M`, `theta`, `Jdot_qdot`, `P_q`, `P_qq` (n x n), `Phi_qq` (n x nm: the
    constraint Hessians side by side); `N0` of (q, lambda, p). `fast` holds some of them as machine code, for numbers.
    """

    spec: ModelSpec
    p: Array
    functions: dict[str, ca.Function]
    fast: dict[str, ca.Function] = field(default_factory=dict, repr=False)

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

    def compiled(self) -> Plant:
        """Give the same plant with its functions compiled to machine code, where there is a compiler."""
        return replace(self, fast=compiled(self.functions))

    def M(self, q: Vector) -> Array:
        """Inertia matrix, n x n."""
        return symmetric(self._evaluate("M", q))

    def theta(self, q: Vector, qdot: Vector) -> Array:
        """Centrifugal, Coriolis and gravity forces of Eq. (4), n."""
        return frozen(self._evaluate("theta", q, qdot)[:, 0])

    def Phi(self, q: Vector) -> Array:
        """Constraint functions of Eq. (1), m."""
        return frozen(self._evaluate("Phi", q)[:, 0])

    def J(self, q: Vector) -> Array:
        """Constraint Jacobian dPhi/dq, m x n."""
        return frozen(self._evaluate("J", q))

    def Jdot_qdot(self, q: Vector, qdot: Vector) -> Array:
        """J' q', m: the part of Phi'' without q''."""
        return frozen(self._evaluate("Jdot_qdot", q, qdot)[:, 0])

    def K(self, q: Vector, qdot: Vector) -> float:
        """Kinetic energy."""
        return float(self._evaluate("K", q, qdot)[0, 0])

    def P(self, q: Vector) -> float:
        """Potential energy."""
        return float(self._evaluate("P", q)[0, 0])

    def P_q(self, q: Vector) -> Array:
        """Gradient of the potential energy, n."""
        return frozen(self._evaluate("P_q", q)[:, 0])

    def P_qq(self, q: Vector) -> Array:
        """Hessian of the potential energy, n x n."""
        return symmetric(self._evaluate("P_qq", q))

    def Phi_qq(self, q: Vector) -> Array:
        """Constraint Hessians, m x n x n."""
        stacked = self._evaluate("Phi_qq", q)
        return frozen(np.stack([symmetric(each) for each in np.hsplit(stacked, self.m)]))

    def N0(self, q: Vector, lambda_: Vector) -> Array:
        """P_qq - sum of lambda_j Phi_j'', n x n: the stiffness that the plant brings, of Eq. (14)."""
        return symmetric(self._evaluate("N0", q, lambda_))

    def _evaluate(self, name: str, *state: Vector) -> Array:
        """Evaluate a function; the next evaluation of it writes over what is given."""
        return evaluator_of(self.fast.get(name) or self.functions[name])(*state, self.p)[0]


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
    motion, rows = equations_of(spec, symbols, arm), constraints_of(spec, symbols, arm)
    P_q = ca.gradient(motion.P, q)
    outputs = {
        "K": motion.K,
        "M": motion.M,
        "theta": motion.theta,
        "Jdot_qdot": ca.vertcat(*(each.rate(q, qdot) for each in rows)),
        "P": motion.P,
        "P_q": P_q,
        "P_qq": ca.jacobian(P_q, q),
        "Phi": ca.vertcat(*(each.phi for each in rows)),
        "J": ca.vertcat(*(each.gradient.T for each in rows)),
        "Phi_qq": ca.horzcat(*(each.hessian for each in rows)),
    }
    moving = {"K", "theta", "Jdot_qdot"}
    functions = {
        name: ca.Function(name, [q, qdot, p] if name in moving else [q, p], [ca.densify(output)])
        for name, output in outputs.items()
    }
    lambda_ = ca.SX.sym("lambda", spec.m)
    bent = sum((lambda_[j] * each.hessian for j, each in enumerate(rows)), ca.SX(spec.n, spec.n))
    functions["N0"] = ca.Function("N0", [q, lambda_, p], [ca.densify(outputs["P_qq"] - bent)])
    return Plant(spec, frozen([each.value.value for each in spec.parameters.values()]), functions)
