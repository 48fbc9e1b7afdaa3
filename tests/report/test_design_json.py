"""`design.json`: its keys and shapes, and its numbers computed once more from other numbers of the same file."""

import hashlib
import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]

# What `firmtouch.design/1` promises: shapes in terms of n and m, k = 2(n - m) poles, () for a number.
OPTIONAL = {"reached"}  # of a robot: how its configuration was found
SHAPES = {
    "operating_point": {
        "q_d": "n",
        "lambda_d": "m",
        "f_d": "n",
        "M": "nn",
        "J": "mn",
        "gravity_gradient": "n",
        "P_qq": "nn",
        "constraint_hessians": "mnn",
        "N0": "nn",
    },
    "gains": {"W": "nn", "C": "nn", "G_f": "mm", "bias": "n"},
    "poles": {"requested": "k2", "achieved": "k2", "residual": ""},
}
# Causes: a force has n components, an offset and a rotation have m, a tilt has one row of n for each constraint.
CAUSES = {"force": ("n",), "offset": ("m",), "rotation": ("m",), "tilt": ("m", "n")}
CONDITION = 1e4  # of K on any shipped model, at most; what the formulas lose against each other
EXACT = 1e-12


@pytest.fixture
def data(report) -> dict:
    return report.json


@pytest.fixture
def sizes(data) -> dict[str, int]:
    n, m = data["model"]["n"], data["model"]["m"]
    return {"n": n, "m": m, "k": 2 * (n - m), "2": 2}


@pytest.fixture
def given(data) -> dict[str, np.ndarray]:
    """All matrices by their names, K of Eq. (14), and an orthonormal basis of ker J that is not firmtouch's."""
    arrays = {name: np.array(each) for name, each in (data["operating_point"] | data["gains"]).items()}
    J = arrays["J"]
    complete, _ = np.linalg.qr(J.T, mode="complete")
    return arrays | {"K": arrays["W"] + arrays["N0"], "free": complete[:, len(J) :]}


def near(actual, expected, tolerance=EXACT):
    actual, expected = np.asarray(actual, dtype=float), np.asarray(expected, dtype=float)
    scale = max(1.0, float(np.max(np.abs(expected), initial=0.0)))
    np.testing.assert_allclose(actual, expected, rtol=0, atol=tolerance * scale)


def digest(path, model):
    """The file, and behind it the files that it names: `cat model.yaml arm.urdf | sha256sum`."""
    attached = b"".join((path.parent / each).read_bytes() for each in model.attached)
    return hashlib.sha256(path.read_bytes() + attached).hexdigest()


def leaves(value) -> Iterator[object]:
    if isinstance(value, dict | list):
        for each in value.values() if isinstance(value, dict) else value:
            yield from leaves(each)
    else:
        yield value


def test_it_names_its_schema_and_the_file_it_was_made_from(report, data):
    path = ROOT / "models" / f"{report.model.name}.yaml"
    assert data["schema"] == "firmtouch.design/1"
    assert data["model"]["name"] == path.stem
    assert data["model"]["sha256"] == digest(path, report.model)
    assert (data["model"]["n"], data["model"]["m"]) == (report.model.spec.n, report.model.spec.m)


def test_every_promised_key_is_there_with_its_shape(data, sizes):
    for section, shapes in SHAPES.items():
        assert set(data[section]) - OPTIONAL == set(shapes)
        for name, letters in shapes.items():
            assert np.shape(data[section][name]) == tuple(sizes[each] for each in letters), f"{section}.{name}"


def test_the_steady_state_has_a_row_for_each_cause(data, sizes):
    assert set(data["steady_state"]) == set(CAUSES)
    for name, letters in CAUSES.items():
        row, causes = data["steady_state"][name], math.prod(sizes[each] for each in letters)
        assert np.shape(row["position"]) == (sizes["n"], causes)
        assert np.shape(row["constraint_force"]) == (sizes["m"], causes)
        for worst in ("worst_position", "worst_constraint_force"):
            assert isinstance(row[worst], float)
            assert row[worst] >= 0


