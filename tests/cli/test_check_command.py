"""`firmtouch check`: a table for each model, exit codes 0, 1 and 2, JSON."""

import json
from pathlib import Path

import pytest

from firmtouch.cli import main

MODELS = Path(__file__).parents[2] / "models"
PENDULUM = MODELS / "pendulum_rod.yaml"


@pytest.fixture
def failing(tmp_path):
    """A model that reads well and whose checks fail: its kinetic energy is linear in a velocity."""
    text = PENDULUM.read_text(encoding="utf-8")
    start = text.index("kinetic_energy:")
    line = text[start : text.index("\n", start)]
    path = tmp_path / "failing.yaml"
    path.write_text(text.replace(line, f"{line} + m*length*dot(x)/1.0*9.81**0*(g/length)**0.5"), encoding="utf-8")
    return path


@pytest.fixture
def broken(tmp_path):
    path = tmp_path / "broken.yaml"
    path.write_text(PENDULUM.read_text(encoding="utf-8").replace("constraints:", "constrains:"), encoding="utf-8")
    return path


def test_a_good_model_gives_a_table_and_exit_code_0(capsys):
    assert main(["check", str(PENDULUM)]) == 0
    output = capsys.readouterr()
    assert "all 13 checks hold" in output.out
    for name in (
        "Phi(q_d) = 0",
        "rank of J",
        "M positive definite",
        "energy kept",
        "lambda-Hessian",
        "two derivations",
    ):
        assert name in output.out
    assert output.err == ""


def test_a_model_that_fails_a_check_gives_exit_code_1_and_says_which(failing, capsys):
    assert main(["check", str(failing)]) == 1
    output = capsys.readouterr().out
    line = next(line for line in output.splitlines() if "K homogeneous" in line)
    assert line.startswith("FAILS")
    assert "checks fail" in output


def test_a_file_that_cannot_be_read_gives_exit_code_2_and_its_place(broken, capsys):
    assert main(["check", str(broken)]) == 2
    output = capsys.readouterr()
    assert f"{broken}:" in output.err
    assert "did you mean `constraints`" in output.err
    assert output.out == ""


def test_a_bad_file_stops_no_other_and_the_worst_exit_code_wins(broken, failing, capsys):
    assert main(["check", str(broken), str(failing), str(PENDULUM)]) == 2
    output = capsys.readouterr()
    assert "all 13 checks hold" in output.out
    assert "checks fail" in output.out
    assert "constrains" in output.err


def test_json_holds_every_check_of_every_model(broken, capsys):
    assert main(["check", "--json", str(PENDULUM), str(broken)]) == 2
    told = json.loads(capsys.readouterr().out)
    assert told["schema"] == "firmtouch.check/1"
    good, bad = told["models"]
    assert good["holds"] is True
    assert good["model"] == "pendulum_rod"
    assert len(good["checks"]) == 13
    for check in good["checks"]:
        assert check.keys() == {"name", "holds", "figure", "relation", "bound", "detail"}
    assert "constrains" in bad["error"]


def test_no_model_at_all_is_a_wrong_question(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["check"])
    assert stop.value.code == 2
    assert "MODEL" in capsys.readouterr().err
