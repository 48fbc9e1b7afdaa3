"""A point of the surface, proven by Krawczyk's operator, against Newton with 60 digits."""

import itertools
from types import SimpleNamespace

import casadi as ca
import flint
import mpmath as mp
import numpy as np
import pytest
from flint import arb
from tests.certificate.exactly import DIGITS, digits, holds, matrix, matrix_holds

from firmtouch.certificate.surface import NoRootError, Surface
from firmtouch.regulation import split_directions

BITS = [53, 64, 128, 256]


@pytest.fixture(scope="session")
def surface(op):
    return Surface(op.plant, op.q_d)


def newton(op, start=None):
    """Solve Phi(q) = 0, V2^T (q - q_d) = 0 with 60 digits."""
    n, m, functions = op.n, op.m, op.plant.functions
    p, V2 = op.plant.p.tolist(), matrix(split_directions(op.J).V2)
    with mp.workdps(DIGITS):
        q_d = matrix(op.q_d).T
        q = q_d.copy() if start is None else mp.matrix(start)
        for _ in range(12):
            F, slope = mp.zeros(n, 1), mp.zeros(n)
            for i, each in enumerate(digits(functions["Phi"], list(q), p)):
                F[i] = each
            for k, each in enumerate(digits(functions["J"], list(q), p)):
                slope[k % m, k // m] = each
            F[m:n, 0] = V2.T * (q - q_d)
            slope[m:n, :] = V2.T
            step = mp.lu_solve(slope, F)
            q -= step
            if mp.norm(step) < mp.mpf(10) ** (5 - DIGITS):
                return q
    raise AssertionError("Newton does not converge")


@pytest.mark.parametrize("bits", BITS)
def test_the_ball_holds_the_root_and_the_distance_is_a_bound(op, surface, bits):
    with flint.ctx.workprec(bits):
        point = surface.root()
    true = newton(op)
    assert all(holds(ball, value) for ball, value in zip(point.q, true, strict=True))
    with mp.workdps(DIGITS):
        far = max(abs(a - mp.mpf(b)) for a, b in zip(true, op.q_d.tolist(), strict=True))
        assert far * (1 - mp.mpf(10) ** -30) <= mid(point.distance)
    assert point.distance < 1e-12
    radius = max(float(each.rad()) for each in point.q)
    assert radius < 2.0 ** (16 - bits)


def test_more_bits_give_smaller_balls_within_one_another(surface):
    found = []
    for bits in (64, 128, 256):
        with flint.ctx.workprec(bits):
            found.append(surface.root().q)
    for wide, narrow in itertools.pairwise(found):
        assert all(a.overlaps(b) for a, b in zip(wide, narrow, strict=True))
        assert all(b.rad() <= a.rad() for a, b in zip(wide, narrow, strict=True))


def test_the_jacobian_is_enclosed_at_the_root(op, surface):
    with flint.ctx.workprec(64):
        J = surface.J(surface.root().q)
    values = digits(op.plant.functions["J"], list(newton(op)), op.plant.p.tolist())
    true = mp.matrix([[values[i + op.m * j] for j in range(op.n)] for i in range(op.m)])
    assert matrix_holds(J, true)


def mid(ball):
    with mp.workdps(DIGITS), flint.ctx.workprec(400):
        return mp.mpf(ball.mid().str(80, radius=False))


@pytest.mark.parametrize("off", [1e-3, 0.02])
def test_a_start_off_the_surface_leads_to_a_root_with_its_distance(op, off):
    """What is proven is a root and how far it is, not that it is near."""
    moved = op.q_d + off
    with flint.ctx.workprec(128):
        point = Surface(op.plant, moved).root()
    q = [mid(each) for each in point.q]
    assert max(abs(each) for each in digits(op.plant.functions["Phi"], q, op.plant.p.tolist())) < 1e-30
    with mp.workdps(DIGITS):
        far = max(abs(a - mp.mpf(b)) for a, b in zip(q, moved.tolist(), strict=True))
        assert far * (1 - mp.mpf(10) ** -30) < mid(point.distance) < far * 1.001


def curve(expression, q):
    """Make a surface of a curve in the plane, at any point."""
    z, p = ca.SX.sym("z", 2), ca.SX.sym("p", 1)
    value = expression(z[0], z[1])
    functions = {
        "Phi": ca.Function("Phi", [z, p], [value]),
        "J": ca.Function("J", [z, p], [ca.densify(ca.jacobian(value, z))]),
    }
    slope = np.nan_to_num(functions["J"](q, 0).full(), nan=1.0, posinf=1.0)
    plant = SimpleNamespace(n=2, m=1, p=np.zeros(1), functions=functions, J=lambda _: slope)
    return Surface(plant, np.array(q))


# Points in the plane, on curves that have no root there, or none that is certain.
NOWHERE = {
    "no root at all": (lambda x, y: y**2 + x**2 + 0.01, (0.1, 0.2)),
    "none in this direction": (lambda x, y: 1 + y**2 * ca.exp(x), (0.0, 1.0)),
    "a double root nearby": (lambda x, y: y**2, (0.3, 1e-9)),
    "a double root, where one starts": (lambda x, y: (y - x) ** 2, (0.25, 0.25)),
    "roots that are a hair away from being": (lambda x, y: y**2 + 1e-14, (0.3, 1e-7)),
    "a pole": (lambda x, y: 1 / y, (0.3, 0.5)),
    "a root's end": (lambda x, y: ca.sqrt(y), (0.3, 0.0)),
    "a kink": (lambda x, y: ca.fabs(y - 0.25), (0.3, 0.25)),
    "a jump": (lambda x, y: ca.atan2(y, x) - 3.141592653589793, (-0.5, 0.0)),
    "no slope": (lambda x, y: 0 * y + 1, (0.3, 0.5)),
}


@pytest.mark.parametrize("bits", BITS)
@pytest.mark.parametrize("name", NOWHERE)
def test_no_root_is_proven_where_there_is_none(name, bits):
    expression, q = NOWHERE[name]
    with flint.ctx.workprec(bits), pytest.raises(NoRootError):
        curve(expression, q).root()


def test_a_jump_between_the_values_is_not_a_root():
    """pi, rounded upwards, is taken nowhere, although the slope of the angle says that it were, beyond the jump."""
    beyond = float(np.nextafter(np.pi, 4))
    for bits in BITS:
        with flint.ctx.workprec(bits), pytest.raises(NoRootError):
            curve(lambda x, y: ca.atan2(y, x) - beyond, (-0.5, 1e-16)).root()


def test_two_roots_within_rounding_are_told_apart_by_bits_alone():
    """y^2 = 1e-40: the box around one of them never holds the other."""
    roots = arb("1e-20", "1e-50"), arb("-1e-20", "1e-50")
    for bits in BITS:
        with flint.ctx.workprec(bits):
            try:
                point = curve(lambda x, y: y**2 - 1e-40, (0.3, 1.1e-20)).root()
            except NoRootError:
                assert bits < 128
                continue
        assert point.q[1].overlaps(roots[0])
        assert not point.q[1].overlaps(roots[1])


def test_the_point_is_the_one_in_the_direction_of_the_normal():
    """The unit circle from (0.6, 0.8) moved outwards: the root is the foot on the ray, known in closed form."""
    surface = curve(lambda x, y: ca.sqrt(x**2 + y**2) - 1, (0.75, 1.0))
    with flint.ctx.workprec(128):
        point = surface.root()
    assert point.distance < arb("0.2000000000000001")
    assert point.distance > arb("0.1999999999999999")
    for ball, value in zip(point.q, (0.6, 0.8), strict=True):
        assert abs(float(ball.mid()) - value) < 1e-15


def test_an_exact_root_has_hardly_a_distance():
    surface = curve(lambda x, y: y - 0.25, (0.5, 0.25))
    with flint.ctx.workprec(64):
        assert surface.root().distance < 1e-15
