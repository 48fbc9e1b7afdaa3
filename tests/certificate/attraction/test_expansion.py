"""Taylor forms in balls: every function, product and inverse holds what 40 digits say, at random points of random cells."""

import casadi as ca
import flint
import mpmath
import numpy as np
import pytest
from flint import arb, arb_mat

from firmtouch.certificate.attraction.expansion import EXPANSIONS, constant, inputs
from firmtouch.certificate.attraction.forms import Weights, arrange
from firmtouch.mechanics.tape import record

FUNCTIONS = {
    "sin": (ca.sin, mpmath.sin, 0.7),
    "cos": (ca.cos, mpmath.cos, 0.7),
    "tan": (ca.tan, mpmath.tan, 0.5),
    "exp": (ca.exp, mpmath.exp, 0.4),
    "log": (ca.log, mpmath.log, 1.9),
    "sqrt": (ca.sqrt, mpmath.sqrt, 1.7),
    "inverse": (lambda x: 1 / x, lambda x: 1 / x, -1.3),
    "atan": (ca.atan, mpmath.atan, 0.8),
    "asin": (ca.asin, mpmath.asin, 0.3),
    "acos": (ca.acos, mpmath.acos, -0.3),
    "sinh": (ca.sinh, mpmath.sinh, 0.6),
    "cosh": (ca.cosh, mpmath.cosh, -0.6),
    "tanh": (ca.tanh, mpmath.tanh, 0.6),
    "fabs": (ca.fabs, abs, -0.9),
    "cube": (lambda x: x**3, lambda x: x**3, 0.2),
    "power": (lambda x: x**1.5, lambda x: x ** mpmath.mpf(1.5), 1.1),
}


def forms(centre, slopes, bends):
    return inputs([arb(x) for x in centre], arb_mat(slopes.tolist()), [arb_mat(each.tolist()) for each in bends])


def holds(ball, value):
    return abs(ball - arb(mpmath.nstr(value, 35))).lower() <= arb(10) ** -30


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("size", [1e-3, 0.05])
def test_an_expansion_holds_the_function_of_what_it_holds(name, size, rng):
    symbolic, exact, centre = FUNCTIONS[name]
    x = ca.SX.sym("x", 2)
    tape = record(ca.Function("f", [x], [symbolic(x[0]) * x[1] + x[1]]), EXPANSIONS)
    slopes, bends = rng.normal(size=(2, 3)) * size, rng.normal(size=(2, 3, 3)) * size**2
    with flint.ctx.workprec(80), mpmath.workdps(40):
        (found,) = tape(forms([centre, 1.3], slopes, bends))[0]
        for e in rng.uniform(-1, 1, size=(40, 3)):
            a, b = (
                mpmath.mpf(c) + mpmath.fdot(s, e) + mpmath.fsum(mpmath.mpf(Q[i, j]) * e[i] * e[j] for i in range(3) for j in range(3))
                for c, s, Q in zip([centre, 1.3], slopes, bends, strict=True)
            )  # fmt: skip
            value = exact(a) * b + b
            at = found.c + sum((found.a[0, k] * e[k] for k in range(3)), arb(0)) + found.r
            at += sum((found.Q[i, j] * e[i] * e[j] for i in range(3) for j in range(3)), arb(0))
            assert holds(at, value)
            assert holds(found.ball, value)


def test_the_angle_is_expanded_in_every_quadrant_and_is_no_number_where_it_jumps():
    x = ca.SX.sym("x", 2)
    tape = record(ca.Function("f", [x], [ca.atan2(x[1], x[0])]), EXPANSIONS)
    for angle in np.linspace(-3, 3, 7):
        centre = [np.cos(angle), np.sin(angle)]
        (found,) = tape(forms(centre, 0.02 * np.eye(2), np.zeros((2, 2, 2))))[0]
        assert found.ball.contains(arb.atan2(arb(centre[1] + 0.01), arb(centre[0] - 0.02)))
    (found,) = tape(forms([-1.0, 0.0], 0.02 * np.eye(2), np.zeros((2, 2, 2))))[0]
    assert not found.ball.is_finite()


def test_what_is_left_over_is_of_third_order(observed_order):
    x = ca.SX.sym("x", 2)
    tape = record(ca.Function("f", [x], [ca.sin(x[0]) / ca.sqrt(x[1]) * x[0]]), EXPANSIONS)

    def rest(size):
        (found,) = tape(forms([0.4, 1.2], size * np.array([[1.0, 0.3], [-0.2, 0.5]]), np.zeros((2, 2, 2))))[0]
        return float(abs(found.r).upper())

    assert observed_order(rest, 0.01) == pytest.approx(3, abs=0.1)


def test_matrices_of_expansions_hold_products_inverses_and_means(rng):
    centre = np.array([[2.0, 0.3], [-0.4, 1.5]])
    slopes, bends = rng.normal(size=(4, 2)) * 0.05, rng.normal(size=(4, 2, 2)) * 0.003
    form = arrange(forms(centre.ravel(order="F"), slopes, bends), 2, 2, 2)
    product, inverse = form * form.turned(), form.inverse()
    mean = form.mean(Weights(2, 0.5, 0.34))
    for e in rng.uniform(-1, 1, size=(30, 2)):

        def matrix(t, e=e):
            values = centre.ravel(order="F") + slopes @ (t * e) + np.einsum("kij,i,j->k", bends, t * e, t * e)
            return values.reshape(2, 2, order="F")

        X = matrix(1.0)
        average = np.mean([matrix(t) for t in (np.arange(2000) + 0.5) / 2000], axis=0)
        for ball, value in ((product.whole, X @ X.T), (inverse.whole, np.linalg.inv(X)), (mean, average)):
            for i, j in np.ndindex(2, 2):
                assert abs(ball[i, j] - value[i, j]).lower() < 1e-7  # the mean is a sum of 2000 terms


def test_a_matrix_that_may_be_singular_has_no_inverse():
    form = arrange(forms([0.1], np.array([[0.2]]), np.zeros((1, 1, 1))), 1, 1, 1)
    with pytest.raises(ZeroDivisionError):
        form.inverse()
    assert constant(2.0).ball == 2
