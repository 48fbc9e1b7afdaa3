"""`firmtouch verify`: no certificate that was changed, cut or made up is called good; and it needs no solver."""

import copy
import json
import math
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmtouch.certificate.file import LONGEST, _digest
from firmtouch.cli import main

ROOT = Path(__file__).parents[2]
PENDULUM = ROOT / "models" / "pendulum_rod.yaml"
PLANE = ROOT / "models" / "spatial_6r_plane.yaml"


@pytest.fixture(scope="module")
def finished(tmp_path_factory) -> Path:
    """The folder of one whole run."""
    folder = tmp_path_factory.mktemp("finished")
    assert main(["design", str(PENDULUM), "--no-pdf", "--no-simulation", "--out", str(folder)]) == 0
    return folder


@pytest.fixture(scope="module")
def whole(finished) -> dict:
    return json.loads((finished / "certificate.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def original(whole) -> dict:
    """Without the region of attraction, which takes longer to prove than all the rest."""
    return resealed(whole | {"surroundings": None})


@pytest.fixture(scope="module")
def content(original) -> bytes:
    return json.dumps(original, indent=1).encode()


@pytest.fixture
def beside(finished, tmp_path) -> Path:
    """A folder with the design.json alone."""
    shutil.copy(finished / "design.json", tmp_path / "design.json")
    return tmp_path


def verified(folder: Path, content, *, model=PENDULUM, capsys=None) -> tuple[int, str]:
    """Put a certificate into a folder and verify it: the exit code, and all that is said."""
    path = folder / "certificate.json"
    path.write_bytes(content if isinstance(content, bytes) else json.dumps(content).encode())
    code = main(["verify", str(path), "--model", str(model)])
    if capsys is None:
        return code, ""
    printed = capsys.readouterr()
    assert "Traceback" not in printed.err
    return code, printed.out + printed.err


def resealed(data: dict) -> dict:
    return data | {"digest": _digest(data)}


def set_in(data: dict, path, value) -> dict:
    """Replace one value somewhere inside."""
    data = copy.deepcopy(data)
    *way, last = path
    at = data
    for key in way:
        at = at[key]
    at[last] = value
    return data


def claim_index(data: dict, name: str) -> int:
    return next(i for i, each in enumerate(data["claims"]) if each["name"] == name)


def ulp(text: str, towards: float = math.inf) -> str:
    return math.nextafter(float.fromhex(text), towards).hex()


def test_what_was_written_is_certified(finished, whole, tmp_path, capsys):
    assert main(["verify", str(finished / "certificate.json"), "--model", str(PENDULUM)]) == 0
    printed = capsys.readouterr()
    count = len(whole["claims"]) + 1  # and the region of attraction
    words = f"{count} claims about gains for assigned poles are proven once more"
    assert printed.out == f"Certified: {words}, model pendulum_rod.\n"
    assert printed.err == ""
    code, said = verified(tmp_path, whole, capsys=capsys)
    assert code == 0
    assert "there is no design.json beside it to compare" in said


def test_json_tells_the_same(finished, whole, original, tmp_path, capsys):
    assert main(["verify", str(finished / "certificate.json"), "--model", str(PENDULUM), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    proven = [*(each["name"] for each in whole["claims"]), "region of attraction"]
    assert told == {"certified": True, "proven": proven, "differences": []}
    (tmp_path / "certificate.json").write_text(json.dumps(set_in(original, ["digest"], "0")), encoding="utf-8")
    assert main(["verify", str(tmp_path / "certificate.json"), "--model", str(PENDULUM), "--json"]) == 1
    told = json.loads(capsys.readouterr().out)
    assert told["certified"] is False
    assert len(told["differences"]) == 1


GAINS = [("W", 0, 0), ("W", 1, 1), ("C", 0, 0), ("C", 1, 1), ("G_f", 0, 0)]


@pytest.mark.parametrize("place", GAINS, ids=str)
@pytest.mark.parametrize("towards", [math.inf, -math.inf])
def test_a_gain_that_is_off_by_one_ulp_is_told(original, beside, capsys, place, towards):
    path = ["gains", *place]
    text = original["gains"][place[0]][place[1]][place[2]]
    changed = set_in(original, path, ulp(text, towards))
    code, said = verified(beside, changed, capsys=capsys)
    assert code == 1
    assert "the digest does not fit" in said
    code, said = verified(beside, resealed(changed), capsys=capsys)  # all claims may still be true
    assert code == 1
    assert "the gains in the design.json beside it are not those that are certified" in said


def test_a_constant_force_that_is_off_by_one_ulp_is_told(original, beside, capsys):
    changed = set_in(original, ["gains", "bias", 0], ulp(original["gains"]["bias"][0]))
    assert verified(beside, changed, capsys=capsys)[0] == 1
    assert verified(beside, resealed(changed), capsys=capsys)[0] == 1


@pytest.mark.parametrize("factor", [-1.0, 0.0, 0.5, 1e6])
@pytest.mark.parametrize("name", ["W", "C"])
def test_other_gains_are_refused_by_their_figures_even_without_a_design_beside(
    original, tmp_path, capsys, name, factor
):
    rows = [[(float.fromhex(x) * factor).hex() for x in row] for row in original["gains"][name]]
    code, said = verified(tmp_path, resealed(set_in(original, ["gains", name], rows)), capsys=capsys)
    assert code == 1
    assert "not proven" in said


def test_an_unsymmetric_gain_is_refused(original, tmp_path, capsys):
    for name in ("W", "C"):
        off = original["gains"][name][0][1]
        code, said = verified(tmp_path, resealed(set_in(original, ["gains", name, 0, 1], ulp(off))), capsys=capsys)
        assert code == 1
        assert "symmetry: the figure 0 is refuted" in said


@pytest.mark.parametrize(
    "size", ["0x1p+300", "0x1.fffffffffffffp+1023", "-0x1.fffffffffffffp+1023", "0x0.0000000000001p-1022"]
)
@pytest.mark.parametrize(
    "place",
    [("gains", "W"), ("gains", "C"), ("gains", "G_f"), ("operating_point", "q_d"), ("operating_point", "lambda_d")],
)
def test_numbers_of_any_size_are_refused_without_a_crash(original, tmp_path, capsys, place, size):
    size = float.fromhex(size).hex()

    def everywhere(values):
        return [everywhere(each) for each in values] if isinstance(values, list) else size

    values = original[place[0]][place[1]]
    code, said = verified(tmp_path, resealed(set_in(original, place, everywhere(values))), capsys=capsys)
    if place[-1] == "G_f" and float.fromhex(size) > 1:
        assert code == 0  # more force feedback makes each error smaller, and all bounds stay true
        return
    assert code == 1
    assert said.startswith("Not certified")


def test_another_design_beside_is_told(original, beside, capsys):
    design = (beside / "design.json").read_bytes()
    (beside / "design.json").write_bytes(design + b" ")
    code, said = verified(beside, original, capsys=capsys)
    assert (code, "is not the one it was made with" in said) == (1, True)
    for content in (b"", b"{", b"[]", b"null", b"\xff", b"[" * 100_000, b'{"gains": 3}'):
        (beside / "design.json").write_bytes(content)
        assert verified(beside, original, capsys=capsys)[0] == 1


# The model file


def test_another_byte_in_the_model_file_is_told(finished, tmp_path, capsys):
    text = PENDULUM.read_bytes()
    path = tmp_path / "pendulum_rod.yaml"
    for content in (
        text + b"\n",
        text.replace(b"a rod", b"a Rod", 1),
        text.replace(b"-4+2j, -4-2j", b"-4+3j, -4-3j"),
    ):
        assert content != text
        path.write_bytes(content)
        assert main(["verify", str(finished / "certificate.json"), "--model", str(path)]) == 1
        assert "it was made for another model file" in capsys.readouterr().out


def test_another_model_is_told_even_when_its_digest_is_put_in(original, tmp_path, capsys):
    import firmtouch

    heavy = (
        PENDULUM.read_text(encoding="utf-8")
        .replace("g: {value: 9.81", "g: {value: 12.81")
        .replace("g: 9.81", "g: 12.81")
    )
    path = tmp_path / "pendulum_rod.yaml"
    path.write_text(heavy, encoding="utf-8")
    changed = firmtouch.read_model(path).sha256
    assert changed != original["model"]["sha256"]
    code, said = verified(tmp_path, resealed(set_in(original, ["model", "sha256"], changed)), model=path, capsys=capsys)
    assert code == 1
    assert "not proven" in said or "is not what the model file asks for" in said or "was changed" in said


def test_a_model_of_another_size_is_told(original, tmp_path, capsys):
    code, said = verified(tmp_path, resealed(original), model=PLANE, capsys=capsys)
    assert code == 1
    assert "W does not fit a model with 6 coordinates and 1 constraints" in said


def test_a_model_that_cannot_be_read_is_a_wrong_question(finished, tmp_path, capsys):
    certificate = str(finished / "certificate.json")
    assert main(["verify", certificate, "--model", str(tmp_path / "missing.yaml")]) == 2
    (tmp_path / "model.yaml").write_text("{", encoding="utf-8")
    assert main(["verify", certificate, "--model", str(tmp_path / "model.yaml")]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    with pytest.raises(SystemExit) as stopped:
        main(["verify", certificate])
    assert stopped.value.code == 2


# The claims


def better(claim: dict, by: float) -> str:
    """Give a figure that claims more than is true."""
    figure = float.fromhex(claim["figure"])
    sign = 1 if claim["relation"] == ">" else -1
    return (figure + sign * by * (abs(figure) or 1)).hex()


def test_a_figure_that_is_better_than_true_is_refused(original, tmp_path, capsys):
    for i, claim in enumerate(original["claims"]):
        bound_of_rounding = claim["name"] in ("surface", "feedforward") or claim["route"] == "comparison"
        figure = (-1e-3).hex() if bound_of_rounding else better(claim, 1e-6)
        code, said = verified(tmp_path, resealed(set_in(original, ["claims", i, "figure"], figure)), capsys=capsys)
        assert code == 1, claim["name"]
        assert claim["name"] in said


CHANGES = {
    "asked": lambda claim: (float.fromhex(claim["asked"]) - 0.5).hex() if claim["asked"] else (1.0).hex(),
    "statement": lambda claim: claim["statement"] + " indeed",
    "scope": lambda claim: "all plants of the polytope" if claim["scope"] == "nominal plant" else "nominal plant",
    "relation": lambda claim: "<" if claim["relation"] == ">" else ">",
    "unit": lambda claim: claim["unit"] + "k",
    "route": lambda claim: "by word of mouth",
    "verdict": lambda claim: "undecided",
    "name": lambda claim: claim["name"] + " ",
    "figure": lambda claim: None,
}


@pytest.mark.parametrize("what", CHANGES)
def test_a_claim_that_was_changed_is_told(original, tmp_path, capsys, what):
    first = list(CHANGES).index(what) % 3  # every claim is changed in three ways
    for i, claim in list(enumerate(original["claims"]))[first::3]:
        changed = resealed(set_in(original, ["claims", i, what], CHANGES[what](claim)))
        code, said = verified(tmp_path, changed, capsys=capsys)
        assert code == 1
        assert claim["name"] in said


def test_claims_that_are_missing_extra_or_there_twice_are_told(original, tmp_path, capsys):
    claims = original["claims"]
    for i in range(len(claims)):
        code, said = verified(tmp_path, resealed(original | {"claims": claims[:i] + claims[i + 1 :]}), capsys=capsys)
        assert (code, f"{claims[i]['name']}: the claim is missing" in said) == (1, True)
    extra = claims[0] | {"name": "friction"}
    code, said = verified(tmp_path, resealed(original | {"claims": [*claims, extra]}), capsys=capsys)
    assert (code, "friction: the model file asks for no such claim" in said) == (1, True)
    for doubled in ([*claims, claims[3]], [claims[3], *claims], [*claims, claims[3] | {"figure": (1e9).hex()}]):
        code, said = verified(tmp_path, resealed(original | {"claims": doubled}), capsys=capsys)
        assert (code, "a claim stands twice" in said) == (1, True)
    assert verified(tmp_path, resealed(original | {"claims": []}), capsys=capsys)[0] == 1


def test_a_certificate_that_says_no_is_no(original, tmp_path, capsys):
    code, said = verified(tmp_path, resealed(original | {"certified": False}), capsys=capsys)
    assert (code, "says that not every claim was proven" in said) == (1, True)


def test_another_point_is_told(original, tmp_path, capsys):
    for name in ("q_d", "lambda_d"):
        values = [(float.fromhex(x) * 1.001 + 1e-3).hex() for x in original["operating_point"][name]]
        changed = resealed(set_in(original, ["operating_point", name], values))
        code, said = verified(tmp_path, changed, capsys=capsys)
        assert (code, f"{name} is not what the model file asks for" in said) == (1, True)
    near = ulp(original["operating_point"]["lambda_d"][0])
    code, said = verified(tmp_path, resealed(set_in(original, ["operating_point", "lambda_d", 0], near)), capsys=capsys)
    assert (code, "lambda_d is not the one in the model file" in said) == (1, True)


def test_another_method_and_made_up_witnesses_are_told(original, tmp_path, capsys):
    code, _ = verified(tmp_path, resealed(set_in(original, ["model", "method"], "region")), capsys=capsys)
    assert code in (1, 2)
    multiplier = {"F": [["0x1p+0"]], "P": [[["0x1p+0"]]], "basis": [["0x1p+0"]], "unit": "0x0p+0"}
    one = (1.0).hex()
    for unit in ((0.0).hex(), (-1.0).hex(), one):
        F, P, basis = [[one] * 3], [[[one, (0.0).hex()], [(0.0).hex(), one]]], [[one], [one]]
        multiplier = {"F": F, "P": P, "basis": basis, "unit": unit}
        changed = set_in(original, ["witness", "multipliers"], {"decay rate": multiplier})
        assert verified(tmp_path, resealed(changed), capsys=capsys)[0] == 1
    for bad in ({"F": []}, {"P": []}, {"P": [[]]}, {"basis": [[one, one]]}, {"F": [[one]]}):
        changed = set_in(original, ["witness", "multipliers"], {"decay rate": multiplier | bad})
        assert verified(tmp_path, resealed(changed), capsys=capsys)[0] == 1
    ragged = set_in(original, ["witness", "multipliers"], {"decay rate": multiplier | {"F": [[one], [one, one]]}})
    assert verified(tmp_path, resealed(ragged), capsys=capsys)[0] == 2
    epsilon = set_in(original, ["witness", "epsilon"], (1e-3).hex())  # proves nothing, and is not used for one plant
    assert verified(tmp_path, resealed(epsilon), capsys=capsys)[0] == 0


def test_matrices_of_other_shapes_are_told(original, tmp_path, capsys):
    one = (1.0).hex()
    for name, rows in (
        ("W", [[one]]),
        ("W", []),
        ("C", [[one, one, one]] * 3),
        ("G_f", [[one, one]] * 2),
        ("bias", [one]),
        ("bias", []),
    ):
        code, said = verified(tmp_path, resealed(set_in(original, ["gains", name], rows)), capsys=capsys)
        assert (code, f"{name} does not fit" in said) == (1, True)
    ragged = set_in(original, ["gains", "W"], [[one], [one, one]])
    assert verified(tmp_path, resealed(ragged), capsys=capsys)[0] == 2
    for name in ("q_d", "lambda_d"):
        code, said = verified(tmp_path, resealed(set_in(original, ["operating_point", name], [])), capsys=capsys)
        assert (code, f"{name} does not fit" in said) == (1, True)


# The region of attraction

FIGURES = ("level", "distance", "speed", "speed_of_joints", "distance_together", "speed_together")


@pytest.mark.parametrize("place", [*(("attraction", name) for name in FIGURES), ("box", "level")], ids=" ".join)
def test_a_region_of_attraction_that_is_larger_than_proven_is_refused(whole, tmp_path, capsys, place):
    path = ["surroundings", *place]
    figure = float.fromhex(whole["surroundings"][place[0]][place[1]])
    code, said = verified(tmp_path, resealed(set_in(whole, path, (figure * 1.01).hex())), capsys=capsys)
    assert (code, "not proven" in said or "proven:" in said) == (1, True)
    assert verified(tmp_path, set_in(whole, path, (figure * 0.99).hex()))[0] == 1  # true, and the digest tells


def test_a_region_of_attraction_of_another_mechanism_or_none_is_refused(whole, tmp_path):
    one, zero = (1.0).hex(), (0.0).hex()
    for place, value, code in (
        (["attraction", "V1"], [[one]], 1),
        (["attraction", "V2"], [[zero], [zero]], 1),
        (["attraction", "V1"], [[one], [one, one]], 2),
        (["attraction", "half_widths"], [], 1),
        (["attraction", "units"], [one], 1),
        (["attraction", "units"], [zero, zero], 2),
        (["attraction", "most_cells"], 10**9, 2),
        (["attraction", "level"], (-1.0).hex(), 2),
        (["attraction", "speed"], "inf", 2),
        (["box", "units"], [one], 1),
        (["box", "half_width"], (3.5).hex(), 1),
    ):
        assert verified(tmp_path, resealed(set_in(whole, ["surroundings", *place], value)))[0] == code


# What is no certificate


NUMBERS = {
    "too large": "0x1p+5000",
    "not a number": "nan",
    "infinite": "inf",
    "minus infinite": "-infinity",
    "a plain number": 1.5,
    "a whole number": 3,
    "a decimal": "1.5",
    "empty": "",
    "nothing": None,
    "a truth": True,
    "a word": "one",
    "a list": ["0x1p+0"],
    "capitals": "0X1.8P+1",
    "another spelling": "0x3p+0",
    "with a space": " 0x1.8000000000000p+1",
    "too many digits": "0x1.80000000000000p+1",
}


@pytest.mark.parametrize("number", NUMBERS.values(), ids=list(NUMBERS))
@pytest.mark.parametrize(
    "place",
    [
        ("gains", "W", 0, 0),
        ("gains", "bias", 0),
        ("operating_point", "q_d", 0),
        ("claims", 0, "figure"),
        ("witness", "epsilon"),
    ],
    ids=str,
)
def test_what_is_no_hexadecimal_number_is_no_certificate(original, tmp_path, capsys, place, number):
    code, said = verified(tmp_path, resealed(set_in(original, place, number)), capsys=capsys)
    if number is None and place[-1] in ("figure", "epsilon"):
        assert code == (1 if place[-1] == "figure" else 0)  # there it may be missing: pole designs have no eps
        return
    assert code == 2
    assert "no certificate" in said


BROKEN = {
    "empty": b"",
    "a space": b" ",
    "not UTF-8": b"\xff\xfe{}",
    "half a UTF-16": b"\x00{\x00}",
    "other text": b"Certified: yes",
    "a list": b"[]",
    "null": b"null",
    "a number": b"1",
    "a string": b'"firmtouch.certificate/1"',
    "the schema alone": b'{"schema": "firmtouch.certificate/1"}',
    "deeply nested": b"[" * 200_000,
    "deeply nested objects": b'{"schema":' * 100_000,
    "20 MB": b'"' + b"x" * 20_000_000 + b'"',
    "a long number": b'{"schema": ' + b"9" * 10_000 + b"}",
}


@pytest.mark.parametrize("content", BROKEN.values(), ids=list(BROKEN))
def test_what_is_no_certificate_is_a_wrong_question(tmp_path, capsys, content):
    code, said = verified(tmp_path, content, capsys=capsys)
    assert code == 2
    assert f"{tmp_path / 'certificate.json'}" in said
    assert "no certificate" in said


def test_a_constant_of_javascript_is_no_number(original, tmp_path, capsys):
    text = json.dumps(original)
    for constant in ("NaN", "Infinity", "-Infinity"):
        code, said = verified(tmp_path, text.replace('"bits": 64', f'"bits": {constant}', 1).encode(), capsys=capsys)
        assert (code, f"{constant} is no number here" in said) == (2, True)


@pytest.mark.parametrize(
    "schema", ["firmtouch.certificate/2", "firmtouch.certificate/1 ", "firmtouch.design/1", "", None, 1, []]
)
def test_a_foreign_schema_is_told(original, tmp_path, capsys, schema):
    code, said = verified(tmp_path, resealed(set_in(original, ["schema"], schema)), capsys=capsys)
    assert (code, "`firmtouch.certificate/1` was expected" in said) == (2, True)


def test_missing_and_unknown_keys_are_no_certificate(original, tmp_path, capsys):
    for key in original:
        rest = {name: value for name, value in original.items() if name != key}
        assert verified(tmp_path, rest if key == "digest" else resealed(rest), capsys=capsys)[0] == 2
    for place in (["more"], ["gains", "more"], ["model", "more"], ["claims", 0, "more"], ["witness", "more"]):
        assert verified(tmp_path, resealed(set_in(original, place, "x")), capsys=capsys)[0] == 2


def test_a_key_that_stands_twice_is_no_certificate(original, tmp_path, capsys):
    text = json.dumps(original).replace('{"W":', '{"W": [], "W":', 1)
    code, said = verified(tmp_path, text.encode(), capsys=capsys)
    assert (code, "a key that stands twice" in said) == (2, True)


def test_a_folder_and_a_missing_file_are_told(tmp_path, capsys):
    assert main(["verify", str(tmp_path), "--model", str(PENDULUM)]) == 2
    assert "cannot be read (Is a directory)" in capsys.readouterr().err
    assert main(["verify", str(tmp_path / "missing.json"), "--model", str(PENDULUM)]) == 2
    assert "cannot be read (No such file or directory)" in capsys.readouterr().err


def test_the_longest_file_is_longer_than_any_design_needs(finished):
    assert (finished / "certificate.json").stat().st_size * 100 < LONGEST < 20_000_000


@pytest.fixture(scope="module")
def scratch(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("scratch")


@settings(max_examples=80)
@given(part=st.floats(0, 1, exclude_max=True))
def test_a_file_that_is_cut_off_is_no_certificate(content, scratch, part):
    assert verified(scratch, content[: int(part * len(content))])[0] == 2


@settings(max_examples=80)
@given(data=st.data())
def test_no_flipped_byte_is_certified(content, scratch, data):
    """Any byte to any other one; what JSON reads as the same (a space that became a line's end) is the same."""
    content = bytearray(content)
    place = data.draw(st.integers(0, len(content) - 1))
    before, content[place] = content[place], data.draw(st.integers(0, 255))
    code = verified(scratch, bytes(content))[0]
    if content[place] == before or {before, content[place]} <= set(b" \n\r\t"):
        assert code == 0
    else:
        assert code in (1, 2)


@settings(max_examples=100)
@given(data=st.data())
def test_no_flipped_bit_is_certified(content, scratch, data):
    content = bytearray(content)
    place, bit = data.draw(st.integers(0, len(content) - 1)), data.draw(st.integers(0, 7))
    content[place] ^= 1 << bit
    assert verified(scratch, bytes(content))[0] in (1, 2)


@settings(max_examples=25)
@given(data=st.data())
def test_no_changed_number_is_certified_beside_its_design_whatever_the_digest(
    finished, original, tmp_path_factory, data
):
    """Gains and figures moved by one part in 2^k, with the digest put right."""
    folder = tmp_path_factory.getbasetemp() / "numbers"
    folder.mkdir(exist_ok=True)
    shutil.copy(finished / "design.json", folder / "design.json")
    name = data.draw(st.sampled_from(["W", "C", "G_f"]))
    rows = np.array([[float.fromhex(x) for x in row] for row in original["gains"][name]])
    i, j = (data.draw(st.integers(0, len(rows) - 1)) for _ in range(2))
    moved = rows[i, j] + (abs(rows[i, j]) or 1.0) * 2.0 ** -data.draw(st.integers(1, 52))
    changed = set_in(set_in(original, ["gains", name, i, j], moved.hex()), ["gains", name, j, i], moved.hex())
    assert verified(folder, resealed(changed))[0] == 1


# Without a solver


def test_it_needs_no_solver_and_no_scipy(finished):
    """pint takes scipy if it is there, hence all are made impossible to import beforehand."""
    code = (
        "import sys\n"
        "for name in ('scipy', 'cvxpy', 'clarabel', 'control', 'matplotlib', 'typst'): sys.modules[name] = None\n"
        "from firmtouch.cli import main\n"
        "sys.exit(main(sys.argv[1:]))\n"
    )
    arguments = ["verify", str(finished / "certificate.json"), "--model", str(PENDULUM)]
    run = subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")
    assert run.stdout.startswith("Certified: ")


def test_a_region_design_of_many_plants_is_verified_without_a_solver(tmp_path):
    assert (
        main(
            [
                "design",
                "--no-attraction",
                str(ROOT / "models" / "planar_3r_circle.yaml"),
                "--method",
                "region",
                "--no-pdf",
                "--out",
                str(tmp_path),
            ]
        )
        == 0
    )
    data = json.loads((tmp_path / "certificate.json").read_text(encoding="utf-8"))
    data = resealed(data | {"surroundings": None})  # which takes long, and has tests of its own
    (tmp_path / "certificate.json").write_text(json.dumps(data), encoding="utf-8")
    assert data["model"]["method"] == "region"
    assert any(each["route"].startswith("[T4], eps = ") for each in data["claims"])
    code = (
        "import sys\n"
        "for name in ('scipy', 'cvxpy', 'clarabel'): sys.modules[name] = None\n"
        "from firmtouch.cli import main\n"
        "sys.exit(main(sys.argv[1:]))\n"
    )
    arguments = [
        "verify",
        str(tmp_path / "certificate.json"),
        "--model",
        str(ROOT / "models" / "planar_3r_circle.yaml"),
    ]
    run = subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")
    # Polytope claims do not survive a stiffer question: the figures were proven, and better ones are not.
    for i, claim in enumerate(data["claims"]):
        if claim["name"].startswith(("decay", "damping", "greatest")):
            changed = resealed(set_in(data, ["claims", i, "figure"], better(claim, 0.5)))
            assert verified(tmp_path, changed, model=ROOT / "models" / "planar_3r_circle.yaml")[0] == 1
