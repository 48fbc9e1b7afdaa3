"""`firmtouch design`: what it writes and prints, exit codes with their reasons, files that are whole or absent."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest
from ruamel.yaml import YAML

from firmtouch.cli import main

ROOT = Path(__file__).parents[2]
PENDULUM = ROOT / "models" / "pendulum_rod.yaml"
FILES = {"certificate.json", "design.json", "report.html", "report.pdf"}

# A point in space: two constraints leave one direction, and two expressions of one surface make them redundant.
POINT = {
    "schema": "firmtouch.model/1",
    "title": "A point on a plane",
    "coordinates": {"x": "m", "y": "m", "z": "m"},
    "parameters": {"m": "2 kg", "g": "9.81 m/s^2"},
    "mechanism": {"kinetic_energy": "0.5*m*(dot(x)**2 + dot(y)**2 + dot(z)**2)", "potential_energy": "m*g*z"},
    "constraints": {"plane": {"expression": "z", "unit": "m"}, "again": {"expression": "2*z", "unit": "m"}},
    "operating_point": {"guess": {"x": 0, "y": 0, "z": 0.1}, "lambda_d": {"plane": 1, "again": 1}},
    "design": {"poles": [-4, -5], "force_feedback": 0.5},
}


@pytest.fixture
def write(tmp_path):
    """Write a model file: that of the pendulum with sections replaced, or a whole document."""

    def write(data=None, **sections) -> Path:
        if data is None:
            data = YAML(typ="safe", pure=True).load(PENDULUM)
        for key, value in sections.items():
            data[key] = data.get(key, {}) | value if isinstance(value, dict) else value
        path = tmp_path / "model.yaml"
        path.write_text(json.dumps(data), encoding="utf-8")
        return path

    return write


@pytest.fixture(scope="module")
def finished(tmp_path_factory) -> Path:
    """The folder of one whole run."""
    folder = tmp_path_factory.mktemp("finished") / "made" / "for it"
    assert main(["design", str(PENDULUM), "--out", str(folder)]) == 0
    return folder


def listed(folder: Path) -> set[str]:
    return {each.name for each in folder.iterdir()} if folder.exists() else set()


def assert_whole(folder: Path) -> None:
    """Every file that has its name is complete."""
    for name in FILES & listed(folder):
        content = (folder / name).read_bytes()
        if name.endswith(".json"):
            assert json.loads(content)["schema"] == f"firmtouch.{name.partition('.')[0]}/1"
        elif name == "report.html":
            assert content.rstrip().endswith(b"</html>")
        else:
            assert content.startswith(b"%PDF-")
            assert content.rstrip().endswith(b"%%EOF")


class TestTheForceLoop:
    def test_a_gain_beyond_the_bound_is_warned_of_and_designed_all_the_same(self, write, tmp_path, capsys):
        path = write(force_path={"bandwidth": "500 rad/s", "delay": "1 ms"}, design={"force_feedback": 4})
        assert main(["design", str(path), "--out", str(tmp_path / "out"), "--no-pdf", "--no-attraction"]) == 0
        printed = capsys.readouterr()
        assert "warning: The force loop is unstable: G_f has an eigenvalue of 4" in printed.err
        data = json.loads((tmp_path / "out" / "design.json").read_text(encoding="utf-8"))
        assert data["force_loop"]["loops"][0]["stable"] is False
        assert "<h2>Force loop</h2>" in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")

    def test_auto_is_chosen_written_as_a_number_and_verified(self, write, tmp_path, capsys):
        path = write(force_path={"delay": "1 ms"}, design={"force_feedback": "auto"})
        assert main(["design", str(path), "--out", str(tmp_path / "out"), "--no-pdf", "--no-attraction"]) == 0
        data = json.loads((tmp_path / "out" / "design.json").read_text(encoding="utf-8"))
        assert data["gains"]["G_f"] == [[0.5]]  # a gain margin of 2 and a modulus margin of 0.5 of a pure delay
        assert data["force_loop"]["asked"].keys() == {"gain", "modulus"}
        assert capsys.readouterr().err == ""
        assert main(["verify", str(tmp_path / "out" / "certificate.json"), "--model", str(path)]) == 0
        assert main(["check", str(path)]) == 0

    def test_auto_without_a_path_is_told_at_its_place(self, write, tmp_path, capsys):
        assert main(["design", str(write(design={"force_feedback": "auto"})), "--out", str(tmp_path / "out")]) == 2
        assert "`auto` needs `force_path`" in capsys.readouterr().err
        assert not (tmp_path / "out").exists()


class TestAFinishedDesign:
    def test_four_files_are_written_into_a_folder_that_is_made(self, finished):
        assert listed(finished) == FILES
        assert_whole(finished)

    def test_the_certificate_verifies(self, finished, capsys):
        assert main(["verify", str(finished / "certificate.json"), "--model", str(PENDULUM)]) == 0
        assert capsys.readouterr().out.startswith("Certified: ")

    def test_files_can_be_read_by_others(self, finished):
        assert {(finished / name).stat().st_mode & 0o777 for name in FILES} == {0o644}

    def test_the_verdict_and_the_files_are_printed_and_nothing_else(self, tmp_path, capsys):
        assert main(["design", str(PENDULUM), "--out", str(tmp_path), "--no-pdf", "--no-simulation"]) == 0
        printed = capsys.readouterr()
        assert printed.out.startswith("Certified: the gains put the poles at −4 ± 2j 1/s")
        written = ("design.json", "certificate.json", "report.html")
        assert printed.out.splitlines()[-3:] == [f"  {tmp_path / name}" for name in written]
        assert printed.err == ""
        assert "\x1b" not in printed.out

    def test_without_pdf_there_are_three_files(self, tmp_path, capsys):
        assert main(["design", str(PENDULUM), "--out", str(tmp_path), "--no-pdf", "--no-simulation"]) == 0
        assert listed(tmp_path) == FILES - {"report.pdf"}

    def test_json_on_stdout_is_the_file_to_the_byte(self, tmp_path, capfdbinary):
        assert main(["design", str(PENDULUM), "--out", str(tmp_path), "--no-pdf", "--json"]) == 0
        sys.stdout.flush()
        printed = capfdbinary.readouterr()
        assert printed.out == (tmp_path / "design.json").read_bytes()
        assert printed.err == b""

    def test_the_default_folder_is_named_after_the_model(self, tmp_path, monkeypatch, capsys):
        monkeypatch.chdir(tmp_path)
        assert main(["design", str(PENDULUM), "--no-pdf"]) == 0
        assert listed(tmp_path / "reports" / "pendulum_rod") == FILES - {"report.pdf"}

    @pytest.mark.slow
    def test_the_same_model_gives_the_same_files_again(self, finished, tmp_path):
        again = run_program("--out", tmp_path)
        assert again.wait() == 0
        for name in FILES:
            assert (tmp_path / name).read_bytes() == (finished / name).read_bytes()

    def test_warnings_go_to_stderr_without_colour_when_it_is_no_terminal(self, write, tmp_path, capsys):
        assert main(["design", str(weak(write)), "--out", str(tmp_path / "out"), "--no-pdf", "--no-simulation"]) == 0
        printed = capsys.readouterr()
        assert printed.err.splitlines()
        assert all(line.startswith("warning: ") for line in printed.err.splitlines())
        assert "\x1b" not in printed.err
        assert "warning:" not in printed.out

    @pytest.mark.parametrize("no_color", [False, True])
    def test_colour_is_for_terminals_and_no_color_is_honoured(self, write, tmp_path, capsys, monkeypatch, no_color):
        monkeypatch.setenv("FORCE_COLOR", "1")  # as on a terminal
        monkeypatch.setenv("TERM", "xterm-256color")
        monkeypatch.delenv("NO_COLOR", raising=False)
        if no_color:
            monkeypatch.setenv("NO_COLOR", "1")
        assert main(["design", str(weak(write)), "--out", str(tmp_path / "out"), "--no-pdf", "--no-simulation"]) == 0
        printed = capsys.readouterr()
        yellow = "\x1b[33m"
        assert (yellow in printed.err) != no_color


def weak(write) -> Path:
    """A design that holds on the tangent level alone, and is warned of: W is negative where the rod's tension helps."""
    return write(design={"poles": [-1, -2], "level": "tangent"})


