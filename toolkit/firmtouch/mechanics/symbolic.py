"""The same mechanism derived a second time, by SymPy from Eq. (3): what the report shows and what `check` compares.

Nothing numeric waits for this; SymPy is imported when it is called.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from firmtouch.modelfile import Expression, ModelSpec
from firmtouch.modelfile.expression import evaluate
from firmtouch.modelfile.expression.functions import SCALAR
from firmtouch.modelfile.sections.constraint import Constraint
from firmtouch.modelfile.sections.mechanism import Bodies, Body, Energies

if TYPE_CHECKING:
    import sympy

LONGEST_EXACT = 8
EXACT_EXPONENT = 8
EXACT_BITS = 64


@dataclass(frozen=True, slots=True)
class SymbolicPlant:
    """Eqs. (1)-(4) as SymPy matrices in the file's own names; `qdot` are the symbols of the velocities.

    The matrices are not simplified. `lambda_` are the symbols of the multipliers.
    """

    spec: ModelSpec
    q: sympy.Matrix
    qdot: sympy.Matrix
    p: sympy.Matrix
    lambda_: sympy.Matrix
    K: sympy.Expr
    P: sympy.Expr
    M: sympy.Matrix
    theta: sympy.Matrix
    Phi: sympy.Matrix
    J: sympy.Matrix
    Jdot_qdot: sympy.Matrix
    P_q: sympy.Matrix
    P_qq: sympy.Matrix
    Phi_qq: tuple[sympy.Matrix, ...]


def derive_symbolically(spec: ModelSpec) -> SymbolicPlant:
    """Derive Eqs. (1)-(4) by SymPy, by the Euler-Lagrange equations of L = K - P with all parameters symbolic."""
    import sympy

    reader = _Reader(spec)
    q, qdot = reader.q, reader.qdot
    K, P = reader.energies()
    Phi = sympy.Matrix(
        [reader.scalar(each.expression) for each in spec.entries.values() if isinstance(each, Constraint)]
    )
    momentum = sympy.Matrix([sympy.diff(K, each) for each in qdot])
    M = momentum.jacobian(qdot)
    # Eq. (3) without q'': d/dt(dL/dq') - dL/dq.
    theta = momentum.jacobian(q) * qdot - sympy.Matrix([sympy.diff(K - P, each) for each in q])
    J = Phi.jacobian(q)
    P_q = sympy.Matrix([sympy.diff(P, each) for each in q])
    return SymbolicPlant(
        spec=spec,
        q=q,
        qdot=qdot,
        p=reader.p,
        lambda_=sympy.Matrix([sympy.Symbol(f"lambda_{name}", real=True) for name in spec.constraints]),
        K=K,
        P=P,
        M=M,
        theta=theta,
        Phi=Phi,
        J=J,
        Jdot_qdot=(J * qdot).jacobian(q) * qdot,
        P_q=P_q,
        P_qq=P_q.jacobian(q),
        Phi_qq=tuple(sympy.hessian(phi, list(q)) for phi in Phi),
    )


class _Reader:
    """The names of a specification as SymPy symbols, and its expressions read with them."""

    def __init__(self, spec: ModelSpec) -> None:
        import sympy

        self._sympy = sympy
        self._spec = spec
        symbols = {name: sympy.Symbol(name, real=True) for name in (*spec.parameters, *spec.coordinates)}
        self._rates = {name: sympy.Symbol(f"{name}_dot", real=True) for name in spec.coordinates}
        self.p = sympy.Matrix([symbols[name] for name in spec.parameters])
        self.q = sympy.Matrix([symbols[name] for name in spec.coordinates])
        self.qdot = sympy.Matrix(list(self._rates.values()))
        self._names: dict[str, Any] = {"pi": sympy.pi, **symbols}
        self._functions = {name: getattr(sympy, name) for name in SCALAR}
        for name, expression in spec.definitions.items():
            self._names[name] = self.read(expression)

    def read(self, expression: Expression) -> Any:  # noqa: ANN401  # SymPy has no types
        return evaluate(
            expression.tree,
            names=self._names,
            rates=self._rates,
            number=self._number,
            functions=self._functions,
            power=self._power,
        )

    def _number(self, text: str) -> Any:  # noqa: ANN401  # SymPy has no types
        """Read short decimals exactly, and long ones as floats."""
        short = len(text) <= LONGEST_EXACT and "e" not in text.lower()
        return self._sympy.Rational(text) if short else self._sympy.Float(text)

    def _power(self, base: Any, exponent: Any) -> Any:  # noqa: ANN401  # SymPy has no types
        """Keep powers of constants from growing into numbers of many digits."""
        long = base.is_Rational and base.p.bit_length() + base.q.bit_length() > EXACT_BITS
        large = base.is_Number and exponent.is_Number and (long or abs(exponent) > EXACT_EXPONENT)
        return self._sympy.Float(base) ** exponent if large else base**exponent

    def scalar(self, expression: Expression) -> Any:  # noqa: ANN401  # SymPy has no types
        return self.read(expression)

    def column(self, expression: Expression) -> Any:  # noqa: ANN401  # SymPy has no types
        return self._sympy.Matrix(self.read(expression))

    def energies(self) -> tuple[Any, Any]:
        mechanism = self._spec.mechanism
        if not isinstance(mechanism, Bodies):
            assert isinstance(mechanism, Energies), "robots are derived by recursion"
            return self.scalar(mechanism.kinetic_energy), self.scalar(mechanism.potential_energy)
        gravity = self.column(mechanism.gravity)
        K = P = self._sympy.Integer(0)
        for body in mechanism.bodies.values():
            mass, centre = self.scalar(body.mass), self.column(body.centre_of_mass)
            velocity = centre.jacobian(self.q) * self.qdot
            K += mass * velocity.dot(velocity) / 2 + self._rotational_energy(body)
            P -= mass * gravity.dot(centre)
        return K, P

    def _rotational_energy(self, body: Body) -> Any:  # noqa: ANN401  # SymPy has no types
        if body.inertia is None:
            return self._sympy.Integer(0)
        if isinstance(body.inertia, Expression):
            assert isinstance(body.orientation, Expression)
            rate = self._derivative(self.scalar(body.orientation))
            return self.scalar(body.inertia) * rate**2 / 2
        R = self._rotation(body.orientation)
        S = R.T * R.applyfunc(self._derivative)
        w = self._sympy.Matrix([S[2, 1] - S[1, 2], S[0, 2] - S[2, 0], S[1, 0] - S[0, 1]]) / 2
        inertia = self._sympy.Matrix([[self.scalar(each) for each in row] for row in body.inertia])
        return (w.T * inertia * w)[0] / 2

    def _derivative(self, expression: Any) -> Any:  # noqa: ANN401  # SymPy has no types
        """Differentiate along the motion: sum of d/dq_i times q_i'."""
        return sum(
            (self._sympy.diff(expression, each) * rate for each, rate in zip(self.q, self.qdot, strict=True)),
            self._sympy.Integer(0),
        )

    def _rotation(self, orientation: Any) -> Any:  # noqa: ANN401  # SymPy has no types
        sympy = self._sympy
        if orientation and isinstance(orientation[0][0], Expression):
            return sympy.Matrix([[self.scalar(each) for each in row] for row in orientation])
        # SymPy's rot_ccw_axis functions turn vectors by the right-hand rule.
        turn = {"x": sympy.rot_ccw_axis1, "y": sympy.rot_ccw_axis2, "z": sympy.rot_ccw_axis3}
        total = sympy.eye(3)
        for axis, angle in orientation:
            total *= turn[axis](self.scalar(angle))
        return total
