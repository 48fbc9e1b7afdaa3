"""`firmtouch simulate`: what it writes and prints, and exit codes with their reasons."""

import csv
import io
import json
from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML

import firmtouch
from firmtouch.cli import main
from firmtouch.design import try_out_design
from firmtouch.report import design_as_json, write_files

ROOT = Path(__file__).parents[2]
PENDULUM = ROOT / "models" / "pendulum_rod.yaml"
CIRCLE = ROOT / "models" / "planar_2r_circle.yaml"
USUAL = ["start_error", "force_step", "offset", "tilt"]
TWO = """\
schema: firmtouch.scenario/1
scenarios:
  push:
    title: Someone leans on it
    duration: 2 s
    disturbances: [{force: {x: 1 N}, from: 0.5 s}]
  still: {duration: 1 s}
"""
# P_d with the right gradient at q_d, and with a maximum there: K22 = -6 m g/l + m g/l = -100 N/m.
UNSTABLE = """\
scenarios:
  falls:
    controller: 5
    P_d: m*g*(y + length) - 3*m*g/length*x**2
    start: {beside_q_d: {x: 1 mm}}
    duration: 5 s
  still: {duration: 1 s}
"""


def simulate(*arguments) -> int:
    return main(["simulate", *map(str, arguments)])


@pytest.fixture
def scenarios(tmp_path):
    def write(text) -> Path:
        path = tmp_path / "runs.yaml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


@pytest.fixture(scope="module")
def usual(tmp_path_factory) -> Path:
    """The folder of the pendulum's usual scenarios."""
    folder = tmp_path_factory.mktemp("usual") / "made" / "for it"
    assert simulate(PENDULUM, "--out", str(folder)) == 0
    return folder


def listed(folder: Path) -> set[str]:
    return {each.name for each in folder.iterdir()} if folder.exists() else set()


def strict(text):
    """Read JSON that holds no NaN and no Infinity, which are not JSON."""
    return json.loads(text, parse_constant=lambda word: pytest.fail(f"{word} in JSON"))


class TestTheFiles:
    def test_there_is_one_for_each_scenario_and_two_for_all(self, usual):
        assert listed(usual) == {"simulation.json", "simulation.html", *(f"{name}.csv" for name in USUAL)}
        assert {each.stat().st_mode & 0o777 for each in usual.iterdir()} == {0o644}

    def test_the_json_tells_what_came_of_each(self, usual):
        data = strict((usual / "simulation.json").read_text(encoding="utf-8"))
        assert data["schema"] == "firmtouch.simulation/1"
        assert data["model"]["name"] == "pendulum_rod"
        assert (data["coordinates"], data["constraints"]) == (["x", "y"], ["rod"])
        assert [each["name"] for each in data["scenarios"]] == USUAL
        for each in data["scenarios"]:
            assert each["outcome"] == "converged"
            assert each["reason"].startswith("came to rest")
            assert each["controller"] == 17
            assert each["end_time"] == each["duration"] == 4.0
            assert each["drift"] < 1e-8
            assert each["largest_part_of_limit"] is None  # the file has no limits

    def test_the_table_of_a_run_agrees_with_the_json(self, usual):
        data = strict((usual / "simulation.json").read_text(encoding="utf-8"))
        q_d, lambda_d = np.array([0, -0.981]), 19.62
        for each in data["scenarios"]:
            header, *rows = csv.reader(io.StringIO((usual / f"{each['name']}.csv").read_text(encoding="utf-8")))
            assert header == ["t", "x", "y", "x_dot", "y_dot", "lambda_rod", "u_x", "u_y", "phi_rod"]
            t, q, qdot, lam, u, phi = np.split(np.array(rows, dtype=float), [1, 3, 5, 6, 8], axis=1)
            assert t[0, 0] == 0
            assert t[-1, 0] == each["end_time"]
            assert np.all(np.diff(t[:, 0]) >= 0)
            # Repeated instants are where a force begins; every number has all its digits.
            assert np.max(np.abs(q - q_d)) == each["largest_position_error"]
            assert np.max(np.abs(lam - lambda_d)) == each["largest_force_error"]
            assert ([lam.min()], [lam.max()]) == (each["least_lambda"], each["greatest_lambda"])
            assert np.max(np.abs(u), axis=0).tolist() == each["largest_u"]
            assert np.max(np.abs(phi)) == each["drift"]
            assert q[-1].tolist() == each["final_q"]
            assert lam[-1].tolist() == each["final_lambda"]
            assert np.max(np.abs(qdot[-1])) < 1e-3

    def test_the_numbers_are_those_of_the_mechanism(self, usual):
        data = {each["name"]: each for each in strict((usual / "simulation.json").read_text())["scenarios"]}
        assert data["start_error"]["largest_position_error"] == pytest.approx(0.1, rel=0.01)
        # 1 N against K22 = 40 N/m, the bound of the file; the offset is its 2 mm along y.
        assert abs(data["force_step"]["final_q"][0]) == pytest.approx(1 / 40, rel=0.02)
        assert abs(data["offset"]["final_q"][1] + 0.981) == pytest.approx(0.002, rel=1e-6)
        for each in data.values():
            np.testing.assert_allclose(each["final_q"], each["equilibrium"]["q"], rtol=0, atol=1e-5)
            np.testing.assert_allclose(each["final_lambda"], each["equilibrium"]["lambda"], rtol=0, atol=1e-3)

    def test_the_report_is_whole_and_stands_alone(self, usual):
        html = (usual / "simulation.html").read_text(encoding="utf-8")
        assert html.rstrip().endswith("</html>")
        assert "src=" not in html.replace("data:", "")
        assert html.count("<figure") == len(USUAL)

    def test_the_default_folder_is_named_after_the_model(self, tmp_path, monkeypatch, capsys, scenarios):
        file = scenarios(TWO)
        monkeypatch.chdir(tmp_path)
        assert simulate(PENDULUM, "--scenario", file, "--only", "still") == 0
        found = listed(tmp_path / "reports" / "pendulum_rod" / "simulation")
        assert found == {"simulation.json", "simulation.html", "still.csv"}


