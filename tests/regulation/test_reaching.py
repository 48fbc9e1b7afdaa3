"""`reach` in model files: what was asked is met with all constraints and limits, or it is said what stands in the way."""

import json
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

import firmtouch
from firmtouch.cli import main
from firmtouch.errors import NoDesignError
from firmtouch.mechanics.arm import arm_of
from firmtouch.mechanics.symbols import Symbols
from firmtouch.mechanics.tree import frame_pose
from firmtouch.modelfile.files import kept
from firmtouch.regulation.inverse_kinematics import BeyondLimitsError, OutOfReachError
from firmtouch.regulation.operating_point import DependentConstraintsError, OutsideLimitsError
from firmtouch.regulation.reaching import PointOffSurfaceError

URDF = Path(__file__).parents[2] / "models" / "urdf"
FILES = {path.name: path.read_bytes() for path in URDF.glob("*.urdf")}
MET = 1e-9  # m or rad: Phi is met to 1e-12, the rest to 1e-10
TABLE = {"surface": {"plane": {"point": [0, 0, 0.1], "normal": [0, 0, 1]}}}
UR5E = {"urdf": "ur5e.urdf", "tool": "flange"}
TWO = {"urdf": "dual_ur5e.urdf", "tool": ["left_tool0", "right_tool0"]}
POINT = [0.4, 0.2, 0.1]
DOWN = np.array([0, 0, -1])


def planar_urdf(lengths, limits, *, effort=100.0):
    """Write arms of planar links about z, with a tip."""
    pieces = ['<link name="ground"/>']
    for i, length in enumerate(lengths):
        lower, upper = limits[i]
        parent, at = ("ground", 0.0) if i == 0 else (f"l{i}", lengths[i - 1])
        pieces.append(
            f'<link name="l{i + 1}"><inertial><origin xyz="{length / 2} 0 0"/><mass value="1"/>'
            f'<inertia ixx="0.001" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="j{i + 1}" type="revolute"><origin xyz="{at} 0 0"/><parent link="{parent}"/><child link="l{i + 1}"/>'
            f'<axis xyz="0 0 1"/><limit lower="{lower}" upper="{upper}" effort="{effort}" velocity="3"/></joint>'
        )
    end = len(lengths)
    pieces.append(
        f'<link name="tip"/><joint name="end" type="fixed"><origin xyz="{lengths[-1]} 0 0"/><parent link="l{end}"/><child link="tip"/></joint>'
    )
    return f'<robot name="planar">{"".join(pieces)}</robot>'.encode()


def read(mechanism, constraints, point, free, files=FILES):
    """Read a robot that leaves so many poles free; without multipliers, all are zero but the one contact's."""
    if not {"lambda_d", "normal_force", "f_d"} & point.keys():
        point = point | {"normal_force": 20}
    document = {
        "schema": "firmtouch.model/1",
        "title": "A robot made by a test",
        "mechanism": mechanism,
        "constraints": constraints,
        "operating_point": point,
        "design": {"poles": [-4 - i for i in range(free)], "force_feedback": 0.5},
    }
    return firmtouch.parse_model(json.dumps(document).encode(), name="made", attached=kept(files))


def op_of(mechanism, constraints, point, free, files=FILES):
    return firmtouch.find_operating_point(firmtouch.derive_plant(read(mechanism, constraints, point, free, files).spec))


def pose(op, link, offset=(0, 0, 0)):
    """Give a link's place and axes at q_d."""
    symbols = Symbols(op.plant.spec)
    arm = arm_of(op.plant.spec, symbols)
    p, R = (each.full() for each in ca.Function("f", [symbols.q], [*frame_pose(arm.tree, link, symbols.q)])(op.q_d))
    return p[:, 0] + R @ np.array(offset), R


def within(op):
    return all(
        each.lower <= q <= each.upper for q, each in zip(op.q_d, op.plant.spec.coordinates.values(), strict=True)
    )


def test_a_contact_is_reached_straight_into_the_surface():
    op = op_of(UR5E, {"table": TABLE}, {"reach": {"point": POINT}}, 10)
    p, R = pose(op, "flange")
    assert p == pytest.approx(POINT, abs=MET)
    assert R[:, 2] == pytest.approx(DOWN, abs=MET)
    assert op.plant.Phi(op.q_d) == pytest.approx([0], abs=1e-12)
    assert within(op)
    assert op.lambda_d == pytest.approx([20])
    # Least room first: the one that is taken is the farthest from limits and singularities.
    rooms = [each.room for each in op.reached.solutions]
    assert rooms == sorted(rooms, reverse=True)


