"""What [T4] and Finsler's multipliers prove holds for every plant of the polytope, by eigenvalues of the DAE pencil."""

import json
from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from tests.certificate.exactly import bare
from tests.synthesis.region_plants import around, assigned, companion_poles, draw_point, problem_of, region
from tests.synthesis.test_region_search import SPECS, with_region

import firmtouch
from firmtouch.certificate.certificate import certify
from firmtouch.certificate.decision import Verdict, decide
from firmtouch.certificate.edges import Edge, EdgeKind
from firmtouch.certificate.file import ModelPart, certificate_as_json, read_certificate, witness_in
from firmtouch.certificate.inequalities import energy_proves, energy_slack, finsler_proves
from firmtouch.certificate.subject import subject_of
from firmtouch.certificate.verify import verify
from firmtouch.certificate.witness import Multipliers, Witness
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation import split_directions
from firmtouch.synthesis.region.design import design_region
from firmtouch.synthesis.region.evidence import find_evidence


def pencil_poles(M, J, C, K):
    """Give the finite eigenvalues of the DAE M q'' + C q' + K q = J^T mu, J q = 0, by QZ."""
    m, n = J.shape
    size = 2 * n + m
    E, A = np.zeros((size, size)), np.zeros((size, size))
    E[:n, :n], E[n : 2 * n, n : 2 * n] = np.eye(n), M
    A[:n, n : 2 * n] = np.eye(n)
    A[n : 2 * n, :n], A[n : 2 * n, n : 2 * n], A[n : 2 * n, 2 * n :] = -K, -C, J.T
    A[2 * n :, :n] = J
    alpha, beta = scipy.linalg.eig(A, E, right=False, homogeneous_eigvals=True)
    ratio = np.abs(beta) / (np.abs(alpha) + np.abs(beta))
    order = np.argsort(ratio)[::-1][: 2 * (n - m)]
    return alpha[order] / beta[order]


def proven_by_energy(subject, edge, epsilon):
    return decide(lambda: energy_proves(subject, edge, epsilon))[0]


@pytest.fixture(params=[0, 1, 2, 3])
def uncertain(request):
    """Draw a plant with vertices around it, gains, and the edges that [T4] proves with one eps."""
    seed = request.param
    rng = np.random.default_rng([seed, 7])
    op = draw_point([3, 4, 5, 4][seed], [1, 2, 2, 1][seed], seed, curvature=0.5)
    gains = assigned(op, rng, 6.0, 2.0)
    vertices = around(op, rng, 4, 0.05)
    subject = bare(op.M, op.J, op.N0, gains.W, gains.C, vertices=vertices, lambda_d=op.lambda_d)
    V2 = split_directions(op.J).V2
    poles = companion_poles(
        np.array([M for M, _ in vertices]), subject.gains.C, gains.W + np.array([N for _, N in vertices]), V2
    )
    return subject, vertices, poles


def test_what_energy_proves_holds_between_the_vertices(uncertain, rng):
    subject, vertices, _ = uncertain
    best = max(np.geomspace(0.05, 50, 60), key=lambda eps: energy_slack(subject, Edge(EdgeKind.DECAY, 0.0), eps))
    reach = [x for x in np.linspace(0.1, 10, 100) if energy_slack(subject, Edge(EdgeKind.DECAY, x), best) > 1e-9]
    assert reach, "no decay rate is proven for this draw"
    decay = Edge(EdgeKind.DECAY, float(reach[-1]))
    disc = next(
        Edge(EdgeKind.BANDWIDTH, w)
        for w in np.geomspace(5, 1000, 200).tolist()
        if energy_slack(subject, Edge(EdgeKind.BANDWIDTH, w), best) > 1e-9
    )
    cones = [z for z in np.linspace(0.01, 0.95, 95) if energy_slack(subject, Edge(EdgeKind.DAMPING, z), best) > 1e-9]
    edges = [decay, disc, *([Edge(EdgeKind.DAMPING, float(cones[-1]))] if cones else [])]
    for edge in edges:
        assert proven_by_energy(subject, edge, best) is Verdict.PROVEN
    op, gains = subject.op, subject.gains
    M, N0 = (np.array(each) for each in zip(*vertices, strict=True))
    for weights in rng.dirichlet(np.ones(len(M)) * 0.5, size=1000):
        m, k = np.tensordot(weights, M, 1), gains.W + np.tensordot(weights, N0, 1)
        for s in pencil_poles(m, op.J, gains.C, k):
            for edge in edges:
                reached = edge.kind.of_pole(complex(s))
                assert reached > edge.value if edge.kind.relation == ">=" else reached < edge.value


