"""What a URDF file says, and its mistakes: each told by name, at its line and column."""

import math

import pytest

import firmtouch
from firmtouch.errors import InputError, ModelFileError
from firmtouch.modelfile.urdf import JointType, Limits, Mimic, Pose, parse_urdf, read_urdf

INERTIAL = '<inertial><origin xyz="0.1 0 0"/><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
LIMIT = '<limit lower="-1" upper="2" velocity="3" effort="4"/>'
GOOD = f"""<?xml version="1.0"?>
<robot name="arm">
<link name="base"/>
<link name="a">{INERTIAL}</link>
<link name="b">{INERTIAL}</link>
<joint name="j" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 0 2"/>{LIMIT}</joint>
<joint name="k" type="prismatic"><parent link="a"/><child link="b"/>{LIMIT}</joint>
</robot>
"""


def read(text: str):
    return parse_urdf(text.encode(), file="arm.urdf")


def mistakes(text: str) -> list[str]:
    with pytest.raises(ModelFileError) as caught:
        read(text)
    return [str(each) for each in caught.value.diagnostics]


def changed(*replacements: tuple[str, str]) -> str:
    text = GOOD
    for old, new in replacements:
        assert old in text
        text = text.replace(old, new, 1)
    return text


def test_values_are_read_in_order_and_axes_are_unit_vectors():
    robot = read(GOOD)
    assert (robot.name, robot.root) == ("arm", "base")
    assert list(robot.links) == ["base", "a", "b"]
    assert list(robot.joints) == ["j", "k"]
    j, k = robot.joints.values()
    assert (j.type, j.parent, j.child, j.axis, j.limits) == (
        JointType.REVOLUTE,
        "base",
        "a",
        (0, 0, 1),
        Limits(-1, 2, 3, 4),
    )
    assert (k.type, k.pose, k.axis, k.mimic) == (JointType.PRISMATIC, Pose(), (1, 0, 0), None)
    assert robot.links["base"].inertial is None
    assert robot.links["a"].inertial.pose.xyz == (0.1, 0, 0)
    assert robot.links["a"].inertial.mass == 2
    assert (robot.links["b"].place, j.place) == ((5, 1), (6, 1))


def test_what_stands_behind_its_use_in_the_file_is_ordered():
    lines = GOOD.splitlines()
    lines[5], lines[6] = lines[6], lines[5]
    assert list(read("\n".join(lines)).joints) == ["j", "k"]


def test_a_continuous_joint_has_no_bounds_of_position_even_where_some_are_written():
    robot = read(changed(("revolute", "continuous")))
    assert robot.joints["j"].limits == Limits(-math.inf, math.inf, 3, 4)
    robot = read(changed(("revolute", "continuous"), (LIMIT, "")))
    assert robot.joints["j"].limits == Limits(-math.inf, math.inf, math.inf, math.inf)


def test_mimic_and_losses():
    robot = read(
        changed(
            (
                LIMIT + "</joint>\n</robot>",
                LIMIT + '<mimic joint="j" multiplier="-2"/><dynamics damping="0.5"/></joint>\n</robot>',
            )
        )
    )
    assert robot.joints["k"].mimic == Mimic("j", -2, 0)
    assert (robot.joints["k"].damping, robot.joints["k"].friction) == (0.5, 0)


def test_what_belongs_to_other_tools_is_passed_over():
    others = (
        '<gazebo reference="a"><plugin filename="x"><anything/></plugin></gazebo><material name="m"/><?tool says?>'
        '<transmission name="t"><joint name="j"/></transmission><ros2_control name="c"><joint name="j"/></ros2_control><joint name="j"/>'
    )
    visual = '<visual><geometry><mesh filename="file:///etc/passwd"/></geometry></visual><collision/>'
    assert (
        read(changed(('<link name="base"/>', f'<link name="base">{visual}</link>{others}<!-- & -->'))).joints
        == read(GOOD).joints
    )


def test_a_massless_link_may_be_written_as_such():
    robot = read(
        changed(
            (
                '<mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>',
                '<mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>',
            )
        )
    )
    assert robot.links["a"].inertial.mass == 0


def test_a_link_that_is_fixed_to_what_carries_it_may_be_a_point_mass():
    point = SIX.replace('"1"', '"0"')
    tip = (
        f'<joint name="t" type="fixed"><parent link="b"/><child link="tip"/></joint><link name="tip">{INERTIAL}</link>'
    )
    robot = read(changed(("</robot>", tip.replace(SIX, point) + "</robot>")))
    assert robot.links["tip"].inertial.inertia == (0,) * 6
    assert "link `tip` has an inertia, but no mass" in mistakes(
        changed(("</robot>", tip.replace('mass value="2"', 'mass value="0"') + "</robot>"))
    )[0]  # fmt: skip