class Refusal(NamedTuple):
    """What is changed in the pendulum's file, what is left out of its operating point, and what is told then."""

    reasons: tuple[str, ...]
    sections: dict
    dropped: tuple[str, ...] = ()


NO_DESIGN = {
    "an unreachable surface": Refusal(
        ("no configuration near", "|phi|"),
        {
            "constraints": {"rod": {"expression": "length + sqrt(x**2 + y**2)", "unit": "m"}},
            "operating_point": {"guess": {"x": "0.3 m", "y": "-0.4 m"}},
        },
        dropped=("q_d",),
    ),
    "a stated configuration off the surface": Refusal(
        ("q_d misses the constraints by 0.081", "guess"), {"operating_point": {"q_d": {"x": "0 m", "y": "-0.9 m"}}}
    ),
    "a force that no contact carries": Refusal(
        ("f_d is no constraint force", "60.00%", "lambda_d"),
        {"operating_point": {"f_d": {"x": "3 N", "y": "4 N"}}},
        dropped=("lambda_d",),
    ),
    "a kinetic energy of degree three": Refusal(
        ("fails its checks", "K homogeneous", "firmtouch check"),
        {
            "parameters": {"c": "1 m/s"},
            "mechanism": {"kinetic_energy": "0.5*m*(dot(x)**2 + dot(y)**2) + m*dot(x)**3/c"},
        },
    ),
    "poles too slow for the full level": Refusal(
        ("not positive definite on the full level", "W_min = -", "level: tangent"), {"design": {"poles": [-1, -2]}}
    ),
}


