"""Surfaces in ball arithmetic: balls and Taylor forms hold the values, tightly on knots and seams too; kinks of users stay refused."""

import casadi as ca
import flint
import mpmath as mp
import numpy as np
import pytest
from flint import arb, arb_mat
from tests.certificate.exactly import DIGITAL, digits, holds
from tests.mechanics.surfaces.given import HEIGHTS, SURFACES, SYMBOLS, Measured, P, measured, surface

from firmtouch.certificate.attraction.expansion import EXPANSIONS, constant, inputs
from firmtouch.mechanics.balls import BALLS, UNDECIDED
from firmtouch.mechanics.intervals import enclose, has_kinks
from firmtouch.mechanics.surfaces import bend, normal, signed_distance
from firmtouch.mechanics.surfaces.spline import basis, coefficients
from firmtouch.mechanics.surfaces.superellipsoid import size_to_the
from firmtouch.mechanics.tape import record
from firmtouch.modelfile.expression.functions import SCALAR

VALUES = np.random.default_rng(7).normal(size=8)
BESIDE = np.array([0.02, 0.02, 0])
WHAT = ("s", "gradient", "hessian", "normal")


def spline(third=False):
    t = ca.SX.sym("t")
    columns = basis(t, len(VALUES))[: 4 if third else 3]
    return ca.Function("f", [t], [ca.vertcat(*(ca.dot(ca.DM(coefficients(VALUES)), each) for each in columns))])


def by_casadi():
    """The same derivatives by differentiating the value, as a plant's are found."""
    t = ca.SX.sym("t")
    value = ca.dot(ca.DM(coefficients(VALUES)), basis(t, len(VALUES))[0])
    slope = ca.gradient(value, t)
    return ca.Function("f", [t], [ca.vertcat(value, slope, ca.gradient(slope, t))])


@pytest.mark.parametrize("name", SURFACES)
def test_balls_hold_a_surface_at_random_points(name, rng):
    one, p = measured(name), [arb(each) for each in P]
    for function in (one.symbolic[each] for each in WHAT):
        tape, exact = record(function, BALLS), record(function, DIGITAL)
        for radius in (0.0, 1e-9, 0.01):
            centre = [0.1, 0.2, 0.3] + 0.2 * rng.normal(size=3)
            (balls,) = tape([arb(each, radius) for each in centre], p)
            with mp.workdps(60):
                place = [
                    mp.mpf(c) + mp.mpf(radius) * mp.mpf(t) for c, t in zip(centre, rng.uniform(-1, 1, 3), strict=True)
                ]
                values = exact(place, [mp.mpf(each) for each in P])[0]
            for ball, value in zip(balls, values, strict=True):
                assert ball.is_finite() or radius > 1e-3
                assert not ball.is_finite() or holds(ball, value)


@pytest.mark.parametrize("make", [spline, by_casadi])
def test_balls_hold_a_spline_at_its_knots_and_between(make, rng):
    tape, exact = record(make(), BALLS), record(make(), DIGITAL)
    for centre in [0, 1, 3, 6, *rng.uniform(-0.5, 7.5, 3)]:
        for radius in (0.0, 1e-12, 0.4, 1.7):
            (balls,) = tape([arb(centre, radius)])
            for place in (-1, *rng.uniform(-1, 1, 2)):
                with mp.workdps(60):
                    values = exact([mp.mpf(float(centre)) + mp.mpf(radius) * mp.mpf(place)])[0]
                assert all(holds(ball, value) for ball, value in zip(balls, values, strict=True))


def test_at_a_knot_balls_are_as_tight_as_between():
    """What a comparison leaves undecided there is multiplied by something as small as the ball."""
    tape = record(spline(), BALLS)
    for radius in (1e-3, 1e-9):
        for knot in range(1, 7):
            (balls,) = tape([arb(knot, radius)])
            assert all(each.rad() < 200 * radius for each in balls)  # the third derivative is of some tens


def test_a_bent_height_field_is_tight_on_a_knot_too():
    """Both at a knot of x and at one of y, with the gradient and the Hessian of the distance."""
    field = Measured(f"height_field: {{x: [-1, 0.8], y: [-0.1, 0.9], heights: {HEIGHTS.tolist()}}}")
    at = np.array([-0.1, 0.4, 0])
    at[2] = -field(at) / field(at, "normal")[2]  # on the surface, where third derivatives are multiplied by zero
    for what in ("s", "bent", "gradient", "hessian"):
        tape = record(field.symbolic[what], BALLS)
        (on,), (beside,) = (tape([arb(x, 1e-9) for x in at + move], [arb(0)] * 2) for move in (0, BESIDE))
        assert max(each.rad() for each in on) < 4 * max(each.rad() for each in beside) < arb(1e-4)


def test_the_third_derivative_is_the_hull_of_its_jump():
    tape = record(spline(third=True), BALLS)
    for knot in range(1, 7):
        (balls,) = tape([arb(knot, 1e-9)])
        for side in (-1e-6, 1e-6):
            assert balls[3].is_finite()
            assert balls[3].contains(tape([arb(knot + side)])[0][3].mid())