def test_what_stands_still_may_have_the_inertia_of_no_body():
    strange = INERTIAL.replace('izz="1"', 'izz="9"')
    still = f'<joint name="t" type="fixed"><parent link="base"/><child link="foot"/></joint><link name="foot">{strange}</link>'
    robot = read(changed(('<link name="base"/>', f'<link name="base">{strange}</link>{still}')))
    assert robot.links["base"].inertial.inertia == robot.links["foot"].inertial.inertia == (1, 0, 0, 1, 0, 9)
    assert "negative mass" in mistakes(changed(('<link name="base"/>', f'<link name="base">{strange}</link>'.replace('"2"', '"-2"'))))[0]  # fmt: skip


def test_a_word_like_one_that_is_there_too_belongs_to_another_tool():
    limit = LIMIT.replace(" effort", ' command_effort="1" gear_velocity="1" effort')
    others = "<collision/><collision_checking/>"
    text = changed((LIMIT, limit), ('<link name="base"/>', f'<link name="base">{others}</link>'))
    assert read(text).joints == read(GOOD).joints
    assert any("no attribute `command_effort`" in each for each in mistakes(text.replace(' effort="4"', "")))


SIX = 'ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"'
MISTAKES = {
    "floating": ([("revolute", "floating")], "6:23: joint `j` is floating: it has six coordinates"),
    "planar": ([("revolute", "planar")], "6:23: joint `j` is planar"),
    "unknown type": ([("revolute", "hinge")], "6:23: joint `j` is of the unknown type `hinge`; there are: revolute"),
    "no type": ([(' type="revolute"', "")], "6:1: joint `j` has no `type`"),
    "no limit": ([(LIMIT, "")], "6:1: joint `j` is revolute and has no `<limit"),
    "no effort": ([(' effort="4"', "")], "`<limit>` has no `effort`"),
    "negative speed": ([('velocity="3"', 'velocity="-3"')], "joint `j` has a negative limit of velocity, -3"),
    "lower > upper": ([('lower="-1"', 'lower="5"')], "joint `j` has a lower limit, 5, above its upper one, 2"),
    "zero axis": ([("0 0 2", "0 0 0")], "6:82: the axis of joint `j` has the length 0"),
    "two numbers": ([("0 0 2", "0 2")], "6:82: `xyz` takes 3 numbers, not 2"),
    "no number": ([("0 0 2", "0 0 two")], "6:82: `two` is no number"),
    "infinite": ([("0 0 2", "0 0 inf")], "`inf` is no number"),
    "underscore": ([("0 0 2", "0 0 1_0")], "`1_0` is no number"),
    "huge mass": ([('mass value="2"', 'mass value="1e10"')], "4:62: `1e10` is too large"),
    "too large": ([("0 0 2", "0 0 1e999")], "6:82: `0 0 1e999` is too large"),
    "xacro number": ([("0 0 2", "0 0 ${x}")], "is a macro's expression; expand the file first"),
    "xacro tag": ([('<link name="base"/>', '<link name="base"/><xacro:arm xmlns:xacro="x"/>')], "3:20: `xacro:arm` is a macro"),
    "misspelt tag": ([("<axis", "<axes"), ], "joint `j` has no `<axes>`; did you mean `axis`?"),
    "misspelt attribute": ([('axis xyz', 'axis xzy')], "6:82: `<axis>` has no attribute `xzy`; did you mean `xyz`?"),
    "quaternion": ([('<origin xyz="0.1 0 0"', '<origin quat_xyzw="0 0 0 1"')], "has a `quat_xyzw`; only `rpy` is read"),
    "closed loop": ([('<link name="base"/>', '<link name="base"/><loop_joint/>')], "3:20: `<loop_joint>` closes a loop"),
    "no parent": ([('<parent link="base"/>', "")], "6:1: joint `j` has no `<parent link=..>`"),
    "unknown child": ([('<child link="a"/>', '<child link="aa"/>')], "the child of joint `j`, `aa`, is no link"),
    "two axes": ([("<axis", '<axis xyz="1 0 0"/><axis')], "a second `<axis>` of joint `j`"),
    "duplicate link": ([('<link name="base"/>', '<link name="base"/><link name="base"/>')], "3:32: a second link of the name `base`"),
    "duplicate joint": ([('name="k"', 'name="j"')], "7:14: a second joint of the name `j`"),
    "two parents": ([('<child link="b"/>', '<child link="a"/>')], "7:1: link `a` hangs at two joints, `j` and `k`"),
    "two roots": ([('<link name="base"/>', '<link name="base"/><link name="other"/>')], "3:20: link `other` hangs at no joint, and neither does `base`"),
    "circle": ([('<parent link="base"/>', '<parent link="b"/>'), ('<link name="base"/>\n', "\n")], "6:1: joints in a circle: j, k"),
    "no links": ([(GOOD.partition("\n")[2], '<robot name="x"/>')], "2:1: a robot without links"),
    "other root": ([(GOOD.partition("\n")[2], "<sdf/>")], "2:1: a URDF file holds one `<robot>`, not `<sdf>`"),
    "nameless": ([('<link name="base"/>', "<link/>")], "3:1: a link has no `name`"),
    "mimic of none": ([(LIMIT, LIMIT + '<mimic joint="x"/>')], "joint `j` follows `x`, which is no joint"),
    "mimic of itself": ([(LIMIT, LIMIT + '<mimic joint="j"/>')], "joint `j` follows `j`, which follows another joint itself"),
    "mimic of fixed": ([("revolute", "fixed"), (LIMIT + "</joint>\n</robot>", LIMIT + '<mimic joint="j"/></joint>\n</robot>')], "joint `k` follows `j`, which is fixed"),
    "negative damping": ([(LIMIT, LIMIT + '<dynamics damping="-1"/>')], "joint `j` has a negative damping, -1"),
    "negative mass": ([('mass value="2"', 'mass value="-2"')], "4:62: link `a` has a negative mass, -2 kg"),
    "no mass": ([('<mass value="2"/>', "")], "the inertial of link `a` has no `<mass>`"),
    "no ixx": ([('ixx="1" ', "")], "`<inertia>` has no `ixx`"),
    "mass zero": ([('mass value="2"', 'mass value="0"')], "link `a` has an inertia, but no mass"),
    "inertia zero": ([(SIX, SIX.replace('"1"', '"0"'))], "link `a` has a mass of 2 kg, but no inertia"),
    "indefinite": ([(SIX, SIX.replace('ixy="0"', 'ixy="1.5"'))], "link `a` has an inertia that is not positive definite: principal moments -0.5, 1 and 2.5"),
    "triangle": ([('izz="1"', 'izz="2.1"')], "link `a` has an inertia that no body has"),
}  # fmt: skip


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes_are_told_by_name_and_place(name):
    replacements, wanted = MISTAKES[name]
    found = mistakes(changed(*replacements))
    assert any(wanted in each for each in found), found
    assert all(each.startswith("arm.urdf:") for each in found)


