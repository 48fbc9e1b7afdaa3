"""Each term of a region design says what it means: its inequalities against closed forms and finished gains [T4]-[T6]."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from tests.synthesis.region_plants import (
    around,
    companion_poles,
    draw_point,
    draw_positive,
    figures,
    point_of,
    problem_of,
    region,
)

from firmtouch.regulation import Gains, close_loop, split_directions
from firmtouch.regulation.steady_state import disturbance_matrices, offset_matrices
from firmtouch.regulation.tangent import Tangent, energy_slack
from firmtouch.synthesis.region.conflicts import NoGainsError, Verdict, has_gains
from firmtouch.synthesis.region.convex import ConvexSearch, gains_of
from firmtouch.synthesis.region.design import solve_problem
from firmtouch.synthesis.region.force_shaping import shape_force
from firmtouch.synthesis.region.margins import Proof, find_margins
from firmtouch.synthesis.region.terms.bandwidth import Bandwidth
from firmtouch.synthesis.region.terms.damping import Damping
from firmtouch.synthesis.region.terms.decay import Decay
from firmtouch.synthesis.region.terms.force_errors import DisturbanceForceError, OffsetForceError
from firmtouch.synthesis.region.terms.gain_bounds import GainEntry, GainNorm, TorqueLimit
from firmtouch.synthesis.region.terms.guaranteed_cost import GuaranteedCost
from firmtouch.synthesis.region.terms.normal_blocks import MixedBlocks
from firmtouch.synthesis.region.terms.positivity import Positivity
from firmtouch.synthesis.region.terms.tangent_stiffness import PositionError

SIZES = st.integers(2, 6).flatmap(lambda n: st.tuples(st.just(n), st.integers(1, min(3, n - 1))))
SEEDS = st.integers(0, 2**32 - 1)
PARTS = st.floats(-1e3, 1e3)
EDGE = 1e-9
"""Relative distance from an edge within which rounding of 2 x 2 eigenvalues decides on which side a point is."""
SOLVER = 1e-4
"""The solver's accuracy in an objective, 1e-6, and STRICT and CLEAR, by which inequalities are kept from their edges,
seen in gains: 1e-4 is what active terms were met to."""


def put(variables, W, C, eps=1.0):
    """Give the search's variables the values of gains in SI (full structure)."""
    v, n = variables, variables.n
    for expression, X in ((v.W, v.scaling.scaled_stiffness(W)), (v.C, v.scaling.scaled_damping(C))):
        (variable,) = expression.variables()
        variable.value = np.array([X[i, j] for j in range(n) for i in range(j + 1)])
    v.eps.value = eps


def keeps(term, problem, gains, eps=1.0, tolerance=1e-9):
    """Tell whether gains satisfy a term's inequalities, to rounding in scaled coordinates."""
    v = problem.variables()
    put(v, gains.W, gains.C, eps)
    return all(float(np.max(each.violation())) <= tolerance for each in term.constraints(v))


def random_gains(op, rng, size=20.0):
    W, C = (draw_positive(rng, op.n, 0.2 * size, 2 * size) for _ in range(2))
    return Gains(W, C, 0.7 * np.eye(op.m), np.zeros(op.n))


def search(problem):
    """Run the convex search alone and give its gains."""
    best = ConvexSearch(problem).run().best
    assert best.status.has_gains, best.status
    return gains_of(problem, best), best


# (1) Regions: the eigenvalue of the 2 x 2 matrix against what the words decay, damping and bandwidth mean.


@given(PARTS, PARTS, st.floats(0.01, 100))
def test_decay_region_is_the_half_plane(x, y, alpha):
    assert Decay(asked=alpha).region().excess(complex(x, y)) == pytest.approx(2 * (x + alpha), rel=1e-12, abs=1e-12)


@given(PARTS, PARTS, st.floats(0.01, 0.99))
def test_damping_region_is_the_sector(x, y, zeta):
    s = complex(x, y)
    assume(abs(s) > 1e-6)
    assume(abs(-x / abs(s) - zeta) > EDGE)
    assert (Damping(asked=zeta).region().excess(s) < 0) == (-x / abs(s) > zeta)


@given(PARTS, PARTS, st.floats(0.01, 1000))
def test_bandwidth_region_is_the_disc(x, y, fastest):
    s = complex(x, y)
    assert Bandwidth(asked=fastest).region().excess(s) == pytest.approx(
        abs(s) - fastest, abs=1e-12 * (abs(s) + fastest)
    )


