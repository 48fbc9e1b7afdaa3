"""The claims of a certificate: each figure against 60 digits, or against what the rest of the package computes."""

import json
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ruamel.yaml import YAML
from tests.certificate.conftest import MODELS
from tests.certificate.exactly import DIGITS, bare, eigenvalues, kernel, matrix, orthonormal
from tests.synthesis.region_plants import draw_positive, draw_symmetric

import firmtouch
from firmtouch.certificate.certificate import Certificate, certify, questions_of
from firmtouch.certificate.claims import errors, gains, positivity, surface
from firmtouch.certificate.claims import poles as pole_claims
from firmtouch.certificate.decision import Verdict
from firmtouch.certificate.edges import Edge, EdgeKind
from firmtouch.certificate.question import Question, Scope, confirm, every, settle
from firmtouch.certificate.subject import subject_of
from firmtouch.mechanics.arrays import frozen
from firmtouch.modelfile.sections.bounds import Bounds
from firmtouch.regulation import Gains, close_loop, steady_state_errors

SAME = 1e-9  # relative, of figures that are bounds: at least the shrinking of 1e-12, and what |J| is bounded by
ROWS = ("force", "offset", "tilt")


def claims_of(kind, subject):
    return {each.name: settle(each) for each in kind.questions(subject)}


def draw_bare(seed, *, level="full", lambda_d=True):
    """Draw a subject of no mechanism; on the tangent level K is indefinite, and K22 > 0."""
    rng = np.random.default_rng([seed, 3])
    n = int(rng.integers(2, 6))
    m = int(rng.integers(1, min(3, n - 1) + 1))
    M, J = draw_positive(rng, n, 0.2, 5), rng.normal(size=(m, n))
    N0, C = draw_symmetric(rng, n, 3.0), draw_positive(rng, n, 1, 20)
    W = draw_positive(rng, n, 1, 100) + 2 * np.linalg.norm(N0, 2) * np.eye(n)
    if level == "tangent":
        V1 = np.linalg.svd(J)[2][:m].T
        W = W - V1 @ V1.T * 3 * np.linalg.norm(W + N0, 2)
        assert np.linalg.eigvalsh(W + N0)[0] < 0
    W = (W + W.T) / 2
    return bare(M, J, N0, W, (C + C.T) / 2, level=level, lambda_d=rng.normal(size=m) * 10 if lambda_d else np.zeros(m))


def exact_errors(subject):
    """Give the worst cases of the table with 60 digits, by the saddle-point system, and |J|."""
    op, n, m = subject.op, subject.op.n, subject.op.m
    with mp.workdps(DIGITS):
        J, K = matrix(op.J), matrix(subject.gains.W) + matrix(op.N0)
        saddle = mp.zeros(n + m)
        saddle[:n, :n], saddle[:n, n:], saddle[n:, :n] = K, -J.T, J
        inverse = mp.inverse(saddle)
        Lambda = mp.inverse(mp.eye(m) + matrix(subject.gains.G_f))
        # K dq - J^T mu = d and J dq = -Delta, with mu = (I + G_f) dlambda
        found = {
            ("position", "force"): inverse[:n, :n],
            ("force", "force"): Lambda * inverse[n:, :n],
            ("position", "offset"): inverse[:n, n:],
            ("force", "offset"): Lambda * inverse[n:, n:],
        }
        lambda_d = matrix(op.lambda_d).T
        radius = norm(J) * mp.norm(lambda_d)
        found |= {(what, "tilt"): found[what, "force"] * radius for what in ("position", "force")}
        if m > 1:
            size = mp.norm(lambda_d)
            across = mp.eye(m) * size - (lambda_d * lambda_d.T / size if size else mp.zeros(m))
            found["force", "rotation"] = Lambda * across
        return {f"{what} error under {cause}": norm(X) for (what, cause), X in found.items()}


def norm(X):
    product = X.T * X if X.cols <= X.rows else X * X.T
    return mp.sqrt(abs(eigenvalues(product)[-1]))


@settings(max_examples=25)
@given(seed=st.integers(0, 10**6), level=st.sampled_from(["full", "tangent"]))
def test_error_bounds_are_bounds_and_tight(seed, level):
    """At least the exact worst cases, and no more than 1e-9 above them; the tangent level has an indefinite K."""
    subject = draw_bare(seed, level=level)
    true, found = exact_errors(subject), claims_of(errors, subject)
    assert found.keys() == true.keys()
    for name, claim in found.items():
        assert claim.verdict is Verdict.PROVEN
        with mp.workdps(DIGITS):
            assert mp.mpf(claim.figure) >= true[name]
            assert claim.figure <= float(true[name]) * (1 + SAME)


