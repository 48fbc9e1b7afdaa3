"""Each check fails on what it is there for, and holds on what is well."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

import firmtouch
from firmtouch.checks import CHECKS, contact, curvature, derivatives, inertia, motion
from firmtouch.checks.subject import make_subject
from firmtouch.mechanics.symbolic import derive_symbolically
from firmtouch.modelfile.sections.joint_tree import Robot

NAMES = {
    "Phi(q_d) = 0", "rank of J", "f_d in range J^T", "joint limits", "drives hold q_d", "M symmetric", "M positive definite", "K homogeneous", "passivity",
    "rotations orthonormal", "Hessians symmetric", "Hessians exact", "energy kept", "lambda-Hessian", "two derivations",
}  # fmt: skip


def failed(model):
    report, _ = firmtouch.check_model(model)
    return {each.name for each in report.failed}


TOO_LARGE_FOR_SYMPY = {"spatial_6r_plane"}


def test_every_check_holds_on_every_shipped_model(model):
    report, symbolic = firmtouch.check_model(model)
    assert report.failed == ()
    assert report.holds
    assert {each.name for each in report.results} == NAMES
    assert len(report.results) == len(CHECKS) + 1
    assert (symbolic is None) == (model.name in TOO_LARGE_FOR_SYMPY or isinstance(model.spec.mechanism, Robot))
    for each in report.results:
        assert each.relation == "-" or (np.isfinite(each.figure) and each.detail)


@pytest.fixture(scope="module")
def make_cart(make_model):
    """Make a pendulum on a held cart from its kinetic energy; `s` is held at zero."""

    def make(K="j*dot(a)**2/2 + m*dot(s)**2/2", P="k*cos(a)", **more):
        sections = {
            "parameters": {"m": "2 kg", "j": "0.5 kg*m^2", "k": "3 J", "b": "0.4 kg*m/s", "e": "1 m^2*kg*s^2"},
            "mechanism": {"kinetic_energy": K, "potential_energy": P},
            "constraints": {"held": "s"},
            "guess": {"a": 0.3, "s": 0},
        }
        return make_model("a s:m", **(sections | more))

    return make


@pytest.mark.parametrize(
    ("K", "expected"),
    [
        ("j*dot(a)**2/2 + m*dot(s)**2/2", set()),
        ("j*dot(a)**2/2 + m*dot(s)**2/2 + b*dot(s)", {"K homogeneous"}),  # linear, in a direction that is held
        ("j*dot(a)**2/2 + m*dot(s)**2/2 + k", {"K homogeneous"}),  # constant
        ("j*dot(a)**2/2 + m*dot(s)**2/2 + e*dot(a)**4", {"K homogeneous", "energy kept", "two derivations"}),
        ("-j*dot(a)**2/2 + m*dot(s)**2/2", {"M positive definite"}),
        ("m*dot(s)**2/2", {"M positive definite", "energy kept"}),  # a coordinate without inertia
    ],
)
def test_each_kinetic_energy_fails_what_it_should(make_cart, K, expected):
    assert failed(make_cart(K)) == expected


def test_a_negative_mass_is_found_with_a_hint(make_arm):
    model = make_arm(2, {"wall": "0.55 - x(p2)"}, [1.0, -0.9], parameters={"m": "-2 kg"})
    report, _ = firmtouch.check_model(model)
    (row,) = report.failed
    assert row.name == "M positive definite"
    assert "negative mass" in row.detail
    assert row.figure < 0


@pytest.mark.parametrize(
    "third_row", [["0", "0", "1.001"], ["0", "0", "-1"], ["0.01*sin(a)", "0", "1"]], ids=["long", "mirrored", "skewed"]
)
def test_a_wrong_rotation_matrix_is_found(make_model, third_row):
    body = {"mass": "m", "inertia": [1, 2, 3], "centre_of_mass": "[l*cos(a), l*sin(a), s]"}
    body["orientation"] = [["cos(a)", "-sin(a)", "0"], ["sin(a)", "cos(a)", "0"], third_row]
    sections = {"constraints": {"held": "s"}, "guess": {"a": 0.3, "s": 0}, "parameters": {"m": "1 kg", "l": "1 m"}}
    model = make_model("a s:m", mechanism={"gravity": "[0, 0, -9.81]", "bodies": {"b": body}}, **sections)
    assert failed(model) == {"rotations orthonormal"}


def test_redundant_constraints_fail_the_rank_and_are_named(make_arm):
    model = make_arm(3, {"wall": "0.9 - x(p3)", "again": "2*x(p3) - 1.8"}, [0.9, -0.8, -0.3])
    report, _ = firmtouch.check_model(model)
    rows = {each.name: each for each in report.failed}
    assert "rank of J" in rows
    assert rows.keys() <= {"rank of J", "energy kept"}  # the multipliers of a motion are not unique either
    assert "the gradient of `again` is -2 wall" in rows["rank of J"].detail


def test_nearly_dependent_constraints_fail_the_rank_by_their_condition(make_arm):
    constraints = {"wall": "0.9 - x(p3)", "again": "2*x(p3) - 1.8 + 1e-8*y(p3)"}
    report, _ = firmtouch.check_model(make_arm(3, constraints, [0.9, -0.8, -0.3]))
    row = next(each for each in report.failed if each.name == "rank of J")
    assert 1e-10 < row.figure < 1e-7
    assert "condition number" in row.detail


def test_a_surface_out_of_reach_fails_with_the_miss(make_arm):
    report, _ = firmtouch.check_model(make_arm(2, {"wall": "1.0 - x(p2)"}, [0.3, 0.2]))
    rows = {each.name: each for each in report.failed}
    assert rows.keys() == {"Phi(q_d) = 0", "energy kept"}  # no motion on a constraint that is not met
    assert rows["Phi(q_d) = 0"].figure > 0.19  # the arm is 0.8 m long


def test_a_force_that_no_contact_can_carry_fails_its_check_alone(make_arm):
    point = {"f_d": {"q1": 1, "q2": 1}, "lambda_d": None}
    report, _ = firmtouch.check_model(make_arm(2, {"wall": "0.55 - x(p2)"}, [1.0, -0.9], operating_point=point))
    (row,) = report.failed
    assert row.name == "f_d in range J^T"
    assert 0 < row.figure < 1


def test_a_configuration_where_the_gradient_does_not_exist_fails_and_stops_nothing(make_arm):
    model = make_arm(2, {"point": "norm(p2 - p2)"}, [1.0, -0.9])
    report, _ = firmtouch.check_model(model)
    assert len(report.results) == len(CHECKS) + 1
    assert not report.holds
    assert "rank of J" in {each.name for each in report.failed}


@pytest.fixture(scope="module")
def subject(arm_on_circle):
    return make_subject(arm_on_circle.spec)


@pytest.fixture
def corrupted(subject):
    """Give the subject with one derived function multiplied, entry by entry, or replaced."""

    def corrupt(name, change):
        old = subject.plant.functions[name]
        inputs = old.sx_in()
        new = ca.Function(name, inputs, [ca.densify(change(old(*inputs), *inputs))])
        return replace(subject, plant=replace(subject.plant, functions=subject.plant.functions | {name: new}))

    return corrupt


@pytest.fixture(scope="module")
def symbolic(arm_on_circle):
    return derive_symbolically(arm_on_circle.spec)


def numeric_failures(subject, symbolic):
    rows = [*(check(subject) for check in CHECKS), derivatives.derivations_agree(subject, symbolic)]
    return {each.name for each in rows if not each.holds}


ALL_OF_M = {"K homogeneous", "passivity", "energy kept", "two derivations"}
TILTED = ca.DM([[1, 1.001, 1], [1, 1, 1], [1, 1, 1]])


@pytest.mark.parametrize(
    ("name", "change", "expected"),
    [
        ("theta", lambda theta, q, v, p: theta * ca.DM([1, 1, 0.999]), {"passivity", "energy kept", "two derivations"}),
        (
            "theta",  # a frame's rotation forgotten: does work, at q' = 0 not to be seen
            lambda theta, q, v, p: theta + ca.vertcat(v[1] ** 2, 0, 0) * 1e-3,
            {"passivity", "energy kept", "two derivations"},
        ),
        (
            "theta",  # does no work, so that energy and passivity cannot see it
            lambda theta, q, v, p: theta + ca.vertcat(-v[1], v[0], 0),
            {"two derivations"},
        ),
        ("P_q", lambda g, q, p: -g, {"passivity", "Hessians exact", "two derivations"}),
        ("P_qq", lambda X, q, p: X * 1.0001, {"Hessians exact", "two derivations"}),
        ("Phi_qq", lambda X, q, p: 0 * X, {"Hessians exact", "two derivations"}),
        ("Phi_qq", lambda X, q, p: X * TILTED, {"Hessians symmetric", "Hessians exact", "two derivations"}),
        ("M", lambda M, q, p: M * TILTED, ALL_OF_M | {"M symmetric"}),
        ("M", lambda M, q, p: M * 1.001, ALL_OF_M),
        ("J", lambda J, q, p: J * 1.001, {"Hessians exact", "energy kept", "two derivations"}),
        ("Jdot_qdot", lambda x, q, v, p: 0 * x, {"energy kept", "two derivations"}),
        ("P", lambda P, q, p: 1.01 * P, {"energy kept"}),
        ("K", lambda K, q, v, p: 1.01 * K, {"K homogeneous", "energy kept"}),
    ],
)
def test_a_corrupted_derivation_is_caught(corrupted, symbolic, name, change, expected):
    assert numeric_failures(corrupted(name, change), symbolic) == expected


def test_an_honest_derivation_fails_nothing(subject, symbolic):
    assert numeric_failures(subject, symbolic) == set()


def test_the_curvature_row_says_what_dropping_lambda_would_do(make_model):
    body = {"mass": "m", "centre_of_mass": "[x1, y1]"}
    model = make_model(
        "x1:m y1:m",
        parameters={"m": "1 kg", "l": "1 m"},
        mechanism={"gravity": "[0, -9.81]", "bodies": {"ball": body}},
        constraints={"rod": "norm([x1, y1]) - l"},
        guess={"x1": 0, "y1": -1},
        lambda_d={"rod": -9.81},
    )
    row = curvature.curvature_matters(make_subject(model.spec))
    assert "±3.132j" in row.detail  # sqrt(g / l)
    assert "without the term ±0" in row.detail
    assert "turn the verdict" in row.detail


def test_poles_that_are_zero_but_for_rounding_are_written_as_zero():
    assert curvature.in_words(np.array([-4.0, -1e-15, 1e-15, 9.0])) == "±2j, ±0, ±0, ±3"
    assert curvature.in_words(np.array([0.0])) == "±0"
    assert curvature.in_words(np.array([-1e-14])) == "±1e-07j"  # alone, it is no rounding of anything


def test_figures_are_the_same_on_every_run(subject):
    for check in (contact.full_rank, inertia.passive, motion.energy_kept):
        assert check(subject).figure == check(subject).figure