@given(PARTS, PARTS, st.floats(0.01, 100), st.sampled_from([Decay(asked=3), Damping(asked=0.6), Bandwidth(asked=30)]))
def test_another_unit_of_time_scales_a_region_and_nothing_else(x, y, omega, term):
    here, there = term.region(), term.region().in_time_unit(omega)
    s = complex(x, y)
    assert there.excess(s / omega) == pytest.approx(here.excess(s) / omega, rel=1e-9, abs=1e-9 * (1 + abs(s) / omega))


# (2) The products of [T4].


@settings(max_examples=40)
@given(SIZES, SEEDS, st.floats(0.1, 5))
def test_motion_is_pm_times_a_at_every_vertex(size, seed, eps):
    rng, op = np.random.default_rng(seed), draw_point(*size, seed)
    problem = problem_of(op, region(2, n=op.n), vertices=around(op, rng, 2, 0.1))
    gains, v = random_gains(op, rng), problem.variables()
    put(v, gains.W, gains.C, eps)
    assert v.values()[0] == pytest.approx(gains.W, rel=1e-12)
    assert v.values()[1] == pytest.approx(gains.C, rel=1e-12)
    for i, tangent in enumerate(problem.tangents(gains)):
        P, PA = v.energy(i).value, v.motion(i).value
        assert pytest.approx(P.T, abs=1e-13 * np.abs(P).max()) == P
        assert pytest.approx(P @ tangent.companion(), abs=1e-11 * np.abs(PA).max()) == PA
        poles = np.linalg.eigvals(tangent.companion()) * problem.scaling.omega  # scaled, they are the loop's own
        true = close_loop(problem.points[i], gains).poles.pencil
        assert np.sort(np.abs(poles)) == pytest.approx(
            np.sort(np.abs(true)), rel=1e-6
        )  # double roots: sqrt of rounding


@settings(max_examples=40)
@given(SIZES, SEEDS, st.floats(0.3, 3))
def test_gains_that_satisfy_a_regions_inequality_have_their_poles_in_it_between_the_vertices_too(size, seed, ratio):
    rng, op = np.random.default_rng(seed), draw_point(*size, seed, curvature=0.2)
    alpha = 2.0
    problem = problem_of(op, region(alpha, n=op.n), vertices=around(op, rng, 3, 0.1))
    omega = problem.scaling.omega
    C, W = (draw_positive(rng, op.n, 0.9, 1.1) * x for x in (2.5 * omega, 2 * omega**2))
    half = scipy.linalg.sqrtm(op.M).real
    gains = Gains(half @ W @ half, half @ C @ half, 0.5 * np.eye(op.m), np.zeros(op.n))
    terms = (*problem.terms, Damping(asked=0.5), Bandwidth(asked=6 * omega))
    eps = ratio * alpha / omega
    positivity = next(each for each in terms if isinstance(each, Positivity))
    assume(keeps(positivity, problem, gains, eps))
    held = [each for each in terms if each is not positivity and keeps(each, problem, gains, eps)]
    weights = rng.dirichlet(np.ones(3), 20)
    M, N0 = (np.tensordot(weights, np.array(each), 1) for each in zip(*around_of(problem), strict=True))
    for s in companion_poles(M, gains.C, gains.W + N0, split_directions(op.J).V2).ravel():
        for each in held:
            assert each.region().excess(s) < 0


def around_of(problem):
    return [(each.M, each.N0) for each in problem.points]


# (3) One free direction: everything in closed form.


@given(st.floats(0.05, 50), st.floats(0.05, 20), st.floats(0.05, 5), st.floats(0.05, 3))
def test_one_mass_with_decay_has_the_closed_form(k, c, eps, alpha):
    """[[2 (e - a) k, e c - 2 a e], [., 2 (c - e - a)]] > 0 and k > e^2, by determinants."""
    first, second = 2 * (eps - alpha) * k, 2 * (c - eps - alpha)
    mixed = eps * c - 2 * alpha * eps
    determinants = (first, first * second - mixed**2, k - eps**2)
    assume(min(map(abs, determinants)) > 1e-6 * (1 + k * c) * (1 + eps))
    tangent = Tangent(*(np.array([[x]]) for x in (1.0, c, k)))
    slack = energy_slack([tangent], [Decay(asked=alpha).region()], eps)
    assert (slack > 0) == (min(determinants) > 0)
    if slack > 0:
        assert np.roots([1, c, k]).real.max() < -alpha


