"""One gain for each joint and any payload: a region design, against gains of the nominal plant made diagonal.

The question is that of `models/planar_3r_circle.yaml`: diagonal W and C, decay rate 4 1/s, damping ratio 0.6, the margin
of (14), and the drives' limit, for every m3 from 2 to 3 kg. The peers are scipy's `place_poles`, for the nominal poles
that the region design reaches, and LQR with Bryson's weights, also with a prescribed degree of stability. Both work on
M22 x2'' + N22 x2 = u2 at the nominal payload, and give u2 = -Kq x2 - Kv x2', which is a gain between all joints.

Two ways lead back to joints: the diagonal W and C whose tangent blocks are nearest to Kq and Kv by least squares, and the
nearest ones without negative entries. With n = 3 and m = 1 three joints' gains meet three entries of a symmetric 2 x 2
matrix, so that the first way loses no more than what is skew, and pays for it with the joints' signs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
import scipy.optimize
import scipy.signal
from tests.benchmarks.measure import ROOT, Figure, best_of

import firmtouch
from firmtouch.mechanics import Array
from firmtouch.regulation import split_directions
from firmtouch.regulation.operating_point import OperatingPoint, operating_point_at
from firmtouch.regulation.projection import Projection
from firmtouch.synthesis.region.convex import ConvexSearch
from firmtouch.synthesis.region.design import solve_problem
from firmtouch.synthesis.region.problem import RegionProblem, build_problem

BETWEEN = 21
"""Payloads beside the ends of the interval."""
REPETITIONS = 7
POSITION, TORQUE = 0.1, 15.0
"""Bryson's weights: what the file says of the start (rad) and of the drives (N m)."""


@dataclass(frozen=True, slots=True)
class Row:
    """Worst decay rate (1/s) and damping ratio over the payloads; the rest where the gains are the joints' own.

    `away` is the distance of the diagonal gains' tangent blocks from the peer's, relative to these; then the smallest entry
    of W (N m/rad) and C (N m s/rad), and eigenvalue of K; `missed` are the terms that do not hold at some payload.
    """

    name: str
    decay: float
    damping: float
    away: float
    least_W: float
    least_C: float
    least_K: float
    missed: tuple[str, ...]


def question() -> RegionProblem:
    model = firmtouch.read_model(ROOT / "models" / "planar_3r_circle.yaml")
    spec = model.spec.model_copy(update={"design": model.spec.design.with_method("region")})
    return build_problem(firmtouch.find_operating_point(firmtouch.derive_plant(spec)), spec)


def payloads(problem: RegionProblem) -> tuple[OperatingPoint, ...]:
    """Evaluate the true plant at the interval's ends and between them, at the same q_d."""
    op = problem.op
    ((name, (low, high)),) = problem.polytope.parameters.items()
    at = list(op.plant.spec.parameters).index(name)
    points = []
    for value in np.linspace(low, high, BETWEEN + 2):
        p = np.array(op.plant.p)
        p[at] = value
        projection = Projection(op.q_d, op.residual, op.moved)
        points.append(operating_point_at(op.plant.with_parameters(p), projection, op.lambda_d))
    return tuple(points)


def reduced(problem: RegionProblem, V2: Array) -> tuple[Array, Array]:
    """Give A and B of the nominal plant without feedback, in (x2, x2')."""
    M, N = (V2.T @ X @ V2 for X in (problem.op.M, problem.op.N0))
    free, inverse = len(M), np.linalg.inv(M)
    A = np.block([[np.zeros((free, free)), np.eye(free)], [-inverse @ N, np.zeros((free, free))]])
    return A, np.vstack([np.zeros((free, free)), inverse])


def lqr(A: Array, B: Array, V2: Array, shift: float) -> Array:
    """Weigh joint angles by POSITION and torques by TORQUE; all poles get a decay rate of at least `shift`."""
    free = B.shape[1]
    Q = scipy.linalg.block_diag(V2.T @ V2 / POSITION**2, np.zeros((free, free)))
    R = np.eye(free) / TORQUE**2
    return np.linalg.solve(R, B.T @ scipy.linalg.solve_continuous_are(A + shift * np.eye(2 * free), B, Q, R))


def worst(points: tuple[OperatingPoint, ...], V2: Array, Kq: Array, Kv: Array) -> tuple[float, float]:
    """Give the least decay rate and damping ratio of M22 x2'' + Kv x2' + (N22 + Kq) x2 = 0 over the payloads."""
    free = len(Kq)
    poles = []
    for point in points:
        M, N = (V2.T @ X @ V2 for X in (point.M, point.N0))
        rate = np.linalg.solve(M, np.hstack([-(N + Kq), -Kv]))
        poles.append(np.linalg.eigvals(np.vstack([np.hstack([np.zeros((free, free)), np.eye(free)]), rate])))
    s = np.concatenate(poles)
    return float(np.min(-s.real)), float(np.min(-s.real / np.abs(s)))


