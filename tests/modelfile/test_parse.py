"""The grammar of expressions: what is read, how it binds, and that nothing else is read."""

import math
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmtouch.modelfile.expression import (
    Call,
    ExpressionError,
    Name,
    Number,
    Power,
    Product,
    Rate,
    Sum,
    Vector,
    evaluate,
    names_in,
    parse,
    size,
)
from firmtouch.modelfile.expression.functions import FUNCTIONS, SCALAR
from firmtouch.modelfile.expression.parse import DEEPEST, LONGEST

NAMES = {"a": 0.7, "b": -1.3, "c": 2.1, "pi": math.pi}
QUICK = 0.5  # seconds: hostile text costs some milliseconds, and a busy machine a hundred times that


def value(text, **names):
    return evaluate(
        parse(text),
        names={**NAMES, **names},
        rates={"a": 5.0},
        number=float,
        functions={name: getattr(math, name) for name in SCALAR},
    )


def problem(text):
    with pytest.raises(ExpressionError) as caught:
        parse(text)
    (only,) = caught.value.problems
    return only


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1 + 2*3", 7),
        ("(1 + 2)*3", 9),
        ("2*3**2", 18),
        ("1 - 2 - 3", -4),
        ("8/4/2", 1),
        ("8/4*2", 4),
        ("8*4/2", 16),
        ("2**3**2", 512),
        ("(2**3)**2", 64),
        ("-2**2", -4),
        ("(-2)**2", 4),
        ("2**-1", 0.5),
        ("2**-2**2", 1 / 16),
        ("--3", 3),
        ("-+-3", 3),
        ("2*-3", -6),
        ("2 - -3", 5),
        ("-a**2", -0.49),
        ("1e3 + .5 + 2. + 1.5E-1", 1002.65),
        (" \t1\n+\r\n2 ", 3),
        ("atan2(1, -1)", 3 * math.pi / 4),
        ("sin(pi/2)", 1),
        ("x([1, 2]) + y([3, 4])*z([5, 6, 7])", 29),
        ("inner([1, 2, 3], [4, 5, 6])", 32),
        ("cross([1, 2], [3, 4])", -2),
        ("norm([3, 4])", 5),
        ("dot(a) + 1", 6),
    ],
)
def test_operators_bind_as_in_python(text, expected):
    assert value(text) == pytest.approx(expected, rel=1e-15)  # the same operations on doubles


def test_vectors_add_scale_and_multiply_entrywise():
    assert value("[1, 2] + 3*[4, 5] - [6, 7]/2") == pytest.approx((10, 13.5), rel=1e-15)
    assert value("-[1, 2, 3]") == (-1, -2, -3)
    assert value("cross([1, 0, 0], [0, 1, 0])") == (0, 0, 1)


def test_a_tree_knows_where_in_the_text_each_part_begins():
    tree = parse("a + sin(b)*[c, 2]**2")
    assert isinstance(tree, Sum)
    (_, first), (minus, product) = tree.terms
    assert (minus, first) == (False, Name("a", 0))
    assert isinstance(product, Product)
    (_, call), (divides, power) = product.factors
    assert (divides, call) == (False, Call("sin", (Name("b", 8),), 4))
    assert power == Power(Vector((Name("c", 12), Number("2", 15)), 11), Number("2", 19), 17)
    assert names_in(tree) == {"a", "b", "c"}
    assert size(tree) == 10


def test_long_sums_and_products_are_flat_so_that_length_is_no_depth():
    assert len(parse("+".join(["a"] * 900)).terms) == 900
    assert len(parse("*".join(["a"] * 900)).factors) == 900


def test_the_rate_of_a_coordinate_is_a_node_of_its_own():
    assert parse("dot(q1)") == Rate("q1", 0)
    for text in ("dot(2)", "dot(a + b)", "dot(a, b)", "dot(sin(a))", "dot(dot(a))"):
        assert "`dot` takes the name of one coordinate" in problem(text).message


@pytest.mark.parametrize(
    ("text", "offset", "words"),
    [
        ("", 0, "an empty expression"),
        ("  \n ", 0, "an empty expression"),
        ("1 +", 3, "the expression ends where a number, a name or a bracket was expected"),
        ("1 + * 2", 4, "unexpected `*`"),
        ("(1 + 2", 6, "the expression ends where `)` was expected"),
        ("(1 + 2]", 6, "unexpected `]` where `)` was expected"),
        ("1 + 2)", 5, "unexpected `)` where an operator or the end was expected"),
        ("[1, 2", 5, "the expression ends where `]` was expected"),
        ("[]", 1, "unexpected `]`"),
        ("()", 1, "unexpected `)`"),
        ("a b", 2, "unexpected `b` where an operator or the end was expected"),
        ("2a", 1, "unexpected `a`"),
        ("a(2)", 0, "there is no function `a`"),
        ("sin()", 4, "unexpected `)`"),
        ("sin(1, 2)", 0, "`sin` takes 1 argument, not 2"),
        ("1 + atan2(1)", 4, "`atan2` takes 2 arguments, not 1"),
        ("a^2", 1, "powers are written `**`"),
        ("a.b", 1, "there are no attributes here, a component is written `x(p)`"),
        ("q1'", 2, "the time derivative of a coordinate is written `dot(q1)`"),
        ("lambda: 0", 6, "`:` has no meaning"),
        ("a = 2", 2, "`=` has no meaning"),
        ("a[0]", 1, "unexpected `[`"),
        ("'text'", 0, "has no meaning"),
        ('"text"', 0, "has no meaning"),
        ("a; b", 1, "`;` has no meaning"),
        ("a @ b", 2, "`@` has no meaning"),
        ("a // b", 3, "unexpected `/`"),
        ("a if b else c", 2, "unexpected `if`"),
        ("__import__('os')", 11, "has no meaning"),
        ("__import__(a)", 0, "there is no function `__import__`"),
        ("().__class__", 2, "`.` has no meaning"),
        ("exec(a)", 0, "there is no function `exec`; those that exist: sin"),
        ("\N{SUPERSCRIPT TWO}", 0, "has no meaning"),
        ("\N{ARABIC-INDIC DIGIT ONE}", 0, "has no meaning"),
        ("α + 1", 0, "has no meaning"),
        ("a\x00b", 1, "has no meaning"),
        ("1e999", 0, "`1e999` is beyond the range of a double"),
        ("2*1e-400", 2, "`1e-400` is beyond the range of a double"),
        ("9" * 400, 0, "is beyond the range of a double"),
    ],
)
def test_a_mistake_is_named_at_its_place(text, offset, words):
    found = problem(text)
    assert words in found.message
    assert found.offset == offset


