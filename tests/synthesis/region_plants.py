"""Plants of no mechanism and region problems about them, for the tests of the search; drawn alike in every process."""

from types import SimpleNamespace

import numpy as np
import scipy.linalg
import scipy.optimize

from firmtouch.mechanics.arrays import frozen, symmetric
from firmtouch.modelfile.sections.design import NormalBlocks
from firmtouch.modelfile.sections.structure import Structure
from firmtouch.modelfile.vector_units import Units
from firmtouch.regulation import Gains, OperatingPoint, split_directions
from firmtouch.regulation.uncertainty import Polytope, Vertex, vertex_point
from firmtouch.synthesis.normal_blocks import damping_blocks, stiffness_blocks
from firmtouch.synthesis.region.coordinates import scale
from firmtouch.synthesis.region.problem import RegionProblem, _range, reference_frequency
from firmtouch.synthesis.region.terms.bandwidth import Bandwidth
from firmtouch.synthesis.region.terms.damping import Damping
from firmtouch.synthesis.region.terms.decay import Decay
from firmtouch.synthesis.region.terms.positivity import Positivity

UNITS = Units("rad", "N m", "N m/rad", "N m s/rad", "m", "N")


def draw_symmetric(rng, n, size=1.0):
    X = rng.normal(size=(n, n)) * size / 2
    return X + X.T


def draw_positive(rng, n, low, high):
    turn, _ = np.linalg.qr(rng.normal(size=(n, n)))
    return turn @ np.diag(rng.uniform(low, high, n)) @ turn.T


def point_of(M, J, N0=None, *, hessians=None, lambda_d=None):
    """Make an operating point from its matrices alone; P_qq is what N0 and the Hessians leave for it."""
    m, n = np.shape(J)
    N0 = np.zeros((n, n)) if N0 is None else N0
    hessians = np.zeros((m, n, n)) if hessians is None else np.array(hessians)
    lambda_d = np.ones(m) if lambda_d is None else np.array(lambda_d)
    spec = SimpleNamespace(coordinates=dict.fromkeys(range(n)), constraints=dict.fromkeys(range(m)))
    return OperatingPoint(
        plant=SimpleNamespace(n=n, m=m, spec=spec),
        q_d=np.zeros(n),
        lambda_d=lambda_d,
        f_d=np.asarray(J).T @ lambda_d,
        M=symmetric(M),
        J=frozen(J),
        g=np.zeros(n),
        P_qq=symmetric(N0 + np.tensordot(lambda_d, hessians, axes=1)),
        constraint_hessians=frozen(hessians),
        N0=symmetric(N0),
        residual=0.0,
        moved=0.0,
    )


def draw_point(n, m, seed, *, curvature=1.0):
    rng = np.random.default_rng(seed)
    hessians = [draw_symmetric(rng, n, curvature) for _ in range(m)]
    M, J, N0 = draw_positive(rng, n, 0.2, 5), rng.normal(size=(m, n)), draw_symmetric(rng, n, 2 * curvature)
    return point_of(M, J, N0, hessians=hessians, lambda_d=rng.normal(size=m))


def region(decay=None, damping=None, bandwidth=None, *, level="full", n, mu=0.0):
    """List the terms of a pole region, and positivity, which no design is without."""
    terms = [Decay(asked=decay)] if decay is not None else []
    terms += [Damping(asked=damping)] if damping is not None else []
    terms += [Bandwidth(asked=bandwidth)] if bandwidth is not None else []
    return (*terms, Positivity(asked=mu, level=level, D=frozen(np.ones(n))))


