"""The truth that certificates are held against: mpmath with 60 digits, from the exact binary64 numbers."""

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import flint
import mpmath as mp
import numpy as np
from flint import arb, arb_mat
from tests.synthesis.region_plants import UNITS, point_of

from firmtouch.certificate.asked import Asked, Causes
from firmtouch.certificate.matrices import exact
from firmtouch.certificate.plants import NOMINAL, PlantBalls
from firmtouch.certificate.subject import Subject
from firmtouch.certificate.surface import SurfacePoint
from firmtouch.mechanics.arrays import frozen
from firmtouch.mechanics.tape import Arithmetic, record
from firmtouch.regulation import Gains

DIGITS = 60
ROUNDED = mp.mpf(10) ** -50
"""How far 60 digits may be off after a few hundred operations, relatively."""
BITS = 400
"""What holds 60 digits exactly."""


class NoValueError(ValueError):
    """The operation has no real value there."""


def _real(operation):
    def call(*arguments):
        try:
            value = operation(*arguments)
        except (ZeroDivisionError, ValueError) as error:
            raise NoValueError from error
        if not isinstance(value, mp.mpf) or not mp.isfinite(value):
            raise NoValueError
        return value

    return call


def _atan2(y, x):
    if y == 0 and x <= 0:
        raise NoValueError
    return mp.atan2(y, x)


def _sign(x):
    if x == 0:
        raise NoValueError
    return mp.sign(x)


OPERATIONS = {
    ca.OP_ASSIGN: lambda x: x,
    ca.OP_ADD: lambda x, y: x + y,
    ca.OP_SUB: lambda x, y: x - y,
    ca.OP_MUL: lambda x, y: x * y,
    ca.OP_DIV: lambda x, y: x / y,
    ca.OP_INV: lambda x: 1 / x,
    ca.OP_NEG: lambda x: -x,
    ca.OP_SQ: lambda x: x * x,
    ca.OP_TWICE: lambda x: x + x,
    ca.OP_POW: mp.power,
    ca.OP_CONSTPOW: mp.power,
    ca.OP_SQRT: mp.sqrt,
    ca.OP_EXP: mp.exp,
    ca.OP_LOG: mp.log,
    ca.OP_SIN: mp.sin,
    ca.OP_COS: mp.cos,
    ca.OP_TAN: mp.tan,
    ca.OP_ASIN: mp.asin,
    ca.OP_ACOS: mp.acos,
    ca.OP_ATAN: mp.atan,
    ca.OP_ATAN2: _atan2,
    ca.OP_SINH: mp.sinh,
    ca.OP_COSH: mp.cosh,
    ca.OP_TANH: mp.tanh,
    ca.OP_FABS: lambda x: _sign(x) * x,
    ca.OP_SIGN: _sign,
    ca.OP_LT: lambda x, y: mp.mpf(x < y),
}
DIGITAL = Arithmetic(mp.mpf, {code: _real(each) for code, each in OPERATIONS.items()})
"""CasADi's operations in mpmath, at the digits of the moment."""


def digits(function, *inputs):
    """Evaluate a CasADi function with 60 digits; gives the entries of its first output by columns."""
    with mp.workdps(DIGITS):
        return record(function, DIGITAL)(*([mp.mpf(each) for each in entries] for entries in inputs))[0]


def ball_of(value, slack=ROUNDED):
    """Enclose a value of 60 digits."""
    with flint.ctx.workprec(BITS), mp.workdps(DIGITS):
        return arb(value, arb((1 + abs(value)) * slack))


def holds(ball, value, slack=ROUNDED):
    """Tell whether a ball holds a value that is known to 60 digits."""
    return ball.is_finite() and ball.overlaps(ball_of(value, slack))


def matrix(values):
    """Take floats as they are."""
    return values if isinstance(values, mp.matrix) else mp.matrix(np.atleast_2d(values).tolist())


def matrix_holds(balls, values, slack=ROUNDED):
    """Tell whether a matrix of balls holds one of 60 digits."""
    rows, columns = balls.nrows(), balls.ncols()
    assert (values.rows, values.cols) == (rows, columns)
    return all(holds(balls[i, j], values[i, j], slack) for i in range(rows) for j in range(columns))


def eigenvalues(X):
    """Give the eigenvalues of a symmetric matrix, ascending."""
    with mp.workdps(DIGITS):
        return list(mp.eigsy(X, eigvals_only=True))


def kernel(J):
    """Give a basis of ker J from the exact J, by elimination with the largest columns first."""
    J = np.atleast_2d(J)
    m, n = J.shape
    with mp.workdps(2 * DIGITS):
        rows, order = [[mp.mpf(x) for x in row] for row in J.tolist()], list(range(n))
        for i in range(m):
            best = max(range(i, n), key=lambda j: abs(rows[i][order[j]]))
            order[i], order[best] = order[best], order[i]
            pivot = rows[i][order[i]]
            rows[i] = [x / pivot for x in rows[i]]
            for k in range(m):
                if k != i:
                    factor = rows[k][order[i]]
                    rows[k] = [a - factor * b for a, b in zip(rows[k], rows[i], strict=True)]
        X = mp.zeros(n, n - m)
        for column, free in enumerate(order[m:]):
            X[free, column] = mp.mpf(1)
            for i in range(m):
                X[order[i], column] = -rows[i][free]
        return X


def orthonormal(X):
    """Orthonormalise the columns."""
    with mp.workdps(2 * DIGITS):
        L = mp.cholesky(X.T * X)
        return X * mp.inverse(L).T