@pytest.mark.parametrize(
    ("axis", "before"),
    [("z", "x"), *(pytest.param(*each, marks=pytest.mark.slow) for each in (("x", "y"), ("y", "z")))],
)
def test_direction_and_across_are_met(axis, before):
    direction, across = np.array([0.2, -0.1, -1]), np.array([1, 1, 0.5])
    reach = {"point": POINT, "axis": axis, "direction": direction.tolist(), "across": across.tolist()}
    op = op_of(UR5E, {"table": TABLE}, {"reach": reach}, 10)
    p, R = pose(op, "flange")
    d = direction / np.linalg.norm(direction)
    beside = across - (across @ d) * d
    assert p == pytest.approx(POINT, abs=MET)
    assert R[:, "xyz".index(axis)] == pytest.approx(d, abs=MET)
    assert R[:, "xyz".index(before)] == pytest.approx(beside / np.linalg.norm(beside), abs=MET)
    assert op.reached.isolated


ELBOWS = ((-2.5, 2.5), (-2.8, 2.8), (-2.8, 2.8))
LENGTHS = (0.5, 0.4, 0.2)
WALL = {"surface": {"plane": {"point": [0.6, 0, 0], "normal": [-1, 0, 0]}}}
ARM = {"urdf": "planar.urdf", "tool": "tip"}


def planar(reach, constraints=None, limits=ELBOWS, lengths=LENGTHS, **point):
    files = {"planar.urdf": planar_urdf(lengths, limits)}
    op = {"reach": {"point": [0.6, 0.3, 0], "axis": "x"} | reach} | point
    return op_of(ARM, constraints or {"wall": WALL}, op, 2 * len(lengths) - 2, files)


def elbows():
    """Give both configurations of the planar arm whose last link points into the wall, by the law of cosines."""
    a, b, c = LENGTHS
    x, y = 0.6 - c, 0.3
    for sign in (1, -1):
        elbow = sign * np.arccos((x * x + y * y - a * a - b * b) / (2 * a * b))
        shoulder = np.arctan2(y, x) - np.arctan2(b * np.sin(elbow), a + b * np.cos(elbow))
        yield np.array([shoulder, elbow, -shoulder - elbow])


def test_both_closed_forms_are_found_and_the_nearest_is_taken():
    found = planar({}).reached.solutions
    assert sorted(tuple(each.q) for each in found) == [
        pytest.approx(each, abs=1e-9) for each in sorted(map(tuple, elbows()))
    ]
    for each in elbows():
        near = dict(zip(("j1", "j2", "j3"), each + np.array([0.2, -0.1, 0.2]), strict=True))
        op = planar({"near": near})
        assert op.q_d == pytest.approx(each, abs=1e-9)
        assert "nearest" in op.reached.because


@pytest.mark.slow
def test_the_answer_is_the_same_every_time():
    first, second = planar({}), planar({})
    assert np.array_equal(first.q_d, second.q_d)
    assert [tuple(each.q) for each in first.reached.solutions] == [tuple(each.q) for each in second.reached.solutions]


@pytest.mark.parametrize(
    ("x", "words"), [(0.65, "50 mm inside the surface of `wall`"), (0.48, "120 mm outside of the surface of `wall`")]
)
def test_a_point_off_the_surface_is_refused_in_millimetres(x, words):
    with pytest.raises(PointOffSurfaceError, match=words) as caught:
        planar({"point": [x, 0.3, 0]})
    assert caught.value.distance == pytest.approx(0.6 - x)


def test_a_rounded_point_is_moved_onto_the_surface():
    op = planar({"point": [0.6004, 0.3, 0]})
    assert pose(op, "tip")[0] == pytest.approx([0.6, 0.3, 0], abs=MET)


@pytest.mark.slow
def test_out_of_reach_says_by_how_much():
    with pytest.raises(OutOfReachError, match="out of reach"):
        planar({"point": [0.6, 1.4, 0]})


@pytest.mark.slow
def test_a_direction_out_of_the_plane_is_out_of_reach_by_its_angle():
    with pytest.raises(OutOfReachError, match="90 deg"):
        planar({"axis": "z"})


def test_beyond_limits_names_the_joint():
    below = ((-2.5, 2.5), (-0.1, 0.1), (-2.8, 2.8))
    with pytest.raises(BeyondLimitsError, match="`j2`") as caught:
        planar({}, limits=below)
    assert set(caught.value.excess) == {"j2"}


def test_across_along_the_direction_is_refused():
    with pytest.raises(NoDesignError, match="`across` points along the direction itself"):
        planar({"across": [2, 0, 0]})


def test_a_direction_that_contradicts_an_aligned_contact_is_refused():
    tilted = {"point": POINT, "direction": [0.3, 0, -1]}
    with pytest.raises(NoDesignError, match=r"`direction` is 16\.7 deg off the normal of `table`"):
        op_of(UR5E, {"table": TABLE | {"align": "z"}}, {"reach": tilted}, 6)