def test_positivity_and_warnings_have_their_forms(data):
    assert set(data["positivity"]) == {"full", "tangent"}
    for level in data["positivity"].values():
        assert set(level) == {"holds", "K_min", "C_min", "W_min"}
        assert isinstance(level["holds"], bool)
    assert all(isinstance(each, str) for each in data["warnings"])


def test_every_number_is_finite(data):
    numbers = [each for each in leaves(data) if isinstance(each, float)]
    assert len(numbers) > 40
    assert all(math.isfinite(each) for each in numbers)


def test_matrices_that_are_symmetric_are_so_to_the_last_bit(given):
    for name in ("M", "P_qq", "N0", "W", "C", "G_f"):
        np.testing.assert_array_equal(given[name], given[name].T, err_msg=name)
    for hessian in given["constraint_hessians"]:
        np.testing.assert_array_equal(hessian, hessian.T)


def test_the_plants_stiffness_is_that_of_its_potential_less_the_curvature_of_the_constraints(given):
    curvature = sum(lam * H for lam, H in zip(given["lambda_d"], given["constraint_hessians"], strict=True))
    near(given["N0"], given["P_qq"] - curvature)


def test_the_force_and_the_bias_follow_from_the_multipliers(given):
    near(given["f_d"], given["J"].T @ given["lambda_d"])
    near(given["bias"], given["gravity_gradient"] - given["f_d"])


def test_the_poles_are_those_of_the_motion_along_the_constraints(data, given):
    M22, C22, K22 = (given["free"].T @ given[name] @ given["free"] for name in ("M", "C", "K"))
    size = len(M22)
    inverse = np.linalg.inv(M22)
    companion = np.block([[np.zeros((size, size)), np.eye(size)], [-inverse @ K22, -inverse @ C22]])
    found = list(np.linalg.eigvals(companion))
    achieved, requested = (np.array(data["poles"][name]) @ [1, 1j] for name in ("achieved", "requested"))
    fastest = np.max(np.abs(requested))
    for pole in achieved:
        nearest = min(found, key=lambda each: abs(each - pole))
        found.remove(nearest)
        # A double pole moves by the square root of the rounding of the gains, 1e-8 of it, times a condition.
        assert abs(nearest - pole) < 1e-6 * fastest
    distances = np.abs(achieved - requested) / np.abs(requested)
    assert data["poles"]["residual"] == pytest.approx(np.max(distances), abs=EXACT)
    assert data["poles"]["residual"] < 1e-6
    assert all(pole.real < 0 for pole in achieved)


def test_the_poles_do_not_depend_on_the_force_feedback_and_neither_does_the_pencil(data, given):
    # The determinant of Eqs. (19)-(20) at a requested pole, against its size at a place between the poles.
    n, m = len(given["M"]), len(given["J"])
    feedback = given["J"].T @ (np.eye(m) + given["G_f"])

    def determinant(s):
        stiffness = given["M"] * s**2 + given["C"] * s + given["K"]
        return np.linalg.det(np.block([[stiffness, -feedback], [given["J"], np.zeros((m, m))]]))

    requested = np.array(data["poles"]["requested"]) @ [1, 1j]
    fastest = np.max(np.abs(requested))
    for pole in requested:
        # At a simple pole it vanishes to rounding; at one of order two, to the square of the poles' own precision.
        assert abs(determinant(pole)) < 1e-6 * abs(determinant(pole + 0.5 * fastest)), f"n = {n}, pole {pole}"


def test_positivity_is_that_of_the_eigenvalues(data, given):
    free = given["free"]
    for level, block in (("full", lambda X: X), ("tangent", lambda X: free.T @ X @ free)):
        told = data["positivity"][level]
        least = {name: np.linalg.eigvalsh(block(given[name]))[0] for name in ("K", "C", "W")}
        for name, value in least.items():
            scale = np.linalg.norm(given[name], 2)
            assert told[f"{name}_min"] == pytest.approx(value, abs=EXACT * scale)
        needed = least.values() if level == "full" else (least["K"], least["C"])
        assert told["holds"] == (min(needed) > 0)


