"""docs/robots.md: its model file is read, and its tables name every key that there is."""

import re
from pathlib import Path

import pytest

import firmtouch
from firmtouch.modelfile.files import beside
from firmtouch.modelfile.sections.chain import ChainMechanism
from firmtouch.modelfile.sections.operating_point import ReachSpec
from firmtouch.modelfile.sections.robot import UrdfMechanism
from firmtouch.modelfile.sections.surface import SurfaceSpec

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "robots.md").read_text(encoding="utf-8")


def named(heading):
    """Give what stands in the first column of the table with this heading."""
    lines = PAGE[PAGE.index(f"| {heading} |") :].split("\n\n")[0].splitlines()[2:]
    return {word for line in lines for word in re.findall(r"`(\w+)`", line.split("|")[1])}


def test_its_model_file_is_read_as_it_stands():
    text = re.search(r"```yaml\n(.*?)```", PAGE, re.DOTALL)[1]
    spec = firmtouch.parse_model(text.encode(), name="page", attached=beside(ROOT / "models" / "page.yaml")).spec
    assert (spec.n, spec.m) == (7, 1)


@pytest.mark.parametrize(
    ("heading", "sections"),
    [
        ("`mechanism`", (UrdfMechanism, ChainMechanism)),
        ("kind", (SurfaceSpec,)),
        ("`reach`", (ReachSpec,)),
    ],
)
def test_its_tables_name_every_key(heading, sections):
    keys = {key for section in sections for key in section.model_fields}
    assert named(heading) - {"mechanism", "kind", "reach"} == keys


def test_every_key_of_a_surface_stands_in_its_row():
    table = PAGE[PAGE.index("| kind |") :].split("\n\n")[0].splitlines()[2:]
    rows = {re.findall(r"`(\w+)`", line)[0]: line for line in table}
    for kind, field in SurfaceSpec.model_fields.items():
        (shape,) = [each for each in field.annotation.__args__ if each is not type(None)]
        assert [key for key in shape.model_fields if f"`{key}" not in rows[kind] and key != "side"] == []