class TestWhatIsPrinted:
    def test_a_line_for_each_scenario_and_the_files(self, tmp_path, capsys, scenarios):
        assert simulate(PENDULUM, "--scenario", scenarios(TWO), "--out", tmp_path / "out") == 0
        printed = capsys.readouterr()
        lines = printed.out.splitlines()
        assert printed.err == ""
        assert "\x1b" not in printed.out
        assert lines[0].split() == [
            "scenario",
            "what",
            "came",
            "of",
            "it",
            "error,",
            "m",
            "contact",
            "force,",
            "N",
            "drives,",
            "N",
        ]
        assert lines[1].startswith("ok")
        assert lines[1].split()[1] == "push"
        assert "came to rest 0.025 m from q_d" in lines[1]
        assert "came to rest at q_d" in lines[2]
        assert lines[3:] == [
            f"  {tmp_path / 'out' / name}" for name in ("simulation.json", "simulation.html", "push.csv", "still.csv")
        ]

    def test_only_one(self, tmp_path, capsys, scenarios):
        assert simulate(PENDULUM, "--scenario", scenarios(TWO), "--only", "still", "--out", tmp_path / "out") == 0
        assert listed(tmp_path / "out") == {"simulation.json", "simulation.html", "still.csv"}
        assert "push" not in capsys.readouterr().out

    def test_json_on_stdout_is_the_file(self, tmp_path, capsys, scenarios):
        assert (
            simulate(PENDULUM, "--scenario", scenarios(TWO), "--out", tmp_path / "out", "--only", "push", "--json") == 0
        )
        printed = capsys.readouterr()
        assert printed.out == (tmp_path / "out" / "simulation.json").read_text(encoding="utf-8")
        assert strict(printed.out)["scenarios"][0]["title"] == "Someone leans on it"
        assert printed.err == ""

    @pytest.mark.parametrize("width", [80, 160])
    def test_on_a_terminal_no_word_and_no_number_is_lost(self, width, tmp_path, monkeypatch, capsys, scenarios):
        file = scenarios(
            "scenarios:\n  still: {duration: 1 s}\n  pull: {disturbances: [{force: {q1: 25 N*m}, from: 0.1 s}]}\n"
        )
        monkeypatch.setattr("firmtouch.cli.simulate.results_console", lambda: on_terminal(width))
        assert simulate(CIRCLE, "--scenario", file, "--out", tmp_path / "out") == 1
        printed = capsys.readouterr().out
        table = printed[: printed.index("  " + str(tmp_path))]
        lines = [line.rstrip() for line in table.splitlines()]
        assert all(len(line) <= width for line in lines)
        told = "lost contact at 0.2179 s: from there on `rim` would have to pull, and it is one-sided"
        headings = "scenario what came of it error, rad contact force, N drives, % of a limit"
        words = [
            *told.split(),
            *headings.split(),
            *["ok", "FAILS", "still", "pull", "came", "to", "rest", "q_d", "40", "0.145", "100"],
        ]
        # A cell that is broken into lines still has all its words, and none is broken itself.
        assert [each for each in words if each not in table.split()] == []
        assert "…" not in table
        if width == 160:
            assert len(lines) == 3
            assert told in lines[2]