def test_least_stiffness_of_one_mass_is_the_closed_form():
    """n = 2, m = 1: K22 = w + nu >= d / gamma alone decides w."""
    op = point_of(np.diag([2.0, 3.0]), [[1.0, 0.0]], np.diag([0.0, -4.0]))
    terms = (*region(n=2), PositionError(asked=0.01, unit="rad", semi_axes=np.array([0.0, 1.5])))
    gains, _ = search(problem_of(op, terms))
    assert gains.W[1, 1] - 4 == pytest.approx(1.5 / 0.01, rel=SOLVER)


# (4), (6), (9) Terms on finished gains: exact ones hold if and only if the inequality does.


def exact_terms(op, gains, rng):
    """List terms whose inequality loses nothing, each with what is reached asked for."""
    n, m = op.n, op.m
    loop = close_loop(op, gains)
    K = loop.split.blocks(loop.K)
    ball, offsets, Lambda = np.full(n, 1.7), np.full(m, 0.3), np.eye(m) / 1.7
    terms = [
        *(GainNorm(name="norm", asked=1, unit="", which=which) for which in "WC"),
        *(GainEntry(name="entry", asked=1, unit="", which=which, joint=n - 1) for which in "WC"),
        TorqueLimit(
            name="torque",
            asked=1,
            unit="N m",
            joint=n - 1,
            position=rng.uniform(0, 1, n),
            velocity=rng.uniform(0, 1, n),
        ),
        PositionError(asked=1, unit="rad", semi_axes=ball),
        OffsetForceError(asked=1, unit="N", semi_axes=offsets, feedback=Lambda, reference=K.X12 @ np.linalg.inv(K.X22)),
        DisturbanceForceError(asked=1, unit="N", semi_axes=ball, feedback=Lambda, reference=K.X22),
    ]
    return [replace(each, asked=each.reached(loop)) for each in terms]


@settings(max_examples=40)
@given(SIZES, SEEDS)
def test_exact_terms_hold_just_when_their_inequalities_do(size, seed):
    rng, op = np.random.default_rng(seed), draw_point(*size, seed, curvature=0.2)
    gains = random_gains(op, rng)
    problem = problem_of(op, region(2, n=op.n))
    for term in exact_terms(op, gains, rng):
        assert keeps(term.eased(1.001), problem, gains), term
        assert not keeps(term.eased(0.999), problem, gains, tolerance=1e-12), term
        assert term.eased(1.001).holds(term.asked)
        assert not term.eased(0.999).holds(term.asked)


@settings(max_examples=60)
@given(SIZES, SEEDS, st.floats(0.2, 3))
def test_position_error_in_an_ellipsoid_is_kept_wherever_its_inequality_is(size, seed, ease):
    """K22^2 >= G^2 follows from G K22 + K22 G >= 2 G^2, and not the other way round."""
    rng, op = np.random.default_rng(seed), draw_point(*size, seed, curvature=0.2)
    gains = random_gains(op, rng)
    term = PositionError(asked=1.0, unit="rad", semi_axes=rng.uniform(0.2, 3, op.n))
    loop = close_loop(op, gains)
    term = replace(term, asked=term.reached(loop) * ease)
    if keeps(term, problem_of(op, region(2, n=op.n)), gains):
        assert term.reached(loop) <= term.asked * (1 + 1e-8)


@settings(max_examples=60)
@given(SIZES, SEEDS, st.floats(0.5, 3), st.floats(0.5, 2))
def test_force_errors_around_any_reference_are_kept_wherever_their_inequalities_are(size, seed, ease, off):
    rng, op = np.random.default_rng(seed), draw_point(*size, seed, curvature=0.2)
    gains, m = random_gains(op, rng), op.m
    loop = close_loop(op, gains)
    K, Lambda = loop.split.blocks(loop.K), np.eye(m) / 1.7
    terms = [
        OffsetForceError(
            asked=1, unit="N", semi_axes=rng.uniform(0.1, 1, m), feedback=Lambda,
            reference=off * K.X12 @ np.linalg.inv(K.X22),
        ),
        OffsetForceError(asked=1, unit="N", semi_axes=rng.uniform(0.1, 1, m), feedback=Lambda),
        DisturbanceForceError(
            asked=1, unit="N", semi_axes=rng.uniform(0.1, 1, op.n), feedback=Lambda, reference=off * K.X22
        ),
    ]  # fmt: skip
    for term in terms:
        asked = replace(term, asked=term.reached(loop) * ease)
        if keeps(asked, problem_of(op, region(2, n=op.n)), gains):
            assert asked.reached(loop) <= asked.asked * (1 + 1e-8)