@pytest.mark.parametrize("seed", range(6))
def test_no_smaller_error_bound_is_confirmed(seed):
    subject = draw_bare(seed)
    true = exact_errors(subject)
    for question in errors.questions(subject):
        value = float(true[question.name])
        slack = 1e-11 if "tilt" in question.name else 1e-14  # |J| is bounded from above by 1e-12 of itself
        assert confirm(question, value * (1 - slack)) is not Verdict.PROVEN
        assert confirm(question, value * (1 + slack)) is Verdict.PROVEN


def test_error_bounds_of_shipped_models_are_the_steady_state_errors(subject, certificate):
    """`regulation.steady_state` computes them otherwise: by the singular value decomposition of J."""
    table = steady_state_errors(close_loop(subject.op, subject.gains), subject.op.plant.spec.bounds)
    worst = {}
    for cause in (*ROWS, "rotation"):
        row = getattr(table, cause)
        worst[f"position error under {cause}"] = row.worst_position.value
        worst[f"force error under {cause}"] = row.worst_constraint_force.value
    found = [each for each in certificate.claims if " error under " in each.name]
    assert len(found) == (7 if subject.op.m > 1 else 6)
    for claim in found:
        assert claim.figure == pytest.approx(worst[claim.name], rel=SAME)


def test_no_force_and_no_angle_make_no_error():
    """What is exactly zero is bounded too: lambda_d = 0, and causes that the file bounds by nothing."""
    for seed in range(4):
        still = claims_of(errors, draw_bare(seed, lambda_d=False))
        for name in ("position error under tilt", "force error under tilt", "force error under rotation"):
            if name in still:
                assert still[name].verdict is Verdict.PROVEN
                assert 0 < still[name].figure < 1e-200
    subject = draw_bare(1)
    causes = replace(subject.asked.causes, tilt=0.0, rotation=0.0, offset=frozen(np.zeros(subject.op.m)))
    found = claims_of(errors, replace(subject, asked=replace(subject.asked, causes=causes)))
    assert all(each.verdict is Verdict.PROVEN for each in found.values())


def test_a_stiffness_that_resists_no_offset_has_a_bound():
    """K = 0 across the surface, on the tangent level: the force under an offset is zero but for rounding."""
    rng = np.random.default_rng(5)
    J = rng.normal(size=(1, 3))
    V2 = np.linalg.svd(J)[2][1:].T
    W = V2 @ np.diag([30.0, 50.0]) @ V2.T
    subject = bare(np.eye(3), J, np.zeros((3, 3)), (W + W.T) / 2, np.eye(3), level="tangent")
    found = claims_of(errors, subject)
    assert all(each.verdict is Verdict.PROVEN for each in found.values())
    assert found["force error under offset"].figure < 1e-12


@settings(max_examples=30)
@given(seed=st.integers(0, 10**6), level=st.sampled_from(["full", "tangent"]), mixed=st.booleans())
def test_margins_are_the_least_eigenvalues(seed, level, mixed):
    subject = draw_bare(seed, level=level)
    n = subject.op.n
    D = np.random.default_rng(seed).uniform(0.2, 5, n) if mixed else np.ones(n)
    subject = replace(subject, asked=replace(subject.asked, D=frozen(D)))
    with mp.workdps(DIGITS):
        W, C = matrix(subject.gains.W), matrix(subject.gains.C)
        K, Z = W + matrix(subject.op.N0), orthonormal(kernel(subject.op.J))
        root = mp.diag([mp.sqrt(mp.mpf(x)) for x in D.tolist()])
        scaled = mp.inverse(root) * K * mp.inverse(root)
        on = orthonormal(root * kernel(subject.op.J))
        true = {"C tangent": eigenvalues(Z.T * C * Z)[0]}
        if level == "full":
            true |= {"C full": eigenvalues(C)[0], "W full": eigenvalues(W)[0], "K full": eigenvalues(scaled)[0]}
            true["K tangent"] = eigenvalues(Z.T * K * Z)[0]
        else:
            true["K tangent"] = eigenvalues(on.T * scaled * on)[0]
    found = claims_of(positivity, subject)
    assert found.keys() == true.keys()
    for name, claim in found.items():
        if true[name] < 0:
            assert claim.verdict is Verdict.REFUTED
            continue
        assert claim.verdict is Verdict.PROVEN
        assert 0 < claim.figure < true[name]
        assert claim.figure == pytest.approx(float(true[name]), rel=1e-9, abs=1e-9)


def test_margins_count_for_the_worst_vertex():
    subject = draw_bare(3)
    op, n = subject.op, subject.op.n
    softer = replace(subject, vertices=((op.M, op.N0), (op.M * 0.5, op.N0 - 2 * np.eye(n))))
    before, after = claims_of(positivity, subject), claims_of(positivity, softer)
    assert after["K full"].figure == pytest.approx(before["K full"].figure - 2, rel=1e-9)
    assert after["W full"].figure == before["W full"].figure
    inertia = [claims_of(surface, each)["inertia"].figure for each in (subject, softer)]
    assert inertia[1] == pytest.approx(inertia[0] / 2, rel=1e-9)


