"""A specification's names as CasADi symbols, and its expressions read with them."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final

import casadi as ca

from firmtouch.modelfile import Expression, ModelSpec
from firmtouch.modelfile.expression import CONSTANTS, evaluate
from firmtouch.modelfile.expression.functions import SCALAR

FUNCTIONS: Final = {
    **{name: getattr(ca, name) for name in SCALAR if not name.startswith("a")},
    "asin": ca.asin,
    "acos": ca.acos,
    "atan": ca.atan,
    "atan2": ca.atan2,
}
NOTHING: Final[Mapping[str, ca.SX]] = MappingProxyType({})


class Symbols:
    """q, q' and the parameters p as columns of symbols, with every definition of the file in terms of them."""

    def __init__(self, spec: ModelSpec) -> None:
        self.q = ca.SX.sym("q", spec.n)
        self.qdot = ca.SX.sym("qdot", spec.n)
        self.p = ca.SX.sym("p", len(spec.parameters))
        self._names: dict[str, Any] = {name: ca.SX(value) for name, value in CONSTANTS.items()}
        self._names |= {name: self.p[i] for i, name in enumerate(spec.parameters)}
        self._names |= {name: self.q[i] for i, name in enumerate(spec.coordinates)}
        self._rates = {name: self.qdot[i] for i, name in enumerate(spec.coordinates)}
        for name, expression in spec.definitions.items():
            self._names[name] = self.read(expression)

    def read(self, expression: Expression, names: Mapping[str, ca.SX] = NOTHING) -> Any:  # noqa: ANN401
        """Read an expression: an SX scalar, or a tuple of them for a vector; `names` are further names in it."""
        return evaluate(
            expression.tree,
            names={**self._names, **names} if names else self._names,
            rates=self._rates,
            number=lambda text: ca.SX(float(text)),
            functions=FUNCTIONS,
        )

    def scalar(self, expression: Expression) -> ca.SX:
        """Read a scalar expression."""
        return ca.SX(self.read(expression))

    def column(self, expression: Expression) -> ca.SX:
        """Read a vector expression as a column."""
        return ca.SX(ca.vertcat(*self.read(expression)))