def test_force_errors_are_the_norms_of_the_steady_state_table(rng):
    op = draw_point(5, 2, 4)
    gains, d, offset = random_gains(op, rng), rng.uniform(0.1, 2, 5), rng.uniform(0.1, 2, 2)
    loop = close_loop(op, gains)
    Lambda = np.linalg.inv(np.eye(2) + gains.G_f)
    K_inverse = np.linalg.inv(loop.K)
    press = np.linalg.inv(op.J @ K_inverse @ op.J.T)  # (J K^-1 J^T)^-1 of Eqs. (26), (32)
    disturbed = DisturbanceForceError(asked=1, unit="N", semi_axes=d).reached(loop)
    assert disturbed == pytest.approx(np.linalg.norm(Lambda @ press @ op.J @ K_inverse @ np.diag(d), 2), rel=1e-9)
    moved = OffsetForceError(asked=1, unit="N", semi_axes=offset).reached(loop)
    assert moved == pytest.approx(np.linalg.norm(Lambda @ press @ np.diag(offset), 2), rel=1e-9)
    assert disturbed == pytest.approx(np.linalg.norm(disturbance_matrices(loop)[1] * d, 2), rel=1e-12)
    assert moved == pytest.approx(np.linalg.norm(offset_matrices(loop)[1] * offset, 2), rel=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_bounds_on_gains_and_errors_hold_where_they_are_active(seed):
    """Each bound asks for a little less than what an unbounded search takes, so it is met by the solver and not by luck."""
    op = draw_point(4, 1, seed, curvature=0.3)
    free, _ = search(problem_of(op, region(3, 0.5, 40, n=4)))
    loop = close_loop(op, free)
    ones = np.ones(4)
    bounds = [
        GainEntry(name="entry", asked=1, unit="", which="W", joint=1),
        GainEntry(name="entry", asked=1, unit="", which="C", joint=2),
        TorqueLimit(name="torque", asked=1, unit="", joint=0, position=0.1 * ones, velocity=0.3 * ones),
        PositionError(asked=1, unit="rad", semi_axes=np.array([1.0, 2.0, 0.5, 1.0])),
    ]
    for bound in bounds:
        tight = replace(bound, asked=0.97 * bound.reached(loop))
        problem = problem_of(op, (*region(3, 0.5, 40, n=4), tight))
        best = ConvexSearch(problem).run().best
        assert best.status.has_gains, bound
        checked = problem.audit(gains_of(problem, best))
        assert checked.holds
        assert checked.results[-1].reached == pytest.approx(tight.asked, rel=1e-2)  # active, up to the search of eps


@pytest.mark.parametrize("which", ["W", "C"])
def test_a_bound_on_the_norm_holds(which):
    op = draw_point(4, 1, 7, curvature=0.3)
    free, _ = search(problem_of(op, region(3, 0.5, 40, n=4)))
    bound = GainNorm(name="norm", asked=1.02 * np.linalg.norm(getattr(free, which), 2), unit="", which=which)
    gains, _ = search(problem_of(op, (*region(3, 0.5, 40, n=4), bound)))
    assert np.linalg.norm(getattr(gains, which), 2) <= bound.asked


def test_positivity_with_a_margin_holds_at_every_vertex():
    """K >= mu D with a D of different units, on both levels."""
    op = draw_point(4, 2, 3, curvature=0.3)
    rng, D = np.random.default_rng(3), np.array([1.0, 30.0, 2.0, 0.5])
    for level in ("full", "tangent"):
        term = Positivity(asked=2.0, unit="of D", level=level, D=D)
        problem = problem_of(op, (Decay(asked=2), term), vertices=around(op, rng, 3, 0.1))
        gains, _ = search(problem)
        V2 = split_directions(op.J).V2
        basis = np.eye(4) if level == "full" else V2
        for point in problem.points:
            K = basis.T @ (gains.W + point.N0) @ basis
            assert scipy.linalg.eigh(K, basis.T @ np.diag(D) @ basis, eigvals_only=True)[0] >= 2.0


# (5) Guaranteed cost [T5].


def cost_term(n, **changed):
    values = {
        "position": np.full(n, 0.05),
        "velocity": np.full(n, 0.5),
        "torque": np.full(n, 10.0),
        "start_position": np.full(n, 0.1),
        "start_velocity": np.full(n, 0.5),
    }
    return GuaranteedCost(**(values | changed))


def riccati_cost(op, term):
    """Give the least cost of the worst start by any state feedback: the optimal regulator of (38), driven by all joints."""
    V2 = split_directions(op.J).V2
    Q, E = term.weights(V2, 1.0)
    t, M22 = V2.shape[1], V2.T @ op.M @ V2
    A = np.block([[np.zeros((t, t)), np.eye(t)], [-np.linalg.solve(M22, V2.T @ op.N0 @ V2), np.zeros((t, t))]])
    B = np.vstack([np.zeros((t, op.n)), np.linalg.solve(M22, V2.T)])
    P = scipy.linalg.solve_continuous_are(A, B, Q, np.diag(term.torque**-2.0))
    return float(scipy.linalg.eigh(P, E, eigvals_only=True)[-1])


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("curvature", [0.0, 0.5])
def test_guaranteed_cost_lies_between_the_optimal_regulator_and_the_bound(seed, curvature):
    """J_LQR <= true cost <= bound; [T4]'s Lyapunov matrix and symmetric gains lose little."""
    op = draw_point(4, 1, seed, curvature=curvature)
    term = cost_term(4)
    problem = problem_of(op, (term, *region(n=4)), objective={"cost": 1.0})
    gains, best = search(problem)
    reached, least = term.reached(close_loop(op, gains)), riccati_cost(op, term)
    assert least * (1 - 1e-9) <= reached <= best.figures["cost"] * (1 + 1e-6)
    assert best.figures["cost"] <= 1.6 * least


def test_true_cost_of_the_worst_start_is_that_of_a_simulated_one():
    """int x^T Q x + u^T R u by quadrature of the matrix exponential."""
    op = draw_point(3, 1, 2, curvature=0.2)
    gains, term = random_gains(op, np.random.default_rng(2)), cost_term(3)
    V2 = split_directions(op.J).V2
    M22, C22, K22 = (V2.T @ X @ V2 for X in (op.M, gains.C, gains.W + op.N0))
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M22, np.hstack([K22, C22]))]])
    Q, E = term.weights(V2, 1.0)
    U = np.hstack([gains.W @ V2, gains.C @ V2]) / term.torque[:, None]
    times, h = np.linspace(0, 60, 60001, retstep=True)
    step = scipy.linalg.expm(A * h)
    X, total = np.eye(4), np.zeros((4, 4))
    weight = Q + U.T @ U
    for i in range(len(times)):
        total += X.T @ weight @ X * h * (0.5 if i in (0, len(times) - 1) else 1.0)
        X = step @ X
    worst = scipy.linalg.eigh(total, E, eigvals_only=True)[-1]
    # The trapezium rule with h = 1 ms errs by (h |A|)^2 / 12.
    assert term.reached(close_loop(op, gains)) == pytest.approx(worst, rel=max(1e-4, (h * np.linalg.norm(A, 2)) ** 2))


