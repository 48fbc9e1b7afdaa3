"""`firmtouch new`: a model file to start from, which works as it is and replaces nothing."""

from pathlib import Path

import pytest
from ruamel.yaml import YAML

from firmtouch.cli import main
from firmtouch.modelfile import read_model


@pytest.fixture(autouse=True)
def in_an_empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_file_that_is_written_passes_its_checks(capsys, tmp_path):
    assert main(["new", "polisher"]) == 0
    told = capsys.readouterr()
    assert told.out == "wrote polisher.yaml\n"
    assert told.err == "next: firmtouch check polisher.yaml && firmtouch design polisher.yaml\n"
    assert main(["check", "polisher.yaml"]) == 0
    assert "checks hold" in capsys.readouterr().out
    text = (tmp_path / "polisher.yaml").read_text()
    assert "firmtouch check polisher.yaml && firmtouch design polisher.yaml" in text
    assert sum("#" in line for line in text.splitlines()) > 10  # it is there to be read


def test_the_file_that_is_written_can_be_designed(tmp_path):
    assert main(["new", "polisher"]) == 0
    assert main(["design", "polisher.yaml", "--no-pdf", "--out", str(tmp_path / "report")]) == 0
    assert (tmp_path / "report" / "design.json").exists()


def test_nothing_is_ever_overwritten(capsys, tmp_path):
    (tmp_path / "mine.yaml").write_text("my work")
    assert main(["new", "mine"]) == 2
    assert capsys.readouterr().err == "mine.yaml exists already, and is left as it is\n"
    assert main(["new", "mine.yaml"]) == 2
    assert (tmp_path / "mine.yaml").read_text() == "my work"
    (tmp_path / "link.yaml").symlink_to(tmp_path / "elsewhere")
    assert main(["new", "link"]) == 2
    assert not (tmp_path / "elsewhere").exists()


@pytest.mark.parametrize(
    ("name", "title"),
    [
        ("polisher.yaml", "Polisher"),
        ("left_arm-2", "Left arm 2"),
        ("with blanks", "With blanks"),
        ('quo"te', 'Quo"te'),
        ("back\\slash", "Back\\slash"),
        ("{brace}", "{brace}"),
        ("a: b # c", "A: b # c"),
        ("ärmchen", "Ärmchen"),
        ("_", "Model"),
    ],
)
def test_any_name_gives_a_file_that_can_be_read(name, title, tmp_path):
    assert main(["new", name]) == 0
    (path,) = tmp_path.glob("*.yaml")
    assert read_model(path).spec.title == title
    assert YAML(typ="safe", pure=True).load(path.read_text(encoding="utf-8"))["title"] == title


@pytest.mark.parametrize("name", ["", ".yaml", " ", "a\nb", "a\x1b[31mb", "a\x00b", "a\udcffb"])
def test_a_name_that_is_none_is_a_wrong_question(capsys, name, tmp_path):
    assert main(["new", name]) == 2
    assert capsys.readouterr().err == "a name was expected, such as `polisher`\n"
    assert list(tmp_path.iterdir()) == []


def test_a_place_that_cannot_be_written_is_told(capsys):
    assert main(["new", "no/such/folder"]) == 2
    assert capsys.readouterr().err == "no/such/folder.yaml: cannot be written (No such file or directory)\n"
    assert main(["new", "x" * 300]) == 2
    assert "cannot be written (File name too long)" in capsys.readouterr().err


URDF = Path(__file__).parents[2] / "models" / "urdf"


class TestRobots:
    def test_the_file_that_is_written_passes_its_checks_and_can_be_designed(self, capsys, tmp_path):
        assert main(["new", "polisher", "--urdf", str(URDF / "panda.urdf")]) == 0
        assert capsys.readouterr().out == "wrote polisher.yaml\n"
        assert main(["check", "polisher.yaml"]) == 0
        spec = read_model("polisher.yaml").spec
        assert (spec.n, spec.m, spec.mechanism.tools()) == (7, 1, ("flange",))
        fast = ["--no-pdf", "--no-attraction", "--no-simulation"]
        assert main(["design", "polisher.yaml", "--out", str(tmp_path / "report"), *fast]) == 0

    def test_the_path_is_relative_to_the_file_and_the_tool_leaves_out_what_does_not_matter(self, tmp_path):
        (tmp_path / "cell").mkdir()
        assert main(["new", "cell/left", "--urdf", str(URDF / "dual_ur5e.urdf"), "--tool", "left_tool0"]) == 0
        model = read_model("cell/left.yaml")
        assert model.spec.n == 6
        assert not Path(next(iter(model.attached))).is_absolute()

    @pytest.mark.parametrize(
        ("arguments", "told"),
        [
            (["--urdf", "none.urdf"], "none.urdf: cannot be read"),
            (
                ["--urdf", str(URDF / "panda.urdf"), "--tool", "flang"],
                "the tool `flang` is no link; did you mean `flange`?",
            ),
            (["--tool", "flange"], "give its `--urdf` too"),
        ],
    )
    def test_what_cannot_be_is_a_wrong_question(self, arguments, told, capsys, tmp_path):
        assert main(["new", "polisher", *arguments]) == 2
        assert told in capsys.readouterr().err
        assert list(tmp_path.iterdir()) == []


def test_a_sensor_file_that_works_as_it_is(capsys, tmp_path):
    assert main(["new", "finger", "--sensor"]) == 0
    told = capsys.readouterr()
    assert told.out == "wrote finger.yaml\n"
    assert told.err == "next: firmtouch thermal finger.yaml\n"
    assert main(["thermal", "finger.yaml", "--no-pdf"]) == 0
    assert (tmp_path / "reports" / "finger" / "thermal.json").exists()


@pytest.mark.parametrize("more", [["--urdf", "arm.urdf"], ["--tool", "flange"]])
def test_a_sensor_has_no_robot(capsys, more):
    assert main(["new", "finger", "--sensor", *more]) == 2
    assert "a sensor has no robot" in capsys.readouterr().err
