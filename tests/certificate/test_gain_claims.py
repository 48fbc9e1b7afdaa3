"""The bounds that a region design sets to its gains, and its cost: any gains may be asked about them."""

import mpmath as mp
import numpy as np
import pytest
import scipy.linalg
from tests.certificate.conftest import MODELS
from tests.certificate.exactly import DIGITS, eigenvalues, matrix
from tests.synthesis.test_region_search import with_region

import firmtouch
from firmtouch.certificate.claims import cost as guaranteed
from firmtouch.certificate.claims import errors, gains, poles, positivity
from firmtouch.certificate.decision import Verdict
from firmtouch.certificate.question import confirm, settle
from firmtouch.certificate.subject import subject_of
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation import Gains

NAME = "planar_3r_circle"


@pytest.fixture(scope="module")
def assigned():
    """Gains of the arm on the pipe with assigned poles, at its operating point."""
    model = firmtouch.read_model(MODELS / f"{NAME}.yaml").with_method("poles")
    op = firmtouch.find_operating_point(firmtouch.derive_plant(model.spec))
    return firmtouch.assign_poles(op, model.spec.design).gains


@pytest.fixture(scope="module")
def asked(assigned):
    """Ask anything about these gains."""

    def ask(gains_=assigned, **region):
        model = with_region(NAME, region)
        op = firmtouch.find_operating_point(firmtouch.derive_plant(model.spec))
        return subject_of(op, gains_)

    return ask


def claims(kind, subject):
    return {each.name: settle(each) for each in kind.questions(subject)}


@pytest.mark.parametrize("name", ["W", "C"])
def test_norms(asked, assigned, name):
    X = getattr(assigned, name)
    with mp.workdps(DIGITS):
        true = mp.sqrt(eigenvalues(matrix(X).T * matrix(X))[-1])
    unit = "N*m/rad" if name == "W" else "N*m*s/rad"
    for factor, verdict in ((1 + 1e-9, Verdict.PROVEN), (1 - 1e-9, Verdict.REFUTED)):
        found = claims(gains, asked(**{name: f"{float(true) * factor!r} {unit}"}, decay=1))[f"norm of {name}"]
        assert found.verdict is verdict
        if verdict is Verdict.PROVEN:
            assert found.figure >= true
            assert found.figure == pytest.approx(float(true), rel=2e-9)


def test_a_structure_that_the_gains_do_not_have_is_refuted(asked, assigned):
    assert claims(gains, asked(decay=1, structure="diagonal"))["structure"].verdict is Verdict.REFUTED
    diagonal = Gains(
        frozen(np.diag(np.diag(assigned.W))), frozen(np.diag(np.diag(assigned.C))), assigned.G_f, assigned.bias
    )
    found = claims(gains, asked(diagonal, decay=1, structure="diagonal"))["structure"]
    assert (found.verdict, found.figure) == (Verdict.PROVEN, 0.0)
    W = np.array(diagonal.W)
    W[0, 1] = W[1, 0] = 5e-324
    hair = Gains(frozen(W), diagonal.C, diagonal.G_f, diagonal.bias)
    assert claims(gains, asked(hair, decay=1, structure="diagonal"))["structure"].verdict is Verdict.REFUTED


def test_torques_are_what_the_rows_add_up_to(asked, assigned):
    errors_ = {"position": "0.1 rad", "velocity": "0.5 rad/s"}
    with mp.workdps(DIGITS):
        true = [
            mp.fsum(abs(mp.mpf(x)) * mp.mpf(0.1) for x in W) + mp.fsum(abs(mp.mpf(x)) * mp.mpf(0.5) for x in C)
            for W, C in zip(assigned.W.tolist(), assigned.C.tolist(), strict=True)
        ]
    for factor, verdict in ((1 + 1e-12, Verdict.PROVEN), (1 - 1e-12, Verdict.REFUTED)):
        for i, joint in enumerate(("q1", "q2", "q3")):
            limit = f"{float(true[i]) * factor!r} N*m"
            region = {"decay": 1, "torque": {"start": errors_ | {"at_most": limit}}}
            found = claims(gains, asked(**region))[f"torque of {joint}, start"]
            assert found.verdict is verdict
            if verdict is Verdict.PROVEN:
                assert true[i] <= found.figure <= float(limit.partition(" ")[0])


def test_the_cost_is_that_of_the_worst_start(asked):
    cost = {
        "position": "0.05 rad",
        "velocity": "0.5 rad/s",
        "torque": "10 N*m",
        "start_position": "0.1 rad",
        "start_velocity": "0.5 rad/s",
    }
    subject = asked(decay=1, cost=cost)
    (question,) = guaranteed.questions(subject)
    claim = settle(question)
    assert claim.verdict is Verdict.PROVEN
    T, worst = subject.basis, 0.0
    W, C = subject.gains.W, subject.gains.C
    for M, K in zip(subject.floats.M, subject.floats.K, strict=True):
        m, c, k = (T.T @ X @ T for X in (M, C, K))
        t = len(m)
        A = np.block([[np.zeros((t, t)), np.eye(t)], [-np.linalg.solve(m, np.hstack([k, c]))]])
        U = np.hstack([W @ T, C @ T]) / 10
        Q = scipy.linalg.block_diag(T.T @ T / 0.05**2, T.T @ T / 0.5**2) + U.T @ U
        E = scipy.linalg.block_diag(T.T @ T / 0.1**2, T.T @ T / 0.5**2)
        P = scipy.linalg.solve_continuous_lyapunov(A.T, -Q)
        worst = max(worst, scipy.linalg.eigh(P, E, eigvals_only=True)[-1])
    assert worst <= claim.figure <= worst * (1 + 1e-6)
    assert confirm(question, worst * (1 - 1e-9)) is not Verdict.PROVEN


def test_margins_in_different_units_of_joints_make_d(asked):
    one, many = (asked(decay=1, positivity=each) for each in ("0.25 N*m/rad", {"q1": 0.5, "q2": 0.25, "q3": 0.125}))
    assert (one.asked.mu, one.asked.D.tolist()) == (0.25, [1.0, 1.0, 1.0])
    assert (many.asked.mu, many.asked.D.tolist()) == (1.0, [0.5, 0.25, 0.125])
    for subject in (one, many):
        claim = claims(positivity, subject)["K full"]
        D = np.diag(subject.asked.D)
        least = min(scipy.linalg.eigh(K, D, eigvals_only=True)[0] for K in subject.floats.K)
        assert claim.figure == pytest.approx(least, rel=1e-9)
        assert claim.verdict is Verdict.PROVEN


def test_error_bounds_that_are_asked_hold_at_every_vertex(asked):
    nominal = claims(errors, asked(decay=1))["position error under force"].figure
    subject = asked(decay=1, position_error="1 rad")
    everywhere = claims(errors, subject)["position error under force"]
    assert everywhere.scope.value == "nominal plant and all vertices"
    assert everywhere.figure >= nominal
    tight = asked(decay=1, position_error=f"{nominal * 0.999!r} rad")
    assert claims(errors, tight)["position error under force"].verdict is Verdict.REFUTED


@pytest.mark.parametrize("region", [{"decay": 500}, {"bandwidth": 1}])
def test_what_the_poles_do_not_reach_is_refuted_by_routh_and_left_open_by_inequalities(asked, region):
    found = claims(poles, asked(**region))
    assert len(found) == 2
    for name, claim in found.items():
        assert claim.verdict is (Verdict.UNDECIDED if name.endswith("LMI") else Verdict.REFUTED)