def test_what_holds_for_the_nominal_plant_alone_is_refuted():
    """One vertex is softer than asked, or slower: asked is what lies between the nominal plant and that vertex."""
    subject = draw_bare(3)
    op, n = subject.op, subject.op.n
    least = claims_of(positivity, subject)["K full"].figure
    decay = claims_of(pole_claims, subject)["decay rate, Routh-Hurwitz"].figure
    asked = replace(subject.asked, mu=least - 1, edges=(Edge(EdgeKind.DECAY, decay * 0.9),))
    nominal = replace(subject, asked=asked)
    soft = replace(nominal, vertices=((op.M, op.N0), (op.M, op.N0 - 2 * np.eye(n))))
    heavy = replace(nominal, vertices=((op.M, op.N0), (op.M * 100, op.N0)))
    for each, verdict in ((nominal, Verdict.PROVEN), (soft, Verdict.REFUTED), (heavy, Verdict.PROVEN)):
        assert claims_of(positivity, each)["K full"].verdict is verdict
    routh = "decay rate, Routh-Hurwitz"
    assert claims_of(pole_claims, nominal)[routh].verdict is Verdict.PROVEN
    assert claims_of(pole_claims, heavy)[routh].verdict is Verdict.REFUTED


def test_the_rank_is_the_least_singular_value():
    for seed in range(5):
        subject = draw_bare(seed)
        claim = claims_of(surface, subject)["rank"]
        with mp.workdps(DIGITS):
            true = mp.sqrt(eigenvalues(matrix(subject.op.J) * matrix(subject.op.J).T)[0])
            assert 0 < mp.mpf(claim.figure) < true
        assert claim.figure == pytest.approx(float(true), rel=1e-9)


def test_dependent_constraints_and_an_inertia_that_is_none_are_refuted():
    J = np.array([[1.0, 2.0, 3.0], [2.0, 4.0, 6.0]])
    subject = bare(np.eye(3), np.vstack([J[0], J[0] + [0, 0, 1e-3]]), np.zeros((3, 3)), np.eye(3), np.eye(3))
    assert claims_of(surface, subject)["rank"].verdict is Verdict.PROVEN
    indefinite = bare(np.diag([1.0, 1.0, -1e-9]), J[:1], np.zeros((3, 3)), np.eye(3), np.eye(3))
    assert claims_of(surface, indefinite)["inertia"].verdict is Verdict.REFUTED


def test_the_force_loop_and_the_constant_force():
    subject = draw_bare(2)
    m = subject.op.m
    for G_f, verdict in ((-0.999999, Verdict.PROVEN), (-1.0, Verdict.REFUTED), (-1.5, Verdict.REFUTED)):
        moved = replace(subject, gains=replace(subject.gains, G_f=frozen(G_f * np.eye(m))))
        assert claims_of(surface, moved)["force loop"].verdict is verdict
    assert claims_of(surface, subject)["feedforward"].verdict is Verdict.PROVEN
    wrong = replace(subject.gains, bias=frozen(np.array(subject.gains.bias) + 1e-6))
    assert claims_of(surface, replace(subject, gains=wrong))["feedforward"].verdict is not Verdict.PROVEN


@pytest.mark.parametrize("name", ["W", "C", "G_f"])
def test_an_unsymmetric_gain_is_refuted(name):
    subject = draw_bare(4)
    X = np.array(getattr(subject.gains, name))
    if len(X) < 2:
        X = np.eye(2) * 0.5
    X[0, 1] = np.nextafter(X[0, 1], np.inf)
    spoilt = replace(subject, gains=replace(subject.gains, **{name: frozen(X)}))
    (question,) = gains.questions(spoilt)
    assert settle(question).verdict is Verdict.REFUTED


def test_another_subject_has_its_own_balls():
    """Gains put in another's place are proven for themselves."""
    subject = draw_bare(6)
    assert claims_of(positivity, subject)["C full"].verdict is Verdict.PROVEN
    other = replace(subject, gains=replace(subject.gains, C=frozen(-np.array(subject.gains.C))))
    assert claims_of(positivity, other)["C full"].verdict is Verdict.REFUTED


def test_shipped_designs_are_certified(certificate, subject):
    assert certificate.certified, certificate.open
    assert certificate.open == ()
    assert [each.name for each in certificate.claims] == [each.name for each in questions_of(subject)]
    for claim in certificate.claims:
        assert np.isfinite(claim.figure)
        if claim.asked is not None and claim.name != "symmetry":
            assert claim.figure >= claim.asked if claim.relation == ">" else claim.figure <= claim.asked