def pivots(X):
    """Give D of X = L D L^T as far as it goes: until a pivot is not positive."""
    n, found = X.rows, []
    rows = [[X[i, j] for j in range(i + 1)] for i in range(n)]
    for k in range(n):
        pivot = rows[k][k]
        found.append(pivot)
        if pivot <= 0:
            break
        for i in range(k + 1, n):
            factor = rows[i][k] / pivot
            for j in range(k + 1, i + 1):
                rows[i][j] -= factor * rows[j][k]
    return found


def is_positive(X, shift=0):
    """Tell whether X - shift I is positive definite."""
    with mp.workdps(DIGITS):
        return pivots(X - shift * mp.eye(X.rows))[-1] > 0


def characteristic(M, C, K):
    """Give det(s^2 M + s C + K), its coefficients from the constant one on."""
    t = M.rows

    def product(a, b):
        found = [mp.mpf(0)] * (len(a) + len(b) - 1)
        for i, x in enumerate(a):
            for j, y in enumerate(b):
                found[i + j] += x * y
        return found

    def determinant(rows, columns):
        if not rows:
            return [mp.mpf(1)]
        total = [mp.mpf(0)] * (2 * len(rows) + 1)
        for k, j in enumerate(columns):
            i = rows[0]
            minor = determinant(rows[1:], columns[:k] + columns[k + 1 :])
            for power, each in enumerate(product([K[i, j], C[i, j], M[i, j]], minor)):
                total[power] += -each if k % 2 else each
        return total

    return determinant(list(range(t)), list(range(t)))


def roots(p):
    """Refine NumPy's roots of a real polynomial (from the constant coefficient on) by Newton to 60 digits.

    That all are found, each once, is seen from their sum and product.
    """
    with mp.workdps(2 * DIGITS):
        p = [each / p[-1] for each in p]
        slope, found = [k * each for k, each in enumerate(p)][1:], []
        for start in np.roots([float(each) for each in p[::-1]]):
            s = mp.mpc(start)
            for _ in range(60):
                step = mp.polyval(p[::-1], s) / mp.polyval(slope[::-1], s)
                s -= step
                if abs(step) <= mp.mpf(10) ** -DIGITS * abs(s):
                    break
            found.append(s)
        size = max(1, *(abs(s) for s in found))
        assert abs(mp.fsum(found) + p[-2]) < mp.mpf(10) ** -40 * size
        assert abs(mp.fprod(found) * (-1) ** len(found) - p[0]) < mp.mpf(10) ** -40 * size ** len(found)
        return found


def poles(M, J, C, K):
    """Give the poles of (38), with 60 digits, from exact matrices."""
    with mp.workdps(2 * DIGITS):
        X = kernel(J)
        return roots(characteristic(*(X.T * matrix(each) * X for each in (M, C, K))))


class BareSurface:
    """A flat surface through q_d = 0, known exactly."""

    def __init__(self, op):
        self.q_d, self._J = exact(np.zeros(op.n)), exact(op.J)

    def J(self, q):
        return self._J

    def root(self):
        return SurfacePoint([arb(0)] * self.q_d.nrows(), arb(0))


class BarePlants:
    """Plants that are known exactly: pairs (M, N0), the nominal one first."""

    def __init__(self, op, pairs):
        self._g, self._pairs = exact(op.g), [(exact(M), exact(N0)) for M, N0 in pairs]
        self.vary = len(pairs) > 1

    def at(self, q):
        nominal, *others = (PlantBalls(NOMINAL if i == 0 else f"v{i}", *each) for i, each in enumerate(self._pairs))
        return nominal, tuple(others) or (nominal,)

    def gradient(self, q):
        return self._g


@dataclass(frozen=True)
class BareSubject(Subject):
    """A subject without a mechanism: M, J and N0 are floats, and exactly these; `vertices` are pairs (M, N0)."""

    vertices: tuple = ()

    @cached_property
    def surface(self):
        return BareSurface(self.op)

    @cached_property
    def plants(self):
        return BarePlants(self.op, [(self.op.M, self.op.N0), *self.vertices])


def asked_for(n, m, *, level="full", mu=0.0, D=None, edges=()):
    """Ask for positivity and edges, with causes of size one."""
    causes = Causes(frozen(np.ones(n)), frozen(np.ones(m)), 1.0, 1.0)
    D = frozen(np.ones(n) if D is None else D)
    return Asked(level, mu, D, tuple(edges), causes, None, {}, None, UNITS)


def bare(M, J, N0, W, C, *, G_f=None, lambda_d=None, vertices=(), witness=None, **asked):
    """Make a subject from matrices alone."""
    op = point_of(M, J, N0, lambda_d=lambda_d)
    gains = Gains(frozen(W), frozen(C), frozen(0.5 * np.eye(op.m) if G_f is None else G_f), frozen(op.g - op.f_d))
    more = {} if witness is None else {"witness": witness}
    return BareSubject(op, gains, asked_for(op.n, op.m, **asked), vertices=tuple(vertices), **more)


def box_of(centre, radius):
    """Make balls from floats."""
    return [
        arb(a, b)
        for a, b in zip(np.ravel(centre).tolist(), np.broadcast_to(radius, np.size(centre)).tolist(), strict=True)
    ]


def point_in(centre, radius, place):
    """Give the point of a box at `place`, with entries in [-1, 1]."""
    with mp.workdps(DIGITS):
        radius = np.broadcast_to(radius, np.size(centre)).tolist()
        return [
            mp.mpf(a) + mp.mpf(b) * mp.mpf(t) for a, b, t in zip(np.ravel(centre).tolist(), radius, place, strict=True)
        ]


def random_balls(rng, n, size=1.0, radius=0.0):
    """Draw a symmetric matrix of balls with its midpoints."""
    X = rng.normal(size=(n, n)) * size
    X = X + X.T
    return X, arb_mat(n, n, [arb(x, radius) for x in X.ravel().tolist()])
