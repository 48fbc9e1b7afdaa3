"""Trigonometric sums in the form that is read most easily: products of sines and cosines become sums of angles."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    import sympy

MOST_TERMS: Final = 300
MOST_FACTORS: Final = 6
MOST_WAVES: Final = 24

Wave = tuple[str, Any]
"""("cos" or "sin", angle); the constant is ("cos", 0)."""


def sum_of_angles(expression: sympy.Expr) -> sympy.Expr | None:
    """Write an expression as a sum of coefficient times cos or sin of an angle, each angle once.

    `None` if it has roots of sums, too many terms or waves, or a product of too many: it would not be read anyway.
    """
    import sympy

    roots = any(each.base.is_Add and not each.exp.is_Integer for each in expression.atoms(sympy.Pow))
    terms = () if roots else sympy.Add.make_args(sympy.expand(expression))
    if not 0 < len(terms) <= MOST_TERMS:
        return None
    coefficients: dict[Wave, list[Any]] = defaultdict(list)
    for term in terms:
        waves = _waves_of(term)
        if waves is None:
            return None
        coefficient, spectrum = waves
        for wave, weight in spectrum.items():
            coefficients[wave].append(weight * coefficient)
    if len(coefficients) > MOST_WAVES:
        return None
    functions = {"cos": sympy.cos, "sin": sympy.sin}
    return sympy.Add(
        *(
            functions[name](angle) * sympy.factor_terms(sympy.Add(*parts))
            for (name, angle), parts in coefficients.items()
        )
    )


def _waves_of(term: Any) -> tuple[Any, dict[Wave, Any]] | None:  # noqa: ANN401  # SymPy has no types
    """Take a product apart: its coefficient, and its sines and cosines as a spectrum."""
    import sympy

    coefficient: Any = sympy.Integer(1)
    spectrum: dict[Wave, Any] = {("cos", sympy.Integer(0)): sympy.Integer(1)}
    count = 0
    for factor in sympy.Mul.make_args(term):
        base, exponent = factor.as_base_exp()
        if not isinstance(base, sympy.cos | sympy.sin) or not (exponent.is_Integer and exponent.is_positive):
            coefficient *= factor
            continue
        count += int(exponent)
        if count > MOST_FACTORS:
            return None
        for _ in range(int(exponent)):
            spectrum = _times(spectrum, type(base).__name__, base.args[0])
    return coefficient, spectrum


def _times(spectrum: dict[Wave, Any], name: str, angle: Any) -> dict[Wave, Any]:  # noqa: ANN401  # SymPy has no types
    """Multiply a spectrum by one wave: cos a cos b = (cos(a - b) + cos(a + b)) / 2, and so on."""
    import sympy

    product: dict[Wave, Any] = defaultdict(lambda: sympy.Integer(0))
    for (other, a), weight in spectrum.items():
        sign = -1 if other == name == "sin" else 1
        result = "cos" if other == name else "sin"
        # sin a cos b has +sin(a - b), cos a sin b has -sin(a - b); sin a sin b has +cos(a - b) and -cos(a + b).
        difference = -1 if (other, name) == ("cos", "sin") else 1
        for wave_sign, at in ((difference, a - angle), (sign, a + angle)):
            flip = at.could_extract_minus_sign()
            factor = -1 if flip and result == "sin" else 1
            product[result, -at if flip else at] += weight * wave_sign * factor / sympy.Integer(2)
    return {wave: weight for wave, weight in product.items() if weight != 0 and wave != ("sin", 0)}