def test_shipped_decay_rates_are_what_the_poles_reach(certificate, subject):
    """Within what floats know of repeated poles: half of their digits."""
    true = min(-s.real for s in close_loop(subject.op, subject.gains).poles.pencil)
    for route in ("LMI", "Routh-Hurwitz"):
        (claim,) = [each for each in certificate.claims if each.name == f"decay rate, {route}"]
        assert claim.figure == pytest.approx(true, rel=1e-3 if route == "LMI" else 1e-6)
        assert claim.figure < true * (1 + 1e-6)


def test_bounds_of_the_file_are_the_causes():
    data = YAML(typ="safe", pure=True).load((MODELS / "planar_2r_circle.yaml").read_text(encoding="utf-8"))
    found = {}
    for size in (1, 3):
        data["bounds"] = {"disturbance": f"{size} N*m", "offset": f"{size} mm", "tilt": f"{size / 100} rad"}
        model = firmtouch.parse_model(json.dumps(data).encode(), name="made").with_method("poles")
        op = firmtouch.find_operating_point(firmtouch.derive_plant(model.spec))
        found[size] = claims_of(errors, subject_of(op, firmtouch.assign_poles(op, model.spec.design).gains))
    for name, claim in found[3].items():
        assert claim.figure == pytest.approx(3 * found[1][name].figure, rel=1e-9)


# Questions and claims themselves


def ask(holds, *, relation=">", asked=None, estimate=1.0, sufficient=False):
    return Question("n", "w", Scope.NOMINAL, relation, asked, "", "r", lambda: estimate, holds, sufficient)


def test_a_figure_is_the_best_that_is_proven_and_never_worse_than_asked():
    claim = settle(ask(lambda value: value < 0.95, asked=0.5))
    assert claim.verdict is Verdict.PROVEN
    assert claim.figure == pytest.approx(0.9)
    assert settle(ask(lambda value: value <= 0.5, asked=0.5)).figure == 0.5
    assert settle(ask(lambda value: value > 1.05, relation="<", asked=2.0)).figure == pytest.approx(1.1)
    assert settle(ask(lambda value: value < 0.3)).verdict is Verdict.UNDECIDED
    assert settle(ask(lambda value: True, estimate=np.inf, asked=0.5)).figure == 0.5
    assert settle(ask(lambda value: True, estimate=np.nan)).verdict is Verdict.UNDECIDED
    refuted = settle(ask(lambda value: False, asked=0.5))
    assert (refuted.verdict, refuted.figure) == (Verdict.REFUTED, np.inf)


def test_a_sufficient_condition_refutes_nothing():
    assert settle(ask(lambda value: False, asked=0.5, sufficient=True)).verdict is Verdict.UNDECIDED
    assert confirm(ask(lambda value: False, sufficient=True), 0.5) is Verdict.UNDECIDED


def test_a_division_by_zero_is_no_answer():
    def broken(value):
        raise ZeroDivisionError

    assert settle(ask(broken, asked=0.5)).verdict is Verdict.UNDECIDED


def test_confirming_takes_the_figure_and_what_is_asked():
    question = ask(lambda value: value < 0.95, asked=0.5)
    assert confirm(question, 0.9) is Verdict.PROVEN
    assert confirm(question, 0.96) is Verdict.REFUTED
    assert confirm(ask(lambda value: value > 0.7, asked=0.5), 0.9) is Verdict.REFUTED  # what is asked does not hold


@given(st.lists(st.sampled_from([True, False, None])))
def test_every_answer_counts(answers):
    found = every(iter(answers))
    assert found is (False if False in answers else None if None in answers else True)


def test_one_open_claim_is_enough_for_no_certificate(certificate):
    for i in range(len(certificate.claims)):
        for verdict in (Verdict.UNDECIDED, Verdict.REFUTED):
            spoilt = list(certificate.claims)
            spoilt[i] = replace(spoilt[i], verdict=verdict)
            found = Certificate(certificate.subject, tuple(spoilt))
            assert not found.certified
            assert found.open == (spoilt[i],)


def test_gains_of_another_plant_are_not_certified(subject):
    """A stiffness of the other sign on the same model."""
    wrong = Gains(frozen(-subject.gains.W), subject.gains.C, subject.gains.G_f, subject.gains.bias)
    found = certify(replace(subject, gains=wrong))
    assert not found.certified
    assert any(each.verdict is Verdict.REFUTED for each in found.open)


def test_bounds_are_ones_where_the_file_has_none(subject):
    assert isinstance(subject.op.plant.spec.bounds, Bounds)
    if subject.op.plant.spec.bounds.tilt is None:
        assert subject.asked.causes.tilt == 1.0