@pytest.mark.parametrize("z", [-1, 1])
def test_a_rounded_direction_of_an_aligned_contact_is_taken_for_the_normal(z):
    rounded = {"point": POINT, "direction": [2e-4, 0, z]}
    op = op_of(UR5E, {"table": TABLE | {"align": "z"}}, {"reach": rounded}, 6)
    assert pose(op, "flange")[1][:, 2] == pytest.approx([0, 0, z], abs=MET)


@pytest.mark.slow
def test_another_frame_than_the_one_that_touches_can_be_placed():
    # The third joint stands where the first two put it, and from there the tip reaches the wall at one of two angles.
    first, second, third = 0.9, 0.5, np.arccos(0.15 / LENGTHS[2])
    wrist = LENGTHS[0] * np.array([np.cos(first), np.sin(first), 0]) + LENGTHS[1] * np.array(
        [np.cos(second), np.sin(second), 0]
    )
    wall = {"surface": {"plane": {"point": [wrist[0] + 0.15, 0, 0], "normal": [-1, 0, 0]}}}
    frame = {"frame": "l3", "point": wrist.tolist(), "direction": [np.cos(third), np.sin(third), 0]}
    op = planar(frame, {"wall": wall})
    assert pose(op, "l3")[0] == pytest.approx(wrist, abs=MET)
    assert pose(op, "tip")[0] == pytest.approx(wrist + np.array([0.15, LENGTHS[2] * np.sin(third), 0]), abs=MET)


@pytest.mark.slow
def test_a_closed_chain_meets_all_rows_the_right_way_round():
    grip = {
        "join": [{"frame": "left_tool0", "position": [0, 0, 0.1]}, {"frame": "right_tool0", "position": [0, 0, 0.1], "orientation": [{"y": "180 deg"}]}]
    }  # fmt: skip
    reach = {"frame": "left_tool0", "point": [0, 0.3, 0.5], "direction": [1, 0, 0]}
    op = op_of(TWO, {"grip": grip}, {"reach": reach, "lambda_d": {"grip_x": 5}}, 12)
    assert op.plant.Phi(op.q_d) == pytest.approx(np.zeros(6), abs=1e-12)
    assert op.lambda_d == pytest.approx([5, 0, 0, 0, 0, 0])
    (left, R), (right, S) = (pose(op, f"{side}_tool0", (0, 0, 0.1)) for side in ("left", "right"))
    assert left == pytest.approx(right, abs=MET)
    assert S.T @ R == pytest.approx(np.diag([-1.0, 1, -1]), abs=MET)  # half a turn about y, and not none
    assert pose(op, "left_tool0")[0] == pytest.approx([0, 0.3, 0.5], abs=MET)
    assert R[:, 2] == pytest.approx([1, 0, 0], abs=MET)
    assert within(op)


# Redundant rows and singular places.


def two_planar_arms():
    """Write two planar arms that stand a metre apart."""
    pieces = ['<link name="ground"/>']
    for side, x in (("a", 0.0), ("b", 1.0)):
        for i in range(3):
            parent, at = ("ground", x) if i == 0 else (f"{side}{i - 1}", 0.5)
            pieces.append(
                f'<link name="{side}{i}"><inertial><origin xyz="0.25 0 0"/><mass value="1"/><inertia ixx="0.001" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>'
                f'<joint name="{side}_{i}" type="continuous"><origin xyz="{at} 0 0"/><parent link="{parent}"/><child link="{side}{i}"/><axis xyz="0 0 1"/></joint>'
            )
    return {"arms.urdf": f'<robot name="two">{"".join(pieces)}</robot>'.encode()}


BOTH = {"urdf": "arms.urdf"}
START = {"a_0": 1.0, "a_1": -0.5, "a_2": 0, "b_0": 2.1, "b_1": 0.6, "b_2": 0.3}
MEET = [{"frame": "a2", "position": [0.25, 0, 0]}, {"frame": "b2", "position": [0.25, 0, 0]}]


def test_rows_that_a_planar_chain_implies_are_named():
    joined = {"grip": {"join": MEET, "hold": "point"}}
    with pytest.raises(DependentConstraintsError) as caught:
        op_of(BOTH, joined, {"guess": START, "lambda_d": {}}, 6, two_planar_arms())
    assert caught.value.rank == 2
    assert [each for each in caught.value.dependencies if "`grip_z`" in each and "zero" in each]
    op = op_of(
        BOTH, {"grip": joined["grip"] | {"without": ["z"]}}, {"guess": START, "lambda_d": {}}, 8, two_planar_arms()
    )
    assert list(op.plant.spec.constraints) == ["grip_x", "grip_y"]


