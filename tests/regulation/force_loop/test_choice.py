"""`force_feedback: auto`, the limit of region designs, and the value that holds a design's force loop."""

import json
from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML

import firmtouch
from firmtouch.errors import InputError
from firmtouch.modelfile.sections.force_path import USUAL_MARGINS
from firmtouch.regulation import close_loop, steady_state_errors
from firmtouch.regulation.force_loop import (
    ForcePath,
    admissible_gain,
    analyse_force_loop,
    force_path_of,
    loop_margins,
    with_chosen_force_feedback,
)
from firmtouch.regulation.force_loop.warnings import force_warnings

MODELS = Path(__file__).parents[3] / "models"
MS = 1e-3


@pytest.fixture
def spec_with():
    """Read a shipped model with sections replaced, or left out where they are None."""

    def make(name="planar_2r_wall", **sections):
        data = YAML(typ="safe", pure=True).load((MODELS / f"{name}.yaml").read_text(encoding="utf-8"))
        for key, value in sections.items():
            data[key] = data[key] | value if key == "design" else value
        data = {key: value for key, value in data.items() if value is not None}
        return firmtouch.parse_model(json.dumps(data).encode(), name=name).spec

    return make


@pytest.fixture
def walked(spec_with, loop_of):
    """Walk to the force loop of a shipped model with sections replaced."""

    def walk(name="planar_2r_wall", **sections):
        spec = with_chosen_force_feedback(spec_with(name, **sections))
        op = firmtouch.find_operating_point(firmtouch.derive_plant(spec))
        return analyse_force_loop(firmtouch.assign_poles(op, spec.design), spec)

    return walk


def test_the_path_is_read_into_seconds(spec_with):
    spec = spec_with(force_path={"bandwidth": "500 rad/s", "delay": "2 ms", "sample": "1 ms"})
    assert force_path_of(spec) == ForcePath(delay=2 * MS, lag=2 * MS, sample=MS)
    assert force_path_of(spec).steps == 2
    assert force_path_of(spec_with()) is None


def test_auto_takes_the_usual_margins_where_none_are_asked(spec_with):
    spec = with_chosen_force_feedback(
        spec_with("planar_3r_wall", design={"force_feedback": "auto"}, force_path={"delay": "1 ms"})
    )
    assert spec.design.force_feedback == ((0.5, 0.0), (0.0, 0.5))  # 1/2 by either margin of a pure delay
    assert spec.force_path.margins == USUAL_MARGINS


def test_auto_takes_the_largest_gain_with_the_margins_asked(spec_with):
    path = {"bandwidth": "500 rad/s", "delay": "1 ms", "margins": {"gain": 1.5, "modulus": 0.3}}
    spec = with_chosen_force_feedback(spec_with(design={"force_feedback": "auto"}, force_path=path))
    ((g,),) = spec.design.force_feedback
    found = loop_margins(ForcePath(delay=MS, lag=2 * MS), g)
    missing = min(found.gain_margin - 1.5, found.modulus_margin - 0.3)
    assert missing == pytest.approx(0, abs=1e-9)  # what the searches leave
    assert spec.force_path.margins.delay is None


def test_auto_keeps_to_the_regions_own_limit(spec_with):
    region = {"decay": 4, "force_feedback_limit": 0.3}
    spec = spec_with(design={"force_feedback": "auto", "region": region}, force_path={"delay": "1 ms"})
    chosen = with_chosen_force_feedback(spec)
    assert chosen.design.force_feedback == ((0.3,),)
    assert chosen.design.region.force_feedback_limit == (0.3,)


def test_a_region_without_a_limit_gets_what_the_path_admits(spec_with):
    design = {"force_feedback": 0.2, "region": {"decay": 4}}
    chosen = with_chosen_force_feedback(spec_with(design=design, force_path={"delay": "1 ms"}))
    assert chosen.design.region.force_feedback_limit == (0.5,)
    assert chosen.design.force_feedback == ((0.2,),)
    assert chosen.force_path.margins is None  # nothing was asked, and nothing was chosen
    unbounded = with_chosen_force_feedback(spec_with(design=design, force_path={"bandwidth": "80 Hz"}))
    assert unbounded.design.region.force_feedback_limit is None


def test_a_file_without_a_force_path_is_left_as_it_is(spec_with):
    spec = spec_with()
    assert with_chosen_force_feedback(spec) is spec


