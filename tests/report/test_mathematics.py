"""SymPy expressions as Typst formulas, and the short forms in which the report shows a mechanism's equations."""

import random

import pytest
import sympy as sp
import typst

from firmtouch.report.document import Equation, Math
from firmtouch.report.mathematics import READABLE, formula, rate, symbol, tidy
from firmtouch.report.typeset import typeset

a, b, c, l1, q1, q2, q1_dot, q2_dot, radius, x = sp.symbols("a b c l1 q1 q2 q1_dot q2_dot radius x", real=True)
RATES = frozenset({"q1_dot", "q2_dot"})

WRITTEN = [
    # A sum: signs between the terms, none doubled.
    (a - b, "a - b"),
    (-a - b, "-a - b"),
    (-x - sp.Rational(1, 2), "-x - (1)/(2)"),
    # A product: sums within it in brackets, its sign in front.
    (-a * (b - c), "-a (b - c)"),
    ((a - b) * (b - c), "(a - b) (b - c)"),
    (a * (b + c) * sp.sin(q1), "a (b + c) sin q_(1)"),
    (sp.sin(q1) * (a + sp.cos(q2)), "(a + cos q_(2)) sin q_(1)"),
    # A fraction: its bar groups, so nothing under or over it needs brackets of its own.
    (a / b, "(a)/(b)"),
    ((a + b) / (a - b), "(a + b)/(a - b)"),
    (-sp.Rational(3, 4) * x, "-(3 x)/(4)"),
    # A power: everything but a name or a number in brackets.
    ((a + b) ** 2, "(a + b)^(2)"),
    (-(x**2), "-x^(2)"),
    (a**2 * b**2, "a^(2) b^(2)"),
    ((a**b) ** c, "(a^(b))^(c)"),
    (a ** (b**c), "a^(b^(c))"),
    ((-2) ** x, "(-2)^(x)"),
    (x**-2, "(1)/(x^(2))"),
    (a ** sp.Rational(3, 2), "a^((3)/(2))"),
    # Roots.
    (sp.sqrt(a + b), "sqrt(a + b)"),
    (a / sp.sqrt(b + c), "(a)/(sqrt(b + c))"),
    # Functions: their power stands at their name, a plain argument needs no brackets.
    (sp.sin(q1) ** 2, "sin^2 q_(1)"),
    (1 / sp.sin(q1 + q2) ** 2, "(1)/(sin^2 (q_(1) + q_(2)))"),
    (sp.cos(2 * q1), "cos (2 q_(1))"),
    (sp.sin(sp.sin(q1)), "sin (sin q_(1))"),
    (sp.atan2(a, b), 'op("atan2") (a, b)'),
    (sp.asin(x), "arcsin x"),
    # Names and rates.
    (radius * a, 'a upright("radius")'),
    (l1 * q1_dot**2 * sp.cos(q1), "l_(1) dot(q)_(1)^(2) cos q_(1)"),
    (q1_dot * (2 * q1_dot + q2_dot), "dot(q)_(1) (2 dot(q)_(1) + dot(q)_(2))"),
    (sp.pi * q1, "pi q_(1)"),
    # Numbers.
    (sp.Integer(0), "0"),
    (sp.Float("-1.5") * x, "-1.5 x"),
]


@pytest.mark.parametrize(("expression", "written"), WRITTEN, ids=[str(each) for each, _ in WRITTEN])
def test_an_expression_is_written_with_the_brackets_it_needs(expression, written):
    assert formula(expression, RATES) == written


@pytest.mark.parametrize(
    ("value", "power"), [("1e-7", "-7"), ("2.5e10", "10"), ("6.02214076e23", "23"), ("-3e-12", "-12")]
)
def test_a_small_or_large_float_is_written_as_a_power_of_ten_with_its_whole_exponent_raised(value, power):
    written = formula(sp.Float(value) * x)
    assert f"10^({power})" in written
    assert "e" not in written


