"""The report's words about the region of attraction, and that it stands in the certificate and is proven again."""

import json
from dataclasses import replace

import pytest

import firmtouch
from firmtouch.certificate.attraction.finding import Finding, look_around
from firmtouch.certificate.file import ModelPart, _digest, certificate_as_json, read_certificate
from firmtouch.certificate.verify import verify
from firmtouch.design import Surroundings, design_model, look_around_design
from firmtouch.report import design_document
from firmtouch.report.document import Figure, Paragraph, Table

NAME = "planar_2r_circle"


@pytest.fixture(scope="module")
def model():
    from pathlib import Path

    return firmtouch.read_model(Path(__file__).parents[2] / "models" / f"{NAME}.yaml")


@pytest.fixture(scope="module")
def design(model):
    return look_around_design(design_model(model))


@pytest.fixture(scope="module")
def written(design, model):
    part = ModelPart(name=NAME, sha256=model.sha256, method="poles")
    finding = design.surroundings.finding
    return certificate_as_json(design.certificate, model=part, design_sha256="", version="test", finding=finding)


def section(design):
    found = [each for each in design_document(design).sections if each.title == "Region of attraction"]
    return found[0] if found else None


def checked(data, model):
    data = data | {"digest": _digest(data)}
    return verify(read_certificate(json.dumps(data).encode(), "certificate.json"), model)


def test_without_a_look_around_there_is_no_section(design):
    assert section(replace(design, surroundings=None)) is None


def test_the_section_tells_level_distances_speeds_and_shows_a_picture(design):
    found, blocks = design.surroundings.finding, section(design).blocks
    (table,) = [each for each in blocks if isinstance(each, Table)]
    assert len(table.rows) == 4
    assert [each for each in blocks if isinstance(each, Figure)]
    told = float("".join(table.rows[0][2][0]).split()[0])
    assert 0.99 * found.attraction.distance < told <= found.attraction.distance
    told = float("".join(table.rows[1][3][0]).split()[0])
    assert 0.99 * found.attraction.speeds.all_joints < told <= found.attraction.speeds.all_joints


def test_what_was_not_proven_is_said_with_the_reason(design):
    nothing = replace(design, surroundings=Surroundings(Finding(None, None, ("not even q*",)), None))
    words = [str(each) for each in section(nothing).blocks if isinstance(each, Paragraph)]
    assert any("No region of attraction was proven: not even q*." in each for each in words)
    assert not [each for each in section(nothing).blocks if isinstance(each, Table | Figure)]


def test_too_many_coordinates_are_not_tried(loop_of, make_arm):
    links = 7
    guess = [1.2, *[-0.3] * (links - 1)]
    arm = make_arm(links, {"wall": "x(p7) - 1.5"}, guess, lambda_d={"wall": -20}, design={"level": "tangent"})
    found = look_around(loop_of(arm))
    assert found.attraction is None
    assert found.box is None
    assert "up to 6 coordinates" in found.reasons[0]


def test_the_certificate_is_proven_again(written, model):
    found = checked(written, model)
    assert found.holds, found.differences
    assert "region of attraction" in found.proven


@pytest.mark.parametrize(
    "figure", ["level", "distance", "speed", "speed_of_joints", "distance_together", "speed_together"]
)
def test_a_figure_that_is_a_little_better_is_not_proven(written, model, figure):
    changed = json.loads(json.dumps(written))
    part = changed["surroundings"]["attraction"]
    part[figure] = (1.03 * float.fromhex(part[figure])).hex()
    found = checked(changed, model)
    assert any("the region of attraction" in each for each in found.differences)
    assert "region of attraction" not in found.proven


@pytest.mark.parametrize("figure", ["half_width", "level"])
def test_a_larger_box_or_level_is_not_proven(written, model, figure):
    """Its edge lies within five per cent of the next equilibrium, or of the lowest energy on it."""
    changed = json.loads(json.dumps(written))
    part = changed["surroundings"]["box"]
    part[figure] = (1.2 * float.fromhex(part[figure])).hex()
    assert any("the box of joint coordinates" in each for each in checked(changed, model).differences)


@pytest.mark.parametrize("name", ["V1", "V2", "half_widths", "units"])
def test_parts_of_another_size_do_not_fit(written, model, name):
    changed = json.loads(json.dumps(written))
    part = changed["surroundings"]["attraction"]
    part[name] = part[name][:-1]
    assert any("does not fit this model" in each for each in checked(changed, model).differences)


def test_more_cells_than_ours_are_no_certificate(written):
    changed = json.loads(json.dumps(written))
    changed["surroundings"]["attraction"]["most_cells"] = 10**9
    with pytest.raises(firmtouch.InputError, match="most_cells"):
        read_certificate(json.dumps(changed).encode(), "certificate.json")
