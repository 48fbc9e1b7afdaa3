"""The exported mechanism is the same one: M, theta and contact points agree to rounding, or it is refused."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import firmtouch
from firmtouch.oracle import (
    NotExpressibleError,
    check_export,
    check_export_at_rest,
    compare_motion_with_mujoco,
    export_mechanism,
    find_touches,
)
from firmtouch.oracle.machine import Machine
from firmtouch.regulation.operating_point import locate

ROOT = Path(__file__).parents[2]
ROUNDING = 1e-13  # of sums of some hundred products, relative to the largest


def export(model, **settings):
    plant = firmtouch.derive_plant(model.spec)
    return export_mechanism(plant, locate(plant).q, **settings)


def test_the_shipped_arms_agree_with_mujoco_to_rounding(arm):
    op = arm.operating_point
    agreement = check_export(export_mechanism(op.plant, op.q_d, touches=find_touches(op)))
    assert agreement.in_motion < ROUNDING


def test_parameters_other_than_the_nominal_ones_are_exported(wall):
    op = wall.operating_point
    heavier = op.plant.with_parameters(1.1 * op.plant.p)
    assert check_export(export_mechanism(heavier, op.q_d)).in_motion < ROUNDING
    mistaken = replace(export_mechanism(heavier, op.q_d), plant=op.plant)
    with pytest.raises(NotExpressibleError, match=r"M differs by 0\.3"):  # m l^2 grows by 1.1^3
        check_export(mistaken)
    with pytest.raises(NotExpressibleError, match=r"gravity differs by 0\.3"):  # m l g grows by 1.1^3 too
        check_export_at_rest(mistaken)


def test_two_arms_become_two_chains(shipped):
    exported = export(shipped("two_arms_bar"))
    assert check_export(exported).in_motion < ROUNDING
    assert exported.xml.count("\n    <body") == 2


def test_six_joints_in_space_agree(grinder):
    op = firmtouch.find_operating_point(firmtouch.derive_plant(grinder.spec))
    assert check_export(export_mechanism(op.plant, op.q_d, touches=find_touches(op))).in_motion < ROUNDING


POINT = None
CASES = {
    # A cart on rails carries a point mass on a rod, whose angle is seen by its acceleration alone; a block stands still.
    "cart": (
        "x:m q",
        "[0, -9.81]",
        {"cart": ("[x, 0*l]", POINT), "bob": ("[x + l*sin(q), -l*cos(q)]", POINT), "block": ("[l, l]", POINT)},
    ),
    # One mass on two slides: the link between them has no mass.
    "slides": ("x:m y:m", "[0, -9.81]", {"mass": ("[x, y]", POINT)}),
    # A universal joint, again without mass in its middle, and a slide along the link.
    "universal": (
        "a b r:m",
        "[0, 0, -9.81]",
        {"rod": ("r*[cos(b)*cos(a), cos(b)*sin(a), -sin(b)]", [{"z": "a"}, {"y": "b"}])},
    ),
    # Coordinates that count from the tip of the chain to its base.
    "backwards": (
        "b a",
        "[0, -9.81]",
        {"base": ("l*[cos(a), sin(a)]", "a"), "tip": ("l*[cos(a) + cos(a + b), sin(a) + sin(a + b)]", "a + b")},
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_slides_point_masses_and_massless_links_agree(make_model, case):
    coordinates, gravity, bodies = CASES[case]
    made = {}
    for name, (centre, orientation) in bodies.items():
        made[name] = {"mass": "2*m", "centre_of_mass": centre}
        if orientation is not POINT:
            inertia = "I" if isinstance(orientation, str) else ["I", "2*I", "2*I"]
            made[name] |= {"inertia": inertia, "orientation": orientation}
    names = [each.partition(":")[0] for each in coordinates.split()]
    model = make_model(
        coordinates,
        parameters={"l": "0.4 m", "m": "1 kg", "I": "0.03 kg*m^2"},
        mechanism={"gravity": gravity, "bodies": made},
        constraints={"any": "x - l" if "x" in names else "l*sin(a)"},
        guess=dict.fromkeys(names, 0.3),
    )
    assert check_export(export(model)).in_motion < 1e-11  # a point mass is given 1e-12 kg m^2, beside 0.1 of its own


def test_geared_rotors_agree_at_rest_and_are_refused_in_motion(shipped, loop_of):
    loop = loop_of(shipped("spatial_6r_plane"))
    op = loop.operating_point
    exported = export_mechanism(op.plant, op.q_d, touches=find_touches(op))
    agreement = check_export_at_rest(exported)
    assert agreement.at_rest < ROUNDING
    # What couples a rotor's spin to its carrier is left out: ratio * Jr = 6e-4 kg m^2, beside 1 kg m^2 of the whole arm.
    assert 1e-4 < agreement.M < 1e-3
    with pytest.raises(NotExpressibleError, match=r"it is another mechanism: MuJoCo's M differs by 0\.000"):
        check_export(exported)
    with pytest.raises(NotExpressibleError, match="another mechanism"):
        compare_motion_with_mujoco(loop)


def test_a_rotors_inertia_counts_by_the_gears_ratio_squared(shipped):
    exported = export(shipped("spatial_6r_plane"))
    armatures = [float(each) for each in re.findall(r'armature="([^"]*)"', exported.xml)]
    assert armatures == pytest.approx([100**2 * 6e-6] * 3)


def test_energies_are_refused(shipped):
    with pytest.raises(NotExpressibleError, match="given by its energies"):
        export(shipped("pendulum_rod"))


def test_angles_that_count_from_the_ground_are_refused(shipped):
    absolute = shipped(
        "planar_2r_wall", ("along: [cos(q1 + q2), sin(q1 + q2)]", "along: [cos(q2), sin(q2)]"), ("q1 + q2", "q2")
    )
    with pytest.raises(NotExpressibleError, match="counted from the ground"):
        export(absolute)


def test_a_coordinate_that_is_no_angle_is_refused(shipped):
    with pytest.raises(NotExpressibleError, match=r"`q2` is no angle .* moves by 2 for one unit"):
        export(shipped("planar_2r_wall", ("q1 + q2", "q1 + 2*q2")))


def test_what_mujoco_would_change_without_a_word_is_refused(wall):
    with pytest.raises(NotExpressibleError, match="below two time steps"):
        export_mechanism(wall.operating_point.plant, wall.operating_point.q_d, timestep=0.011)


def test_what_mujoco_refuses_is_told(wall):
    op = wall.operating_point
    exported = export_mechanism(op.plant, op.q_d)
    with pytest.raises(NotExpressibleError, match=r"MuJoCo refuses the mechanism: .*mass"):
        Machine(replace(exported, xml=exported.xml.replace('mass="4.0"', 'mass="-4.0"')))


def test_the_gap_is_phi_and_the_rows_force_is_mujocos_contact_force(arm, rng):
    import mujoco

    op = arm.operating_point
    machine = Machine(export_mechanism(op.plant, op.q_d, touches=find_touches(op)))
    seen = 0
    for _ in range(50):
        q = op.q_d + rng.uniform(-0.05, 0.05, op.n)
        machine.place(q, np.zeros(op.n))
        phi = op.plant.Phi(q)[0]  # the contact is the first constraint of every one of these arms
        if phi > 0:
            assert machine.data.ncon == 0
            continue
        seen += 1
        assert machine.data.contact.dist == pytest.approx([phi], abs=1e-15)  # rounding at metre size
        force = np.zeros(6)
        mujoco.mj_contactForce(machine.model, machine.data, 0, force)
        assert machine.lambda_()[0] == pytest.approx(force[0])
        # J^T lambda is all that constrains: the same sign, scale and point as ours.
        assert op.plant.J(q).T @ machine.lambda_() == pytest.approx(machine.data.qfrc_constraint, rel=1e-9, abs=1e-9)
    assert seen > 10


def test_robots_are_not_exported_and_it_is_said():
    plant = firmtouch.derive_plant(firmtouch.read_model(ROOT / "models" / "panda_plane.yaml").spec)
    with pytest.raises(NotExpressibleError, match="held against Pinocchio"):
        export_mechanism(plant, np.zeros(plant.n))