@pytest.mark.parametrize(
    "share",
    [
        pytest.param(
            1.5,
        ),
        pytest.param(
            2.0,
        ),
        4.0,
    ],
)
def test_a_bound_on_the_cost_is_kept_at_every_vertex(share):
    """What a search for the least cost reaches, a search with a bound of 1.5 times that reaches too."""
    op = draw_point(3, 1, 5, curvature=0.2)
    vertices = around(op, np.random.default_rng(5), 3, 0.05)
    free = problem_of(op, (cost_term(3), *region(n=3)), vertices=vertices, objective={"cost": 1.0})
    term = cost_term(3, asked=share * search(free)[1].figures["cost"])
    problem = problem_of(op, (term, *region(n=3)), vertices=vertices)
    gains, _ = search(problem)
    assert all(term.reached(close_loop(point, gains)) <= term.asked for point in problem.points)


def test_the_search_for_a_conflict_sees_that_a_bound_on_the_cost_can_be_kept():
    """`has_gains` of a problem for which gains were found."""
    op = draw_point(3, 1, 5, curvature=0.2)
    term = cost_term(3, asked=4.0)
    problem = problem_of(op, (term, *region(n=3)))
    search(problem)
    assert has_gains(problem, problem.terms)


# (7) Mixed blocks [T1], [T2].


@pytest.mark.parametrize("weight", [0.0, 0.4, 1.0])
def test_mixed_blocks_are_the_wished_share_of_decoupling(weight):
    op = draw_point(5, 2, 8, curvature=0.3)
    problem = problem_of(op, (*region(3, 0.6, 40, n=5), MixedBlocks(weight=weight)))
    gains, _ = search(problem)
    loop = close_loop(op, gains)
    M = loop.split.blocks(op.M)
    for X in (loop.split.blocks(loop.K), loop.split.blocks(gains.C)):
        wish = weight * M.X12 @ np.linalg.solve(M.X22, X.X22)
        assert pytest.approx(wish, abs=1e-6 * np.linalg.norm(X.X22)) == X.X12  # as MixedBlocks itself asks