@pytest.mark.parametrize("refusal", NO_DESIGN.values(), ids=list(NO_DESIGN))
def test_where_there_is_no_design_the_reason_is_told_and_nothing_written(write, tmp_path, capsys, refusal):
    data = YAML(typ="safe", pure=True).load(PENDULUM)
    for name in refusal.dropped:
        del data["operating_point"][name]
    out = tmp_path / "out"
    assert main(["design", str(write(data, **refusal.sections)), "--out", str(out)]) == 1
    printed = capsys.readouterr()
    assert printed.err.startswith("no design: ")
    for each in refusal.reasons:
        assert each in printed.err
    assert printed.out == ""
    assert not out.exists()


def test_redundant_constraints_are_named_with_what_they_are_made_of(write, tmp_path, capsys):
    assert main(["design", str(write(POINT)), "--out", str(tmp_path / "out")]) == 1
    told = capsys.readouterr().err
    assert "redundant" in told
    assert "rank 1" in told
    assert "the gradient of `again` is +2 plane" in told
    assert not (tmp_path / "out").exists()


def test_json_of_a_model_without_a_design_is_empty_and_the_reason_stays_on_stderr(write, tmp_path, capsys):
    path = write(design={"poles": [-1, -2]})
    assert main(["design", str(path), "--out", str(tmp_path / "out"), "--json"]) == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "no design" in printed.err


BAD_INPUT = {
    "no yaml": ("{", "model.yaml:"),
    "empty": ("", "model.yaml:"),
    "a list": ("[1, 2]", "model.yaml:1:1"),
    "an unknown key": (PENDULUM.read_text(encoding="utf-8") + "\nbogus: 1\n", "`bogus`"),
    "a pole alone": (PENDULUM.read_text(encoding="utf-8").replace("[-4+2j, -4-2j]", "[-4+2j, -5]"), "no conjugate"),
    "too few poles": (PENDULUM.read_text(encoding="utf-8").replace("[-4+2j, -4-2j]", "[-4]"), "2(n - m) = 2"),
}


