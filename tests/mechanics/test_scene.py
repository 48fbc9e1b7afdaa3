"""The picture's numbers: forces by virtual work, joints, and ghosts on the constraint."""

import json

import numpy as np
import pytest

import firmtouch
from firmtouch.mechanics import draw_scene
from firmtouch.modelfile.rows import rows_written
from firmtouch.modelfile.sections.frames import OnFrames
from firmtouch.regulation import project, split_directions

EXACT = 1e-12  # positions and forces of order one, through some ten operations


@pytest.fixture
def drawn():
    """Draw a model at its operating point, and say where that is."""

    def draw(model, ghosts=()):
        op = firmtouch.find_operating_point(firmtouch.derive_plant(model.spec))
        return op, draw_scene(op.plant, op.q_d, op.lambda_d, ghosts)

    return draw


def rows_of_force(spec, contact):
    """Which rows of Phi a contact's force stands for: those of its entry that count metres; moments are no force."""
    rows, entry = list(spec.constraints), spec.entries[contact]
    if not isinstance(entry, OnFrames):
        return [rows.index(contact)]
    return [rows.index(name) for name, row in entry.rows(contact).items() if row.unit == "m"]


def test_each_contact_force_does_the_virtual_work_of_its_constraint(op):
    scene = draw_scene(op.plant, op.q_d, op.lambda_d)

    def place(q, contact):
        """Say where the force acts, relative to where its reaction does (if on the mechanism too)."""
        found = next(each for each in draw_scene(op.plant, q, op.lambda_d).forces if each.constraint == contact)
        return found.point - (0 if found.reaction_at is None else found.reaction_at)

    for each in scene.forces:
        share = sum(op.lambda_d[j] * op.J[j] for j in rows_of_force(op.plant.spec, each.constraint))
        steps = np.eye(op.n) * 1e-5
        moved = [place(op.q_d + h, each.constraint) - place(op.q_d - h, each.constraint) for h in steps]
        missing = np.linalg.norm(np.array(moved) @ each.force / 2e-5 - share) / (np.linalg.norm(share) or 1.0)
        assert missing == pytest.approx(each.remainder, abs=1e-8)  # central differences of step 1e-5


def test_a_walls_force_is_along_its_normal_with_the_size_of_lambda(make_arm, drawn):
    drawing = {"lines": {"arm": ["p0", "p1", "p2"]}, "contacts": {"wall": "p2"}}
    _, scene = drawn(make_arm(2, {"wall": "0.55 - x(p2)"}, [1.0, -0.9], lambda_d={"wall": 40}, drawing=drawing))
    (contact,) = scene.forces
    assert contact.force == pytest.approx([-40, 0], abs=1e-9)  # towards growing phi, away from the wall
    assert contact.point[0] == pytest.approx(0.55, abs=EXACT)
    assert contact.remainder < EXACT


def test_a_moment_is_a_remainder_that_no_force_makes(make_arm, drawn):
    drawing = {"lines": {"arm": ["p0", "p3"]}, "contacts": {"wall": "p3", "level": "p3"}}
    constraints = {"wall": "0.9 - x(p3)", "level": {"expression": "a3 + 0.2", "unit": "rad"}}
    # With three joints a force at the tip has two components, and a moment takes the third.
    _, scene = drawn(make_arm(3, constraints, [0.9, -0.8, -0.3], drawing=drawing))
    assert {each.constraint: each.remainder > 0.1 for each in scene.forces} == {"wall": False, "level": True}


def test_without_a_drawing_a_planar_arm_is_drawn_through_its_joints(make_arm, drawn):
    op, scene = drawn(make_arm(2, {"wall": "0.55 - x(p2)"}, [1.0, -0.9]))
    q1, q2 = op.q_d
    elbow = 0.4 * np.array([np.cos(q1), np.sin(q1)])
    centre = elbow + 0.18 * np.array([np.cos(q1 + q2), np.sin(q1 + q2)])
    assert scene.lines[0] == pytest.approx(np.array([[0, 0], elbow, centre]), abs=EXACT)
    assert scene.masses == pytest.approx(np.array([elbow * 0.18 / 0.4, centre]), abs=EXACT)
    assert (scene.dimension, scene.forces, scene.walls) == (2, (), ())


def test_without_a_drawing_a_spatial_arm_is_drawn_through_its_joints(make_model, drawn):
    upper, fore = "[cos(a)*cos(b), sin(a)*cos(b), sin(b)]", "[cos(a)*cos(b + c), sin(a)*cos(b + c), sin(b + c)]"
    link = {"mass": "m", "inertia": [0.01, 0.04, 0.04]}
    bodies = {
        "upper": link | {"centre_of_mass": f"0.5*l*{upper}", "orientation": [{"z": "a"}, {"y": "-b"}]},
        "fore": link | {"centre_of_mass": f"l*{upper} + 0.3*l*{fore}", "orientation": [{"z": "a"}, {"y": "-b - c"}]},
    }
    model = make_model(
        "a b c",
        parameters={"m": "2 kg", "l": "0.6 m"},
        mechanism={"gravity": "[0, 0, -9.81]", "bodies": bodies},
        definitions={"tip": f"l*{upper} + l*{fore}"},
        constraints={"table": "z(tip) - 0.2"},
        guess={"a": 0.4, "b": 0.9, "c": -1.4},
    )
    op, scene = drawn(model)
    a, b, _ = op.q_d
    elbow = 0.6 * np.array([np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.sin(b)])
    assert scene.dimension == 3
    assert scene.lines[0][:2] == pytest.approx(np.array([[0, 0, 0], elbow]), abs=EXACT)
    assert scene.lines[0][2] == pytest.approx(scene.masses[1], abs=EXACT)


