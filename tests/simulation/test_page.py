"""docs/simulation.md: its scenario file works, and its tables name every key that there is."""

import re
from pathlib import Path

import pytest

import firmtouch
from firmtouch.modelfile.sections import scenario as sections
from firmtouch.regulation import Controller

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "simulation.md").read_text()


@pytest.fixture(scope="module")
def runs():
    """Run the page's example as a reader would, for the model that the page names."""
    (example,) = re.findall(r"```yaml\n(.*?)```", PAGE, flags=re.DOTALL)
    model = firmtouch.read_model(ROOT / "models" / "planar_3r_circle.yaml")
    op = firmtouch.find_operating_point(firmtouch.derive_plant(model.spec))
    loop = firmtouch.assign_poles(op, model.spec.design)
    scenarios = firmtouch.scenarios_of(firmtouch.parse_scenarios(example.encode(), model, file="page.yaml"), loop)
    return {each.name: firmtouch.simulate(loop, each) for each in scenarios}


def test_the_example_of_the_page_runs_to_a_good_end(runs):
    assert list(runs) == ["thrown", "bumped", "workshop", "strong_drives"]
    assert all(each.outcome.good for each in runs.values())
    ends = [each.t[-1] for each in runs.values()]
    assert ends == pytest.approx([2, 4, 1, 16 / 9], rel=0.02)  # the last has the usual duration, given to two digits


def test_the_example_means_what_it_says(runs):
    thrown, bumped, workshop, strong = (each.scenario for each in runs.values())
    assert thrown.start.qdot == pytest.approx([0, 0.2, 0])
    assert bumped.feedback.path.ideal
    assert bumped.world.changes == (0.5, 0.6, 1.0)
    assert (workshop.feedback.path.sample, workshop.feedback.path.steps) == (1e-3, 2)
    assert workshop.world.E.tolist() == [[2e-3, 0, 0]]
    assert strong.feedback.controller is Controller.ENERGY_WITH_FORCE
    assert strong.feedback.limits is None
    assert thrown.feedback.limits == pytest.approx([60, 40, 15])


SECTIONS = {
    "scenario": sections.ScenarioSpec,
    "start": sections.StartSpec,
    "disturbances": sections.DisturbanceSpec,
    "surface": sections.SurfaceSpec,
    "noise": sections.NoiseSpec,
}


@pytest.mark.parametrize("name", SECTIONS)
def test_a_table_of_the_page_has_every_key_of_its_section(name):
    header = re.compile(rf"^\|[^|]*\b{name}\b`? \| holds \|$", flags=re.MULTILINE)
    (begin,) = (each.end() for each in header.finditer(PAGE))
    table = PAGE[begin : PAGE.index("\n\n", begin)]
    first = re.findall(r"^\|([^|]*)\|", table, flags=re.MULTILINE)
    told = {key for cell in first for key in re.findall(r"`(\w+)`", cell)}
    assert told == {field.alias or key for key, field in SECTIONS[name].model_fields.items()}