# (8) Margins.


@pytest.fixture(scope="module")
def designed():
    """Designs with m = 1 and m = 2, on both levels, and one with vertices."""

    def make(n, m, seed, level="full", count=1):
        op = draw_point(n, m, seed, curvature=0.5)
        vertices = around(op, np.random.default_rng(seed), count, 0.05) if count > 1 else None
        problem = problem_of(op, region(3, 0.5, 40, n=n, level=level), vertices=vertices)
        gains, best = search(problem)
        loops = problem.audit(gains).loops
        return problem, gains, find_margins(problem, gains, loops, best.epsilon), best.epsilon

    return [make(3, 1, 1), make(4, 1, 2, "tangent"), make(4, 2, 3), make(4, 1, 4, count=3)]


def least_of(problem, gains, move, *, each=lambda point: 0.0):
    """Give the least eigenvalue of K - `move` over the vertices, on the problem's level."""
    level = next(term for term in problem.terms if isinstance(term, Positivity)).level
    basis = np.eye(problem.op.n) if level == "full" else split_directions(problem.op.J).V2
    return min(np.linalg.eigvalsh(basis.T @ (gains.W + p.N0 - move) @ basis)[0] for p in problem.points)


def test_k_stays_positive_for_every_error_of_lambda_d_within_the_margin(designed, rng):
    """K - sum dlambda_j Phi_j'' > 0 for ||dlambda|| < margin; for m = 1 it is singular beyond."""
    for problem, gains, margins, *_ in designed:
        hessians, m = problem.op.constraint_hessians, problem.op.m
        assert np.isfinite(margins.lambda_d)
        for _ in range(200):
            direction = rng.normal(size=m)
            move = margins.lambda_d * (1 - 1e-9) * direction / np.linalg.norm(direction)
            assert least_of(problem, gains, np.tensordot(move, hessians, 1)) > 0
        if m == 1:
            beyond = [least_of(problem, gains, side * 1.001 * margins.lambda_d * hessians[0]) for side in (-1, 1)]
            assert min(beyond) < 0


@pytest.mark.parametrize(
    "which",
    [
        0,
        pytest.param(1),
        2,
        3,
    ],
    ids=["full, m = 1", "tangent", "full, m = 2", "vertices"],
)
def test_k_stays_positive_for_every_error_of_n0_within_the_margin(designed, rng, which):
    """||dN0|| up to margin ||N0||, in any direction; on the tangent level V2^T K V2 > 0."""
    for problem, gains, margins, *_ in designed[which : which + 1]:
        for _ in range(100):
            X = rng.normal(size=(problem.op.n,) * 2)
            X = (X + X.T) / np.linalg.norm(X + X.T, 2)
            for point in problem.points:
                size = margins.N0 * np.linalg.norm(point.N0, 2) * (1 - 1e-9)
                alone = replace(problem, points=(point,))
                assert least_of(alone, gains, size * X) > 0


def test_mu_is_the_least_eigenvalue_of_k(designed):
    for problem, gains, margins, *_ in designed:
        assert margins.mu == pytest.approx(least_of(problem, gains, 0.0), rel=1e-9)


@pytest.mark.parametrize("which", ["W", "C"])
def test_poles_stay_in_the_region_for_all_multiples_within_the_margin(designed, rng, which):
    """200 plants and multiples between the ends; beyond them by half, some pole has left it or no proof is found."""
    for problem, gains, margins, epsilon in designed:
        interval = getattr(margins, which)
        assert interval.low <= 1 <= interval.high
        V2 = split_directions(problem.op.J).V2
        regions = [each.region() for each in problem.terms[:3]]
        factors = rng.uniform(interval.low, min(interval.high, 64.0), 200)
        weights = rng.dirichlet(np.ones(len(problem.points)), 200)
        M, N0 = (np.tensordot(weights, np.array([getattr(p, name) for p in problem.points]), 1) for name in ("M", "N0"))
        for factor, one_M, one_N0 in zip(factors, M, N0, strict=True):
            W, C = gains.W * (factor if which == "W" else 1), gains.C * (factor if which == "C" else 1)
            poles = companion_poles(one_M, C, W + one_N0, V2)
            assert all(r.excess(s) < 0 for s in poles for r in regions)
        assert interval.high < np.inf  # the disc, or the damping ratio, ends every growth
        beyond = replace(gains, **{which: getattr(gains, which) * interval.high * 1.5})
        tangents = [*problem.tangents(gains), *problem.tangents(beyond)]
        assert not Proof(problem, gains, epsilon).holds(tangents)


