"""What the report says of simulations: the numbers of the trajectories, pictures whose words can be read, and HTML."""

import json
import re
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML
from tests.report.test_browser import DESK, LOOK, PHONE, Visit, opened

import firmtouch
from firmtouch.design import try_out_design
from firmtouch.report import design_as_json, render_html
from firmtouch.report.contents import errors, simulation
from firmtouch.report.contents.simulation import simulation_document
from firmtouch.report.document import Callout, Figure, Math, Table
from firmtouch.report.figures.trajectory import run_picture
from firmtouch.report.simulation_json import steady_state_as_json, trajectory_as_csv
from firmtouch.simulation.trajectory import Outcome

ROOT = Path(__file__).parents[2]
MODELS = ("planar_3r_wall", pytest.param("pendulum_rod", marks=pytest.mark.slow), "planar_2r_circle")
SUPERSCRIPTS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


@pytest.fixture(scope="module", params=MODELS)
def tried(request):
    return tried_out(request.param)


def tried_out(name, cache={}):  # noqa: B006  # one design for all tests
    if name not in cache:
        cache[name] = try_out_design(firmtouch.design_model(firmtouch.read_model(ROOT / "models" / f"{name}.yaml")))
    return cache[name]


def text(line):
    return "".join(f"[{each.typst}]" if isinstance(each, Math) else getattr(each, "text", each) for each in line)


def numbers(words):
    """The numbers in words as the report writes them: −1.2×10⁻³."""
    words = words.replace("−", "-")
    found = re.findall(r"-?\d+(?:\.\d+)?(?:×10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?", words)
    return [float(each.replace("×10", "e").translate(SUPERSCRIPTS)) for each in found]


@pytest.fixture(scope="module")
def whole():
    """A design and its section on simulations, with the pictures."""
    design = tried_out("planar_3r_wall")
    return design, simulation.section(design)


class TestTheSection:
    def test_without_a_trial_there_is_none(self, tried):
        assert simulation.section(replace(tried, trial=None)) is None

    def test_a_row_and_a_picture_for_each_run(self, whole):
        tried, blocks = whole[0], whole[1].blocks
        (table,) = [each for each in blocks if isinstance(each, Table)]
        figures = [each for each in blocks if isinstance(each, Figure)]
        assert len(table.rows) == len(figures) == len(tried.trial.runs)
        for run, figure in zip(tried.trial.runs, figures, strict=True):
            assert run.trajectory.reason.replace("q_d", "[q_d]").replace("`", "") in text(figure.caption)
            assert run.trajectory.scenario.title in figure.alt

    def test_the_numbers_are_those_of_the_trajectories(self, tried):
        op = tried.loop.operating_point
        table = simulation._table(tried.trial.runs, op)
        for row, run in zip(table.rows, tried.trial.runs, strict=True):
            trajectory, cells = run.trajectory, [text(each) for each in row]
            assert cells[1] == trajectory.outcome.value
            # Three digits are written, four of the force.
            assert numbers(cells[2]) == pytest.approx([np.max(np.abs(trajectory.q - op.q_d))], rel=6e-3)
            if op.m == 1:
                assert numbers(cells[3]) == pytest.approx(
                    [trajectory.lambda_.min(), trajectory.lambda_.max()], rel=6e-4
                )
            else:
                off = np.max(np.abs(trajectory.lambda_ - op.lambda_d))
                assert numbers(cells[3]) == pytest.approx([off], rel=6e-3)
            limits = trajectory.scenario.feedback.limits
            if limits is None:
                assert numbers(cells[4]) == pytest.approx([np.max(np.abs(trajectory.u))], rel=6e-3, abs=1e-9)
                assert "limit" not in cells[4]
            else:
                assert numbers(cells[4]) == pytest.approx([100 * np.max(np.abs(trajectory.u) / limits)], rel=6e-3)
                assert cells[4].endswith("% of its limit")
            drift = np.max(np.abs(trajectory.Phi))
            assert numbers(cells[5]) == pytest.approx([drift], rel=0.5)  # one digit
            assert drift < 1e-7

    def test_a_run_that_went_wrong_is_a_warning(self):
        data = YAML(typ="safe", pure=True).load((ROOT / "models" / "planar_2r_circle.yaml").read_text(encoding="utf-8"))
        data["bounds"]["disturbance"] = "6 N*m"
        model = firmtouch.parse_model(json.dumps(data).encode(), name="pushed")
        design = firmtouch.design_model(model)
        tried = try_out_design(design)
        (bad,) = [each.trajectory for each in tried.trial.runs if not each.trajectory.outcome.good]
        assert bad.outcome is Outcome.ELSEWHERE
        (new,) = set(tried.warnings) - set(design.warnings)
        assert new == f"Simulated, “A constant force begins” {bad.reason}."
        # Where it is simulated alone, it says so above everything.
        (whole,) = simulation_document(model, tried.loop.operating_point, tried.trial.runs).sections
        callouts = [each for each in whole.blocks if isinstance(each, Callout)]
        assert len(callouts) == 1
        assert whole.blocks[0] is callouts[0]


