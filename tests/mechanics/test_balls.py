"""Balls: every operation's ball holds what mpmath finds with 60 digits, and is no number where there may be none."""

import math

import casadi as ca
import flint
import mpmath as mp
import pytest
from flint import arb
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.certificate.exactly import DIGITAL, DIGITS, NoValueError, digits, holds

from firmtouch.mechanics.balls import BALLS, _whole_power
from firmtouch.mechanics.tape import record

UNARY = (
    "ASSIGN", "INV", "NEG", "SQ", "TWICE", "SQRT", "EXP", "LOG", "SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN",
    "SINH", "COSH", "TANH", "FABS", "SIGN",
)  # fmt: skip
BINARY = ("ADD", "SUB", "MUL", "DIV", "POW", "CONSTPOW", "ATAN2", "LT")
WIDER = 1.05  # a function that bends is bounded from the middle of its ball, and the tangent's bound is a rough one

centres = st.one_of(st.floats(-3, 3), st.sampled_from([0.0, 1.0, -1.0, 0.5, math.pi, math.pi / 2]))
radii = st.one_of(st.just(0.0), st.floats(0, 1), st.floats(-16, -1).map(lambda x: 10.0**x))
places = st.floats(-1, 1)
exponents = st.one_of(st.integers(-5, 7).map(float), st.sampled_from([0.5, -0.5, 1.5, 1 / 3]))


def operation(name):
    return getattr(ca, f"OP_{name}")


def point(centre, radius, place):
    with mp.workdps(DIGITS):
        return mp.mpf(centre) + mp.mpf(radius) * mp.mpf(place)


def true(code, *arguments):
    with mp.workdps(DIGITS):
        try:
            return DIGITAL.operations[code](*arguments)
        except NoValueError:
            return None


def assert_holds(ball, value):
    """A ball that is a number holds the value, and where there is none the ball is no number."""
    if ball.is_finite():
        assert value is not None
        assert holds(ball, value)


def test_all_operations_are_tested():
    assert {operation(name) for name in UNARY + BINARY} == set(BALLS.operations)


@pytest.mark.parametrize("name", UNARY)
@settings(max_examples=50)
@given(bits=st.sampled_from([53, 64, 256]), centre=centres, radius=radii, place=places)
def test_an_operation_of_one_ball_holds_all_its_values(bits, name, centre, radius, place):
    code = operation(name)
    with flint.ctx.workprec(bits):
        ball = BALLS.operations[code](arb(centre, radius))
    assert_holds(ball, true(code, point(centre, radius, place)))


@pytest.mark.parametrize("name", BINARY)
@settings(max_examples=60)
@given(first=st.tuples(centres, radii, places), second=st.tuples(centres, radii, places), exponent=exponents)
def test_an_operation_of_two_balls_holds_all_its_values(name, first, second, exponent):
    code = operation(name)
    if name == "CONSTPOW":
        second = (exponent, 0.0, 0.0)
    with flint.ctx.workprec(64):
        ball = BALLS.operations[code](arb(*first[:2]), arb(*second[:2]))
    assert_holds(ball, true(code, point(*first), point(*second)))


@pytest.mark.parametrize("name", [*UNARY, *BINARY])
@settings(max_examples=25)
@given(centre=centres, radius=radii, other=st.tuples(centres, radii), exponent=exponents)
def test_the_halves_of_a_ball_give_nothing_outside(name, centre, radius, other, exponent):
    """Subdivision never enlarges, but for the rounding of radii."""
    code = operation(name)
    with flint.ctx.workprec(64):
        rest = () if name in UNARY else (arb(exponent),) if name == "CONSTPOW" else (arb(*other),)
        whole = BALLS.operations[code](arb(centre, radius), *rest)
        if not whole.is_finite():
            return
        widened = arb(whole.mid(), whole.rad() * WIDER + arb(2) ** -50 * (1 + abs(whole.mid())))
        for sign in (-1, 1):
            part = BALLS.operations[code](arb(centre) + sign * arb(radius) / 2 + arb(0, radius) / 2, *rest)
            assert part.is_finite()
            assert widened.contains(part)


def test_powers_of_balls_around_zero_are_numbers():
    """`arb ** 2` itself is no number there, which would leave every flat Jacobian without an enclosure."""
    assert not (arb(0, 1e-9) ** 2).is_finite()
    for exponent in range(1, 9):
        for ball in (arb(0, 1e-9), arb(1e-10, 1e-9), arb(0)):
            found = BALLS.operations[ca.OP_CONSTPOW](ball, arb(exponent))
            assert found.is_finite()
            assert found.contains(0)
            assert found.abs_upper() <= arb(1.1e-9) ** exponent * (1 + arb(2) ** -20)
    assert BALLS.operations[ca.OP_CONSTPOW](arb(0, 1), arb(0)) == 1
    assert not BALLS.operations[ca.OP_CONSTPOW](arb(0, 1), arb(-2)).is_finite()
    assert not BALLS.operations[ca.OP_CONSTPOW](arb(0, 1), arb(0.5)).is_finite()


