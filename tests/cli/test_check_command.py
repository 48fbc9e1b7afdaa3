"""`firmtouch check`: tables or JSON on stdout, mistakes on stderr, and the exit code says which."""

import json
from pathlib import Path

import pytest

from firmtouch.checks import CHECKS
from firmtouch.cli import main

MODELS = Path(__file__).parents[2] / "models"
WALL, PENDULUM = MODELS / "planar_2r_wall.yaml", MODELS / "pendulum_rod.yaml"


@pytest.fixture
def write(tmp_path):
    """Write the pendulum's file with one piece changed."""

    def write(*changes, name="made.yaml") -> Path:
        text = PENDULUM.read_text()
        for old, new in changes:
            assert text.count(old) == 1
            text = text.replace(old, new)
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


def check(capsys, *arguments):
    code = main(["check", *map(str, arguments)])
    told = capsys.readouterr()
    return code, told.out, told.err


def line_of(path, word):
    return next(i for i, line in enumerate(path.read_text().splitlines(), start=1) if word in line)


def test_a_good_model_gets_a_table_with_a_row_for_each_check_and_exit_code_0(capsys):
    code, out, err = check(capsys, WALL)
    assert code == 0
    assert err == ""
    title, heading, *rows, verdict = out.rstrip().splitlines()
    assert title.strip() == str(WALL)
    assert heading.split() == ["check", "figure", "bound", "found"]
    assert len(rows) == len(CHECKS) + 1  # and the comparison with SymPy
    assert all(row.startswith("ok ") for row in rows)
    assert verdict == f"all {len(rows)} checks hold"
    assert any("dropping it would turn the verdict on stability" in row for row in rows)


def test_a_check_that_fails_is_marked_and_the_exit_code_is_1(capsys, write):
    # Without the weight the model is sound, but for a q_d that hangs in the air.
    code, out, err = check(capsys, write(("q_d: {x: 0 m, y: -0.981 m}", "q_d: {x: 0 m, y: -0.9 m}")))
    assert code == 1
    assert err == ""
    failed = [row for row in out.splitlines() if row.startswith("FAILS")]
    assert [row[6:20].strip() for row in failed] == ["Phi(q_d) = 0", "energy kept"]
    assert "q_d misses the constraints by 0.081" in failed[0]
    assert out.rstrip().endswith("2 of 15 checks fail")


@pytest.mark.parametrize(
    ("change", "failing"),
    [
        (("value: 2.0 kg", "value: -2.0 kg"), {"M positive definite"}),
        (("value: 2.0 kg", "value: 0 kg"), {"M positive definite", "energy kept"}),
        (("0.5*m*(dot(x)**2", "m*g*y + 0.5*m*(dot(x)**2"), {"K homogeneous"}),
        (("m*g*y", "m*g*length*log(y/length)"), {"energy kept"}),
        (("length - sqrt(x**2 + y**2)", "length - sqrt(x**2 - y**2)"), {"Phi(q_d) = 0", "rank of J"}),
        (("length - sqrt(x**2 + y**2)", "0*y + length - sqrt(length**2)"), {"rank of J"}),
    ],
    ids=["negative mass", "no mass", "not homogeneous", "logarithm of a negative", "root of a negative", "no gradient"],
)
@pytest.mark.filterwarnings("error")
def test_a_model_that_is_wrong_fails_its_checks_and_never_the_program(capsys, write, change, failing):
    code, out, err = check(capsys, "--json", write(change))
    assert code == 1
    assert err == ""
    failed = {each["name"] for each in json.loads(out)["models"][0]["checks"] if not each["holds"]}
    assert failing <= failed


def test_mistakes_in_a_file_go_to_stderr_with_exit_code_2(capsys, write):
    path = write(("value: 2.0 kg", "value: 2.0 kgg"), ("poles: [", "pole: ["))
    code, out, err = check(capsys, path)
    assert code == 2
    assert out == ""
    mass, pole = (line_of(path, each) for each in ("kgg", "pole:"))
    assert err.splitlines() == [
        f"{path}:{mass}:18: `kgg` is no unit; did you mean `kg`?",
        f"{path}:{pole}:3: unknown key `pole`; there are: method, poles, region, force_feedback, normal_blocks, level, "
        "modes; did you mean `poles`?",
    ]