@pytest.mark.parametrize("e", [2.0, 3.0, 4.0, 5.0, 8.0])
def test_whole_powers_are_numbers_on_their_seams(e):
    t = ca.SX.sym("t")
    value = size_to_the(t, e)
    slope = ca.gradient(value, t)
    tape = record(ca.Function("f", [t], [ca.vertcat(value, slope, ca.gradient(slope, t))]), BALLS)
    for radius in (0.0, 1e-9):
        (balls,) = tape([arb(0, radius)])
        for ball, true in zip(balls, (0, 0, 2 if e == 2 else 0), strict=True):
            assert ball.contains(true)
            assert ball.rad() < 10 * radius + 1e-15


@pytest.mark.parametrize("e", [2.5, 3.5])
def test_other_powers_are_no_numbers_on_their_seams(e):
    t = ca.SX.sym("t")
    tape = record(ca.Function("f", [t], [size_to_the(t, e)]), BALLS)
    assert not tape([arb(0, 1e-9)])[0][0].is_finite()
    assert tape([arb(-0.5, 1e-9)])[0][0].contains(arb(0.5) ** arb(e))


def test_taylor_forms_hold_a_spline_across_a_knot(rng):
    function = by_casadi()
    tape = record(function, EXPANSIONS)
    for centre, size in [(3.0, 1e-3), (2.999, 0.01), (3.4, 0.3)]:
        (found,) = tape(inputs([arb(centre)], arb_mat([[size]]), [arb_mat(1, 1)]))
        for e in rng.uniform(-1, 1, 10):
            with mp.workdps(60):
                values = digits(function, [mp.mpf(centre) + mp.mpf(size) * mp.mpf(e)])
            for each, value in zip(found, values, strict=True):
                here = (
                    each.c + each.a[0, 0] * arb(e) + each.Q[0, 0] * arb(e) ** 2 + each.r
                    if each.a is not None
                    else each.c
                )
                assert holds(here, value)
                assert holds(each.ball, value)


def test_a_comparison_that_is_undecided_is_both():
    less = BALLS.operations[ca.OP_LT]
    assert [less(arb(0), arb(1)), less(arb(1), arb(0)), less(arb(1), arb(1))] == [1, 0, 0]
    assert less(arb(0, 1), arb(0)).contains(0)
    assert less(arb(0, 1), arb(0)).contains(1)
    assert less(arb(0, 1), arb(0)).rad() == UNDECIDED.rad()
    assert EXPANSIONS.operations[ca.OP_LT](constant(arb(0, 1)), constant(0)).ball.contains(arb(0.5, 0.5))
    with flint.ctx.workprec(53):
        assert less(arb.nan(), arb(0)).contains(1)


def test_nothing_that_a_file_can_write_compares():
    """So nobody's kink is enclosed as a spline's: neither the functions nor their derivatives make comparisons."""
    for name, count in SCALAR.items():
        x = ca.SX.sym("x", count)
        value = getattr(ca, name)(*ca.vertsplit(x))
        hessian, gradient = ca.hessian(value, x)
        function = ca.Function("f", [x], [value, gradient, hessian, ca.jacobian(ca.vec(hessian), x)])
        assert ca.OP_LT not in [function.instruction_id(k) for k in range(function.n_instructions())]


@pytest.mark.parametrize("expression", ["sqrt(x**2) - z", "(x**2)**1.5 - z"])
def test_a_kink_of_the_users_is_no_number(expression):
    """CasADi makes an absolute value of the root of a square, whose sign is undecided, not [-1, 1]."""
    spec, x = surface(f'implicit: {{expression: "{expression}"}}'), ca.SX.sym("x", 3)
    at_x = bend(spec, x, SYMBOLS)
    outputs = ca.vertcat(at_x.value, at_x.gradient, ca.vec(at_x.hessian))
    tape = record(ca.Function("f", [x, SYMBOLS.p], [ca.densify(outputs)]), BALLS)
    p = [arb(each) for each in P]
    assert not all(each.is_finite() for each in tape([arb(0, 1e-9)] * 3, p)[0])
    assert all(each.is_finite() for each in tape([arb(0.5, 1e-9), arb(0), arb(0.1)], p)[0])


def test_intervals_refuse_to_move_a_knot():
    """A parameter in a spline's argument would look like a polynomial to one who differentiates four times."""
    function = spline()
    assert has_kinks(function)
    with pytest.raises(Exception, match="a spline has a knot there"):
        enclose(function, [(2.5, 3.5)], "the plant")
    bounds = enclose(function, [(2.25, 2.75)], "the plant")
    assert np.all(bounds >= np.abs(function(2.5).full().ravel()))
    assert not has_kinks(ca.Function("f", [SYMBOLS.p], [SYMBOLS.p**3]))


def test_all_surfaces_can_be_differentiated_three_times_on_the_tape():
    x = ca.SX.sym("x", 3)
    for text in SURFACES.values():
        if "height" in text:
            continue  # below, in one variable
        s = signed_distance(surface(text), x, SYMBOLS)
        third = ca.jacobian(ca.vec(ca.hessian(s, x)[0]), x)
        record(ca.Function("f", [x, SYMBOLS.p], [ca.densify(third), normal(surface(text), x, SYMBOLS)]), BALLS)
    field = signed_distance(surface(SURFACES["height field"]), x, SYMBOLS)
    third = ca.jacobian(ca.hessian(field, x)[0][0, 0], x)
    record(ca.Function("f", [x, SYMBOLS.p], [ca.densify(third)]), BALLS)