def test_margins_of_one_plant_end_where_a_pole_leaves_the_region():
    """One vertex, one free direction: general Lyapunov matrices prove all there is, so the ends are the poles' own."""
    op = point_of(np.diag([1.0, 2.0]), [[1.0, 0.0]], np.diag([0.0, -3.0]))
    problem = problem_of(op, region(3, 0.5, 40, n=2))
    gains, best = search(problem)
    margins = find_margins(problem, gains, problem.audit(gains).loops, best.epsilon)
    V2 = split_directions(op.J).V2

    def inside(which, factor):
        W, C = gains.W * (factor if which == "W" else 1), gains.C * (factor if which == "C" else 1)
        decay, damping, bandwidth = figures(companion_poles(op.M, C, W + op.N0, V2))
        return decay > 3 and damping > 0.5 and bandwidth < 40

    ends = {"W": margins.W, "C": margins.C}
    grid = np.geomspace(1, 64, 4000)
    for which, interval in ends.items():
        high = next(f for f in grid if not inside(which, f))
        low = next(1 / f for f in grid if not inside(which, 1 / f))
        assert interval.low >= low * (1 - 1e-3)
        assert interval.high <= high * (1 + 1e-3)
        assert not inside(which, 1.5 * max(interval.high, high))


# (10) Conflicts.


@pytest.fixture(scope="module")
def contradiction():
    """||W|| <= w and K22 >= d / gamma with N0 = 0 contradict each other by a factor of two, whatever else is asked."""
    op = point_of(np.diag([1.0, 2.0, 3.0]), [[1.0, 0.0, 0.0]])
    stiffness = 2.0 / 0.01
    norm = GainNorm(name="norm of W", asked=stiffness / 2, unit="N m/rad", which="W")
    error = PositionError(asked=0.01, unit="rad", semi_axes=np.full(3, 2.0))
    problem = problem_of(op, (Decay(asked=1.0), *region(n=3), norm, error))
    with pytest.raises(NoGainsError) as caught:
        solve_problem(problem)
    return problem, caught.value


def test_a_contradiction_is_named_and_nothing_else(contradiction):
    _, error = contradiction
    assert error.verdict is Verdict.INFEASIBLE
    assert {each.term.name for each in error.conflict} == {"norm of W", "position error"}
    needed = {each.term.name: each.needed for each in error.conflict}
    assert needed["norm of W"] == pytest.approx(200, rel=0.015)  # bisected to 1 %
    assert needed["position error"] == pytest.approx(0.02, rel=0.015)


def test_easing_one_of_the_conflict_as_said_helps_and_less_does_not(contradiction):
    problem, error = contradiction
    for each in error.conflict:
        others = tuple(e.term for e in error.conflict if e is not each)
        assert has_gains(problem, (*others, replace(each.term, asked=each.needed)))
        assert not has_gains(problem, (*others, replace(each.term, asked=each.needed * 0.98)))
        assert has_gains(problem, others)


def test_no_conflict_is_claimed_where_small_gains_will_do():
    """M = I, N0 = 0 and ||W|| <= 0.1 alone: W = 0.05 I is a design, so "no gains exist" would be false."""
    op = point_of(np.eye(3), [[1.0, 0.0, 0.0]])
    norm = GainNorm(name="norm of W", asked=0.1, unit="N m/rad", which="W")
    problem = problem_of(op, (*region(n=3), norm))
    known = Gains(0.05 * np.eye(3), np.eye(3), problem.G_f, np.zeros(3))
    assert problem.audit(known).holds
    try:
        assert solve_problem(problem).results
    except NoGainsError as error:
        assert error.verdict is not Verdict.INFEASIBLE


# (11) The second stage.


def shaped_problem(terms=(), *, n=5, m=2, seed=6, disturbance=1.0, limit=None, objective=None, G_f=None):
    op = draw_point(n, m, seed, curvature=0.3)
    problem = problem_of(
        op,
        (*region(3, 0.5, 30, n=n), *terms),
        shaped=True,
        disturbance=np.full(n, disturbance),
        limit=limit,
        objective=objective,
        G_f=G_f,
    )
    plain = problem.with_terms(problem.terms[:4])
    gains, _ = search(plain)
    return problem, close_loop(op, gains)