def test_zero_written_at_length_is_no_vanished_number():
    assert value("0.000e-999") == 0


def test_an_unknown_function_is_answered_with_the_nearest_one():
    assert problem("sine(a)").in_words().endswith("; did you mean `sin`?")
    assert problem("arctan2(a, b)").in_words().endswith("; did you mean `atan2`?")
    assert problem("dott(a)").in_words().endswith("; did you mean `dot`?")
    assert "did you mean" not in problem("foo(a)").in_words()
    for name in FUNCTIONS:
        assert f" {name}" in problem("foo(a)").message


@pytest.mark.parametrize("name", ["abs", "Abs", "min", "max", "sign", "floor", "round", "mod"])
def test_a_function_without_second_derivative_is_refused_with_that_reason(name):
    found = problem(f"1 + {name}(a)")
    assert found.message == (
        f"`{name}` has no second derivative everywhere, and energies and constraints must have two"
    )
    assert found.offset == 4


def quickly_refused(text):
    start = time.process_time()
    found = problem(text)
    assert time.process_time() - start < QUICK
    return found


@pytest.mark.parametrize("bracket", ["(", "[", "-", "+", "sin(", "a**", "2*(", "[["])
def test_ten_thousand_brackets_are_refused_at_once(bracket):
    hostile = bracket * 10_000 + "a"
    assert f"an expression of {len(hostile)} characters; at most {LONGEST} are read" in quickly_refused(hostile).message
    inside = bracket * ((LONGEST - 1) // len(bracket)) + "a"
    found = quickly_refused(inside)
    assert f"nested more than {DEEPEST} deep; use `definitions`" in found.message
    assert 0 < found.offset <= DEEPEST * len(bracket)


def test_an_expression_of_a_hundred_kilobytes_is_refused_at_once():
    assert "100000 characters" in quickly_refused("a" * 100_000).message


def test_nesting_up_to_the_bound_is_read():
    assert value("(" * (DEEPEST - 1) + "a" + ")" * (DEEPEST - 1)) == 0.7
    assert "nested" in problem("(" * DEEPEST + "a" + ")" * DEEPEST).message


# Random trees, printed with as few or as many brackets as chance will have it.

NUMBERS = st.one_of(st.integers(0, 30).map(str), st.floats(0.01, 100).map(lambda each: f"{each:.4g}"))
LEAVES = st.one_of(NUMBERS, st.sampled_from(sorted(NAMES)))
GAPS = st.sampled_from(["", " ", "\n", "  "])


@st.composite
def _larger(draw, smaller):
    a, b, gap = draw(smaller), draw(smaller), draw(GAPS)
    form = draw(
        st.sampled_from(
            [
                "{a}{_}+{_}{b}",
                "{a}{_}-{_}{b}",
                "{a}{_}*{_}{b}",
                "{a}{_}/{_}{b}",
                "-{a}",
                "+{a}",
                "({_}{a}{_})",
                "{f}({a})",
                "{a}**{n}",
                "({a})**{n}",
                "-({a}){_}*{b}",
                "atan2({a},{_}{b})",
                "{b}**-{n}",
            ]
        )
    )
    return form.format(
        a=a, b=b, _=gap, f=draw(st.sampled_from(["sin", "cos", "tanh", "atan"])), n=draw(st.integers(1, 3))
    )


@given(st.recursive(LEAVES, _larger, max_leaves=25))
def test_any_expression_has_the_value_that_python_gives_it(text):
    python = {**NAMES, **{name: getattr(math, name) for name in ("sin", "cos", "tanh", "atan", "atan2")}}

    def both(read):
        try:
            return read()
        except (ZeroDivisionError, OverflowError) as error:
            return type(error)

    expected = both(lambda: eval(f"({text})", {"__builtins__": {}}, python))
    try:
        found = both(lambda: value(text))
    except ExpressionError as error:
        assert "nested more than" in str(error)
        return
    if isinstance(expected, type) or isinstance(found, type):
        assert found is expected
    elif math.isnan(expected):
        assert math.isnan(found)
    else:
        # The order of the operations is the same, so that even rounding agrees.
        assert found == expected


@given(st.text(max_size=60))
def test_any_text_is_read_or_refused_and_nothing_else(text):
    try:
        parse(text)
    except ExpressionError as error:
        assert all(0 <= each.offset <= len(text) for each in error.problems)
