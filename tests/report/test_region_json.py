"""What a region design adds to `design.json`: its keys, and its numbers computed once more from the same file."""

import numpy as np
import pytest

REGION = {"decay": 3, "damping": 0.5, "bandwidth": 60, "structure": "diagonal", "positivity": "5 N*m/rad"}
ADDED = {"specification", "objective", "structure", "margins", "uncertainty", "search", "front", "force_front"}


@pytest.fixture(scope="module")
def data(arm_in_region):
    return arm_in_region(REGION).json


def test_every_promised_key_is_there(data, shipped_report):
    assert set(data) >= ADDED
    assert not set(shipped_report("pendulum_rod").json) & ADDED
    assert set(data["margins"]) == {"mu", "lambda_d", "N0", "parameters", "W", "C", "edges"}
    assert set(data["uncertainty"]) >= {"vertices", "worst_vertex", "enlargement"}
    assert set(data["search"]) >= {"epsilon", "status", "solver_time", "total_time"}
    assert data["poles"]["requested"] == []
    assert data["poles"]["residual"] is None


def test_the_specification_is_what_was_asked_and_the_gains_reach_it(data):
    rows = {each["name"]: each for each in data["specification"]}
    assert (rows["decay rate"]["asked"], rows["damping ratio"]["asked"], rows["greatest |s|"]["asked"]) == (3, 0.5, 60)
    poles = [np.array(vertex["poles"]) @ [1, 1j] for vertex in data["uncertainty"]["vertices"]]
    reached = {
        "decay rate": min(np.min(-s.real) for s in poles),
        "damping ratio": min(np.min(-s.real / np.abs(s)) for s in poles),
        "greatest |s|": max(np.max(np.abs(s)) for s in poles),
    }
    for name, value in reached.items():
        assert rows[name]["reached"] == pytest.approx(value, rel=1e-12)  # the same poles, read again
        assert rows[name]["margin"] > 0


def test_the_gains_have_the_structure(data):
    pattern = np.array(data["structure"]["pattern"])
    assert data["structure"]["kind"] == "diagonal"
    for name in ("W", "C"):
        gains = np.array(data["gains"][name])
        assert np.all(gains[~pattern] == 0)
        assert np.all(np.diag(gains) > 0)


def test_mu_is_the_least_eigenvalue_of_the_stiffness_over_the_interval(data):
    nominal = np.linalg.eigvalsh(np.array(data["gains"]["W"]) + np.array(data["operating_point"]["N0"]))[0]
    assert 5 <= data["margins"]["mu"] <= nominal
    low, high = data["margins"]["parameters"]["m3"]
    assert low <= 2
    assert high >= 3


def test_no_report_takes_longer_to_solve_than_it_took_in_all(data):
    assert 0 < data["search"]["solver_time"] <= data["search"]["total_time"]
    assert data["search"]["status"] == "solved"


def test_a_front_has_its_ends_and_falls_between(arm_in_region):
    front = arm_in_region(REGION, front=("gains", "margin")).json["front"]
    gains, margin = np.array(front["points"]).T
    assert (front["x"]["unit"], front["y"]["unit"]) == ("N m/rad", "N m/rad")
    assert np.all(np.diff(gains) > 0)
    assert np.all(np.diff(margin) > -1e-3 * margin[-1])  # eps is searched, and not to the last digit
    assert front["chosen"] == front["points"][0]
