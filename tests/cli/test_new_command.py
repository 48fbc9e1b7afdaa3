"""`firmtouch new`: a model file that works as it is, and is never written over another."""

import pytest

from firmtouch.cli import main


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_the_file_that_is_written_passes_every_check_and_gives_a_design(tmp_path, capsys):
    assert main(["new", "polisher"]) == 0
    assert "polisher.yaml" in capsys.readouterr().out
    assert main(["check", "polisher.yaml"]) == 0
    assert main(["design", "polisher.yaml", "--no-pdf"]) == 0
    assert (tmp_path / "reports" / "polisher" / "report.html").exists()


@pytest.mark.parametrize("name", ["polisher.yaml", "a b", "it's: #1", '"quoted"', "ünï-code_2", "-{braces}"])
def test_odd_names_give_files_that_read(name, tmp_path, capsys):
    assert main(["new", "--", name]) == 0
    (path,) = tmp_path.glob("*.yaml")
    assert path.name == name.removesuffix(".yaml") + ".yaml"
    capsys.readouterr()
    assert main(["check", "--", str(path)]) == 0


def test_an_existing_file_is_left_as_it_is(tmp_path, capsys):
    (tmp_path / "polisher.yaml").write_text("mine", encoding="utf-8")
    assert main(["new", "polisher"]) == 2
    assert (tmp_path / "polisher.yaml").read_text(encoding="utf-8") == "mine"
    assert "exists already" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["", ".yaml", "no/such/folder/model"])
def test_a_name_that_cannot_be_written_is_a_wrong_question(name, capsys):
    assert main(["new", name]) == 2
    assert capsys.readouterr().err