def test_all_mistakes_are_told_at_once():
    found = mistakes(changed(("revolute", "floating"), ("0 0 2", "0 0 0"), ('mass value="2"', 'mass value="x"')))
    assert [each.split(":")[1] for each in found] == ["4", "6"]  # the axis of what is no joint is not read
    found = mistakes(changed(("0 0 2", "0 0 0"), ('mass value="2"', 'mass value="x"'), ("prismatic", "planar")))
    assert [each.split(":")[1] for each in found] == ["4", "6", "7"]


def test_a_plate_rounded_to_three_digits_is_a_body():
    # A plate of 0.3 m by 0.7 m has izz = ixx + iyy exactly; rounded, it may miss it by a unit of the third digit.
    plate = 'ixx="0.83" ixy="0" ixz="0" iyy="0.83" iyz="0" izz="{}"'
    for izz in (1.66, 1.661):
        assert read(changed((SIX, plate.format(izz)))).links["a"].inertial.inertia[-1] == izz
    assert len(mistakes(changed((SIX, plate.format(1.67))))) == 1


def test_columns_count_characters():
    assert mistakes(changed(('<link name="base"/>', '<link name="π"/><link name="base"/>')))[0].startswith(
        "arm.urdf:3:17:"
    )


def test_a_file_that_is_not_there_is_an_input_error(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_urdf(tmp_path / "none.urdf")
    (tmp_path / "arm.urdf").write_text(GOOD, encoding="utf-8")
    assert read_urdf(tmp_path / "arm.urdf").joints == read(GOOD).joints
    assert issubclass(ModelFileError, firmtouch.errors.InputError)