def problem_of(
    op, terms, *, vertices=None, structure="full", objective=None, shaped=False, G_f=None, limit=None, disturbance=None
):
    """Pose a region problem without a file; `vertices` are pairs (M, N0), the nominal plant alone if there are none."""
    pairs = [(op.M, op.N0)] if vertices is None else vertices
    corners = tuple(Vertex({"v": float(i)}, (), symmetric(M), symmetric(N0), op.g) for i, (M, N0) in enumerate(pairs))
    polytope = Polytope(corners, {}, None, None, 1.0, 0.0, 0.0, 0.0)
    split = split_directions(op.J)
    omega = reference_frequency(op, split, tuple(terms))
    return RegionProblem(
        op=op,
        polytope=polytope,
        points=tuple(vertex_point(op, each) for each in corners),
        terms=tuple(terms),
        objective=objective or {"gains": 1.0},
        structure=Structure.full(op.n) if structure == "full" else Structure.diagonal(op.n),
        G_f=frozen(0.5 * np.eye(op.m) if G_f is None else G_f),
        feedback_limit=None if limit is None else frozen(limit),
        shaped=shaped,
        disturbance=frozen(np.ones(op.n) if disturbance is None else disturbance),
        units=UNITS,
        scaling=scale(op, split, omega),
        where=_range(tuple(terms), omega),
    )


def companion_poles(M, C, K, V2):
    """Give the poles of (38) for stacked M and K (... x n x n)."""
    M22, K22 = V2.T @ M @ V2, V2.T @ K @ V2
    C22 = np.broadcast_to(V2.T @ C @ V2, K22.shape)
    t = K22.shape[-1]
    lower = -np.linalg.solve(M22, np.concatenate([K22, C22], axis=-1))
    upper = np.broadcast_to(np.hstack([np.zeros((t, t)), np.eye(t)]), (*K22.shape[:-2], t, 2 * t))
    return np.linalg.eigvals(np.concatenate([upper, lower], axis=-2))


def figures(poles):
    """Give decay, damping ratio and bandwidth of the worst pole."""
    return -poles.real.max(), (-poles.real / abs(poles)).min(), abs(poles).max()


def draw_modes(rng, count, low, high):
    """Draw (c, k) of s^2 + c s + k, with both roots of a size between two bounds; half of them complex."""
    c, k = [], []
    for _ in range(count):
        if rng.random() < 0.5:
            size, angle = rng.uniform(low, high), rng.uniform(0, 1.2)
            c.append(2 * size * np.cos(angle))
            k.append(size**2)
        else:
            a, b = rng.uniform(low, high, 2)
            c.append(a + b)
            k.append(a * b)
    return np.array(c), np.array(k)


def assigned(op, rng, low, spread):
    """Assign random poles with random mode shapes and complete the blocks; K22 is above the plant's own stiffness."""
    split = split_directions(op.J)
    M, N0 = split.blocks(op.M), split.blocks(op.N0)
    t = op.n - op.m
    S = np.linalg.cholesky(M.X22).T
    turn, _ = np.linalg.qr(rng.normal(size=(t, t)))
    c, k = draw_modes(rng, t, low, low * spread)
    X = S.T @ turn
    policy = NormalBlocks(margin=0.1)
    K = split.assemble(stiffness_blocks(symmetric((X * k) @ X.T), M, N0, policy))
    C = split.assemble(damping_blocks(symmetric((X * c) @ X.T), M, policy))
    return Gains(symmetric(K - op.N0), symmetric(C), frozen(0.5 * np.eye(op.m)), frozen(op.g - op.f_d))


def around(op, rng, count, size):
    """Draw `count` plants around an operating point, the point itself their mean, within a relative size."""
    half = scipy.linalg.sqrtm(op.M).real
    N = np.linalg.norm(op.N0, 2)
    moves = np.array([[draw_symmetric(rng, op.n) for _ in range(2)] for _ in range(count)])
    moves -= moves.mean(axis=0)
    moves *= size / np.linalg.norm(moves, 2, axis=(-2, -1)).max()
    return [(half @ (np.eye(op.n) + A) @ half, op.N0 + N * B) for A, B in moves]