def test_a_place_in_a_message_is_never_taken_for_a_smiley(capsys, write):
    # rich would make an emoji of `:100:`.
    path = write(("poles: [", "poles: [0, "))
    path.write_text("\n" * (100 - line_of(path, "poles:")) + path.read_text())
    code, _, err = check(capsys, path)
    assert code == 2
    assert err.startswith(f"{path}:100:11: the pole `0` is not stable")


def test_a_title_with_brackets_is_no_markup(capsys, write):
    code, out, _ = check(capsys, write(name="[red]:100:.yaml"))
    assert code == 0
    assert "[red]:100:.yaml" in out


@pytest.mark.parametrize(
    "content", [b"", b"\x89PNG\r\n\x1a\n\x00\x00", b"- a\n", b"a: [", b"a: !!python/object:os.system x"]
)
def test_what_is_no_model_file_is_refused_with_exit_code_2(capsys, tmp_path, content):
    path = tmp_path / "made.yaml"
    path.write_bytes(content)
    code, out, err = check(capsys, path)
    assert (code, out) == (2, "")
    assert err.startswith(f"{path}:1:")


def test_a_path_that_cannot_be_read_is_refused_with_exit_code_2(capsys, tmp_path):
    code, out, err = check(capsys, tmp_path / "none.yaml")
    assert (code, out) == (2, "")
    assert err == f"{tmp_path}/none.yaml: cannot be read (No such file or directory)\n"
    code, _, err = check(capsys, tmp_path)
    assert code == 2
    assert "Is a directory" in err
    code, _, err = check(capsys, "a\x00b")
    assert code == 2
    assert "cannot be read" in err


def test_one_bad_file_stops_no_other_and_the_worst_code_wins(capsys, write, tmp_path):
    bad = write(("q_d: {x: 0 m, y: -0.981 m}", "q_d: {x: 0 m, y: -0.9 m}"), name="bad.yaml")
    code, out, err = check(capsys, tmp_path / "none.yaml", bad, PENDULUM)
    assert code == 2
    assert "none.yaml" in err
    assert "checks fail" in out
    assert "checks hold" in out
    assert check(capsys, bad, PENDULUM)[0] == 1
    assert check(capsys, PENDULUM, WALL)[0] == 0


def test_json_holds_every_check_with_its_figure_and_bound(capsys):
    code, out, err = check(capsys, "--json", PENDULUM, WALL)
    assert code == 0
    assert err == ""
    told = json.loads(out)
    assert told["schema"] == "firmtouch.check/1"
    assert [each["model"] for each in told["models"]] == ["pendulum_rod", "planar_2r_wall"]
    for model in told["models"]:
        assert model["holds"] is True
        assert [each["name"] for each in model["checks"]][:2] == ["Phi(q_d) = 0", "rank of J"]
        for each in model["checks"]:
            assert set(each) == {"name", "holds", "figure", "relation", "bound", "detail"}
            if each["relation"] == "<=":
                assert each["figure"] <= each["bound"]
            elif each["relation"] == ">=":
                assert each["figure"] >= each["bound"]


def test_json_has_null_for_a_figure_that_is_no_number(capsys, write):
    code, out, _ = check(capsys, "--json", write(("length - sqrt(x**2 + y**2)", "length*log(x/length) + x - x")))
    assert code == 1
    assert "NaN" not in out
    assert "Infinity" not in out
    first = json.loads(out)["models"][0]["checks"][0]
    assert (first["holds"], first["figure"]) == (False, None)


def test_json_tells_what_could_not_be_read(capsys, tmp_path):
    code, out, err = check(capsys, "--json", tmp_path / "none.yaml", PENDULUM)
    assert code == 2
    assert "none.yaml" in err
    first, second = json.loads(out)["models"]
    assert set(first) == {"model", "error"}
    assert "cannot be read" in first["error"]
    assert second["holds"] is True


def test_a_model_that_is_large_is_not_compared_with_sympy(capsys, write):
    # 22 sines in one another: nothing for CasADi, and exponential for SymPy.
    nested = "sin(" * 22 + "y/length" + ")" * 22
    code, out, _ = check(capsys, write(("m*g*y", f"m*g*length*{nested}")))
    assert code == 0
    assert "not compared: too large for SymPy" in out


def test_no_model_is_a_wrong_question(capsys):
    with pytest.raises(SystemExit) as caught:
        main(["check"])
    assert caught.value.code == 2
    assert "MODEL" in capsys.readouterr().err
