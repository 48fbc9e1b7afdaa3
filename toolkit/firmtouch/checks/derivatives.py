"""Checks of what was derived: Hessians against finite differences, CasADi against SymPy."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

import casadi as ca
import numpy as np

from firmtouch.checks.growth import second_derivatives
from firmtouch.checks.inertia import ROUNDING
from firmtouch.checks.result import CheckResult, at_most, largest, told
from firmtouch.checks.subject import Subject, relative
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import call
from firmtouch.modelfile.expression.functions import SCALAR
from firmtouch.modelfile.sections.joint_tree import Robot
from firmtouch.modelfile.sections.section import expressions_in

if TYPE_CHECKING:
    from firmtouch.mechanics.symbolic import SymbolicPlant

STEP: Final = 1e-5
DIFFERENCES: Final = 1e-6
"""Central differences with step 1e-5 are good to 1e-10 of third derivatives and 1e-11 of rounding over the step."""
LARGEST_COMPUTED: Final = 3000
"""CasADi operations beyond which SymPy takes more than two seconds (measured: 0.7 ms for each)."""
LARGEST_WRITTEN: Final = 100_000
"""The same for second derivatives as they are written out, times coordinates (measured: 10 us for each node)."""
DEEPEST_WRITTEN: Final = 20
"""Beyond this nesting SymPy's questions about signs take exponential time; an arm of six links is 14 deep."""


def hessians_symmetric(subject: Subject) -> CheckResult:
    """Each Phi_j'' and P_qq equals its transpose."""
    plant = subject.plant
    stacked = call(plant.functions["Phi_qq"], subject.q_d, plant.p)
    matrices = [*np.hsplit(stacked, plant.m), call(plant.functions["P_qq"], subject.q_d, plant.p)]
    return at_most(
        "Hessians symmetric", largest(relative(X - X.T, X) for X in matrices), ROUNDING, "P_qq and each Phi_j''"
    )


def hessians_by_differences(subject: Subject) -> CheckResult:
    """Each Phi_j'' and P_qq equals the central difference of J and P_q."""
    plant, errors = subject.plant, []
    for q, _ in subject.states(3):
        Phi_qq, P_qq = plant.Phi_qq(q), plant.P_qq(q)
        J_size, g_size = plant.J(q), plant.P_q(q)
        for i in range(plant.n):
            h = np.eye(plant.n)[i] * STEP
            J_i = (plant.J(q + h) - plant.J(q - h)) / (2 * STEP)
            g_i = (plant.P_q(q + h) - plant.P_q(q - h)) / (2 * STEP)
            errors += [relative(J_i - Phi_qq[:, i, :], Phi_qq, J_size), relative(g_i - P_qq[i], P_qq, g_size)]
    detail = "against central differences of J and P_q at 3 configurations"
    return at_most("Hessians exact", largest(errors), DIFFERENCES, detail)


def derivations_agree(subject: Subject, symbolic: SymbolicPlant | None) -> CheckResult:
    """Two derivations agree at random states: CasADi's and SymPy's (`None`: not asked), or a robot's two."""
    if isinstance(subject.plant.spec.mechanism, Robot):
        return _recursion_agrees(subject)
    if symbolic is None:
        return told("two derivations", "not compared: too large for SymPy")
    pairs = [_pairs(subject, symbolic, q, qdot) for q, qdot in subject.states(3)]
    errors = {}
    for name in pairs[0]:  # Phi vanishes at q_d, so each difference is held against the largest value of all states
        ours, theirs = (np.stack([each[name][side] for each in pairs]) for side in (0, 1))
        errors[name] = largest([relative(ours - theirs, ours)])
    worst = max(errors, key=lambda name: errors[name])
    detail = f"CasADi against SymPy at 3 states; largest difference in {worst}"
    return at_most("two derivations", errors[worst], ROUNDING, detail)


