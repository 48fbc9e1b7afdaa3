"""`firmtouch design --method region`: which method is taken, fronts, and answers of no with their reasons."""

import json
from pathlib import Path

import pytest

from firmtouch.cli import main

ROOT = Path(__file__).parents[2]
ARM = ROOT / "models" / "planar_3r_circle.yaml"


@pytest.fixture
def design(tmp_path, capsys):
    """Run the command on the 3R arm with some of its text replaced; gives exit code, stdout and stderr."""

    def run(*arguments, replace=()):
        text = ARM.read_text(encoding="utf-8")
        for old, new in replace:
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / "arm.yaml"
        path.write_text(text, encoding="utf-8")
        code = main(
            [
                "design",
                str(path),
                "--no-pdf",
                "--no-attraction",
                "--no-simulation",
                "--out",
                str(tmp_path / "out"),
                *arguments,
            ]
        )
        return code, *capsys.readouterr()

    return run


def line_and_column(text):
    lines = ARM.read_text(encoding="utf-8").splitlines()
    line = next(i for i, each in enumerate(lines) if text in each)
    return f"arm.yaml:{line + 1}:{lines[line].index(text) + 1}:"


def test_the_command_line_chooses_the_method(design):
    code, out, _ = design("--method", "region", "--json")
    assert code == 0
    assert json.loads(out)["structure"]["kind"] == "diagonal"
    code, out, _ = design("--json")
    assert code == 0
    assert "structure" not in json.loads(out)


def test_a_file_without_a_region_cannot_be_designed_by_region(capsys, tmp_path):
    path = ROOT / "models" / "pendulum_rod.yaml"
    assert main(["design", str(path), "--method", "region", "--out", str(tmp_path)]) == 2
    assert "region" in capsys.readouterr().err


def test_the_verdict_names_the_payload(design):
    code, out, err = design("--method", "region")
    assert code == 0
    assert "for every m3 from 2 to 3 kg" in out
    assert err == ""


@pytest.mark.parametrize(
    ("front", "words"),
    [("gains", "two objectives"), ("gains,gains", "no pair"), ("gains,cost", "no pair"), ("gains,beauty", "no pair")],
)
def test_a_front_needs_two_objectives_that_exist(design, front, words):
    code, _, err = design("--method", "region", "--front", front)
    assert code == 2
    assert words in err


def test_a_front_needs_a_region_design(design):
    code, _, err = design("--front", "gains,margin")
    assert code == 2
    assert "--method region" in err


@pytest.mark.slow
def test_terms_that_conflict_are_named_with_what_they_would_have_to_give(design):
    code, out, err = design("--method", "region", replace=[("at_most: 15 N*m", "at_most: 1 N*m")])
    assert code == 1
    assert out == ""
    assert "no design: no gains exist that meet these terms" in err
    assert "margin of (14) at least 5 N m/rad" in err
    assert "torque of q3, start at most 1 N m: would have to be" in err


def test_an_interval_without_an_inertia_is_told_at_its_place(design):
    code, _, err = design("--method", "region", replace=[("interval: [2.0 kg, 3.0 kg]", "interval: [-90 kg, 3.0 kg]")])
    assert code == 2
    assert line_and_column("[2.0 kg, 3.0 kg]") in err
    assert "not positive definite at m3 = -90" in err


def test_the_least_force_error_needs_blocks_that_are_free(design):
    replace = [
        ("method: poles", "method: region"),
        ("structure: diagonal", "structure: full\n    objective: force_error"),
    ]
    code, _, err = design(replace=replace)
    assert code == 2
    assert "normal_blocks: free" in err
    assert "arm.yaml:" in err
