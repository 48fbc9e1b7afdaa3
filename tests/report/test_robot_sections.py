"""What the report says of robots: their joints, the configuration that was taken, and matrices of many columns."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import firmtouch
from firmtouch.modelfile.urdf.robot import JointType
from firmtouch.regulation.inverse_kinematics import Reached, Solution
from firmtouch.regulation.inverse_kinematics.solution import FARTHEST, NEAREST
from firmtouch.report import render_html, render_pdf
from firmtouch.report.contents import mechanism, operating_point
from firmtouch.report.contents.reached import MOST, configurations
from firmtouch.report.contents.robot import from_file
from firmtouch.report.document import Code, Document, Math, Matrices, Matrix, Paragraph, Section, Strong, Table
from firmtouch.report.numbers import matrix

ROOT = Path(__file__).parents[2]


def text(line):
    return "".join(f"[{each.typst}]" if isinstance(each, Math) else getattr(each, "text", each) for each in line)


def told(blocks):
    return " ".join(text(each.line) for each in blocks if isinstance(each, Paragraph))


def tables(blocks):
    return [each for each in blocks if isinstance(each, Table)]


def column(table, heading):
    i = [text(each) for each in table.headings].index(heading)
    return [text(row[i]) for row in table.rows]


def number(words):
    return float(words.replace("−", "-").rstrip("°% m"))


def solution(q, *, manipulability=0.05, margin=0.2):
    return Solution(np.array(q, dtype=float), 1e-15, manipulability, 0.1, margin, manipulability * margin)


@pytest.fixture(scope="module")
def arm(make_arm):
    return make_arm(3, {"wall": "0.9 - x(p3)"}, [0.9, -0.8, -0.3]).spec


class TestTheConfigurations:
    def test_the_taken_one_is_marked_and_all_are_listed_in_degrees(self, arm):
        found = Reached(
            (solution([1.0, -0.5, 0.2]), solution([0.2, 0.5, -0.2], manipulability=0.01)), FARTHEST, 40, 30, 3
        )
        blocks = list(configurations(found, arm))
        (table,) = tables(blocks)
        assert [text(each) for each in table.headings] == ["", "taken", "2"]
        assert all(isinstance(row[1][0], Strong) for row in table.rows)
        assert [number(each) for each in column(table, "taken")[:3]] == pytest.approx(
            np.degrees([1.0, -0.5, 0.2]), abs=5e-3
        )
        assert column(table, "taken")[3:] == ["0.05", "0.1", "20 %"]
        assert "found 2 different configurations" in told(blocks)
        assert FARTHEST in told(blocks)
        assert "isolated" in told(blocks)

    def test_of_many_the_first_are_listed_and_the_others_counted(self, arm):
        found = Reached(tuple(solution([0.1 * i, 0, 0]) for i in range(20)), NEAREST, 64, 60, 2)
        blocks = list(configurations(found, arm))
        (table,) = tables(blocks)
        assert len(table.headings) == MOST + 1
        assert f"The first {MOST} of 20" in text(table.caption)
        assert NEAREST in told(blocks)
        assert "leaves one direction free" in told(blocks)

    def test_a_single_one_needs_no_table(self, arm):
        blocks = list(configurations(Reached((solution([1, 0, 0], margin=np.inf),), FARTHEST, 8, 8, 3), arm))
        assert tables(blocks) == []
        assert "found one configuration" in told(blocks)
        assert "No joint is limited." in told(blocks)

    def test_hardly_turned_joints_are_at_zero(self, arm):
        found = Reached((solution([1e-9, -1e-12, 0.5]), solution([0, 0, 1])), FARTHEST, 8, 8, 3)
        (table,) = tables(configurations(found, arm))
        assert column(table, "taken")[:2] == ["0°", "0°"]


@pytest.fixture(scope="module")
def design(shipped_report):
    """The 7-joint arm on a table."""
    return shipped_report("panda_plane").design


@pytest.fixture(scope="module")
def blocks(design):
    return mechanism.section(design).blocks


@pytest.mark.slow
class TestARobotsModel:
    def test_it_names_the_file_its_root_and_the_tool(self, blocks, design):
        (line,) = [each.line for each in blocks if isinstance(each, Paragraph) and "is read from" in text(each.line)]
        robot = design.model.spec.mechanism.urdf
        assert [each.text for each in line if isinstance(each, Code)] == [
            robot.name,
            "panda.urdf",
            robot.root,
            "flange",
        ]
        assert str(ROOT) not in told(blocks)  # where the files stand here is nobody's business

    def test_the_joints_stand_with_the_limits_of_the_file(self, blocks, design):
        joints = tables(blocks)[0]
        moving = [each for each in design.model.spec.mechanism.urdf.joints.values() if each.type is JointType.REVOLUTE]
        limits = [tuple(map(number, each.split(" to "))) for each in column(joints, "limits")]
        expected = [np.degrees([each.limits.lower, each.limits.upper]) for each in moving]
        assert np.array(limits) == pytest.approx(np.array(expected), rel=5e-4)  # four figures
        assert column(joints, "greatest speed") == [f"{each.limits.velocity:.4g} rad/s" for each in moving]
        assert column(joints, "greatest effort") == [f"{each.limits.effort:.4g} N m" for each in moving]

    def test_the_constraints_are_said_in_words_with_the_surfaces_measures(self, blocks):
        (row,) = tables(blocks)[1].rows
        assert [text(each) for each in row[1:3]] == ["m", "the grinder's point stays on the table"]
        assert text(row[3]).startswith("flange on a plane: point [0, 0, 0.10 m], normal [0, 0, 1]")

    def test_the_recursion_is_named_with_its_operations(self, blocks, design):
        functions = design.loop.operating_point.plant.functions
        assert "Featherstone" in told(blocks)
        assert f"in {functions['M'].n_instructions()} and {functions['theta'].n_instructions()} scalar" in told(blocks)
        assert "too long" not in told(blocks)

    def test_what_it_carries_is_told(self, blocks):
        assert "Its link flange carries mp with the centre of mass at [0, 0, 0.5*lt]" in told(blocks)

    def test_the_operating_point_tells_of_the_inverse_kinematics(self, design):
        blocks = operating_point.section(design).blocks
        reached = design.loop.operating_point.reached
        assert f"found {len(reached.solutions)} different configurations" in told(blocks)
        assert reached.because in told(blocks)

    def test_no_number_is_rounding(self, design):
        for block in operating_point.section(design).blocks:
            cells = [text(cell) for row in block.rows for cell in row] if isinstance(block, Table) else []
            assert not [each for each in cells if re.search(r"10⁻[¹²]?[5-9⁰¹²³⁴⁵⁶⁷⁸⁹]{2}", each)]


def test_locked_joints_branches_left_out_and_other_gravity_are_told(tmp_path):
    """Read alone, not designed: one arm of two, on a wall."""
    mechanism_ = {
        "urdf": str(ROOT / "models" / "urdf" / "dual_ur5e.urdf"),
        "tool": "left_tool0",
        "locked": {"left_wrist_3": "0.5 rad"},
        "gravity": [0, 9.81, 0],
        "base": {"position": [0, 0, "1 m"], "orientation": [{"x": "90 deg"}]},
    }
    surface = {"plane": {"point": [0, 0, "0.1 m"], "normal": [0, 0, 1]}}
    data = {
        "schema": "firmtouch.model/1",
        "title": "One arm of two",
        "mechanism": mechanism_,
        "constraints": {"table": {"surface": surface}},
        "operating_point": {"reach": {"point": ["-0.5 m", "0.4 m", "0.1 m"]}, "normal_force": "10 N"},
        "design": {"poles": [-4, -5, -6, -7, -8, -9, -10, -11], "force_feedback": 0.5},
    }
    path = tmp_path / "arm.yaml"
    path.write_text(json.dumps(data), encoding="utf-8")
    words = told(from_file(firmtouch.read_model(path).spec.mechanism))
    assert "Locked: left_wrist_3 at 0.5 rad." in words
    assert "Left out, as they do not move the tool: right_shoulder_pan, " in words
    assert "left_elbow" not in words
    assert "Gravity is (0, 9.81, 0) m/s²" in words
    assert "world at [0, 0, 1 m], turned by 90 deg about x" in words


def wide(n):
    """A matrix whose entries need their full width."""
    rng = np.random.default_rng(n)
    return Matrix(Math("M"), matrix(rng.normal(size=(n, n)) * 10.0 ** rng.integers(-5, 3, size=(n, n)), 3), "")


class TestWideMatrices:
    def test_of_many_large_hessians_their_share_of_the_stiffness_is_shown(self, random_point):
        op = random_point(12, 6, seed=1)
        (weighted,) = operating_point.curvatures(op)
        assert weighted.rows == matrix(op.P_qq - op.N0, 3)
        for n, m in ((12, 1), (8, 3)):
            assert len(operating_point.curvatures(random_point(n, m, seed=1))) == m

    def test_a_long_column_is_laid_on_its_side(self):
        long, short = (operating_point.as_vector("g - J^T lambda_d", np.arange(1.0, n + 1)) for n in (12, 8))
        assert long.rows == (tuple(str(i) for i in range(1, 13)),)
        assert long.name == Math("(g - J^T lambda_d)^T")
        assert short.rows == tuple((str(i),) for i in range(1, 9))

    @pytest.mark.parametrize("n", [7, 12, 14, 20])
    def test_they_stay_on_the_page(self, run, tmp_path, n):
        document = Document("t", "s", "f", (Section("M", (Matrices((wide(n),)),)),))
        path = tmp_path / "m.pdf"
        path.write_bytes(render_pdf(document))
        run("pdftoppm", "-r", "50", "-gray", path, tmp_path / "page")
        for each in tmp_path.glob("page*.pgm"):
            inked = np.asarray(Image.open(each)) < 200
            sides = round(20 / 25.4 * 50)  # the margins are 23 mm wide
            assert not inked[:, :sides].any()
            assert not inked[:, -sides:].any()
        words = run("pdftotext", "-enc", "UTF-8", path, "-")
        assert ("columns 1 to" in words) == (n > 7)  # at full width of all entries

    @pytest.mark.parametrize(("n", "sort"), [(6, ""), (7, "wide"), (12, "large"), (14, "large huge")])
    def test_html_sets_the_larger_ones_smaller(self, n, sort):
        html = render_html(Document("t", "s", "f", (Section("M", (Matrices((wide(n),)),)),)))
        assert f'<table class="matrix{" " if sort else ""}{sort}">' in html