@pytest.mark.parametrize(("content", "reason"), BAD_INPUT.values(), ids=list(BAD_INPUT))
def test_a_bad_file_is_told_with_its_place_and_nothing_is_written(tmp_path, capsys, content, reason):
    path, out = tmp_path / "model.yaml", tmp_path / "out"
    path.write_text(content, encoding="utf-8")
    assert main(["design", str(path), "--out", str(out)]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert str(path) in printed.err
    assert reason in printed.err
    assert not out.exists()


def test_a_missing_file_and_a_folder_for_a_file_are_bad_input(tmp_path, capsys):
    assert main(["design", str(tmp_path / "missing.yaml")]) == 2
    assert "missing.yaml: cannot be read (No such file or directory)" in capsys.readouterr().err
    assert main(["design", str(tmp_path)]) == 2
    assert "cannot be read (Is a directory)" in capsys.readouterr().err


@pytest.mark.parametrize("below", [False, True])
def test_an_output_folder_that_is_a_file_is_bad_input_and_the_file_is_left(tmp_path, capsys, below):
    taken = tmp_path / "taken"
    taken.write_text("mine", encoding="utf-8")
    assert main(["design", str(PENDULUM), "--no-pdf", "--out", str(taken / "below" if below else taken)]) == 2
    printed = capsys.readouterr()
    assert "cannot be written" in printed.err
    assert printed.out == ""
    assert taken.read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize("arguments", [["design"], ["design", "a.yaml", "--bogus"], ["desing", "a.yaml"], []])
def test_a_wrong_command_line_is_bad_input_with_a_usage_line(capsys, arguments):
    with pytest.raises(SystemExit) as stopped:
        main(arguments)
    assert stopped.value.code == 2
    assert "usage: firmtouch" in capsys.readouterr().err


def test_the_files_of_an_earlier_run_stay_whole_when_a_later_one_fails(write, tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["design", str(PENDULUM), "--out", str(out)]) == 0
    before = {name: (out / name).read_bytes() for name in FILES}
    assert main(["design", str(write(design={"poles": [-1, -2]})), "--out", str(out)]) == 1
    (tmp_path / "model.yaml").write_text("{", encoding="utf-8")
    assert main(["design", str(tmp_path / "model.yaml"), "--out", str(out)]) == 2
    assert {name: (out / name).read_bytes() for name in listed(out)} == before


def run_program(*arguments) -> subprocess.Popen:
    command = [sys.executable, "-m", "firmtouch", "design", str(PENDULUM), *map(str, arguments)]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@pytest.mark.parametrize("seconds", [0.3, 0.9, 1.6, 2.1, 2.6])
def test_a_run_that_is_killed_leaves_whole_files_or_none(tmp_path, seconds):
    run = run_program("--out", tmp_path / "out")
    try:
        run.wait(timeout=seconds)
    except subprocess.TimeoutExpired:
        run.kill()
        assert run.wait() < 0
    assert_whole(tmp_path / "out")


# The moments that matter: in the middle of a file, before it is on the disk, and before it gets its name.
DYING = """
import os, signal, sys
from pathlib import Path
from firmtouch.report.write import write_files

calls = 0
def dying(call):
    def die(*arguments, **options):
        global calls
        calls += 1
        if calls == int(sys.argv[2]):
            os.kill(os.getpid(), signal.SIGKILL)
        return call(*arguments, **options)
    return die

os.fsync = dying(os.fsync)
Path.replace = dying(Path.replace)
write_files(Path(sys.argv[1]), {name: b"new" * 100_000 for name in sys.argv[3:]})
"""


@pytest.mark.parametrize("moment", range(1, 2 * len(FILES) + 2))
def test_each_file_is_the_old_or_the_new_one_whenever_the_writing_is_killed(tmp_path, moment):
    for name in FILES:
        (tmp_path / name).write_bytes(b"old")
    killed = subprocess.run([sys.executable, "-c", DYING, str(tmp_path), str(moment), *sorted(FILES)], check=False)
    assert killed.returncode == (0 if moment > 2 * len(FILES) else -9)
    contents = {name: (tmp_path / name).read_bytes() for name in FILES}
    assert set(contents.values()) <= {b"old", b"new" * 100_000}
    replaced = [name for name in sorted(FILES) if contents[name] != b"old"]
    assert replaced == sorted(FILES)[: (moment - 1) // 2]
    assert all(each.startswith(".") for each in listed(tmp_path) - FILES)  # what is left behind is out of sight


def test_a_pipe_that_closes_early_is_no_error(tmp_path):
    command = [
        sys.executable,
        "-m",
        "firmtouch",
        "design",
        str(PENDULUM),
        "--json",
        "--no-pdf",
        "--no-simulation",
        "--out",
        str(tmp_path),
    ]
    read, write = os.pipe()
    os.close(read)
    with os.fdopen(write, "wb") as closed:
        finished = subprocess.run(command, stdout=closed, stderr=subprocess.PIPE, text=True, check=False)
    assert "Traceback" not in finished.stderr
    assert listed(tmp_path) == FILES - {"report.pdf"}