def _recursion_agrees(subject: Subject) -> CheckResult:
    """M and theta by recursion over the tree agree with Eqs. (2)-(4) from the energies."""
    plant = subject.plant
    q, qdot, p = ca.SX.sym("q", plant.n), ca.SX.sym("qdot", plant.n), plant.p
    K, P = plant.functions["K"](q, qdot, p), plant.functions["P"](q, p)
    momentum = ca.gradient(K, qdot)
    outputs = [ca.jacobian(momentum, qdot), ca.jtimes(momentum, q, qdot) - ca.gradient(K, q) + ca.gradient(P, q)]
    function = ca.Function("lagrange", [q, qdot], [ca.densify(each) for each in outputs])
    errors = []
    for at, velocity in subject.states(3):
        M, theta = (each.full() for each in function(at, velocity))
        errors += [relative(plant.M(at) - M, M), relative(plant.theta(at, velocity) - theta.ravel(), theta)]
    detail = "M and theta by recursion over the joints against Lagrange's equations of the energies, at 3 states"
    return at_most("two derivations", largest(errors), ROUNDING, detail)


def worth_comparing(subject: Subject) -> bool:
    """Tell whether SymPy can derive this model in two seconds."""
    plant, spec = subject.plant, subject.plant.spec
    if isinstance(spec.mechanism, Robot):
        return False
    computed = sum(plant.functions[name].n_instructions() for name in ("theta", "M", "Phi_qq", "P_qq"))
    deepest = max(each.extent.depth for each in expressions_in((spec.mechanism, spec.entries)))
    written = plant.n * second_derivatives(spec)
    return computed <= LARGEST_COMPUTED and deepest <= DEEPEST_WRITTEN and written <= LARGEST_WRITTEN


def _pairs(subject: Subject, symbolic: SymbolicPlant, q: Array, qdot: Array) -> dict[str, tuple[Array, Array]]:
    plant = subject.plant
    values = dict(zip(symbolic.q, q, strict=True)) | dict(zip(symbolic.qdot, qdot, strict=True))
    values |= dict(zip(symbolic.p, plant.p, strict=True))
    evaluate = _Evaluator(values)

    def column(matrix: Any) -> Array:  # noqa: ANN401  # SymPy has no types
        return evaluate.matrix(matrix).ravel()

    return {
        "M": (plant.M(q), evaluate.matrix(symbolic.M)),
        "theta": (plant.theta(q, qdot), column(symbolic.theta)),
        "Phi": (plant.Phi(q), column(symbolic.Phi)),
        "J": (plant.J(q), evaluate.matrix(symbolic.J)),
        "J' q'": (plant.Jdot_qdot(q, qdot), column(symbolic.Jdot_qdot)),
        "P_q": (plant.P_q(q), column(symbolic.P_q)),
        "P_qq": (plant.P_qq(q), evaluate.matrix(symbolic.P_qq)),
        "Phi''": (plant.Phi_qq(q), np.stack([evaluate.matrix(each) for each in symbolic.Phi_qq])),
    }


class _Evaluator:
    """Evaluates SymPy expressions in floats by walking them; `lambdify` would run generated code."""

    def __init__(self, values: Mapping[Any, float]) -> None:
        self._known: dict[Any, float] = {symbol: float(value) for symbol, value in values.items()}

    def matrix(self, matrix: Any) -> Array:  # noqa: ANN401  # SymPy has no types
        rows, columns = matrix.shape
        return np.array([[self.scalar(matrix[i, j]) for j in range(columns)] for i in range(rows)])

    def scalar(self, expression: Any) -> float:  # noqa: ANN401  # SymPy has no types
        known = self._known.get(expression)
        if known is None:
            known = self._known[expression] = self._compute(expression)
        return known

    def _compute(self, expression: Any) -> float:  # noqa: ANN401  # SymPy has no types
        if expression.is_number:
            value = complex(expression)
            return value.real if value.imag == 0 else math.nan
        arguments = [self.scalar(each) for each in expression.args]
        try:
            if expression.is_Add:
                return math.fsum(arguments)
            if expression.is_Mul:
                return math.prod(arguments)
            if expression.is_Pow:
                return math.pow(*arguments)
            return float(_FUNCTIONS[type(expression).__name__](*arguments))
        except (ValueError, OverflowError, KeyError, ZeroDivisionError):
            return math.nan


def _sign(x: float) -> float:
    return math.copysign(1.0, x) if x else 0.0


def _dirac(x: float, _: float = 0) -> float:
    return 0.0 if x else math.nan


_FUNCTIONS: Final[Mapping[str, Callable[..., float]]] = {
    **{name: getattr(math, name) for name in SCALAR},
    # SymPy writes the root of a square as `Abs`, and differentiates it twice.
    "Abs": abs,
    "sign": _sign,
    "DiracDelta": _dirac,
}
