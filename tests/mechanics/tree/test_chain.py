"""A chain of rods against its closed form in absolute angles."""

import math

import casadi as ca
import numpy as np
import pytest

from firmtouch.errors import InputError
from firmtouch.mechanics.tree import mass_matrix, planar_chain, theta

LENGTH, MASS, G = 0.7, 1.3, 9.81
ROUNDING = 1e-12  # of the largest entry; thirty links are some ten thousand operations, which leave some 1e-15


def closed_form(n, q, qdot):
    """Lagrange by hand: with a_i the angle of rod i to the x axis, and q_i that to the rod before.

    Rod k > i passes l (-sin a_i, cos a_i) a_i' on whole, rod i itself half of it at its centre.
    """
    L = np.tril(np.ones((n, n)))
    a, rate = L @ q, L @ qdot
    beyond = np.array([[n - 1 - max(i, j) + (1 / 3 if i == j else 1 / 2) for j in range(n)] for i in range(n)])
    C = MASS * LENGTH**2 * beyond
    M = C * np.cos(a[:, None] - a)
    weight = MASS * G * LENGTH * (n - 1 - np.arange(n) + 1 / 2) * np.cos(a)
    return L.T @ M @ L, L.T @ ((C * np.sin(a[:, None] - a)) @ rate**2 + weight)


@pytest.mark.parametrize("n", [1, 2, 5, 30])
def test_mass_matrix_and_theta(n, rng):
    tree = planar_chain(n, length=LENGTH, mass=MASS)
    q, qdot = ca.SX.sym("q", n), ca.SX.sym("qdot", n)
    f = ca.Function("f", [q, qdot], [ca.densify(mass_matrix(tree, q)), theta(tree, q, qdot)])
    for x, v in rng.normal(size=(5, 2, n)):
        for got, wanted in zip(f(x, v), closed_form(n, x, v), strict=True):
            np.testing.assert_allclose(
                got.full().reshape(wanted.shape), wanted, rtol=0, atol=ROUNDING * np.abs(wanted).max()
            )


def test_frames(say):
    tree = planar_chain(3, length=LENGTH, mass=MASS)
    assert list(tree.frames) == ["link1", "link2", "link3", "tip"]
    assert [each.name for each in tree.coordinates] == ["q1", "q2", "q3"]
    p = say.functions(tree).p([math.pi / 2, -math.pi / 2, math.pi / 2])  # up, along x, up
    np.testing.assert_allclose(p, [LENGTH, 2 * LENGTH, 0], atol=1e-15)


def test_operations_grow_with_the_square_of_the_links_at_most():
    def operations(n):
        q, qdot = ca.SX.sym("q", n), ca.SX.sym("qdot", n)
        tree = planar_chain(n, length=LENGTH, mass=MASS)
        return [
            ca.Function("f", [q, qdot], [each]).n_instructions()
            for each in (mass_matrix(tree, q), theta(tree, q, qdot))
        ]

    small, large = operations(8), operations(16)
    assert large[0] < 4.5 * small[0]  # M has n^2 entries
    assert large[1] < 2.2 * small[1]  # theta is one walk along the chain


@pytest.mark.parametrize(
    ("n", "options", "word"),
    [
        (0, {}, "0 links"),
        (101, {}, "1 to 100"),
        (2, {"length": 0.0}, "length"),
        (2, {"mass": -1.0}, "mass"),
        (2, {"mass": math.nan}, "mass"),
        (2, {"gravity": math.inf}, "gravity"),
    ],
)
def test_impossible_chains_are_refused(n, options, word):
    with pytest.raises(InputError, match=word):
        planar_chain(n, **({"length": LENGTH, "mass": MASS} | options))