def nearest(V2: Array, K: Array, solve: Callable[[Array, Array], Array]) -> Array:
    """Find the joints' gains d for which V2^T diag(d) V2 is nearest to K."""
    return solve(np.stack([np.outer(row, row).ravel() for row in V2], axis=1), K.ravel())


def joint_row(name: str, problem: RegionProblem, W: Array, C: Array, away: float = 0.0) -> Row:
    """Ask everything that the file asks, at every payload, from the gains alone."""
    points, V2 = problem.points, tangent(problem)
    decay, damping = worst(points, V2, V2.T @ W @ V2, V2.T @ C @ V2)
    checked = problem.audit(problem.gains(W, C))
    least_K = min(float(np.linalg.eigvalsh(W + point.N0)[0]) for point in points)
    missed = tuple(each.term.name for each in checked.results if not each.holds)
    return Row(name, decay, damping, away, float(np.min(np.diag(W))), float(np.min(np.diag(C))), least_K, missed)


def tangent(problem: RegionProblem) -> Array:
    return split_directions(problem.op.J).V2


def peer_rows(name: str, problem: RegionProblem, gain: Array) -> list[Row]:
    """Take a peer's gain as it is, and both ways back to the joints."""
    V2 = tangent(problem)
    Kq, Kv = np.hsplit(gain, 2)
    rows = [
        Row(f"{name}, own", *worst(problem.points, V2, Kq, Kv), 0.0, np.nan, np.nan, np.nan, ("structure: diagonal",))
    ]
    ways = {
        "diagonal": lambda X, y: np.linalg.lstsq(X, y, rcond=None)[0],
        "diagonal >= 0": lambda X, y: scipy.optimize.nnls(X, y)[0],
    }
    for way, solve in ways.items():
        W, C = (np.diag(nearest(V2, K, solve)) for K in (Kq, Kv))
        away = max(float(np.linalg.norm(V2.T @ X @ V2 - K) / np.linalg.norm(K)) for X, K in ((W, Kq), (C, Kv)))
        rows.append(joint_row(f"{name}, {way}", problem, W, C, away))
    return rows


def print_table(rows: list[Row], problem: RegionProblem) -> None:
    ((name, (low, high)),) = problem.polytope.parameters.items()
    print(
        f"  the least of each for {len(problem.points)} payloads {name} from {low:g} to {high:g} kg, and what is missed:"
    )
    print(f"  {'':<28}{'decay':>8}{'damping':>9}{'away':>7}{'W_ii':>9}{'C_ii':>9}{'K':>9}  missed")
    for each in rows:
        numbers = f"{each.decay:8.2f}{each.damping:9.3f}{each.away:7.0%}"
        numbers += "".join(f"{value:9.1f}" for value in (each.least_W, each.least_C, each.least_K))
        numbers = numbers.replace("nan%", "   -").replace("nan", "  -")
        print(f"  {each.name:<28}{numbers}  {', '.join(each.missed) or '-'}")


def figures() -> list[Figure]:
    problem = question()
    V2, ours = tangent(problem), solve_problem(problem)
    everywhere = replace(problem, points=payloads(problem))
    A, B = reduced(problem, V2)
    wanted = np.array(ours.loop.poles.pencil)
    peers: dict[str, Callable[[], Array]] = {
        "place_poles": lambda: scipy.signal.place_poles(A, B, wanted).gain_matrix,
        "LQR": lambda: lqr(A, B, V2, 0.0),
        "LQR, decay 4": lambda: lqr(A, B, V2, 4.0),
    }
    times = {name: best_of(REPETITIONS, solve) for name, solve in peers.items()}
    own = joint_row("firmtouch", everywhere, ours.loop.gains.W, ours.loop.gains.C)
    rows = [row for name, solve in peers.items() for row in peer_rows(name, everywhere, solve())]
    print_table([own, *rows], everywhere)
    results = everywhere.audit(ours.loop.gains).results
    least = min(results, key=lambda each: each.margin / each.term.asked)
    projected = [each for each in rows if "diagonal" in each.name]
    kept = sum(not each.missed for each in projected)
    placed = sum("decay rate" not in each.missed and "damping ratio" not in each.missed for each in projected)
    search = best_of(REPETITIONS, lambda: ConvexSearch(problem).run())
    slow, fast = max(times.values()), min(times.values())
    ratios = f"{1e3 * search:.0f} ms against {1e3 * slow:.2f} ms for one gain without a promise ({1e3 * fast:.2f} ms the fastest)"
    return [
        Figure(
            "diagonal gains: least relative margin", least.margin / least.term.asked, ">=", 0, "",
            f"{least.term.name}, at {len(everywhere.points)} payloads",
        ),
        Figure(
            "peers made diagonal that keep all terms", kept, "<=", 0, "",
            f"of {len(projected)}; {placed} keep the poles in the region",
        ),
        Figure("search / the slowest peer", search / slow, "<=", 2000, "", ratios),
    ]  # fmt: skip