def on_terminal(width):
    from rich.console import Console

    return Console(width=width, color_system=None, highlight=False)


class TestTheAnswerIsNo:
    def test_lost_contact_is_told_with_its_time(self, tmp_path, capsys, scenarios):
        text = "scenarios: {pull: {disturbances: [{force: {q1: 25 N*m}, from: 0.1 s}]}}"
        assert simulate(CIRCLE, "--scenario", scenarios(text), "--out", tmp_path / "out") == 1
        assert "lost contact at 0.2179 s: from there on `rim` would have to pull" in capsys.readouterr().out
        (run,) = strict((tmp_path / "out" / "simulation.json").read_text())["scenarios"]
        assert run["outcome"] == "contact_lost"
        assert 0.1 < run["end_time"] < run["duration"]
        # It ends where the force is just no longer a push, of 40 N.
        assert run["final_lambda"][0] == pytest.approx(0, abs=0.05)
        assert run["least_lambda"][0] <= 0
        html = (tmp_path / "out" / "simulation.html").read_text(encoding="utf-8")
        assert "lost contact at 0.2179 s" in html

    def test_an_unstable_potential_diverges_and_says_when(self, tmp_path, capsys, scenarios):
        assert simulate(PENDULUM, "--scenario", scenarios(UNSTABLE), "--out", tmp_path / "out") == 1
        lines = capsys.readouterr().out.splitlines()
        falls, still = strict((tmp_path / "out" / "simulation.json").read_text())["scenarios"]
        assert (falls["outcome"], falls["controller"]) == ("diverged", 5)
        assert still["outcome"] == "converged"
        assert lines[1].startswith("FAILS")
        assert f"diverged at {falls['end_time']:.4g} s" in lines[1]
        # 2 s^2 + 16 s - 100 = 0 has the root 4.12 1/s: from 1 mm to 1 m it takes about ln(1000)/4.12 = 1.68 s, and a
        # little more, since a part of the start is in the root that falls.
        assert falls["end_time"] == pytest.approx(1.9, abs=0.3)
        assert falls["largest_position_error"] == pytest.approx(1.0, rel=0.01)

    def test_a_model_without_gains_is_told_by_the_search(self, tmp_path, capsys):
        data = YAML(typ="safe", pure=True).load(PENDULUM)
        data["operating_point"]["q_d"] = {"x": "0 m", "y": "-2 m"}
        path = tmp_path / "model.yaml"
        path.write_text(json.dumps(data))
        assert simulate(path, "--out", tmp_path / "out") == 1
        assert capsys.readouterr().err.startswith("no design: ")
        assert not (tmp_path / "out").exists()


# A scenario file for the pendulum, and what is said of it.
WRONG = {
    "joint": ("scenarios:\n  a: {disturbances: [{force: {q7: 1 N}}]}\n", ":2:31: `q7` is no coordinate; there are: x, y"),
    "noise": ("scenarios:\n  a:\n    noise: {position: 1 um}\n", ":3:5: noise is drawn once a sample, and nothing is sampled here; give `force_path` a `sample`"),
    "gradient": ("scenarios:\n  a: {controller: 11, P_d: m*g*y + 2*m*g*x}\n", ":2:23: its gradient at q_d must be f_d = J^T lambda_d, and is off by 39.2 (in SI)"),
    "yaml": ("scenarios: {", ":1:13: no valid YAML"),
    "start": ("scenarios:\n  far: {start: {q: {x: 0, y: 0}}}\n", "scenario `far` cannot start where it shall: no configuration near the given one satisfies the constraints: Newton's method came to (0, 0), where the largest |phi| is 0.981"),
}  # fmt: skip