def test_an_even_power_is_not_negative():
    for square in (BALLS.operations[ca.OP_SQ](arb(0, 1)), _whole_power(arb(0, 1), 2), _whole_power(arb(0.1, 1), 4)):
        assert square.contains(0)
        assert square.lower() > arb(-1.5)
    assert _whole_power(arb(2, 0.5), 2) > 0


@pytest.mark.parametrize("exponent", [*range(-6, 0), *range(1, 8)])
def test_a_whole_power_is_exact_on_exact_numbers(exponent):
    with flint.ctx.workprec(128):
        found = _whole_power(arb(-3), exponent)
        assert found.overlaps(arb(-3) ** exponent)
        assert found.is_exact() == (exponent > 0)


@pytest.mark.parametrize(
    ("name", "balls"),
    [
        ("DIV", [arb(1), arb(0, 1)]),
        ("INV", [arb(0, 1e-30)]),
        ("INV", [arb(0)]),
        ("SQRT", [arb(0, 1)]),
        ("SQRT", [arb(-1)]),
        ("LOG", [arb(0, 1)]),
        ("LOG", [arb(0)]),
        ("ASIN", [arb(1, 0.1)]),
        ("ACOS", [arb(-1, 0.1)]),
        ("TAN", [arb(1.5707963267948966, 1e-3)]),
        ("ATAN2", [arb(0, 1e-9), arb(-1)]),  # the jump
        ("ATAN2", [arb(0, 1e-9), arb(0, 1e-9)]),
        ("ATAN2", [arb(0), arb(0)]),
        ("FABS", [arb(0, 1e-9)]),  # the kink
        ("SIGN", [arb(0, 1e-9)]),
        ("SIGN", [arb(0)]),
    ],
)
def test_what_has_no_certain_value_is_no_number(name, balls):
    found = BALLS.operations[operation(name)](*balls)
    assert not found.is_finite()
    assert not (found + 1 > 0)
    assert not (found * 0 <= 0)


@pytest.mark.parametrize(("y", "x"), [(1.0, 0.0), (-1.0, 0.0), (1.0, -1.0), (-1.0, -1.0), (0.0, 1.0), (1e-9, -1.0)])
def test_angles_are_numbers_away_from_their_jump(y, x):
    with flint.ctx.workprec(64):
        found = BALLS.operations[ca.OP_ATAN2](arb(y, 1e-10), arb(x, 1e-10))
    assert found.is_finite()
    assert found.contains(arb(math.atan2(y, x)))


def test_no_number_stays_none_through_a_whole_function():
    x = ca.SX.sym("x", 2)
    tape = record(ca.Function("f", [x], [ca.sqrt(x[0]) * 0.5 + x[1], x[1]]), BALLS)
    (spoilt,), (fine,) = tape([arb(0, 1), arb(1)])
    assert not spoilt.is_finite()
    assert fine == 1


WHOLE = ("M", "J", "Phi", "P_q", "P_qq", "Phi_qq")


@pytest.mark.parametrize("radius", [0.0, 1e-8, 0.03])
def test_functions_of_shipped_models_are_enclosed_on_random_boxes(plant, place, rng, radius):
    """Balls of the whole function hold its value at random points of a random box, and halves give nothing outside."""
    centre = (place + 0.05 * rng.normal(size=plant.n)).tolist()
    parameters = [arb(each) for each in plant.p.tolist()]
    for name in WHOLE:
        function = plant.functions[name]
        tape = record(function, BALLS)
        with flint.ctx.workprec(64):
            (balls,) = tape([arb(each, radius) for each in centre], parameters)
            half = [arb(each + radius / 2, radius / 2) if radius else arb(each) for each in centre]
            (inner,) = tape(half, parameters)
        place = rng.uniform(-1, 1, plant.n)
        q = [point(a, radius, t) for a, t in zip(centre, place.tolist(), strict=True)]
        for ball, part, value in zip(balls, inner, digits(function, q, plant.p.tolist()), strict=True):
            assert ball.is_finite() or radius > 1e-3
            if ball.is_finite():
                assert holds(ball, value)
                assert arb(ball.mid(), ball.rad() * WIDER + arb(2) ** -40 * (1 + abs(ball.mid()))).contains(part)