class TestTheTableOfErrors:
    @staticmethod
    def table(design):
        (found,) = [each for each in errors.section(design).blocks if isinstance(each, Table)]
        return found

    def test_without_a_trial_it_has_no_such_column(self, tried):
        assert "simulated" not in [text(each) for each in self.table(replace(tried, trial=None)).headings]

    def test_what_is_simulated_stands_beside_the_worst_case(self, tried):
        table = self.table(tried)
        headings = [text(each) for each in table.headings]
        worst, simulated = headings.index("worst"), headings.index("simulated")
        assert simulated == worst + 1
        predicted, steady = tried.steady_state, tried.trial.steady_state
        cases = [
            (getattr(predicted, name), i, getattr(steady, name)[i])
            for name in ("force", "offset", "tilt", *(["rotation"] if tried.loop.operating_point.m > 1 else []))
            for i in (0, 1)
        ]
        cases = [
            (case, found)
            for error, i, found in cases
            if (case := (error.worst_position, error.worst_constraint_force)[i]).value > 0
        ]
        assert len(cases) == len(table.rows)
        for row, (case, found) in zip(table.rows, cases, strict=True):
            assert numbers(text(row[worst]))[0] == pytest.approx(case.value, rel=6e-3)
            cell = text(row[simulated])
            size = np.linalg.norm(found.effects[0])
            if found.outcome is not Outcome.CONVERGED:
                assert cell == found.outcome.value
                continue
            told = numbers(cell)
            assert told[0] == pytest.approx(size, rel=6e-3)
            off = 100 * found.deviations[0] if found.deviations[0] > 1e-7 else 0
            assert told[1] == pytest.approx(off, rel=0.06)  # two digits
            assert ("order" in cell) == (not np.isnan(found.order))
            if "order" in cell:
                assert told[2] == pytest.approx(found.order, rel=0.06)

    def test_a_small_cause_is_told_as_a_part_of_the_table_s(self):
        data = YAML(typ="safe", pure=True).load((ROOT / "models" / "pendulum_rod.yaml").read_text(encoding="utf-8"))
        del data["bounds"]
        model = firmtouch.parse_model(json.dumps(data).encode(), name="unbounded")
        table = self.table(try_out_design(firmtouch.design_model(model)))
        offset = next(row for row in table.rows if text(row[0]).startswith("surface offset"))
        assert "(no bound given)" in text(offset[0])
        assert "for 0.001 of it" in text(offset[[text(each) for each in table.headings].index("simulated")])