@pytest.mark.parametrize(
    ("name", "written"),
    [
        ("q1", "q_(1)"),
        ("q_1", "q_(1)"),
        ("q12", "q_(12)"),
        ("m", "m"),
        ("theta2", "theta_(2)"),
        ("x_wall", 'x_("wall")'),
        ("I_zz_2", 'I_("zz",2)'),
        ("radius", 'upright("radius")'),
        ("mass_2", 'upright("mass")_(2)'),
        ("sum", 'upright("sum")'),  # Typst's word for a sign, and a user's for a length
        ("q1a", 'upright("q1a")'),
        ("left_shoulder_lift", 'upright("left shoulder lift")'),  # of several words, as robots' joints
        ("left_wrist_1", 'upright("left wrist")_(1)'),
        ("panda_joint7", 'upright("panda joint")_(7)'),
        ("theta_max", 'theta_("max")'),
    ],
)
def test_a_name_becomes_a_symbol_with_its_index(name, written):
    assert symbol(name) == written


def test_the_dot_of_a_velocity_stands_over_the_letter_and_not_over_its_index():
    assert rate("q1") == "dot(q)_(1)"
    assert rate("x") == "dot(x)"
    assert rate("x_wall") == 'dot(x)_("wall")'
    assert rate("radius") == 'dot(upright("radius"))'
    assert rate("left_wrist_1") == 'dot(upright("left wrist"))_(1)'


def test_all_that_is_written_can_be_typeset_in_a_line_and_displayed():
    names = ["q1", "x_wall", "I_zz_2", "radius", "q1a", "_x", "x__y", "in", "sum", "let", "none", "pi", "dot", "lambda"]
    sources = [formula(each, RATES) for each, _ in WRITTEN]
    sources += [f(name) for name in names for f in (symbol, rate)]
    formulas = [*map(Math, dict.fromkeys(sources)), *map(Equation, dict.fromkeys(sources))]
    set_ = typeset(formulas)
    assert set(set_.formulas) == set(formulas)
    for each in set_.formulas.values():
        assert each.width > 0.1  # em: a letter is 0.3 wide, a minus sign 0.8
        assert each.height > 0.1
        assert each.depth > -0.5 * each.height


def test_a_formula_that_typst_cannot_read_is_not_passed_over():
    with pytest.raises(typst.TypstError):
        typeset([Math("frac(a")])


TIDIED = {
    "inertia of two links": (
        2 * a * b * sp.cos(q1) * sp.cos(q1 + q2) + 2 * a * b * sp.sin(q1) * sp.sin(q1 + q2) + a**2 + c
    ),
    "pythagoras": a * sp.sin(q1) ** 2 + a * sp.cos(q1) ** 2,
    "speeds": (-a * q1_dot * sp.sin(q1) * b) ** 2 + (a * q1_dot * sp.cos(q1) * b) ** 2 + a * sp.cos(q1),
    "gravity": b * a * sp.cos(q1) + c * (a * sp.cos(q1) + x * sp.cos(q1 + q2)),
    "already short": a - b * sp.cos(q1),
    "a root": sp.sqrt((a * sp.cos(q1) - b) ** 2 + (a * sp.sin(q1) - c) ** 2) - x,
    "a number": sp.Rational(3, 2),
    "zero in disguise": sp.sin(q1) * sp.cos(q1) - sp.sin(2 * q1) / 2,
}


@pytest.mark.parametrize("expression", TIDIED.values(), ids=list(TIDIED))
def test_a_tidied_expression_has_the_same_value_and_is_no_longer(expression):
    short = tidy(expression)
    assert short is not None
    assert short.count_ops() <= expression.count_ops()
    assert short.free_symbols <= expression.free_symbols
    draw = random.Random(7)
    for _ in range(5):
        at = {each: draw.uniform(0.3, 2) for each in expression.free_symbols}
        # Some thirty operations on numbers of order one to ten.
        assert float(short.subs(at)) == pytest.approx(float(expression.subs(at)), rel=1e-11, abs=1e-11)


def test_what_cannot_be_made_short_is_left_out():
    long = sum(sp.sin(k * q1 + sp.Symbol(f"p{k}")) * sp.Symbol(f"m{k}") for k in range(READABLE))
    assert tidy(long) is None


def test_two_equal_columns_of_a_long_expression_are_gathered():
    short = tidy(a * sp.cos(q1) * b + a * sp.cos(q1) * c)
    assert short.count_ops() <= 4  # a (b + c) cos q1


def test_every_equation_of_a_shipped_model_that_is_shown_can_be_typeset(report):
    shown = [
        block
        for section in report.document.sections
        for block in section.blocks
        if isinstance(block, Equation) and block.typst.count("=")
    ]
    assert len(shown) > 8
    assert len(typeset(shown).formulas) == len(set(shown))
