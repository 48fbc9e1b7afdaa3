"""Formulas that a parser, a computer algebra or a floating-point unit could choke on, in every place of a model."""

import pytest
from tests.hostile.harness import MODELS, survive

BASE = MODELS["pendulum_rod"].read_text()
PLACES = {
    "kinetic energy": ("0.5*m*(dot(x)**2", "0.5*m*(({})*0.1 + 1)*(dot(x)**2"),
    "potential energy": ("m*g*y", "m*g*length*({})"),
    "constraint": ("length - sqrt(x**2 + y**2)", "'1e-3*length*({}) + length - sqrt(x**2 + y**2)'"),
}
u, v = "x/length", "y/length"
PRIMES = "(2*3*5*7*11*13*17*19*23)"

FORMULAS = {
    # Numbers that grow when they are kept exactly.
    "a ladder of powers": "(" * 9 + "(1/3)" + "**8)" * 9 + f"*{u}",
    "a slow ladder of powers": "(" * 7 + "1.0000001" + "**8)" * 7 + f"*{u}",
    "roots of large numbers": f"((1234567*7654321)**(1/3)*(99999989*3)**(1/7)*{PRIMES}**(1/5))**(3/7)*{u}",
    "powers of sums of roots": "(" + "+".join(f"{i}**(1/2)" for i in range(2, 30)) + f")**8*{u}",
    "angles that are parts of pi": "*".join(f"sin(pi/{i})*cos(pi*{i}/17)" for i in range(3, 40)) + f"*{u}",
    "a sum of large fractions": f"({'+'.join(['12345678**8/87654321**8'] * 60)})*{u}",
    "towers that end near zero": f"exp(-exp(exp(6.5)))*{u} + exp(-exp(700))*{v}",
    "the sine of a huge number": f"sin(exp(700))*{u} + tan(1e300*{v})",
    "a long decimal": f"0.{'123456789' * 100}*{u}",
    "a pole that is one number away": f"tan(pi/2)*1e-16*{u}",
    # Nesting that questions of every level at every level make exponential.
    "atan2 in atan2": "atan2(1, " * 19 + u + ")" * 19,
    "atan2 in atan2, both arguments": f"atan2({u}, 1 + " * 7 + v + ")" * 7,
    "tanh in products": f"{u}*tanh({v} + " * 9 + v + ")" * 9,
    "sine in sine": "sin(" * 35 + u + ")" * 35,
    "fraction in fraction": "1/(1 + " * 19 + u + ")" * 19,
    "power in power": f"(1 + {u})**(" * 12 + v + ")" * 12,
    "root in root": "sqrt(1 + " * 19 + u + ")" * 19,
    "a long product": "*".join(f"(2 + sin({i}*{u}))" for i in range(1, 100)),
    "a long sum": "+".join(f"sin({i}*{u})*cos({i}*{v})" for i in range(1, 110)),
    # Places where a function, its derivative or only its second derivative does not exist.
    "the root of a square": f"sqrt(({u})**2)",
    "roots of powers": f"(({u})**2)**(1/3)*(({v})**4)**(1/8)",
    "the logarithm of a negative number": f"log({v})",
    "the root of a negative number": f"sqrt({v})",
    "a negative number to a power": f"(-2)**({u})",
    "zero to the power of zero": f"(0*{u})**({v})",
    "zero by zero": f"({u} - {u})/({v} - {v})",
    "the angle of nothing": f"atan2({u} - {u}, {v} - {v})",
    "the length of nothing": "norm([x - x, y - y])/length",
    "the cosine that is five": f"acos(5 + {u})",
    "overflow": f"exp(1e4*{v}) + exp(-1e4*{v})",
    "overflow in a product": f"1e200*{u}*1e200*{v}",
    "something stiff": f"sin(1e6*{u})*exp(50*{v})",
}


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("formula", FORMULAS)
def test_any_formula_gets_an_answer_soon(formula, place, tmp_path, canary, capfd):
    old, new = PLACES[place]
    assert BASE.count(old) == 1
    text = BASE.replace(old, new.format(FORMULAS[formula]).replace("x", "x"))
    survive(text.encode(), f"{formula} in the {place}", tmp_path / "made.yaml", canary)
    assert capfd.readouterr() == ("", "")