def full_case(seed, slack=0.1):
    """Draw a plant (every second with 2 to 4 vertices) and the region that a random assigned design meets with slack."""
    for attempt in range(100):
        rng = np.random.default_rng([seed, attempt])
        n = int(rng.integers(2, 8))
        m = int(rng.integers(1, min(3, n - 1) + 1))
        op = point_of(
            draw_positive(rng, n, 0.2, 5), rng.normal(size=(m, n)), draw_symmetric(rng, n, rng.uniform(1, 20))
        )
        V2 = split_directions(op.J).V2
        own = scipy.linalg.eigh(V2.T @ op.N0 @ V2, V2.T @ op.M @ V2, eigvals_only=True)[-1]
        low = np.sqrt(max(1.2 * own, 0.0)) + rng.uniform(1, 4)
        gains = assigned(op, rng, low, rng.uniform(1.2, 5))
        vertices = around(op, rng, int(rng.integers(2, 5)), rng.uniform(0.05, 0.15)) if seed % 2 else None
        plants = vertices or [(op.M, op.N0)]
        if not all(np.linalg.eigvalsh(M)[0] > 0 for M, _ in plants):
            continue
        M, N0 = (np.array(each) for each in zip(*plants, strict=True))
        decay, damping, bandwidth = figures(companion_poles(M, gains.C, gains.W + N0, V2))
        if decay <= 0:
            continue
        problem = problem_of(
            op,
            region(decay * (1 - slack), damping * (1 - slack), bandwidth * (1 + slack), n=n),
            vertices=vertices,
        )
        if problem.audit(gains).holds:
            return problem, gains
    raise AssertionError("no plant was drawn")


def diagonal_plant(seed):
    """Draw a plant and a region that diagonal gains may or may not meet."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 8))
    m = int(rng.integers(1, min(3, n - 1) + 1))
    M, J, N = draw_positive(rng, n, 0.2, 5), rng.normal(size=(m, n)), draw_symmetric(rng, n, 2)
    decay = rng.uniform(1, 6)
    bandwidth, damping = decay * rng.uniform(3, 8), rng.uniform(0.3, 0.75)
    op = point_of(M, J, N * 0.3 * decay**2)
    return problem_of(op, region(decay, damping, bandwidth, n=n), structure="diagonal"), rng


def local_search(problem, rng, tries=12):
    """Look for diagonal gains by Nelder and Mead's method from several starts; gives gains or nothing."""
    op, n = problem.op, problem.op.n
    T = problem.scaling.T
    decay, damping, bandwidth = (each.asked for each in problem.terms[:3])
    N22, t = T.T @ op.N0 @ T, T.shape[1]
    A = np.zeros((2 * t, 2 * t))
    A[:t, t:] = np.eye(t)

    def missed(x):
        gains = np.exp(x)
        A[t:, :t] = -(T.T * gains[:n]) @ T - N22
        A[t:, t:] = -(T.T * gains[n:]) @ T
        s = np.linalg.eigvals(A)
        size = abs(s)
        v = max(
            (s.real.max() + decay) / decay,
            (size.max() - bandwidth) / bandwidth,
            2 * (s.real + damping * size).max() / bandwidth,
        )
        K = op.N0.copy()
        K[np.diag_indices(n)] += gains[:n]
        return max(v, -np.linalg.eigvalsh(K)[0] / bandwidth**2)

    class Enough(Exception):  # noqa: N818
        pass

    def stop(intermediate_result):
        if intermediate_result.fun < -0.02:
            raise StopIteration

    k, c = decay * bandwidth, 2 * np.sqrt(decay * bandwidth) * max(damping, 0.9)
    for _ in range(tries):
        mass = np.log(np.diag(op.M))
        start = np.concatenate(
            [mass + np.log(k) + rng.normal(size=n) * 0.7, mass + np.log(c) + rng.normal(size=n) * 0.5]
        )
        found = scipy.optimize.minimize(
            missed,
            start,
            method="Nelder-Mead",
            callback=stop,
            options={"maxiter": 400 * n, "xatol": 1e-5, "fatol": 1e-7, "adaptive": True},
        )
        if found.fun < -0.01:
            W, C = np.exp(found.x[:n]), np.exp(found.x[n:])
            return problem.gains(np.diag(W), np.diag(C))
    return None
