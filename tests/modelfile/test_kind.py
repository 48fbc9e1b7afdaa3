"""Dimensions and sizes of expressions, found without evaluating them."""

import time

import pytest

from firmtouch.modelfile.expression import ExpressionError, Kind, kind_of, parse
from firmtouch.modelfile.expression.kind import LITERAL, MOST_UNDECLARED, UNKNOWN
from firmtouch.modelfile.units import parse_unit


def kind_in(unit, size=0):
    return Kind(parse_unit(unit).dimension, size)


NAMES = {
    "l": kind_in("m"),
    "m1": kind_in("kg"),
    "t": kind_in("s"),
    "q": kind_in("rad"),
    "n": kind_in("1"),
    "p": kind_in("m", 2),
    "r": kind_in("m", 3),
    "f": kind_in("N", 2),
    "bad": UNKNOWN,
}
RATES = {"l": kind_in("m/s"), "q": kind_in("rad/s")}


def kind(text, **names):
    return kind_of(parse(text), names={**NAMES, **names}, rates=RATES)


def problems(text, *, rates=RATES, hidden=None):
    with pytest.raises(ExpressionError) as caught:
        kind_of(parse(text), names=NAMES, rates=rates, hidden=hidden or {})
    return caught.value.problems


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("l + 2*l - l/3", "m"),
        ("l*l/t**2*m1", "J"),
        ("m1*l**2", "kg*m^2"),
        ("l**-1", "1/m"),
        ("l**(1/2)*l**0.5", "m"),
        ("sqrt(l)*sqrt(l)", "m"),
        ("sqrt(l**2)", "m"),
        ("sqrt(m1/t)**2", "kg/s"),
        ("sin(q)", "1"),
        ("exp(l/l)", "1"),
        ("atan2(l, 2*l)", "1"),
        ("atan2(l, 1)", "1"),
        ("q**n", "1"),
        ("dot(q)", "1/s"),
        ("0.5*m1*dot(l)**2", "J"),
        ("x(p)", "m"),
        ("z(r)", "m"),
        ("norm(p)", "m"),
        ("inner(p, f)", "J"),
        ("cross(p, f)", "J"),
        ("l - 1.2", "m"),
        ("1.2 - l", "m"),
        ("1 + pi + l", "m"),
        ("l + 0*2", "m"),
    ],
)
def test_dimensions_follow_the_operations(text, unit):
    found = kind(text)
    assert found.dimension == parse_unit(unit).dimension
    assert found.size == 0
    assert found.known
    assert not found.literal


@pytest.mark.parametrize(
    ("text", "unit", "size"),
    [
        ("p + p", "m", 2),
        ("2*p - p/3", "m", 2),
        ("[l, 2*l]", "m", 2),
        ("[l, 0]", "m", 2),
        ("[0, 0, l]", "m", 3),
        ("p + [l, 0]", "m", 2),
        ("p + [1, 0]", "m", 2),
        ("l*[cos(q), sin(q)]", "m", 2),
        ("-r", "m", 3),
        ("cross(r, r)", "m^2", 3),
    ],
)
def test_vectors_carry_a_size_through(text, unit, size):
    assert kind(text) == kind_in(unit, size)


def test_numbers_alone_are_literals_and_adapt_in_sums():
    assert kind("2*3 + pi**2 - sin(1)") == LITERAL
    assert kind("[1, 2]") == Kind(size=2, literal=True)
    for unit in ("m", "kg", "1"):
        assert LITERAL.fits(parse_unit(unit).dimension)
    assert kind("2 + l").fits(parse_unit("m").dimension)
    assert not kind("2 + l").fits(parse_unit("kg").dimension)
    # A product with a number is no literal.
    assert not kind("2*n").literal