def test_a_design_from_a_file_whose_gain_is_not_chosen_is_refused(spec_with, loop_of):
    spec = spec_with(design={"force_feedback": "auto"}, force_path={"delay": "1 ms"})
    op = firmtouch.find_operating_point(firmtouch.derive_plant(spec))
    with pytest.raises(InputError, match="with_chosen_force_feedback"):
        firmtouch.assign_poles(op, spec.design)


def test_one_loop_for_each_eigenvalue_of_g_f(walked):
    G_f = [[0.6, 0.2], [0.2, 0.3]]
    found = walked("planar_3r_wall", design={"force_feedback": G_f}, force_path={"delay": "1 ms"})
    assert [each.gain for each in found.loops] == pytest.approx(np.linalg.eigvalsh(G_f).tolist(), rel=1e-12)
    assert found.stable
    assert found.asked is None
    assert found.admissible == admissible_gain(ForcePath(delay=MS), USUAL_MARGINS) == 0.5
    assert list(force_warnings(found)) == []  # no margins are asked


def test_the_chosen_gain_stands_on_its_margins_and_keeps_them(walked):
    path = {"bandwidth": "80 Hz", "sample": "1 ms", "margins": {"delay": "2 ms", "modulus": 0.6}}
    found = walked(design={"force_feedback": "auto"}, force_path=path)
    assert [each.name for each in found.verdicts] == ["delay", "modulus"]
    assert all(each.kept for each in found.verdicts)
    assert min(each.least / each.asked for each in found.verdicts) == pytest.approx(1, abs=1e-9)
    assert list(force_warnings(found)) == []


class TestWarnings:
    def test_a_gain_beyond_the_bound_is_told_with_the_bound(self, walked):
        found = walked(design={"force_feedback": 4}, force_path={"bandwidth": "500 rad/s", "delay": "1 ms"})
        (words,) = force_warnings(found)
        assert "unstable: G_f has an eigenvalue of 4" in words
        assert "below 3.807 [T8]" in words

    def test_a_margin_that_is_not_kept_is_told_with_the_gain_that_keeps_it(self, walked):
        found = walked(design={"force_feedback": 0.8}, force_path={"delay": "1 ms", "margins": {"gain": 2}})
        (words,) = force_warnings(found)
        assert words.startswith("The gain margin of the force loop is 1.25, where 2 is asked")
        assert "up to g = 0.5" in words

    def test_a_contact_that_is_unstable_is_told_with_the_gain_from_which_on(self, walked):
        path = {"bandwidth": "80 Hz", "contact_stiffness": "1e6 N/m"}
        found = walked(design={"force_feedback": 0.8}, force_path=path)
        (words,) = force_warnings(found)
        assert "at the file's `contact_stiffness` the loop is unstable" in words.lower()
        assert f"from g = {found.contact.critical_gain:.3g} on" in words
        soft = walked(design={"force_feedback": 0.8}, force_path=path | {"contact_stiffness": "1e3 N/m"})
        assert list(force_warnings(soft)) == []
        assert soft.contact.poles.stable

    def test_without_a_force_path_a_gain_of_one_deserves_a_word(self, walked):
        (words,) = force_warnings(walked(design={"force_feedback": 1.5}))
        assert "one sample late is stable only below 1" in words
        assert list(force_warnings(walked(design={"force_feedback": 0.99}))) == []


@pytest.mark.parametrize("g", [0.0, 1.0, 30.0, 1000.0])
def test_t7_every_gain_is_stable_with_an_ideal_path_and_divides_the_force_error(g, arm_in_corner, loop_of):
    """The poles of the whole pencil do not move, and dlambda goes with 1 / (1 + g), from 0 to 1000 I."""
    plain = loop_of(arm_in_corner)
    gains = {
        each: plain.gains.__class__(plain.gains.W, plain.gains.C, each * np.eye(2), plain.gains.bias)
        for each in (0.0, g)
    }
    without, loop = (close_loop(plain.operating_point, gains[each]) for each in (0.0, g))
    assert max(s.real for s in loop.poles.pencil) < 0
    np.testing.assert_allclose(loop.poles.pencil, without.poles.pencil, rtol=1e-6)  # the pencil's own accuracy
    bounds = arm_in_corner.spec.bounds
    for name in ("force", "offset", "tilt"):
        expected = getattr(steady_state_errors(without, bounds), name).constraint_force / (1 + g)
        found = getattr(steady_state_errors(loop, bounds), name).constraint_force
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)  # rounding, over the condition of K
    assert analyse_force_loop(loop, arm_in_corner.spec).stable
