"""`firmtouch montecarlo`: what it prints and writes, goes on after a stop, runs again, and its exit codes."""

import csv
import hashlib
import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from firmtouch.cli import main
from firmtouch.montecarlo import proven

ROOT = Path(__file__).parents[2]
MODEL = str(ROOT / "models" / "planar_2r_circle.yaml")


def asked(*words, out, runs=20, jobs=1) -> list[str]:
    return ["montecarlo", MODEL, "--runs", str(runs), "--jobs", str(jobs), "--out", str(out), *words]


@pytest.fixture(scope="module")
def finished(tmp_path_factory) -> Path:
    """The folder of one study."""
    folder = tmp_path_factory.mktemp("finished") / "made" / "for it"
    assert main(asked(out=folder)) == 0
    return folder


@pytest.fixture(scope="module")
def design(tmp_path_factory) -> Path:
    """The folder of a finished design, with its proven region."""
    folder = tmp_path_factory.mktemp("design")
    assert main(["design", MODEL, "--out", str(folder), "--no-pdf", "--no-simulation"]) == 0
    return folder


def answer(folder: Path) -> dict:
    return json.loads((folder / "montecarlo.json").read_bytes())


class TestAStudy:
    def test_it_tells_the_fraction_and_where_the_files_are(self, tmp_path, capsys):
        assert main(asked(out=tmp_path)) == 0
        said, talk = capsys.readouterr()
        assert "of 20 runs converged: " in said
        assert "95 % confidence" in said
        assert f"{tmp_path / 'montecarlo.json'}\n" in said
        assert f"--out {tmp_path} --run NUMBER" in said
        assert "Nothing is proven here" in said
        assert talk == ""

    def test_the_file_holds_what_was_asked_and_found(self, finished):
        found = answer(finished)
        assert (found["schema"], found["runs"], found["question"]["seed"]) == ("firmtouch.montecarlo/1", 20, 1)
        assert found["converged"] == found["outcomes"]["converged"]
        assert found["interval"][0] < found["fraction"] < found["interval"][1]
        lines = (finished / "runs.jsonl").read_text().splitlines()
        assert len(lines) == 21
        assert {json.loads(each)["run"] for each in lines[1:]} == {str(i) for i in range(1, 21)}
        assert found["question"]["model"]["sha256"] == hashlib.sha256(Path(MODEL).read_bytes()).hexdigest()

    def test_json_is_the_file(self, finished, tmp_path, capsys):
        assert main(asked("--json", out=tmp_path)) == 0
        assert capsys.readouterr().out.encode() == (finished / "montecarlo.json").read_bytes()

    def test_after_a_stop_it_goes_on_to_the_same_answer(self, finished, tmp_path):
        content = (finished / "runs.jsonl").read_bytes()
        (tmp_path / "runs.jsonl").write_bytes(content[: len(content) // 2])
        assert main(asked(out=tmp_path)) == 0
        assert (tmp_path / "montecarlo.json").read_bytes() == (finished / "montecarlo.json").read_bytes()
        assert sorted((tmp_path / "runs.jsonl").read_bytes().splitlines()) == sorted(content.splitlines())

    def test_more_runs_are_added_to_those_that_are_there(self, finished, tmp_path):
        (tmp_path / "runs.jsonl").write_bytes((finished / "runs.jsonl").read_bytes())
        assert main(asked(out=tmp_path, runs=25)) == 0
        assert (tmp_path / "runs.jsonl").read_bytes().startswith((finished / "runs.jsonl").read_bytes())
        assert answer(tmp_path)["runs"] == 25

    @pytest.mark.slow
    def test_two_processes_give_the_same(self, finished, tmp_path):
        command = [sys.executable, "-m", "firmtouch", *asked(out=tmp_path, jobs=2)]
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=120, check=False, cwd=ROOT,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(each for each in sys.path if each)},
        )  # fmt: skip
        assert (done.returncode, done.stderr) == (0, "")
        assert (tmp_path / "montecarlo.json").read_bytes() == (finished / "montecarlo.json").read_bytes()

    def test_at_least_is_about_the_intervals_lower_end(self, finished, tmp_path, capsys):
        low = answer(finished)["interval"][0]
        (tmp_path / "runs.jsonl").write_bytes((finished / "runs.jsonl").read_bytes())
        assert main(asked("--at-least", str(low), out=tmp_path)) == 0
        assert main(asked("--at-least", str(low + 1e-9), out=tmp_path)) == 1
        assert "NOT reached" in capsys.readouterr().out

    def test_scenarios_come_from_a_file(self, tmp_path, capsys):
        file = tmp_path / "s.yaml"
        file.write_text(
            "scenarios: {a: {controller: 15, duration: 1 s}, b: {}}\ndraw: {tilt: none, offset: none, disturbance: none, parameters: none}\n"
        )
        assert main(asked("--scenario", str(file), out=tmp_path / "a")) == 2
        assert "holds 2 scenarios; choose by `--name`: a, b" in capsys.readouterr().err
        assert main(asked("--scenario", str(file), "--name", "c", out=tmp_path / "a")) == 2
        assert "holds no scenario 'c'; there are: a, b" in capsys.readouterr().err
        assert main(asked("--scenario", str(file), "--name", "a", out=tmp_path / "a", runs=3)) == 0
        said = capsys.readouterr().out
        assert "Around `a`, controller (15), 1 s each" in said
        assert "tilt" not in said