@pytest.mark.parametrize(
    ("text", "offset", "words"),
    [
        ("l + m1", 4, "kg is added to m"),
        ("l - t + l", 4, "s is added to m"),
        ("l + n", 4, "a number is added to m"),
        ("1 + l + m1", 8, "kg is added to m"),
        ("l + p", 4, "a vector of 2 in m is added to m"),
        ("p + r", 4, "a vector of 3 in m is added to a vector of 2 in m"),
        ("p + 1", 4, "a number is added to a vector of 2 in m"),
        ("[l, t]", 4, "s is joined to m"),
        ("[l]", 0, "a vector of 1; vectors here have 2 or 3 entries"),
        ("[l, l, l, l]", 0, "a vector of 4"),
        ("[p, p]", 0, "a vector inside a vector"),
        ("p*f", 2, "a product of two vectors; use `inner` or `cross`"),
        ("l/p", 2, "a division by a vector"),
        ("p**2", 1, "a power of a vector"),
        ("2**p", 1, "a power of a vector"),
        ("l**n", 3, "the base is in m, so its exponent must be a constant number"),
        ("2**l", 3, "an exponent in m"),
        ("q**33", 3, "an exponent of 33; at most 32"),
        ("9**9**9", 4, "an exponent of 3.874e+08; at most 32"),
        ("sin(l)", 4, "`sin` of m; it takes a plain number or an angle"),
        ("log(m1/t)", 4, "`log` of kg s^-1"),
        ("sin(p)", 0, "`sin` takes a scalar, not a vector"),
        ("sqrt(p)", 0, "`sqrt` takes a scalar"),
        ("atan2(l, t)", 9, "s is compared to m"),
        ("x(l)", 0, "`x` takes a component of a vector"),
        ("z(p)", 0, "`z` takes a component of a vector; this is a vector of 2 in m"),
        ("norm(l)", 0, "`norm` takes vectors of one size"),
        ("inner(p, r)", 0, "not a vector of 2 in m and a vector of 3 in m"),
        ("cross(p, l)", 0, "`cross` takes vectors of one size"),
        ("1/0", 2, "a division by zero"),
        ("q/(2 - 2)", 3, "a division by zero"),
        ("q/(3*0)", 3, "a division by zero"),
        ("0**-1", 1, "a constant that is no finite number"),
        ("q + 0**-1", 5, "a constant that is no finite number"),
        ("q*sqrt(-1)", 2, "a constant that is no finite number"),
        ("q + log(0)", 4, "a constant that is no finite number"),
        ("q*exp(exp(exp(100)))", 2, "a constant that is no finite number"),
        ("1e308*1e308", 0, "a constant that is no finite number"),
        ("q + (-8)**(1/3)", 8, "a constant that is no finite number"),
        ("q + sin((-8)**0.5)", 4, "a constant that is no finite number"),
        ("[q, asin(2)]", 4, "a constant that is no finite number"),
    ],
)
def test_what_does_not_go_together_is_refused_at_its_place(text, offset, words):
    (found,) = problems(text)
    assert words in found.message
    assert found.offset == offset


def test_every_node_is_read_once_however_deep_it_stands():
    start = time.process_time()
    for nested in ("atan2(1, {})", "atan2({}, 2)", "2**({})", "1/({})", "inner([{}, 1], [1, 2])", "norm([1, {}])"):
        text = "q"
        for _ in range(18):
            text = nested.format(text)
        if not text.startswith("2**"):
            kind(text)
            continue
        with pytest.raises(ExpressionError, match="exponent"):
            kind(text.replace("q", "2"))
    assert time.process_time() - start < 1.0  # some milliseconds; reading arguments twice would take minutes


def test_undeclared_names_are_reported_together_once_each_and_with_a_suggestion():
    found = problems("ll + m*q + m*zz + dot(qq)")
    assert [(each.offset, each.message) for each in found] == [
        (0, "`ll` is not declared"),
        (5, "`m` is not declared"),
        (13, "`zz` is not declared"),
        (18, "`qq` is no coordinate"),
    ]
    assert found[0].in_words().endswith("; did you mean `l`?")
    assert found[1].in_words().endswith("; did you mean `m1`?")
    assert found[2].in_words() == "`zz` is not declared"
    assert found[3].in_words().endswith("; did you mean `q`?")


def test_hundreds_of_undeclared_names_make_ten_messages():
    found = problems("+".join(f"u{i}" for i in range(500)))
    assert [each.message for each in found] == [f"`u{i}` is not declared" for i in range(MOST_UNDECLARED)]


def test_velocities_are_refused_where_only_the_configuration_counts():
    (found,) = problems("2*dot(q)", rates={})
    assert found.message == "velocities are not allowed here: this expression depends on the configuration alone"
    assert found.offset == 2


def test_a_name_that_cannot_be_used_here_is_no_undeclared_one():
    (found,) = problems("l + tip", hidden={"tip": "it stands further down"})
    assert found.message == "`tip` cannot be used here: it stands further down"


@pytest.mark.parametrize(
    "text",
    [
        "bad + l",
        "l + bad",
        "bad + l + m1*bad",
        "bad*l",
        "l/bad",
        "bad**2",
        "l**bad",
        "bad**q",
        "sin(bad)",
        "sin(bad*l)",
        "x(bad)",
        "z(bad)",
        "norm(bad)",
        "inner(bad, p)",
        "cross(p, bad)",
        "atan2(bad, l)",
        "[bad, l]",
        "[bad, 0.05]",
        "[0.05, bad]",
        "bad + p",
        "bad - 1",
        "1 - bad",
        "bad/(bad - 1)",
        "sqrt(bad)",
    ],
)
def test_a_name_whose_own_declaration_is_wrong_agrees_with_everything(text):
    kind(text)


def test_an_unknown_part_hides_no_other_mistake():
    assert problems("bad + l + m1")[0].message == "kg is added to m"
    assert problems("bad*sin(l)")[0].message.startswith("`sin` of m")


def test_an_unknown_summand_makes_a_sum_with_numbers_no_literal():
    assert kind("bad + 1") == UNKNOWN
    assert kind("1 + bad") == UNKNOWN
    assert not kind("[bad, 1]").literal
