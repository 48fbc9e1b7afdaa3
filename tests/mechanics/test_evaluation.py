"""Evaluators against ordinary calls: the same numbers in the same places, whatever the shapes."""

import pickle

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmtouch.mechanics.evaluation import build_evaluator

sizes = st.integers(0, 4)


@given(st.lists(st.tuples(sizes, sizes), min_size=1, max_size=3), st.integers(0, 2**16))
def test_all_shapes(shapes, seed):
    rng = np.random.default_rng(seed)
    inputs = [ca.SX.sym(f"a{i}", *shape) for i, shape in enumerate(shapes)]
    outputs = [*(2 * each for each in inputs), *(each.T for each in inputs), ca.vertcat(*map(ca.vec, inputs))]
    outputs += [ca.diag(outputs[-1]), ca.SX(3, 2), ca.triu(ca.SX(ca.DM.ones(3, 3)))]  # sparse, empty, constant
    function = ca.Function("f", inputs, outputs)
    evaluator = build_evaluator(function)
    for _ in range(2):  # nothing of the first call may stay in the second
        values = [rng.normal(size=shape) for shape in shapes]
        given_ = [each[:, 0] if each.shape[1] == 1 else each for each in values]
        for mine, other in zip(evaluator(*given_), function.call(values), strict=True):
            np.testing.assert_array_equal(mine, other.full())


@pytest.fixture
def evaluator():
    q, qdot = ca.SX.sym("q", 3), ca.SX.sym("qdot", 3)
    return build_evaluator(ca.Function("f", [q, qdot], [q @ qdot.T, ca.sin(q)]))


def test_results_are_the_memory_and_copies_are_not(evaluator):
    kept, copied = evaluator([1, 2, 3], [0, 1, 0])[0], evaluator.copies([1, 2, 3], [0, 1, 0])[0]
    evaluator([4, 5, 6], [1, 0, 0])
    np.testing.assert_array_equal(kept, np.outer([4, 5, 6], [1, 0, 0]))
    np.testing.assert_array_equal(copied, np.outer([1, 2, 3], [0, 1, 0]))
    copied[0, 0] = 7.0  # whose copy it is may write
    with pytest.raises(ValueError, match="read-only"):
        kept[0, 0] = 7.0


@pytest.mark.parametrize(
    "values", [([1, 2, 3],), ([1, 2, 3], [1, 2, 3], [1, 2, 3]), ([1, 2], [1, 2, 3]), (np.ones((3, 3)), 1)]
)
def test_wrong_values_are_refused(evaluator, values):
    with pytest.raises(ValueError, match=r"argument|broadcast"):
        evaluator(*values)


def test_a_pickled_one_has_memory_of_its_own(evaluator):
    first = evaluator([1, 2, 3], [1, 1, 1])[1]
    other = pickle.loads(pickle.dumps(evaluator))
    other([0, 0, 0], [0, 0, 0])
    np.testing.assert_array_equal(first[:, 0], np.sin([1, 2, 3]))


def test_it_keeps_what_it_stands_on_alive():
    """The function, its buffer and the arrays go out of sight; only the evaluator is left."""

    def make():
        x = ca.SX.sym("x", 50)
        return build_evaluator(ca.Function("f", [x], [ca.cumsum(x)]))

    many = [make() for _ in range(50)]
    for each in many:
        np.testing.assert_array_equal(each(np.ones(50))[0][:, 0], np.arange(1, 51))