def test_a_held_frame_of_a_planar_chain_has_three_rows_too_many():
    joined = {"join": MEET, "hold": "frame", "without": ["about_x"]}
    with pytest.raises(DependentConstraintsError) as caught:
        op_of(BOTH, {"grip": joined}, {"guess": START, "lambda_d": {}}, 2, two_planar_arms())
    assert caught.value.rank == 3
    assert [
        name for name in ("grip_z", "grip_about_y") if any(f"`{name}`" in each for each in caught.value.dependencies)
    ] == ["grip_z", "grip_about_y"]


def stretched(q, normal):
    """Give a stretched arm of two links whose tip is on a plane."""
    chain = {"planar_chain": {"n": 2, "length": 0.5, "mass": 1}}
    at = [np.cos(q), np.sin(q), 0]
    plane = {"surface": {"plane": {"point": at, "normal": normal}}}
    return op_of(chain, {"wall": plane}, {"q_d": {"q1": q, "q2": 0}}, 2)


def test_a_stretched_arm_cannot_push_along_itself():
    with pytest.raises(DependentConstraintsError, match="gradient of `wall` is zero") as caught:
        stretched(0.0, [-1, 0, 0])
    assert caught.value.rank == 0


def test_a_stretched_arm_that_pushes_across_itself_has_a_design(loop_of):
    op = stretched(0.0, [0, 1, 0])
    assert op.J == pytest.approx(np.array([[1, 0.5]]))
    loop = firmtouch.assign_poles(op, op.plant.spec.design)
    assert np.array(loop.poles.pencil).real == pytest.approx([-4, -5])


@pytest.mark.slow
def test_a_reach_that_only_a_stretched_arm_meets_is_found_and_told_singular():
    op = planar({"point": [0.6, np.sqrt(0.9**2 - 0.4**2), 0]})
    assert abs(op.q_d[1]) < 1e-6  # a double solution is found to the root of the rounding
    best = op.reached.solutions[0]
    assert best.manipulability == pytest.approx(0, abs=1e-6)


# Limits and drives, in `check` and in `design`.


@pytest.fixture
def write(tmp_path):
    def write(point, *, limits=ELBOWS, effort=100.0):
        (tmp_path / "planar.urdf").write_bytes(planar_urdf(LENGTHS, limits, effort=effort))
        model = {
            "schema": "firmtouch.model/1",
            "title": "An arm",
            "mechanism": ARM,
            "constraints": {"wall": WALL},
            "operating_point": point,
            "design": {"poles": [-4, -5, -6, -7], "force_feedback": 0.5},
        }
        path = tmp_path / "arm.yaml"
        path.write_text(json.dumps(model))
        return path

    return write


GUESS = dict(zip(("j1", "j2", "j3"), map(float, next(elbows())), strict=True))
NARROW = ((-2.5, 2.5), (-2.8, 1.0), (-2.8, 2.8))


def test_a_configuration_outside_of_joint_limits_fails_the_check_and_the_design(write, capsys, tmp_path):
    assert GUESS["j2"] > 1.0
    path = write({"q_d": GUESS, "normal_force": "5 N"}, limits=NARROW)
    assert main(["check", str(path)]) == 1
    out = capsys.readouterr().out
    failed = [line for line in out.splitlines() if line.startswith("FAILS")]
    assert len(failed) == 1
    assert failed[0].split()[1:3] == ["joint", "limits"]
    assert "`j2`" in failed[0]
    assert main(["design", str(path), "--out", str(tmp_path / "out")]) == 1
    told = capsys.readouterr()
    assert "`j2`" in told.err + told.out
    with pytest.raises(OutsideLimitsError, match="`j2` at 1"):
        firmtouch.find_operating_point(firmtouch.derive_plant(firmtouch.read_model(path).spec))


def test_a_drive_that_cannot_hold_fails_the_check_and_the_design(write, capsys, tmp_path):
    path = write({"q_d": GUESS, "normal_force": "20 N"}, effort=0.5)
    assert main(["check", str(path)]) == 1
    out = capsys.readouterr().out
    failed = [line for line in out.splitlines() if line.startswith("FAILS")]
    assert len(failed) == 1
    assert failed[0].split()[1:4] == ["drives", "hold", "q_d"]
    (joint,) = [name for name in GUESS if f"`{name}`" in failed[0]]
    assert main(["design", str(path), "--out", str(tmp_path / "out")]) == 1
    told = capsys.readouterr()
    assert f"`{joint}`" in told.err + told.out


@pytest.mark.slow
def test_what_is_out_of_reach_stops_no_other_check(write, capsys, tmp_path):
    far = write({"reach": {"point": [0.6, 5, 0], "axis": "x"}, "normal_force": "5 N"})
    good = Path(__file__).parents[2] / "models" / "pendulum_rod.yaml"
    assert main(["check", "--json", str(far), str(good)]) == 1
    told = capsys.readouterr()
    first, second = json.loads(told.out)["models"]
    assert "out of reach" in first["error"]
    assert second["holds"]
    assert told.err.startswith(f"{far}: no operating point: out of reach")
