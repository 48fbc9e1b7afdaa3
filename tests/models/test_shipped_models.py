"""Every file in `models/` is one that a user can start from: it reads, checks, has a design, and draws its contact."""

import jsonschema
import numpy as np
import pytest
from ruamel.yaml import YAML

import firmtouch
from firmtouch.mechanics import draw_scene
from firmtouch.modelfile.json_schema import model_schema
from firmtouch.modelfile.sections.frames import OnFrames
from firmtouch.synthesis.pole_assignment import requested_poles

SIZES = {  # name: (n, m)
    "dual_arm_box": (12, 6),
    "panda_plane": (7, 1),
    "panda_sphere_normal": (7, 3),
    "pendulum_rod": (2, 1),
    "planar_2r_circle": (2, 1),
    "planar_2r_wall": (2, 1),
    "planar_3r_circle": (3, 1),
    "planar_3r_wall": (3, 2),
    "spatial_3r_sphere": (3, 1),
    "spatial_6r_plane": (6, 1),
    "two_arms_bar": (6, 3),
    "ur5e_plane": (6, 1),
}


@pytest.fixture
def scene(op):
    return draw_scene(op.plant, op.q_d, op.lambda_d)


def test_the_model_is_listed_with_its_numbers_of_coordinates_and_constraints(model):
    assert (model.spec.n, model.spec.m) == SIZES[model.name]


def test_every_listed_model_is_shipped(request):
    shipped = {path.stem for path in (request.config.rootpath / "models").glob("*.yaml")}
    assert shipped == set(SIZES)


def test_the_json_schema_accepts_the_file(request, model):
    data = YAML(typ="safe", pure=True).load(request.config.rootpath / "models" / f"{model.name}.yaml")
    schema = model_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    jsonschema.Draft202012Validator(schema).validate(data)


def test_all_checks_hold(model):
    report, _ = firmtouch.check_model(model)
    assert [f"{each.name}: {each.figure:.3g}, {each.detail}" for each in report.failed] == []


def test_the_poles_are_achieved_by_both_routes(loop):
    requested = np.sort_complex(requested_poles(loop.operating_point.plant.spec.design))
    # Double poles move by the square root of the rounding of W and C, some 1e-7.
    tolerance = 1e-6 * np.max(np.abs(requested))
    for achieved in (loop.poles.pencil, loop.poles.reduced):
        # Sorting puts real parts first, and rounding may swap two poles whose real parts are alike: take the nearest.
        distance = np.abs(np.subtract.outer(requested, achieved))
        assert np.max(np.min(distance, axis=1)) < tolerance
        assert np.max(np.min(distance, axis=0)) < tolerance
        assert np.sum(achieved) == pytest.approx(np.sum(requested), abs=tolerance)


def test_the_design_holds_on_the_full_level_with_gains_of_a_sensible_size(loop):
    assert loop.full.holds
    assert np.linalg.norm(loop.gains.W) < 1e3  # a joint of such an arm is held with some 10 to 300 N m/rad


def test_the_worst_position_errors_are_small_enough_for_a_first_order_theory(loop):
    errors = firmtouch.steady_state_errors(loop, loop.operating_point.plant.spec.bounds)
    for each in (errors.force, errors.offset, errors.tilt):
        assert each.given
        assert 0 < each.worst_position.value < 0.2  # rad or m: the cosine of 0.2 rad is 2 % off one
    assert errors.rotation.given == (loop.operating_point.m > 1)  # for m = 1, R is +-1 and turns nothing


def test_the_force_feedback_bears_a_sample_of_delay(loop):
    gains = np.linalg.eigvalsh(loop.gains.G_f)
    assert gains[0] > 0
    assert gains[-1] < 1


def test_the_guess_is_close_to_the_configuration_that_it_is_projected_to(op):
    assert op.moved < 0.01  # guesses are given to 0.1 or 1 degree, that is 2 or 17 mrad in each joint


def test_the_drawing_has_a_contact_whose_force_makes_all_of_its_constraints_share(scene):
    assert scene.forces
    for each in scene.forces:
        assert each.remainder < 1e-9  # a least-squares solution of size one, whose rounding is 1e-16 times a condition


def test_the_force_has_the_size_of_the_multipliers_since_phi_counts_metres(op, scene):
    lambda_d = dict(zip(op.plant.spec.constraints, op.lambda_d, strict=True))
    for each in scene.forces:
        entry = op.plant.spec.entries[each.constraint]
        # The gradient of phi with respect to the contact point has length one; gaps along three axes make one force.
        rows = entry.rows(each.constraint) if isinstance(entry, OnFrames) else {each.constraint: entry}
        sizes = [lambda_d[name] for name, row in rows.items() if row.unit == "m"]
        assert np.linalg.norm(each.force) == pytest.approx(np.linalg.norm(sizes), rel=1e-9)


def test_the_force_points_out_of_the_surface(scene):
    for each in scene.forces:
        for surface in scene.rounds:
            outwards = (each.point - surface.centre) / surface.radius
            # On the rim to 1e-12, so the unit normal is good to 1e-11.
            assert np.linalg.norm(outwards) == pytest.approx(1, abs=1e-9)
            assert outwards @ each.force == pytest.approx(np.linalg.norm(each.force), rel=1e-9)
        for patch in scene.patches:
            # Both are the surface's normal there, times a number.
            assert each.point == pytest.approx(patch.contact, abs=1e-9)
            assert each.force == pytest.approx(np.linalg.norm(each.force) * patch.normal, rel=1e-9, abs=1e-9)
        for wall in scene.walls:
            assert wall.points[:, 0] == pytest.approx(each.point[0], abs=1e-9)  # projected to 1e-12
            assert each.force == pytest.approx([-np.linalg.norm(each.force), 0], abs=1e-9)  # the arm is to the left


def test_a_contact_is_drawn_where_a_line_ends(scene):
    ends = np.array([end for line in scene.lines for end in (line[0], line[-1])])
    for each in scene.forces:
        # The bar's contact stands at a stated place that the projection does not know: 1 mm is a pixel.
        assert np.min(np.linalg.norm(ends - each.point, axis=1)) < 1e-3