class TestDesignJson:
    def test_it_holds_what_was_simulated(self, tried):
        data = json.loads(json.dumps(design_as_json(tried), allow_nan=False))["simulation"]
        assert data["steady_state"] == json.loads(json.dumps(steady_state_as_json(tried.trial.steady_state)))
        for told, run in zip(data["scenarios"], tried.trial.runs, strict=True):
            trajectory = run.trajectory
            assert told["name"] == trajectory.scenario.name
            assert told["outcome"] == trajectory.outcome.name.lower()
            assert told["final_q"] == trajectory.q[-1].tolist()
            assert told["end_time"] == trajectory.t[-1]
        for name in ("force", "offset", "rotation", "tilt"):
            for effect, found in zip(
                ("position", "constraint_force"), getattr(tried.trial.steady_state, name), strict=True
            ):
                told = data["steady_state"][name][effect]
                assert (told is None) == (found is None)
                if found is not None:
                    assert told["relative_deviations"] == found.deviations.tolist()
                    assert told["order"] == (None if np.isnan(found.order) else found.order)

    def test_without_a_trial_it_has_no_such_part(self, tried):
        assert "simulation" not in design_as_json(replace(tried, trial=None))

    def test_a_csv_has_every_digit(self, tried):
        trajectory = tried.trial.runs[0].trajectory
        rows = [each.split(",") for each in trajectory_as_csv(trajectory, tried.loop.operating_point).splitlines()]
        assert len(rows) == trajectory.t.size + 1
        assert [float(each[0]) for each in rows[1:]] == trajectory.t.tolist()
        assert [float(each) for each in rows[-1][1 : 1 + trajectory.q.shape[1]]] == trajectory.q[-1].tolist()