def test_ghosts_lie_on_the_constraint_and_move_the_lines(make_arm, drawn):
    drawing = {"lines": {"arm": ["p0", "p1", "p2", "p3"]}, "surfaces": {"c": {"centre": "[0.9, 0.2]", "radius": 0.25}}}
    model = make_arm(3, {"circle": "norm(p3 - [0.9, 0.2]) - 0.25"}, [1.2, -0.9, -0.7], drawing=drawing)
    op, _ = drawn(model)
    away = [project(op.plant, op.q_d + 0.2 * each).q for each in split_directions(op.J).V2.T]
    _, scene = drawn(model, away)
    (circle,) = scene.rounds
    assert (circle.radius, *circle.centre) == pytest.approx((0.25, 0.9, 0.2))
    for (ghost,) in scene.ghosts:
        assert np.linalg.norm(ghost[-1] - circle.centre) == pytest.approx(circle.radius, abs=1e-11)  # Newton's residual
        assert np.linalg.norm(np.diff(ghost, axis=0), axis=1) == pytest.approx([0.4, 0.4, 0.4], abs=EXACT)
        assert np.abs(ghost - scene.lines[0]).max() > 0.02


CHAIN = {"planar_chain": {"n": 3, "length": "0.4 m", "mass": "1 kg"}}


@pytest.fixture
def chain_scene(make_model):
    """Draw a chain of three rods at some angles; where its constraints do not hold, it is drawn all the same."""

    def draw(constraint, q):
        data = {
            "schema": "firmtouch.model/1",
            "title": "A chain",
            "mechanism": CHAIN,
            "constraints": {"held": constraint},
            "operating_point": {"guess": dict(zip(("q1", "q2", "q3"), q, strict=True)), "lambda_d": {}},
            "design": {"force_feedback": 0.5},
        }
        rows = rows_written(constraint)
        data["operating_point"]["lambda_d"] = {each.name("held"): 10 for each in rows}
        data["design"]["poles"] = [-4 - i for i in range(2 * (3 - len(rows)))]
        plant = firmtouch.derive_plant(firmtouch.parse_model(json.dumps(data).encode(), name="chain").spec)
        return draw_scene(plant, np.array(q, dtype=float), np.zeros(plant.m))

    return draw


def test_a_chain_stands_on_its_base_with_the_first_joints_axis(chain_scene):
    scene = chain_scene({"distance": "0.5 m", "between": ["link1", "tip"]}, [0.5, -0.7, 0.9])
    (base,) = scene.bases
    assert base.point == pytest.approx([0, 0, 0], abs=EXACT)
    assert base.axis == pytest.approx([0, 0, 1], abs=EXACT)


def test_a_rod_is_drawn_between_its_frames(chain_scene):
    scene = chain_scene({"distance": "0.5 m", "between": ["link2", "tip"]}, [0.5, -0.7, 0.9])
    (rod,) = scene.rails
    assert rod[1] == pytest.approx(max((each[-1] for each in scene.lines), key=lambda x: x[0]), abs=EXACT)
    assert rod[0] == pytest.approx([0.4 * np.cos(0.5), 0.4 * np.sin(0.5), 0], abs=EXACT)


def test_rails_are_drawn_where_they_are(chain_scene):
    line = {"rail": {"line": {"point": [0, "0.3 m", 0], "direction": [2, 0, 0]}}, "frame": "tip", "hold": "point"}
    (straight,) = chain_scene(line, [0.5, -0.7, 0.9]).rails
    assert np.diff(straight, axis=0)[0, 1:] == pytest.approx([0, 0], abs=EXACT)
    circle = {
        "rail": {"circle": {"centre": ["0.5 m", 0, 0], "axis": [0, 0, 3], "radius": "0.2 m"}},
        "frame": "tip",
        "hold": "point",
    }
    (ring,) = chain_scene(circle, [0.5, -0.7, 0.9]).rails
    assert np.linalg.norm(ring - [0.5, 0, 0], axis=1) == pytest.approx(0.2, abs=EXACT)
    assert ring[:, 2] == pytest.approx(0, abs=EXACT)


def test_joined_frames_hold_what_is_between_them_and_the_chains_end_at_the_hands(chain_scene):
    join = {"join": [{"frame": "tip", "position": ["0.1 m", 0, 0]}, "link2"], "hold": "point", "without": ["z"]}
    scene = chain_scene(join, [0.5, -0.7, 0.9])
    (held,) = scene.held
    tip = np.array([*np.sum([[np.cos(a), np.sin(a)] for a in np.cumsum([0.5, -0.7, 0.9])], axis=0) * 0.4, 0])
    assert held.ends[0] == pytest.approx(tip, abs=EXACT)
    assert held.ends[1] == pytest.approx([0.4 * np.cos(0.5), 0.4 * np.sin(0.5), 0], abs=EXACT)
    assert held.across @ (held.ends[1] - held.ends[0]) == pytest.approx(0, abs=EXACT)
    assert np.linalg.norm(held.across) == pytest.approx(1, abs=EXACT)
    assert any(np.allclose(each[-1], tip) for each in scene.lines)