class TestOneRunAgain:
    def test_it_is_the_same_bit_for_bit_and_has_a_table(self, finished, capsys):
        assert main(asked("--run", "7", out=finished)) == 0
        said = capsys.readouterr().out
        assert "Run 7 of seed 1; drawn, in SI:" in said
        assert "the same as recorded, bit for bit" in said
        with (finished / "run-7.csv").open() as file:
            rows = list(csv.reader(file))
        assert rows[0] == ["t", "q1", "q2", "q1_dot", "q2_dot", "lambda_rim", "u_q1", "u_q2", "phi_rim"]
        table = np.array(rows[1:], dtype=float)
        recorded = next(
            json.loads(each)
            for each in (finished / "runs.jsonl").read_text().splitlines()[1:]
            if json.loads(each)["run"] == "7"
        )
        assert np.max(np.abs(table[:, 5] - 40)) == pytest.approx(recorded["force"], rel=1e-12)  # lambda_d is 40 N
        assert table[-1, 0] == recorded["t"]

    def test_json_tells_what_was_drawn(self, finished, capsys):
        assert main(asked("--run", "7", "--json", out=finished)) == 0
        told = json.loads(capsys.readouterr().out)
        assert told["as_recorded"] is True
        assert 3.0 <= told["drawn"]["parameters"]["m2"] <= 4.5

    def test_any_number_can_be_had(self, tmp_path, capsys):
        assert main(asked("--run", "4000", "--json", out=tmp_path)) == 0
        assert json.loads(capsys.readouterr().out)["as_recorded"] is None
        assert not (tmp_path / "runs.jsonl").exists()


class TestAgainstTheProof:
    def test_starts_inside_converge(self, design, tmp_path, capsys):
        assert main(["montecarlo", str(design), "--runs", "3", "--jobs", "1", "--out", str(tmp_path)]) == 0
        assert "All 50 further starts inside the proven region (V < 0.0783 J and " in capsys.readouterr().out
        assert answer(tmp_path)["inside"] == {"runs": 50, "contradictions": [], "pulled": 0}

    def test_a_contradiction_is_told_with_its_number_and_exit_code_1(self, design, tmp_path, capsys, monkeypatch):
        def spoilt(part, loop):
            return tuple(replace(each, level=50 * each.level) for each in found(part, loop)[:1])

        found = proven.regions_of_file
        monkeypatch.setattr(proven, "regions_of_file", spoilt)
        monkeypatch.setattr("firmtouch.cli.montecarlo.LEAST_INSIDE", 12)
        command = ["montecarlo", str(design), "--runs", "3", "--jobs", "1", "--out", str(tmp_path)]
        assert main(command) == 1
        said = capsys.readouterr().out
        first = answer(tmp_path)["inside"]["contradictions"][0]["run"]
        assert f"CONTRADICTION: run {first} starts inside the proven region" in said
        assert f"--run {first}\n" in said
        assert main([*command, "--run", first]) == 1
        assert "the same as recorded, bit for bit" in capsys.readouterr().out

    def test_a_certificate_of_another_design_is_refused(self, design, tmp_path, capsys):
        for name in ("design.json", "certificate.json"):
            (tmp_path / name).write_bytes((design / name).read_bytes())
        with (tmp_path / "design.json").open("a") as file:
            file.write("\n")
        assert main(["montecarlo", str(tmp_path), "--runs", "3"]) == 2
        assert "belongs to another design.json" in capsys.readouterr().err

    def test_a_changed_certificate_is_refused(self, design, tmp_path, capsys):
        (tmp_path / "design.json").write_bytes((design / "design.json").read_bytes())
        data = json.loads((design / "certificate.json").read_bytes())
        data["surroundings"]["attraction"]["level"] = (4.0).hex()
        (tmp_path / "certificate.json").write_text(json.dumps(data))
        assert main(["montecarlo", str(tmp_path), "--runs", "3"]) == 2
        assert "its digest does not fit" in capsys.readouterr().err


class TestMistakes:
    @pytest.mark.parametrize(
        ("words", "message"),
        [
            (["--runs", "0"], "`--runs 0`: a number from 1"),
            (["--jobs", "0"], "`--jobs 0`: a number from 1"),
            (["--seed", "-1"], "`--seed -1`: a number from 0"),
            (["--at-least", "99"], "`--at-least 99`: a part from 0 to 1"),
            (["--name", "a"], "give that by `--scenario FILE`"),
            (["--run", "x"], "'x' is no run"),
            (["--run", "p1"], "would start inside a proven region, and none is known here"),
            (["--scenario", "nowhere.yaml"], "nowhere.yaml: cannot be read"),
        ],
    )
    def test_they_are_told(self, tmp_path, capsys, words, message):
        assert main(["montecarlo", MODEL, "--out", str(tmp_path), *words]) == 2
        assert message in capsys.readouterr().err
        assert not list(tmp_path.iterdir())

    def test_another_question_in_the_folder_is_refused_unless_fresh(self, finished, tmp_path, capsys):
        (tmp_path / "runs.jsonl").write_bytes((finished / "runs.jsonl").read_bytes())
        for words in (["--seed", "2"], ["--seed", "2", "--run", "3"]):
            assert main(asked(*words, out=tmp_path, runs=3)) == 2
            assert "holds runs of another question: seed (1 there, 2 here) differ" in capsys.readouterr().err
        assert main(asked("--seed", "2", "--fresh", out=tmp_path, runs=3)) == 0
        assert answer(tmp_path)["question"]["seed"] == 2
        assert len((tmp_path / "runs.jsonl").read_text().splitlines()) == 4

    def test_a_folder_that_cannot_be_made(self, tmp_path, capsys):
        (tmp_path / "file").write_text("x")
        assert main(asked(out=tmp_path / "file" / "below", runs=2)) == 2
        assert "cannot be" in capsys.readouterr().err