class TestTheQuestionWasWrong:
    @pytest.mark.parametrize(("text", "words"), WRONG.values(), ids=list(WRONG))
    def test_a_scenario_that_cannot_be(self, text, words, tmp_path, capsys, scenarios):
        path = scenarios(text)
        assert simulate(PENDULUM, "--scenario", path, "--out", tmp_path / "out") == 2
        printed = capsys.readouterr()
        assert printed.out == ""
        (line,) = printed.err.splitlines()
        assert line.startswith(f"{path}{words}" if words.startswith(":") else words)
        assert not (tmp_path / "out").exists()

    def test_both_things_that_only_the_loop_can_tell_are_told_at_once(self, tmp_path, capsys, scenarios):
        text = WRONG["noise"][0] + WRONG["gradient"][0].partition("\n")[2].replace("  a:", "  b:")
        assert simulate(PENDULUM, "--scenario", scenarios(text), "--out", tmp_path / "out") == 2
        assert len(capsys.readouterr().err.splitlines()) == 2

    def test_noise_with_samples_is_drawn(self, tmp_path, scenarios):
        text = "scenarios: {a: {duration: 50 ms, force_path: {sample: 5 ms}, noise: {position: 0.1 mm}}}"
        assert simulate(PENDULUM, "--scenario", scenarios(text), "--out", tmp_path / "out") == 0
        (run,) = strict((tmp_path / "out" / "simulation.json").read_text())["scenarios"]
        assert run["largest_position_error"] > 1e-7

    @pytest.mark.parametrize(
        ("arguments", "words"),
        [
            ([PENDULUM, "--only", "fall"], "no scenario `fall`; there are: start_error, force_step, offset, tilt"),
            (["missing.yaml"], "missing.yaml: cannot be read"),
            (["missing.json"], "missing.json: cannot be read"),
            ([PENDULUM, "--scenario", "missing.yaml"], "missing.yaml: cannot be read"),
            ([str(ROOT / "models")], "this folder holds no design.json; `firmtouch design MODEL --out"),
        ],
        ids=["name", "model", "design", "scenarios", "folder"],
    )
    def test_what_is_not_there(self, arguments, words, tmp_path, monkeypatch, capsys):
        monkeypatch.chdir(tmp_path)
        assert simulate(*arguments) == 2
        printed = capsys.readouterr()
        assert printed.out == ""
        assert words in printed.err
        assert listed(tmp_path) == set()

    @pytest.mark.parametrize(
        ("value", "words"),
        [("1", "1 is not between 1e-14 and 0.01"), ("nan", "nan is not between"), ("small", "'small' is no number")],
    )
    def test_a_tolerance_that_is_none(self, value, words, capsys):
        with pytest.raises(SystemExit) as ended:
            simulate(PENDULUM, "--tolerance", value)
        assert ended.value.code == 2
        assert words in capsys.readouterr().err

    def test_a_folder_that_cannot_be_made(self, tmp_path, capsys, scenarios):
        (tmp_path / "file").write_text("")
        assert simulate(PENDULUM, "--scenario", scenarios(TWO), "--out", tmp_path / "file" / "out") == 2
        printed = capsys.readouterr()
        assert printed.out == ""
        assert "cannot be written" in printed.err


def test_a_model_and_its_design_give_the_same_numbers(usual, tmp_path):
    """The folder of a design, its design.json, and the model itself."""
    folder = tmp_path / "design"
    design = try_out_design(firmtouch.design_model(firmtouch.read_model(PENDULUM)))
    write_files(folder, {"design.json": json.dumps(design_as_json(design)).encode()})
    runs = strict((usual / "simulation.json").read_text())["scenarios"]
    assert strict((folder / "design.json").read_text())["simulation"]["scenarios"] == runs
    for target, only in ((folder, "tilt"), (folder / "design.json", "start_error")):
        assert simulate(target, "--only", only, "--out", tmp_path / only) == 0
        assert (tmp_path / only / f"{only}.csv").read_bytes() == (usual / f"{only}.csv").read_bytes()
        (run,) = strict((tmp_path / only / "simulation.json").read_text())["scenarios"]
        assert run in runs
