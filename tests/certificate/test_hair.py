"""Designs that miss what is asked by a hair, and such that do not: no verdict that 60 digits contradict."""

from collections import Counter
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from tests.certificate.exactly import DIGITS, bare, eigenvalues, is_positive, kernel, matrix, orthonormal, poles
from tests.synthesis.region_plants import draw_positive, draw_symmetric

from firmtouch.certificate.claims import poles as pole_claims
from firmtouch.certificate.claims import positivity
from firmtouch.certificate.decision import Verdict
from firmtouch.certificate.edges import Edge, EdgeKind
from firmtouch.certificate.question import settle
from firmtouch.mechanics.arrays import symmetric

HAIR = 1e-12
CLEAR = mp.mpf(10) ** -9
"""Above this true margin, relatively, nothing may stay undecided."""
BARELY_CLEAR = 3e-9
EDGES = {each.name.lower(): each for each in EdgeKind}
KINDS = ("K", "W", "C", "C22", "K22", "still", *EDGES)


def draw(seed):
    """Draw gains and what is asked of them; which eigenvalue is a hair beside its bound, and on which side."""
    rng = np.random.default_rng([seed, 41])
    n = int(rng.integers(2, 6))
    m = int(rng.integers(1, min(2, n - 1) + 1))
    kind, spoilt = KINDS[int(rng.integers(len(KINDS)))], bool(seed % 2)
    clear = not spoilt and bool(rng.integers(2))
    side = -HAIR if spoilt else float(rng.choice([HAIR, BARELY_CLEAR]))
    M, J = draw_positive(rng, n, 0.2, 5), rng.normal(size=(m, n))
    N0 = draw_symmetric(rng, n, 3.0)
    W, C = draw_positive(rng, n, 1, 100), draw_positive(rng, n, 1, 20)
    W = W + np.eye(n) * max(0.0, 1 - np.linalg.eigvalsh(W + N0)[0])  # K > 0 to begin with
    mu = float(rng.choice([0.0, np.exp(rng.uniform(-2, 2))])) if not clear else 0.0
    level = "tangent" if kind in ("C22", "K22", "still") else "full"
    V2 = np.linalg.svd(J)[2][m:].T
    if not clear:
        match kind:
            case "K":
                W = W + moved(W + N0, mu, side)
            case "W":
                W = W + moved(W, 0.0, side)
                N0 = N0 + np.eye(n) * (max(0.0, -np.linalg.eigvalsh(W + N0)[0]) + mu + 1)
            case "C":
                C = C + moved(C, 0.0, side)
            case "C22":
                C = C + V2 @ moved(V2.T @ C @ V2, 0.0, side) @ V2.T
            case "K22":
                W = W + V2 @ moved(V2.T @ (W + N0) @ V2, mu, side) @ V2.T
            case "still":  # one mode with a damping of a hair: a pole on either side of the axis
                W, C = nearly_undamped(M, N0, V2, rng, side)
    W, C, mu = symmetric(W), symmetric(C), 0.0 if kind == "still" else mu
    subject = bare(M, J, N0, W, C, level=level, mu=mu)
    if kind in EDGES:
        edge = EDGES[kind]
        value = reached(poles(subject.op.M, J, C, stiffness_of(subject)), edge)
        if edge is EdgeKind.DAMPING and value == 1:  # all poles are real, and have all the damping there is
            value, side = mp.mpf(0.999), abs(side)
            spoilt = False
        wanted = Edge(edge, float(value * (1 - (0.1 if clear else side) * (1 if edge.relation == ">=" else -1))))
        subject = replace(subject, asked=replace(subject.asked, edges=(wanted,)))
    return subject, kind, spoilt


def stiffness_of(subject):
    with mp.workdps(DIGITS):
        return matrix(subject.gains.W) + matrix(subject.op.N0)


def reached(found, kind):
    """Give what the worst pole reaches."""
    match kind:
        case EdgeKind.DECAY:
            return min(-s.real for s in found)
        case EdgeKind.DAMPING:
            return min(-s.real / abs(s) for s in found)
        case EdgeKind.BANDWIDTH:
            return max(abs(s) for s in found)


def moved(X, value, side):
    """Give what moves the least eigenvalue of X to `side` beside a value, relatively."""
    eigenvalues_, vectors = np.linalg.eigh(X)
    v = vectors[:, 0]
    goal = value + side * (value or np.linalg.norm(X, 2))
    return (goal - eigenvalues_[0]) * np.outer(v, v)