def test_one_vertex_spoilt_is_enough_for_no_proof(uncertain):
    subject, vertices, _ = uncertain
    epsilons = np.geomspace(0.05, 50, 60)
    edge = Edge(EdgeKind.DECAY, 0.05)
    best = max(epsilons, key=lambda eps: energy_slack(subject, edge, eps))
    assert proven_by_energy(subject, edge, best) is Verdict.PROVEN
    for i, (M, N0) in enumerate(vertices):
        # K22 is certainly indefinite there, so a pole lies on the right.
        soft = N0 - 2 * np.eye(len(M)) * np.linalg.norm(subject.gains.W + N0, 2)
        spoilt = replace(subject, vertices=(*vertices[:i], (M, soft), *vertices[i + 1 :]))
        assert proven_by_energy(spoilt, edge, best) is not Verdict.PROVEN
        heavy = replace(subject, vertices=(*vertices[:i], (-M, N0), *vertices[i + 1 :]))
        assert proven_by_energy(heavy, edge, best) is not Verdict.PROVEN


def test_energy_proves_no_faster_decay_than_the_poles_have(uncertain):
    subject, _, poles = uncertain
    decay = -poles.real.max()
    for eps in [*np.geomspace(0.01, 100, 25).tolist(), -1.0, 0.0]:
        assert proven_by_energy(subject, Edge(EdgeKind.DECAY, decay * (1 + 1e-9)), eps) is not Verdict.PROVEN
        disc = Edge(EdgeKind.BANDWIDTH, float(abs(poles).max()) * (1 - 1e-9))
        assert proven_by_energy(subject, disc, eps) is not Verdict.PROVEN


# Decentralised gains on the pipe, where no eps of [T4] is found: the search leaves multipliers.


@pytest.fixture(scope="module")
def arm():
    return with_region("planar_3r_circle", *SPECS["diagonal"][:1])


@pytest.fixture(scope="module")
def found(arm):
    op = firmtouch.find_operating_point(firmtouch.derive_plant(arm.spec))
    return design_region(op, arm.spec)


@pytest.fixture(scope="module")
def decentralised(found):
    evidence, scaling = find_evidence(found.problem, found.loop.gains), found.problem.scaling
    assert evidence.epsilon is None
    multipliers = {
        name: Multipliers(each.F, each.P, scaling.T, scaling.omega) for name, each in evidence.multipliers.items()
    }
    return subject_of(found.loop.operating_point, found.loop.gains, Witness(None, multipliers))


@pytest.fixture(scope="module")
def proven(decentralised):
    return certify(decentralised)


def test_the_claims_are_proven_by_that_route(found, proven):
    assert found.search.stage == "alternation"
    assert proven.certified, proven.open
    routes = {each.name: each.route for each in proven.claims if each.name.endswith("LMI")}
    assert routes == {"decay rate, LMI": "Finsler's lemma", "greatest |s|, LMI": "Finsler's lemma"}


def test_they_are_proven_again_after_a_round_trip_through_a_file(arm, proven):
    part = ModelPart(name=arm.name, sha256=arm.sha256, method="region")
    data = certificate_as_json(proven, model=part, design_sha256="", version="0")
    file = read_certificate(json.dumps(data).encode(), "made")
    mine, theirs = witness_in(file).multipliers, proven.subject.witness.multipliers
    assert mine.keys() == theirs.keys()
    for name, each in mine.items():
        assert np.array_equal(each.F, theirs[name].F)
        assert np.array_equal(each.basis, theirs[name].basis)
        assert each.unit == theirs[name].unit
        assert all(np.array_equal(a, b) for a, b in zip(each.P, theirs[name].P, strict=True))
    again = verify(file, arm)
    assert again.holds, again.differences
    assert len(again.proven) == len(proven.claims)