def extents(figure):
    """The boxes of all words that are drawn, in pixels, with the words."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.text import Text

    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    hidden = set()
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            slack = 1e-9 * (high - low)
            for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
                if not low - slack <= tick.get_loc() <= high + slack:
                    hidden |= {tick.label1, tick.label2}
    words = [
        each for each in figure.findobj(Text) if each not in hidden and each.get_visible() and each.get_text().strip()
    ]
    return [(each.get_text(), each.get_window_extent(canvas.get_renderer())) for each in words]


@pytest.fixture
def drawn(monkeypatch):
    """Draw a run, and give the figure itself."""

    def draw(run, op):
        found = []
        monkeypatch.setattr("firmtouch.report.figures.trajectory.as_svg", lambda figure, _: found.append(figure))
        from firmtouch.report.figures.canvas import styled

        run_picture(run, op, "run")
        with styled():
            boxes = extents(found[0])
        return found[0], boxes

    return draw


def assert_legible(figure, boxes):
    width, height = figure.bbox.width, figure.bbox.height
    for word, box in boxes:
        assert box.x0 >= -0.5, word
        assert box.y0 >= -0.5, word
        assert box.x1 <= width + 0.5, word
        assert box.y1 <= height + 0.5, word
    for (one, first), (two, second) in combinations(boxes, 2):
        overlap = (
            min(first.x1, second.x1) - max(first.x0, second.x0),
            min(first.y1, second.y1) - max(first.y0, second.y0),
        )
        assert min(overlap) <= 0.5, f"{one!r} over {two!r}"


class TestThePictures:
    def test_no_word_stands_over_another_or_outside(self, tried, drawn):
        for run in tried.trial.runs[1:2]:
            assert_legible(*drawn(run, tried.loop.operating_point))

    def test_the_axes_say_what_and_in_which_unit(self, tried, drawn):
        op = tried.loop.operating_point
        _, boxes = drawn(tried.trial.runs[0], op)
        words = [word for word, _ in boxes]
        assert words.count("time, s") == 3
        names = [each.replace("_", " ") for each in (*op.plant.spec.coordinates, *op.plant.spec.constraints)]
        assert {*names, "linear prediction"} <= set(words)
        limited = tried.trial.runs[0].trajectory.scenario.feedback.limits is not None
        assert ("joint force, % of its limit" in words) == limited

    def test_every_line_is_drawn_and_the_prediction_behind_it(self, tried, drawn):
        op = tried.loop.operating_point
        run = tried.trial.runs[1]
        figure, _ = drawn(run, op)
        position, force, drive = figure.axes
        n, m = op.n, op.m
        for axes, mine, predicted in (
            (position, run.trajectory.q - op.q_d, run.prediction.q - op.q_d),
            (force, run.trajectory.lambda_, run.prediction.lambda_),
        ):
            lines = [each for each in axes.lines if len(each.get_ydata()) > 2]
            assert len(lines) == 2 * mine.shape[1]
            behind = [each for each in lines if each.get_zorder() == 2]
            shift = op.lambda_d if axes is force and m > 1 else 0
            np.testing.assert_allclose(np.column_stack([each.get_ydata() for each in behind]), predicted - shift)
            front = [each for each in lines if each.get_zorder() == 3]
            np.testing.assert_array_equal(np.column_stack([each.get_ydata() for each in front]), mine - shift)
        assert len([each for each in drive.lines if len(each.get_ydata()) > 2]) == n

    def test_twice_drawn_is_the_same_to_the_byte(self, whole):
        tried, section = whole
        first = next(each for each in section.blocks if isinstance(each, Figure))
        assert run_picture(tried.trial.runs[0], tried.loop.operating_point, "run0") == first.svg

    def test_a_trajectory_of_hardly_any_instants_is_drawn(self, tried, drawn):
        run = tried.trial.runs[0]
        cut = {name: getattr(run.trajectory, name)[:1] for name in ("t", "q", "qdot", "lambda_", "u", "Phi")}
        short = replace(run, trajectory=replace(run.trajectory, **cut))
        assert_legible(*drawn(short, tried.loop.operating_point))

    @pytest.mark.parametrize("factor", [1e-9, 1e8])
    def test_numbers_beyond_all_size_are_drawn_legibly(self, drawn, factor):
        """A run that diverged ends with large numbers."""
        tried = tried_out("planar_3r_wall")
        run, op = tried.trial.runs[0], tried.loop.operating_point
        wild, tame = run.trajectory, run.prediction
        wild = replace(wild, q=op.q_d + factor * (wild.q - op.q_d), lambda_=factor * wild.lambda_, u=factor * wild.u)
        tame = replace(tame, q=op.q_d + factor * (tame.q - op.q_d), lambda_=factor * tame.lambda_)
        assert_legible(*drawn(replace(run, trajectory=wild, prediction=tame), op))


@pytest.mark.slow
@pytest.mark.parametrize("name", [each.stem for each in sorted((ROOT / "models").glob("*.yaml"))])
def test_all_pictures_of_the_shipped_models_are_legible(name, drawn):
    model = firmtouch.read_model(ROOT / "models" / f"{name}.yaml").with_method("poles")
    from firmtouch.design import find_gains
    from firmtouch.regulation import steady_state_errors
    from firmtouch.simulation.trial import run_all
    from firmtouch.simulation.usual import usual_scenarios

    loop = find_gains(model).loop
    for run in run_all(loop, usual_scenarios(loop, steady_state_errors(loop, model.spec.bounds))):
        assert_legible(*drawn(run, loop.operating_point))


@pytest.mark.slow
@pytest.mark.browser
@pytest.mark.parametrize("width", [PHONE, DESK], ids=["phone", "desk"])
def test_the_report_of_simulations_in_a_browser(browser, tmp_path, width):
    design = tried_out("planar_3r_wall")
    path = tmp_path / "simulation.html"
    html = render_html(simulation_document(design.model, design.loop.operating_point, design.trial.runs))
    path.write_text(html, encoding="utf-8")
    for visit in opened(browser, path, width):
        assert isinstance(visit, Visit)
        seen = visit.look()
        assert visit.complaints == []
        assert visit.requests == [visit.file]
        assert seen.overflow <= 0
        assert seen.pictures == len(design.trial.runs)
        for name in ("outside", "flat", "empty", "invisible", "dangling", "repeated", "small", "narrow", "unnamed"):
            assert f"{name}:" in LOOK
            assert getattr(seen, name) == [], name