@pytest.fixture(scope="module")
def shaped():
    problem, loop = shaped_problem()
    return problem, loop, shape_force(problem, loop)


def transient_of(problem, loop, C12, K12):
    """|| Y U S^-1 [K12 - M12 M22^-1 K22, omega (C12 - M12 M22^-1 C22)] ||, Eq. (37)."""
    split = loop.split
    M, C, K = (split.blocks(X) for X in (loop.operating_point.M, loop.gains.C, loop.K))
    L = np.linalg.solve(M.X22, M.X12.T).T
    outer = np.linalg.solve(np.eye(len(split.S)) + loop.gains.G_f, split.U / split.S)
    return np.linalg.norm(outer @ np.hstack([K12 - L @ K.X22, problem.scaling.omega * (C12 - L @ C.X22)]), 2)


def test_the_front_goes_from_no_transient_to_no_mixed_block(shaped):
    """Its first end is [T1]; its last is K12 = 0, which is least over a ball, Eq. (26)."""
    problem, loop, shape = shaped
    split, points = loop.split, shape.front.points
    outer = np.linalg.solve(np.eye(2) + loop.gains.G_f, split.U / split.S)
    largest = transient_of(problem, loop, np.zeros((2, 3)), np.zeros((2, 3)))
    assert points[0].x <= 1e-3 * largest  # MINOR, the weight of what breaks ties
    assert points[-1].y == pytest.approx(np.linalg.norm(outer, 2), rel=2e-3)  # MINOR again
    x, y = np.array([(each.x, each.y) for each in points]).T
    assert len(points) == 9
    assert np.all(np.diff(x) >= -1e-3 * largest)
    assert np.all(np.diff(y) <= 2e-3 * y[0])


def test_the_second_stage_moves_no_pole(shaped):
    problem, loop, shape = shaped
    after = close_loop(problem.op, shape.gains)
    for name in ("W", "C"):
        before, now = (loop.split.blocks(getattr(gains, name)).X22 for gains in (loop.gains, shape.gains))
        assert now == pytest.approx(before, abs=1e-6 * np.linalg.norm(before, 2))  # the solver's equations
    assert np.abs(np.array(after.poles.reduced)) == pytest.approx(np.abs(np.array(loop.poles.reduced)), rel=1e-3)
    assert problem.audit(shape.gains).holds
    K, C = (after.split.blocks(X) for X in (after.K, shape.gains.C))
    assert shape.front.chosen.x <= 1e-2 * transient_of(
        problem, after, 0 * C.X12, 0 * K.X12
    )  # least transient by default


def test_the_objective_force_error_takes_the_other_end():
    problem, loop = shaped_problem(objective={"gains": 1.0, "force_error": 1.0})
    shape = shape_force(problem, loop)
    K = loop.split.blocks(shape.gains.W + problem.op.N0)
    reached = np.linalg.norm(disturbance_matrices(close_loop(problem.op, shape.gains))[1], 2)
    assert reached == pytest.approx(shape.front.points[-1].y, rel=5e-3)
    assert np.linalg.norm(K.X12 @ np.linalg.inv(K.X22), 2) < 0.1  # its square is what 1 + |L|^2 sees of it


def test_force_feedback_is_as_little_as_the_errors_ask_and_within_its_limit():
    """G_f: 0 <= G_f <= limit, the asked errors hold, and a tenth less feedback would break one of them."""
    limit, d = np.array([3.0, 2.0]), 1.0
    _, loop = shaped_problem(G_f=np.zeros((2, 2)), limit=limit)
    outer = np.linalg.norm(loop.split.U / loop.split.S, 2)
    asked = 0.6 * outer  # of the least error without feedback
    term = DisturbanceForceError(asked=asked, unit="N", semi_axes=np.full(5, d), feedback=np.eye(2))
    problem, loop = shaped_problem((term,), G_f=np.zeros((2, 2)), limit=limit)
    gains = shape_force(problem, loop).gains
    assert np.linalg.eigvalsh(gains.G_f)[0] >= -1e-6  # NEGLIGIBLE
    assert np.linalg.eigvalsh(np.diag(limit) - gains.G_f)[0] >= -1e-4  # the solver's accuracy, through an inverse
    assert term.reached(close_loop(problem.op, gains)) <= asked
    less = replace(gains, G_f=0.9 * gains.G_f)
    assert term.reached(close_loop(problem.op, less)) > asked