def nearly_undamped(M, N0, V2, rng, side):
    t = V2.shape[1]
    L = np.linalg.cholesky(V2.T @ M @ V2)
    turn, _ = np.linalg.qr(rng.normal(size=(t, t)))
    X = L @ turn
    k, c = rng.uniform(1, 50, t), rng.uniform(1, 10, t)
    c[0] = side * c.max()
    K22, C22 = X @ np.diag(k) @ X.T, X @ np.diag(c) @ X.T
    V1 = np.linalg.svd(V2.T)[2][t:].T
    return V2 @ (K22 - V2.T @ N0 @ V2) @ V2.T + V1 @ V1.T, V2 @ C22 @ V2.T + V1 @ V1.T


def truths(subject, kind):
    """Give for each claim whether it holds, and whether its margin is clear: from the exact floats, with 60 digits."""
    op, gains, asked = subject.op, subject.gains, subject.asked
    with mp.workdps(DIGITS):
        W, C = (matrix(each) for each in (gains.W, gains.C))
        K, Z = stiffness_of(subject), orthonormal(kernel(op.J))
        tangent = {"C": Z.T * C * Z, "K": Z.T * K * Z}
        wanted = {"C tangent": (tangent["C"], 0.0), "K tangent": (tangent["K"], 0.0)}
        if asked.level == "full":
            wanted |= {"C full": (C, 0.0), "W full": (W, 0.0), "K full": (K, asked.mu)}
        else:
            wanted["K tangent"] = (tangent["K"], asked.mu)
        found = {}
        for name, (X, value) in wanted.items():
            size, bound = mp.mnorm(X, "f"), mp.mpf(value)
            signs = [is_positive(X, bound + each * size) for each in (0, CLEAR, -CLEAR)]
            found[name] = signs[0], signs[1] or not signs[2]
        at_stake = {"K": "K full", "W": "W full", "C": "C full", "C22": "C tangent", "K22": "K tangent"}.get(kind)
        if at_stake is not None:  # the same by eigenvalues, which share nothing with pivots
            X, value = wanted[at_stake]
            assert (eigenvalues(X)[0] > value) is found[at_stake][0]
        found_poles = poles(op.M, op.J, gains.C, K)
        (edge,) = asked.edges or (pole_claims.STABLE,)
        size = 1 if edge.kind is EdgeKind.DAMPING else max(abs(s) for s in found_poles)
        margin = (reached(found_poles, edge.kind) - edge.value) * (1 if edge.kind.relation == ">=" else -1)
        for route in ("LMI", "Routh-Hurwitz"):
            found[f"{edge.kind.words}, {route}"] = bool(margin > 0), bool(abs(margin) > CLEAR * size)
    return found


def questions(subject):
    return [*positivity.questions(subject), *pole_claims.questions(subject)]


def look_at(seeds):
    """Settle all claims of some designs, and hold them against the truth."""
    count = Counter()
    for seed in seeds:
        subject, kind, spoilt = draw(seed)
        true, certified = truths(subject, kind), True
        for question in questions(subject):
            claim, (holds, clear) = settle(question), true.pop(question.name)
            certified &= claim.verdict is Verdict.PROVEN
            where = f"seed {seed}: {claim.name} is {claim.verdict.value}, and truly {holds}"
            assert not (claim.verdict is Verdict.PROVEN and not holds), where
            assert not (claim.verdict is Verdict.REFUTED and holds), where
            if claim.verdict is Verdict.UNDECIDED:
                sufficient = question.sufficient and not holds  # where a proof fails that is not a refutation
                assert sufficient or not clear, where
                count[f"undecided by {claim.route}, truly {holds}"] += 1
        assert not true, f"seed {seed}: not asked: {list(true)}"
        assert not (spoilt and certified), f"seed {seed}: certified, and {kind} is spoilt"
        count[f"{kind} {'spoilt' if spoilt else 'fine'}, {'' if certified else 'not '}certified"] += 1
    return count


def test_no_verdict_is_wrong():
    count = look_at(range(200))
    assert sum(each for name, each in count.items() if "spoilt" in name) > 90
    assert sum(each for name, each in count.items() if name.endswith("fine, certified")) > 80


@pytest.mark.slow
@pytest.mark.parametrize("chunk", range(8))
def test_no_verdict_is_wrong_about_many_designs(chunk):
    count = look_at(range(1000 + 1250 * chunk, 1000 + 1250 * (chunk + 1)))
    print("; ".join(f"{name}: {each}" for name, each in sorted(count.items())))
    assert sum(each for name, each in count.items() if "spoilt" in name) > 600
    assert not any("spoilt, certified" in name for name in count)
