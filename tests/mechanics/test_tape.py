"""Tapes: CasADi's instructions in another arithmetic give what CasADi gives."""

import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.certificate.exactly import DIGITAL, digits

from firmtouch.mechanics import intervals
from firmtouch.mechanics.balls import BALLS
from firmtouch.mechanics.tape import Arithmetic, UnknownOperationError, record
from firmtouch.modelfile.expression.functions import SCALAR

FLOATS = Arithmetic(
    float,
    {
        ca.OP_ADD: lambda x, y: x + y,
        ca.OP_SUB: lambda x, y: x - y,
        ca.OP_MUL: lambda x, y: x * y,
        ca.OP_DIV: lambda x, y: x / y,
        ca.OP_NEG: lambda x: -x,
        ca.OP_SQ: lambda x: x * x,
        ca.OP_TWICE: lambda x: 2 * x,
        ca.OP_SIN: math.sin,
        ca.OP_COS: math.cos,
    },
)
LAST_DIGITS = 1e-13  # of sums in another order, and of two libraries' sines


def test_inputs_constants_and_outputs_have_their_places():
    x, y = ca.SX.sym("x", 2), ca.SX.sym("y", 1, 2)
    first = ca.vertcat(x[1], 3.25, y[0, 1])
    second = ca.horzcat(ca.vertcat(x[0], x[0] * y[0, 0]), ca.vertcat(7, x[1] - 0.5))
    tape = record(ca.Function("f", [x, y], [first, second]), FLOATS)
    assert tape([2.0, 3.0], [5.0, 11.0]) == ([3.0, 3.25, 11.0], [2.0, 10.0, 7.0, 2.5])  # by columns
    assert tape.lengths == (3, 4)


def test_an_entry_that_is_never_stored_is_zero():
    x = ca.SX.sym("x")
    tape = record(ca.Function("f", [x], [ca.densify(ca.vertcat(ca.SX(1, 1), x))]), FLOATS)
    assert tape([4.0]) == ([0.0, 4.0],)


def test_a_sparse_output_lists_its_entries_only():
    x = ca.SX.sym("x")
    tape = record(ca.Function("f", [x], [ca.diag(ca.vertcat(x, 2 * x))]), FLOATS)
    assert tape.lengths == (2,)
    assert tape([4.0]) == ([4.0, 8.0],)


def test_registers_that_are_used_again_do_not_mix():
    """Far more intermediate values than CasADi has registers, all of them needed."""
    x = ca.SX.sym("x")
    terms = [x]
    for k in range(60):
        terms.append(ca.sin(terms[-1]) * (k + 1) + terms[k // 2])
    function = ca.Function("f", [x], [ca.vertcat(*terms[::-1])])
    assert function.sz_w() < function.n_instructions()
    (values,) = record(function, FLOATS)([0.7])
    assert values == pytest.approx(function(0.7).full().ravel().tolist(), rel=1e-9)


def test_a_tape_can_be_played_again_and_does_not_remember():
    x = ca.SX.sym("x")
    tape = record(ca.Function("f", [x], [x * x + 1]), FLOATS)
    assert [tape([each])[0][0] for each in (1.0, 2.0, 1.0)] == [2.0, 5.0, 2.0]


def test_an_operation_that_an_arithmetic_does_not_know_is_named():
    x = ca.SX.sym("x")
    with pytest.raises(UnknownOperationError, match=r"^OP_ERF$"):
        record(ca.Function("f", [x], [ca.erf(x)]), BALLS)
    with pytest.raises(UnknownOperationError, match=r"^OP_FLOOR$"):
        record(ca.Function("f", [x], [ca.floor(x)]), BALLS)


def test_balls_and_intervals_know_the_same_operations():
    assert set(BALLS.operations) == set(intervals._interval_operations()) == set(DIGITAL.operations)


@pytest.mark.parametrize("name", SCALAR)
def test_balls_know_every_function_of_a_model_file_and_its_derivatives(name):
    x = ca.SX.sym("x", SCALAR[name])
    value = getattr(ca, name)(*ca.vertsplit(x))
    hessian, gradient = ca.hessian(value, x)
    third = ca.jacobian(ca.vec(hessian), x)
    record(ca.Function("f", [x], [value, gradient, hessian, third, ca.jacobian(ca.vec(third), x)]), BALLS)


@pytest.mark.parametrize("which", ["M", "J", "Phi", "P_q", "P_qq", "Phi_qq"])
def test_shipped_models_have_the_values_of_casadi(plant, place, which, rng):
    function = plant.functions[which]
    for _ in range(2):
        q = place + 0.05 * rng.normal(size=plant.n)
        values = digits(function, q.tolist(), plant.p.tolist())
        dense = np.zeros(function.numel_out(0))
        dense[np.array(function.sparsity_out(0).find(), dtype=int)] = [float(each) for each in values]
        found = function(q, plant.p).full().ravel(order="F")
        assert dense == pytest.approx(found, rel=LAST_DIGITS, abs=LAST_DIGITS * max(1, np.abs(found).max()))


@given(st.lists(st.floats(-10, 10), min_size=3, max_size=3))
def test_a_polynomial_is_what_it_is(values):
    x = ca.SX.sym("x", 3)
    function = ca.Function("f", [x], [(x[0] - x[1]) * x[2] - (x[0] * x[0] + 2 * x[1]) / 4])
    a, b, c = values
    ((found,),) = record(function, FLOATS)(values)
    assert found == pytest.approx((a - b) * c - (a * a + 2 * b) / 4, rel=LAST_DIGITS, abs=LAST_DIGITS)
