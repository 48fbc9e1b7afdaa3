"""SymPy expressions -> Typst formulas, and the simplification that makes a mechanism's trigonometry readable."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final

from firmtouch.report.trigonometry import sum_of_angles

if TYPE_CHECKING:
    import sympy

READABLE: Final = 50
"""Operations up to which a closed form is read rather than skipped."""
UNBROKEN: Final = 14
"""Operations up to which something is put under a root or over a fraction bar, where no line can break."""
WORTH_TIDYING: Final = 260
"""Operations up to which simplification is tried."""
LONGEST_BASE: Final = 24
"""Operations up to which something is put under a root or a power."""
LARGEST_POWER: Final = 4
"""Powers beyond this are not multiplied out."""
_GREEK: Final = frozenset(
    {"alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu", "xi",
     "rho", "sigma", "tau", "phi", "chi", "psi", "omega", "Gamma", "Delta", "Theta", "Lambda", "Xi", "Sigma", "Phi",
     "Psi", "Omega"}
)  # fmt: skip
_NAME: Final = re.compile(r"(?P<stem>[A-Za-z]+?)_?(?P<index>[0-9]*)")

_WORDS: Final = re.compile(r"(?P<stem>(?P<first>[A-Za-z]{2,})_[A-Za-z0-9_]*?[A-Za-z])_?(?P<index>[0-9]*)")


def symbol(name: str) -> str:
    """Write a name of a model file as a symbol: `q1` as q with index 1, `x_wall` as x with index "wall".

    Names of several words, as robots' joints have them, are written so: `left_wrist_1` as left wrist with index 1.
    """
    words = _WORDS.fullmatch(name)
    if words is not None and words["first"] not in _GREEK:
        index = words["index"]
        return f'upright("{words["stem"].replace("_", " ")}")' + (f"_({index})" if index else "")
    stem, _, tail = name.partition("_")
    match = _NAME.fullmatch(stem)
    if match is None:
        return f'upright("{name}")'
    letters, index = match["stem"], match["index"]
    base = letters if len(letters) == 1 or letters in _GREEK else f'upright("{letters}")'
    indices = [each for each in (index, *tail.split("_")) if each]
    if not indices:
        return base
    written = ",".join(each if each.isdigit() or len(each) == 1 else f'"{each}"' for each in indices)
    return f"{base}_({written})"


def rate(name: str) -> str:
    """Write the velocity of a coordinate."""
    base, underscore, index = symbol(name).partition("_(")
    return f"dot({base}){underscore}{index}"


def tidy(expression: sympy.Expr) -> sympy.Expr | None:
    """Bring an expression into a readable form; `None` if there is none that is short enough."""
    forms = [expression]
    if expression.count_ops() <= WORTH_TIDYING and not _has_large_power(expression):
        summed = sum_of_angles(expression)
        forms += [summed] if summed is not None else []
    best = min(forms, key=lambda form: form.count_ops())
    return best if best.count_ops() <= READABLE and not _has_long_base(best) else None


def _has_long_base(expression: sympy.Expr) -> bool:
    """Tell whether a root or power is too long for a line: within its brackets none can break."""
    import sympy

    return any(each.base.count_ops() > LONGEST_BASE for each in expression.atoms(sympy.Pow))


def _has_large_power(expression: sympy.Expr) -> bool:
    import sympy

    return any(each.exp.is_number and abs(each.exp) > LARGEST_POWER for each in expression.atoms(sympy.Pow))


def formula(expression: sympy.Expr, rates: frozenset[str] = frozenset()) -> str:
    """Write a SymPy expression in Typst's notation; names in `rates` are velocities `q1_dot`."""
    return _Printer(rates).write(expression)


class _Printer:
    """Writes an expression by precedence: sums, products, powers, atoms."""

    def __init__(self, rates: frozenset[str]) -> None:
        self._rates = rates

    def write(self, e: Any) -> str:  # noqa: ANN401  # SymPy has no types
        return self._sum(e) if e.is_Add else self._product(e)

    def _sum(self, e: Any) -> str:  # noqa: ANN401  # SymPy has no types
        text = ""
        for term in e.as_ordered_terms():
            written = self._product(term)
            negative = written.startswith("-")
            glue = (" - " if negative else " + ") if text else ("-" if negative else "")
            text += glue + written.removeprefix("-")
        return text

    def _product(self, e: Any) -> str:  # noqa: ANN401  # SymPy has no types
        coefficient, rest = e.as_coeff_Mul()
        sign = "-" if coefficient.is_negative else ""
        numerator, denominator = (abs(coefficient) * rest).as_numer_denom()
        top = self._factors(numerator)
        if denominator == 1:
            return sign + top
        if numerator.count_ops() > UNBROKEN:
            return f"{sign}1/({self._factors(denominator)}) {f'({top})' if numerator.is_Add else top}"
        return f"{sign}({top})/({self._factors(denominator)})"

    def _factors(self, e: Any) -> str:  # noqa: ANN401  # SymPy has no types
        factors = e.as_ordered_factors() if e.is_Mul else [e]
        if len(factors) == 1:
            return self._sum(factors[0]) if factors[0].is_Add else self._power(factors[0])
        return " ".join(f"({self._sum(each)})" if each.is_Add else self._power(each) for each in factors)

    def _power(self, e: Any) -> str:  # noqa: ANN401  # SymPy has no types
        if not e.is_Pow:
            return self._atom(e)
        base, exponent = e.as_base_exp()
        if exponent.is_Rational and exponent.q == 2 and exponent.p == 1 and base.count_ops() <= UNBROKEN:
            return f"sqrt({self.write(base)})"
        if base.is_Function and exponent.is_Integer and exponent.is_positive:
            return self._call(base, f"^{exponent}")
        return f"{self._grouped(base)}^({self.write(exponent)})"

    def _grouped(self, e: Any) -> str:  # noqa: ANN401  # SymPy has no types
        simple = e.is_Symbol or (e.is_Integer and not e.is_negative)
        return self._atom(e) if simple else f"({self.write(e)})"

    def _atom(self, e: Any) -> str:  # noqa: ANN401  # SymPy has no types
        if e.is_Symbol:
            return rate(str(e).removesuffix("_dot")) if str(e) in self._rates else symbol(str(e))
        if e.is_Function:
            return self._call(e, "")
        if e.is_Float:
            mantissa, _, power = f"{float(e):.6g}".partition("e")
            return f"{mantissa} dot 10^({int(power)})" if power else mantissa
        if e.is_Add or e.is_Mul:
            return f"({self.write(e)})"
        return "pi" if str(e) == "pi" else str(e)

    def _call(self, e: Any, exponent: str) -> str:  # noqa: ANN401  # SymPy has no types
        name = type(e).__name__
        known = {"asin": "arcsin", "acos": "arccos", "atan": "arctan"}.get(name, name)
        operator = (
            known
            if known in {"sin", "cos", "tan", "exp", "log", "sinh", "cosh", "tanh", "arcsin", "arccos", "arctan"}
            else f'op("{known}")'
        )
        arguments = ", ".join(self.write(each) for each in e.args)
        plain = len(e.args) == 1 and e.args[0].is_Symbol
        return f"{operator}{exponent} {arguments}" if plain else f"{operator}{exponent} ({arguments})"
