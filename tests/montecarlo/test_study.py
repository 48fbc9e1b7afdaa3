"""Runs: the same from any process and after any other, with figures that can be had from their trajectories."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from firmtouch.certificate.attraction import find_attraction, find_whole_box
from firmtouch.certificate.attraction.finding import Finding
from firmtouch.errors import InputError
from firmtouch.montecarlo import Label, Record, Sets, build_study, clopper_pearson, run_all, run_labelled, summarise
from firmtouch.montecarlo.draw import generator
from firmtouch.montecarlo.journal import NAME, Journal, OtherQuestionError, read_runs
from firmtouch.montecarlo.proven import regions_of_finding, start_inside
from firmtouch.montecarlo.question import question_of
from firmtouch.montecarlo.record import OFF, read_label, record_as_json, record_from_json
from firmtouch.regulation.lyapunov import potential
from firmtouch.simulation.continuous import Integrator
from firmtouch.simulation.run import simulate
from firmtouch.simulation.trajectory import Outcome

LABELS = [Label(False, i) for i in range(1, 31)]


@pytest.fixture(scope="module")
def records(study):
    return [run_labelled(study, each)[0] for each in LABELS]


@pytest.fixture(scope="module")
def regions(circle):
    """What is proven of it, on the surface and on a box."""
    return regions_of_finding(Finding(find_attraction(circle), find_whole_box(circle), ()), circle)


class TestARun:
    def test_it_is_the_same_again_and_from_a_copy_as_other_processes_have_it(self, study, records):
        copy = pickle.loads(pickle.dumps(study))
        for label in LABELS[7:2:-1]:
            assert run_labelled(study, label)[0] == records[label.number - 1]
            assert run_labelled(copy, label)[0] == records[label.number - 1]

    def test_figures_are_those_of_its_trajectory(self, study, records):
        record, trajectory = run_labelled(study, LABELS[1])
        op = study.loop.operating_point
        assert record.converged
        assert record.farthest == np.max(np.abs(trajectory.q - op.q_d))
        assert record.distance == np.max(np.abs(trajectory.q[-1] - trajectory.rest.q))
        assert record.force == np.max(np.abs(trajectory.lambda_ - op.lambda_d))
        assert record.torque == np.max(np.abs(trajectory.u) / study.base.feedback.limits)
        assert (record.t, record.V, record.pulled) == (study.base.duration, None, False)

    def test_without_limits_there_is_no_part_of_one(self, study):
        base = replace(study.base, feedback=replace(study.base.feedback, limits=None))
        record, _ = run_labelled(build_study(study.loop, base, study.sets, seed=5), LABELS[1])
        assert record.torque is None
        assert summarise([record]).worst[-1].records == ()

    def test_a_start_that_misses_the_surface_is_no_run(self, circle, study):
        far = Sets(np.zeros(2), np.zeros(2), {}, np.zeros(2), np.array([5.0]), 0.0, 0.0)  # metres: out of reach
        record, trajectory = run_labelled(build_study(circle, study.base, far, seed=1), Label(False, 1))
        assert (record.outcome, record.counts, trajectory) == (OFF, False, None)

    def test_the_base_is_what_simulate_gives_where_nothing_is_drawn(self, study):
        nothing = Sets(np.zeros(2), np.zeros(2), {}, np.zeros(2), np.zeros(1), 0.0, 0.0)
        _, trajectory = run_labelled(build_study(study.loop, study.base, nothing, seed=1), Label(False, 3))
        assert np.array_equal(trajectory.q, simulate(study.loop, study.base).q)

    def test_batches_hold_every_label_once(self, study, records):
        found = [each for batch in run_all(study, LABELS, jobs=1) for each in batch]
        assert found == records


class TestLabels:
    def test_there_and_back(self):
        for each in (Label(False, 1), Label(True, 17), Label(False, 123456789)):
            assert read_label(str(each)) == each

    @pytest.mark.parametrize("text", ["", "0", "-1", "q1", "p", "p0", "1.5", "1e3", "9999999999", "１"])
    def test_anything_else_is_refused(self, text):
        with pytest.raises(InputError, match="is no run"):
            read_label(text)


class TestClopperPearson:
    @pytest.mark.parametrize("n", [1, 7, 1000])
    def test_none_and_all_have_closed_forms(self, n):
        # P(no success) = (1 - p)^n = 0.025
        assert clopper_pearson(0, n) == pytest.approx((0.0, 1 - 0.025 ** (1 / n)), rel=1e-12)
        assert clopper_pearson(n, n) == pytest.approx((0.025 ** (1 / n), 1.0), rel=1e-12)

    def test_one_of_two(self):
        # 1 - (1 - p)^2 = 0.025 and 1 - p^2 = 0.025
        assert clopper_pearson(1, 2) == pytest.approx((1 - math.sqrt(0.975), math.sqrt(0.975)), rel=1e-12)

    @pytest.mark.parametrize(("k", "n"), [(3, 10), (81, 263), (993, 1000)])
    def test_it_is_scipys_exact_interval(self, k, n):
        found = stats.binomtest(k, n).proportion_ci(confidence_level=0.95, method="exact")
        assert clopper_pearson(k, n) == pytest.approx((found.low, found.high), rel=1e-9)

    def test_published_81_of_263(self):
        # Agresti and Coull's and Newcombe's worked example: 0.2527 to 0.3676 (Newcombe 1998, Table I, method 5)
        assert clopper_pearson(81, 263) == pytest.approx((0.2527, 0.3676), abs=5e-5)

    def test_without_a_trial_nothing_is_known(self):
        assert clopper_pearson(0, 0) == (0.0, 1.0)


class TestSummary:
    def test_counts_and_the_worst(self, records):
        off = Record(Label(False, 99), OFF, "no surface")
        found = summarise([*records[::-1], off])
        assert (found.runs, found.off_surface) == (len(records), 1)
        assert sum(found.counts.values()) == len(records)
        assert found.converged == found.counts["converged"] == sum(each.outcome == "converged" for each in records)
        by_name = {each.figure: each.records for each in found.worst}
        assert by_name["force"][0].force == max(each.force for each in records)
        assert all(not each.converged for each in by_name["distance"])
        assert [each.torque for each in by_name["torque"]] == sorted((each.torque for each in records), reverse=True)[
            :5
        ]
        assert found == summarise([off, *records])


class TestJournal:
    def test_records_come_back_exactly(self, records):
        for each in records:
            assert record_from_json(record_as_json(each)) == each

    def test_what_was_cut_off_is_run_again(self, tmp_path, records):
        question = {"seed": 5}
        with Journal(tmp_path, question, fresh=False) as journal:
            journal.append(records)
        path = tmp_path / NAME
        whole = path.read_bytes()
        path.write_bytes(whole[:-20])  # in the middle of the last line
        known = read_runs(tmp_path, question)
        assert set(known.values()) == set(records[:-1])
        with Journal(tmp_path, question, fresh=False) as journal:
            journal.append(records[-1:])
        assert path.read_bytes() == whole

    @pytest.mark.parametrize("length", [0, 10])
    def test_a_first_line_that_was_cut_off_is_no_run(self, tmp_path, length):
        with Journal(tmp_path, {"seed": 5}, fresh=False):
            pass
        path = tmp_path / NAME
        whole = path.read_bytes()
        path.write_bytes(whole[:length])
        assert read_runs(tmp_path, {"seed": 5}) == {}
        with Journal(tmp_path, {"seed": 5}, fresh=False):
            pass
        assert path.read_bytes() == whole

    def test_another_question_is_refused_with_what_differs(self, tmp_path):
        with Journal(tmp_path, {"seed": 5, "draw": {"tilt": 0.1}}, fresh=False):
            pass
        with pytest.raises(
            OtherQuestionError, match=r"seed \(5 there, 6 here\), draw\.tilt \(0\.1 there, 0\.2 here\) differ"
        ):
            read_runs(tmp_path, {"seed": 6, "draw": {"tilt": 0.2}})

    @pytest.mark.parametrize("content", [b"hello\n", b"[]\n", b'{"schema": "other/1", "question": {}}\n', b"\xff\n"])
    def test_another_file_is_refused(self, tmp_path, content):
        (tmp_path / NAME).write_bytes(content)
        with pytest.raises(InputError, match="these are no runs"):
            read_runs(tmp_path, {})

    @pytest.mark.parametrize(
        "line", [b"{}", b"x", b'{"run": 3}', b"[]", b'{"run": "1", "outcome": "converged", "t": "x"}']
    )
    def test_a_line_that_is_no_run_is_told(self, tmp_path, line):
        with Journal(tmp_path, {}, fresh=False):
            pass
        path = tmp_path / NAME
        path.write_bytes(path.read_bytes() + line + b"\n")
        with pytest.raises(InputError, match=r"runs\.jsonl:2: no run"):
            read_runs(tmp_path, {})

    def test_a_question_knows_everything_that_a_run_depends_on(self, study, models):
        question = question_of(study, models("planar_2r_circle"))
        for other in (
            replace(study, seed=6),
            replace(study, base=replace(study.base, duration=1.0)),
            replace(study, sets=replace(study.sets, tilt=0.0)),
        ):
            assert question_of(other, models("planar_2r_circle")) != question


class TestInsideTheProof:
    def test_starts_are_on_the_surface_along_it_and_below_the_level(self, circle, regions):
        plant, V = circle.operating_point.plant, []
        for region in regions:
            for i in range(1, 21):
                start, energy = start_inside(circle, region, generator(3, Label(True, i)))
                V.append(energy / region.level)
                kinetic = start.qdot @ plant.M(start.q) @ start.qdot / 2
                assert np.max(np.abs(plant.Phi(start.q))) < 1e-11
                assert np.max(np.abs(plant.J(start.q) @ start.qdot)) < 1e-12  # rounding
                assert energy == pytest.approx(potential(circle, start.q) + kinetic, rel=1e-9)
        assert 0.9 < max(V) < 1  # they do come close to it
        assert min(V) >= 0

    def test_all_of_them_converge_under_both_controllers(self, circle, study, regions):
        inside = build_study(circle, study.base, study.sets, seed=2, regions=regions)
        for i in range(1, 13):
            record, _ = run_labelled(inside, Label(True, i))
            assert record.converged
            assert record.V < record.level
        assert {run_labelled(inside, Label(True, i))[1].scenario.feedback.controller.value for i in (1, 3)} == {15, 11}

    def test_a_spoilt_proof_is_contradicted(self, circle, study, regions):
        spoilt = replace(regions[0], level=50 * regions[0].level)  # behind the next equilibrium, at 0.159 rad
        inside = build_study(circle, study.base, study.sets, seed=2, regions=(spoilt,))
        runs = [run_labelled(inside, Label(True, i)) for i in range(1, 17)]
        found, box = summarise(record for record, _ in runs), regions[1]
        assert found.inside == 16
        assert found.contradictions
        for record, trajectory in runs:  # and what is truly proven is not
            if record in found.contradictions:
                assert not (box.holds(trajectory.q[0]) and record.V < box.level)

    def test_contacts_may_pull_there(self, circle, study):
        constraints = [each.operating_point.plant.spec.constraints["rim"] for each in (circle, study.bilateral)]
        assert [each.one_sided for each in constraints] == [True, False]
        assert study.bilateral.gains == circle.gains


def test_what_comes_after_a_lost_contact_is_not_followed(circle, study, monkeypatch):
    # Without contact this motion becomes so fast after 0.83 s that its integrator fails again and again.
    count, call = [], Integrator.__call__
    monkeypatch.setattr(Integrator, "__call__", lambda self, *words: count.append(1) or call(self, *words))
    record, _ = run_labelled(replace(study, seed=1), Label(False, 48))
    assert record.outcome == Outcome.CONTACT_LOST.name.lower()
    assert record.t == pytest.approx(0.826, abs=1e-3)
    assert len(count) < 10  # the whole, halves of it until one can be followed, and a close look
