"""Poles that are asked for are had, and the free blocks do what they promise: [T1], [T2], [T3]."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

import firmtouch
from firmtouch.modelfile.sections.design import DesignSpec, NormalBlocks
from firmtouch.regulation import control_law, project, split_directions
from firmtouch.regulation.closed_loop import match_poles, pole_distance
from firmtouch.regulation.controllers import Controller
from firmtouch.regulation.split import Blocks
from firmtouch.regulation.steady_state import disturbance_matrices
from firmtouch.synthesis import PolesMissedError, pole_assignment
from firmtouch.synthesis.pairing import MOST_PAIRINGS, Mode, UnpairedPoleError, pairings
from firmtouch.synthesis.pole_assignment import POLE_TOLERANCE, NotPositiveError, requested_poles

SIZES = st.integers(2, 7).flatmap(lambda n: st.tuples(st.just(n), st.integers(1, n - 1)))
SEEDS = st.integers(0, 2**32 - 1)
POLICIES = [NormalBlocks(), NormalBlocks(policy="reject"), NormalBlocks(policy="blend", weight=0.4, margin=0.2)]


def asked(poles, m, *, blocks=POLICIES[0], level="tangent", modes="plant"):
    """Write a specification without a file; poles are single, or pairs."""
    groups = tuple(each if isinstance(each, tuple) else (complex(each),) for each in poles)
    G_f = tuple(map(tuple, 0.5 * np.eye(m)))
    return DesignSpec.model_construct(
        poles=groups, force_feedback=G_f, normal_blocks=blocks, level=level, modes=modes, method="poles"
    )


def random_poles(count, seed, low=2.0, high=20.0):
    """Draw `count` pairs, real or complex, with |s| between two bounds."""
    rng, poles = np.random.default_rng(seed), []
    for _ in range(count):
        size, angle = rng.uniform(low, high), rng.uniform(0, 1.4)
        conjugate = [-size * np.exp(1j * angle), -size * np.exp(-1j * angle)]
        poles += conjugate if rng.random() < 0.5 else list(-rng.uniform(low, high, 2))
    return poles


@settings(max_examples=60)
@given(SIZES, SEEDS, st.sampled_from(POLICIES))
def test_real_and_complex_poles_are_placed_by_both_routes(random_point, size, seed, policy):
    (n, m), poles = size, random_poles(size[0] - size[1], seed)
    loop = firmtouch.assign_poles(random_point(n, m, seed), asked(poles, m, blocks=policy))
    assert pole_distance(loop.poles.pencil, tuple(poles)) < POLE_TOLERANCE
    assert pole_distance(loop.poles.reduced, tuple(poles)) < POLE_TOLERANCE
    assert np.array_equal(loop.gains.W, loop.gains.W.T)
    assert np.array_equal(loop.gains.C, loop.gains.C.T)


@settings(max_examples=30)
@given(SIZES, SEEDS, st.floats(0.5, 50))
def test_trap_6_poles_that_are_all_equal_are_placed(random_point, size, seed, decay):
    (n, m), count = size, 2 * (size[0] - size[1])
    loop = firmtouch.assign_poles(random_point(n, m, seed), asked([-decay] * count, m))
    assert pole_distance(loop.poles.pencil, (-decay + 0j,) * count) < POLE_TOLERANCE


def test_conjugate_pairs_may_be_repeated_and_real_ones_grouped(random_point):
    op = random_point(5, 2, 3)
    poles = [-3 + 4j, -3 - 4j, -3 + 4j, -3 - 4j, (-2 + 0j, -9 + 0j)]
    loop = firmtouch.assign_poles(op, asked(poles, 2))
    flat = requested_poles(asked(poles, 2))
    assert pole_distance(loop.poles.pencil, flat) < 1e-9  # semisimple: no square root of rounding
    K22, M22 = (loop.split.blocks(X).X22 for X in (loop.K, op.M))
    stiffnesses = np.linalg.eigvals(np.linalg.solve(M22, K22)).real
    assert np.sort(stiffnesses) == pytest.approx([18, 25, 25], rel=1e-9)  # 2 * 9 and twice 3^2 + 4^2


def test_an_odd_number_of_real_poles_is_refused_with_them():
    groups = ((-3 + 1j,), (-3 - 1j,), (-2 + 0j,), (-4 + 0j,), (-5 + 0j,))
    with pytest.raises(UnpairedPoleError, match=r"3 real poles \(-2, -4, -5\)"):
        list(pairings(groups))


@pytest.mark.parametrize(("real", "ways"), [(2, 1), (4, 3), (6, 15), (10, MOST_PAIRINGS), (12, 1)])
def test_all_pairings_are_listed_as_long_as_they_are_few(real, ways):
    poles = tuple((-(1.0 + i) + 0j,) for i in range(real))
    found = {tuple(sorted((mode.c, mode.k) for mode in modes)) for modes in pairings(poles)}
    assert len(found) == ways
    for modes in found:
        roots = np.sort(np.concatenate([np.roots([1, *mode]) for mode in modes]))
        assert roots == pytest.approx(-np.arange(real, 0, -1.0), rel=1e-7)  # numpy's roots of quadratics


def test_equal_poles_are_paired_in_one_way():
    assert list(pairings(((-2 + 0j,),) * 6)) == [(Mode(4.0, 4.0),) * 3]


@settings(max_examples=30)
@given(SIZES, SEEDS)
def test_t1_decoupling_makes_the_right_side_of_eq_37_vanish(random_point, size, seed):
    n, m = size
    loop = firmtouch.assign_poles(random_point(n, m, seed), asked(random_poles(n - m, seed), m))
    M, C, K = (loop.split.blocks(X) for X in (loop.operating_point.M, loop.gains.C, loop.K))
    for X in (C, K):
        x2_part = X.X12 - M.X12 @ np.linalg.solve(M.X22, X.X22)  # with x2'' = -M22^-1 (C22 x2' + K22 x2)
        assert np.abs(x2_part).max() < 1e-11 * np.abs(loop.K).max()  # rounding of gains of that size


@settings(max_examples=30)
@given(SIZES, SEEDS, st.floats(0, 1))
def test_t2_rejection_has_no_mixed_blocks_and_a_blend_lies_between(random_point, size, seed, weight):
    (n, m), poles = size, random_poles(size[0] - size[1], seed)
    blends = {"decouple": 1.0, "reject": 0.0, "blend": weight}
    loops = {}
    for policy in blends:
        blocks = NormalBlocks(policy=policy, weight=weight if policy == "blend" else None)
        loops[policy] = firmtouch.assign_poles(random_point(n, m, seed), asked(poles, m, blocks=blocks))
    K12 = {policy: loop.split.blocks(loop.K).X12 for policy, loop in loops.items()}
    C12 = {policy: loop.split.blocks(loop.gains.C).X12 for policy, loop in loops.items()}
    for X12 in (K12, C12):
        size = 1e-11 * max(1, *(np.abs(each.K).max() for each in loops.values()))  # rounding of gains of that size
        for policy, share in blends.items():
            assert X12[policy] == pytest.approx(share * X12["decouple"], abs=size)
    force = {policy: np.linalg.norm(disturbance_matrices(loop)[1], 2) for policy, loop in loops.items()}
    assert force["reject"] <= min(force["blend"], force["decouple"]) * (1 + 1e-9)  # rounding


@settings(max_examples=60)
@given(SIZES, SEEDS, st.sampled_from(["decouple", "reject"]), st.floats(0.01, 0.9))
def test_t3_the_margins_of_c_k_and_w_hold_exactly(random_point, size, seed, policy, margin):
    (n, m), op = size, random_point(*size, seed)
    blocks = NormalBlocks(policy=policy, margin=margin)
    loop = firmtouch.assign_poles(op, asked(random_poles(n - m, seed, 8, 20), m, blocks=blocks))
    assume(loop.tangent.W[0] > 1e-3)
    least = {}
    for name in ("C", "K", "W"):
        full, tangent = getattr(loop.full, name), getattr(loop.tangent, name)
        least[name] = full[0] / tangent[0]
        # Rounding of the largest eigenvalue, seen from the least.
        assert least[name] >= margin - 1e-11 * full[-1] / tangent[0]
    assert least["C"] == pytest.approx(margin, rel=1e-6)  # C has nothing else to hold, so its margin is met exactly
    assert min(least["K"], least["W"]) == pytest.approx(margin, rel=1e-6)
    assert loop.full.holds


@settings(max_examples=10)
@given(SIZES.filter(lambda size: size[0] - size[1] == 2), SEEDS)
@example((4, 1), 4_154_420_470)  # least gain without regard to W22 would make it indefinite here
def test_least_gain_is_no_larger_than_with_the_plants_own_mode_shapes_and_holds_where_they_do(random_point, size, seed):
    (n, m), op = size, random_point(*size, seed)
    poles = random_poles(n - m, seed, 2, 6)
    level = "full" if firmtouch.assign_poles(op, asked(poles, m)).full.holds else "tangent"
    own, least = (
        firmtouch.assign_poles(op, asked(poles, m, level=level, modes=each)) for each in ("plant", "least_gain")
    )
    assert np.linalg.norm(least.gains.W) <= np.linalg.norm(own.gains.W) * (1 + 1e-9)  # rounding
    assert pole_distance(least.poles.pencil, tuple(poles)) < POLE_TOLERANCE


@settings(max_examples=20)
@given(SIZES, SEEDS)
def test_asking_for_the_plants_own_stiffness_on_its_own_mode_shapes_needs_no_tangent_gain(random_point, size, seed):
    (n, m), op = size, random_point(*size, seed)
    op = replace(op, N0=op.N0 @ op.N0 + np.eye(n))
    M22, N22 = (split_directions(op.J).blocks(X).X22 for X in (op.M, op.N0))
    sizes = np.sqrt(scipy.linalg.eigvalsh(N22, M22))  # the plant's frequencies
    poles = [each * turn for each in sizes for turn in (-0.6 + 0.8j, -0.6 - 0.8j)]
    loop = firmtouch.assign_poles(op, asked(poles, m))
    assert np.abs(loop.tangent.W).max() < 1e-10 * np.abs(N22).max()  # rounding of K22 - N22


@pytest.mark.parametrize("modes", ["plant", "least_gain"])
def test_poles_are_paired_so_that_w_is_positive_where_a_pairing_makes_it_so(random_point, modes):
    op = random_point(3, 1, 0)
    M22 = split_directions(op.J).blocks(op.M).X22
    stiffness = np.linalg.cholesky(M22) @ np.diag([1.5, 30]) @ np.linalg.cholesky(M22).T
    N0 = split_directions(op.J).assemble(Blocks(np.eye(1), np.zeros((1, 2)), stiffness))
    # Of the stiffnesses (2, 120), (10, 24), (12, 20), the second is nearest to the plant's, and 24 < 30.
    loop = firmtouch.assign_poles(replace(op, N0=N0), asked([-1, -2, -10, -12], 1, level="full", modes=modes))
    assert loop.full.holds


def test_poles_that_miss_are_refused_with_both_lists(random_point, monkeypatch):
    monkeypatch.setattr(pole_assignment, "POLE_TOLERANCE", 1e-12)  # double poles miss this by the root of rounding
    with pytest.raises(PolesMissedError, match=r"asked for -3\+0j, -3\+0j.*the finished gains give -") as refusal:
        firmtouch.assign_poles(random_point(3, 2, 0), asked([-3, -3], 2))
    assert 1e-12 < refusal.value.residual < POLE_TOLERANCE
    assert pole_distance(refusal.value.achieved, refusal.value.requested) <= refusal.value.residual


@pytest.fixture
def stiff_plant(random_point):
    """A plant that is stiffer on its tangent directions than slow poles ask for."""
    op = random_point(4, 1, 7)
    return replace(op, P_qq=op.P_qq + 200 * np.eye(4), N0=op.N0 + 200 * np.eye(4))


def test_a_plant_stiffer_than_the_poles_is_refused_on_the_full_level_with_the_remedy(stiff_plant):
    slow = [-1, -1.5, -2, -2.5, -3, -4]
    with pytest.raises(NotPositiveError, match="faster poles, or `level: tangent`") as refusal:
        firmtouch.assign_poles(stiff_plant, asked(slow, 1, level="full"))
    assert refusal.value.loop.tangent.W[0] < 0
    assert f"W_min = {refusal.value.loop.full.W[0]:.4g}" in str(refusal.value)
    loop = firmtouch.assign_poles(stiff_plant, asked(slow, 1, level="tangent"))
    assert loop.tangent.holds
    assert not loop.full.holds
    assert loop.full.K[0] > 0
    assert loop.full.C[0] > 0


@pytest.mark.parametrize("modes", ["plant", "least_gain"])
def test_poles_that_are_the_plants_own_are_refused_on_the_full_level_in_words_and_not_as_missed(stiff_plant, modes):
    M22, N22 = (split_directions(stiff_plant.J).blocks(X).X22 for X in (stiff_plant.M, stiff_plant.N0))
    sizes = np.sqrt(scipy.linalg.eigvalsh(N22, M22) * (1 + 1e-12))  # W22 is positive by rounding at most
    poles = [each * turn for each in sizes for turn in (-0.6 + 0.8j, -0.6 - 0.8j)]
    with pytest.raises(NotPositiveError, match="faster poles, or `level: tangent`"):
        firmtouch.assign_poles(stiff_plant, asked(poles, 1, level="full", modes=modes))


@pytest.mark.parametrize("policy", ["decouple", "reject"])
def test_each_shipped_model_is_designed_on_its_level(op, policy):
    design = op.plant.spec.design.model_copy(update={"normal_blocks": NormalBlocks(policy=policy)})
    loop = firmtouch.assign_poles(op, design)
    achieved = match_poles(loop.poles.pencil, requested_poles(design))
    assert np.abs(np.subtract(achieved, requested_poles(design))).max() < POLE_TOLERANCE * max(map(abs, achieved))
    assert (loop.full if design.level == "full" else loop.tangent).holds


def peak_force_error(loop, simulate, start):
    op = loop.operating_point
    law = control_law(op, loop.gains, Controller.AFFINE_WITH_FORCE)
    q = project(op.plant, op.q_d + start * loop.split.V2[:, 0]).q
    run = simulate(op, law, q, np.zeros(op.n), 1.5, tolerance=1e-8)
    return np.abs(run.lambda_ - op.lambda_d).max()


def test_t1_halving_the_start_quarters_the_force_transient(arm_on_circle, simulate):
    op = firmtouch.find_operating_point(firmtouch.derive_plant(arm_on_circle.spec))
    peaks = {}
    for policy in ("decouple", "reject"):
        design = arm_on_circle.spec.design.model_copy(update={"normal_blocks": NormalBlocks(policy=policy)})
        loop = firmtouch.assign_poles(op, design)
        peaks[policy] = [peak_force_error(loop, simulate, start) for start in (0.1, 0.05, 0.025)]
    quartering = np.divide(peaks["decouple"][:-1], peaks["decouple"][1:])
    halving = np.divide(peaks["reject"][:-1], peaks["reject"][1:])
    assert quartering == pytest.approx([4, 4], rel=0.15)  # second order, and the third at starts of 0.1 rad
    assert halving == pytest.approx([2, 2], rel=0.15)
    assert peaks["decouple"][0] < peaks["reject"][0] / 4