def test_it_holds_for_1000_hands(decentralised, rng):
    subject = decentralised
    op, gains, names = subject.op, subject.gains, list(subject.op.plant.spec.parameters)
    low, high = subject.asked.intervals["m3"]
    p, ends = np.array(op.plant.p), []
    for mass in (low, high):
        p[names.index("m3")] = mass
        ends.append([op.plant.with_parameters(p).M(op.q_d), op.plant.with_parameters(p).P_qq(op.q_d)])
    curved = op.N0 - op.P_qq
    for t in rng.uniform(size=1000):
        M, P_qq = ((1 - t) * a + t * b for a, b in zip(*ends, strict=True))  # both are affine in the mass
        poles = pencil_poles(M, op.J, gains.C, gains.W + P_qq + curved)
        for edge in subject.asked.edges:
            reached = [edge.kind.of_pole(complex(s)) for s in poles]
            assert min(reached) > edge.value if edge.kind.relation == ">=" else max(reached) < edge.value


@pytest.mark.parametrize("edge", [0, 1])
def test_what_is_spoilt_is_not_proven(decentralised, edge):
    subject = decentralised
    edge = subject.asked.edges[edge]
    whole = subject.witness.multipliers[edge.kind.words]

    def verdict(multipliers, subject=subject, edge=edge):
        return decide(lambda: finsler_proves(subject, edge, multipliers))[0]

    assert verdict(whole) is Verdict.PROVEN
    P = whole.P
    for i in range(len(P)):
        spoilt = (*P[:i], frozen(-P[i]), *P[i + 1 :])
        assert verdict(replace(whole, P=spoilt)) is not Verdict.PROVEN
        assert verdict(replace(whole, P=(*P[:i], frozen(0 * P[i]), *P[i + 1 :]))) is not Verdict.PROVEN
    assert verdict(replace(whole, F=frozen(0 * whole.F))) is not Verdict.PROVEN
    assert verdict(replace(whole, F=frozen(-whole.F))) is not Verdict.PROVEN
    assert verdict(replace(whole, P=P[:1])) is not Verdict.PROVEN
    assert verdict(replace(whole, P=())) is not Verdict.PROVEN
    assert verdict(replace(whole, P=(*P, P[0]))) is not Verdict.PROVEN
    assert verdict(replace(whole, basis=frozen(0 * whole.basis))) is not Verdict.PROVEN
    assert verdict(replace(whole, basis=frozen(whole.basis[:, [0, 0]]))) is not Verdict.PROVEN
    for unit in (-whole.unit, 0.0, np.nan, np.inf):
        assert verdict(replace(whole, unit=unit)) is not Verdict.PROVEN
    beyond = Edge(edge.kind, edge.value * (4 if edge.kind.relation == ">=" else 0.25))
    assert verdict(whole, edge=beyond) is not Verdict.PROVEN
    gains = subject.gains
    soft = subject_of(subject.op, replace(gains, C=frozen(0.01 * gains.C)), subject.witness)
    slack = subject_of(subject.op, replace(gains, W=frozen(-gains.W)), subject.witness)
    if edge.kind is EdgeKind.DECAY:
        assert verdict(whole, subject=soft) is not Verdict.PROVEN
    assert verdict(whole, subject=slack) is not Verdict.PROVEN


def test_time_that_runs_backwards_proves_nothing_of_an_unstable_loop(decentralised):
    """A negative unit of time would turn the left half plane into the right one."""
    subject = decentralised
    whole = subject.witness.multipliers["decay rate"]
    gains = replace(subject.gains, C=frozen(-subject.gains.C))
    backwards = replace(whole, unit=-whole.unit)
    mirrored = subject_of(subject.op, gains, subject.witness)
    assert (
        decide(lambda: finsler_proves(mirrored, Edge(EdgeKind.DECAY, -subject.asked.edges[0].value), backwards))[0]
        is not Verdict.PROVEN
    )


def test_evidence_of_the_search_is_evidence_for_the_proof():
    """eps as the search finds it, in its own coordinates, serves in those of the certificate."""
    op = draw_point(4, 1, 11, curvature=0.3)
    rng = np.random.default_rng(3)
    gains = assigned(op, rng, 5.0, 1.5)
    problem = problem_of(op, region(2.0, 0.1, 60.0, n=4))
    evidence = find_evidence(problem, gains)
    assert evidence.epsilon is not None
    subject = bare(op.M, op.J, op.N0, gains.W, gains.C, lambda_d=op.lambda_d)
    for edge in (Edge(EdgeKind.DECAY, 2.0), Edge(EdgeKind.DAMPING, 0.1), Edge(EdgeKind.BANDWIDTH, 60.0)):
        assert proven_by_energy(subject, edge, evidence.epsilon) is Verdict.PROVEN