def test_steady_state_errors_are_those_of_the_formulas_with_the_inverse_stiffness(data, given):
    J, K, lambda_d = given["J"], given["K"], given["lambda_d"]
    m, n = J.shape
    Lambda, inverse = np.linalg.inv(np.eye(m) + given["G_f"]), np.linalg.inv(K)
    stiffness = np.linalg.inv(J @ inverse @ J.T)  # of the contact: force for each offset
    T = inverse - inverse @ J.T @ stiffness @ J @ inverse
    force = -Lambda @ stiffness @ J @ inverse
    expected = {
        "force": (T, force),  # Eqs. (25), (26)
        "offset": (inverse @ J.T @ stiffness, Lambda @ stiffness),  # Eqs. (31), (32)
        "rotation": (np.zeros((n, m)), -Lambda),  # Eqs. (35), (36) in first order
        "tilt": (np.hstack([each * T for each in lambda_d]), np.hstack([each * force for each in lambda_d])),
    }
    for name, (position, constraint_force) in expected.items():
        near(data["steady_state"][name]["position"], position, EXACT * CONDITION)
        near(data["steady_state"][name]["constraint_force"], constraint_force, EXACT * CONDITION)


def test_the_rest_position_under_a_disturbance_solves_the_linear_equilibrium(data, given):
    J, K = given["J"], given["K"]
    m, n = J.shape
    force = data["steady_state"]["force"]
    matrix = np.block([[K, -J.T @ (np.eye(m) + given["G_f"])], [J, np.zeros((m, m))]])
    at_rest = np.linalg.solve(matrix, np.vstack([np.eye(n), np.zeros((m, n))]))
    near(force["position"], at_rest[:n], EXACT * CONDITION)
    near(force["constraint_force"], at_rest[n:], EXACT * CONDITION)


def test_worst_cases_are_norms_over_the_bounds_and_no_sample_exceeds_them(data, rng):
    for name in ("force", "offset"):
        row = data["steady_state"][name]
        semi_axes = np.array(row["bound"])
        causes = rng.normal(size=(2000, semi_axes.size))
        causes *= semi_axes / np.linalg.norm(causes, axis=1)[:, None]
        for effect in ("position", "constraint_force"):
            matrix, worst = np.array(row[effect]), row[f"worst_{effect}"]
            assert worst == pytest.approx(np.linalg.norm(matrix * semi_axes, 2), rel=1e-9)
            assert np.max(np.linalg.norm(causes @ matrix.T, axis=1)) <= worst * (1 + 1e-9)


def test_the_worst_cause_lies_within_its_bound_and_has_the_worst_effect(data):
    for name in ("force", "offset"):
        row = data["steady_state"][name]
        for effect in ("position", "constraint_force"):
            cause = np.array(row[f"worst_{effect}_cause"])
            assert np.linalg.norm(cause / row["bound"]) == pytest.approx(1, rel=1e-9)
            near(np.array(row[effect]) @ cause, row[f"worst_{effect}_effect"], 1e-9)
            assert np.linalg.norm(row[f"worst_{effect}_effect"]) == pytest.approx(row[f"worst_{effect}"], rel=1e-9)


def test_the_worst_tilt_and_the_worst_rotation_are_made_of_the_multipliers(data, given):
    lambda_d, J = given["lambda_d"], given["J"]
    tilt, force = data["steady_state"]["tilt"], data["steady_state"]["force"]
    radius = tilt["bound"] * np.linalg.norm(J, 2) * np.linalg.norm(lambda_d)
    for effect in ("position", "constraint_force"):
        assert tilt[f"worst_{effect}"] == pytest.approx(radius * np.linalg.norm(force[effect], 2), rel=1e-9)
    rotation = data["steady_state"]["rotation"]
    assert rotation["worst_position"] == 0
    cause = np.array(rotation["worst_constraint_force_cause"])
    assert abs(cause @ lambda_d) < 1e-9 * (1 + lambda_d @ lambda_d)  # a turned vector leaves at right angles
    assert np.linalg.norm(cause) <= rotation["bound"] * np.linalg.norm(lambda_d) * (1 + 1e-9)
    if len(lambda_d) == 1:
        assert rotation["worst_constraint_force"] == 0  # one multiplier has nowhere to turn


def test_every_check_that_the_design_passed_is_listed(data):
    assert data["checks"]
    assert all(each["holds"] for each in data["checks"])
