"""Equations as machine code: the same runs to the last bit, where there are many of them, and only there."""

from dataclasses import replace

import numpy as np
import pytest

from firmtouch.mechanics.compiled import find_compiler
from firmtouch.montecarlo.study import nominal_scenario
from firmtouch.simulation.many import MANY_RUNS, SOME_RUNS
from firmtouch.simulation.run import build_simulator, simulate
from firmtouch.simulation.scenario import Start

pytestmark = pytest.mark.skipif(find_compiler() is None, reason="there is no C compiler")


@pytest.fixture
def libraries(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return lambda: len(list(tmp_path.rglob("*.so")))


def runs_alike(loop, libraries):
    scenario = nominal_scenario(loop)
    op = loop.operating_point
    scenario = replace(scenario, start=Start(op.q_d + 0.02 * loop.split.V2[:, 0], np.zeros(op.n)))
    found, counted = [], []
    for runs in (1, SOME_RUNS, MANY_RUNS, SOME_RUNS):
        simulator = build_simulator(loop, scenario, runs=runs)
        counted.append((libraries(), simulator.dae.outputs.is_a("SXFunction")))
        found.append(simulate(loop, scenario, simulator=simulator))
    for other in found[1:]:
        assert other.outcome == found[0].outcome
        for name in ("t", "q", "qdot", "lambda_", "u", "Phi"):
            np.testing.assert_array_equal(getattr(other, name), getattr(found[0], name))
    return counted


def test_many_runs_are_compiled_and_the_same(libraries, loop_of, make_arm):
    arm = make_arm(2, {"wall": "0.55 - x(p2)"}, [0.9, -0.9])
    # Nothing; nothing, because nothing is there; the rate and the outputs; both are found again.
    assert runs_alike(loop_of(arm), libraries) == [(0, True), (0, True), (2, False), (2, False)]


@pytest.mark.slow
def test_all_models(libraries, loop):
    """Of the 6R arm, only the outputs may be short enough; none of it is not an error."""
    counted = runs_alike(loop, libraries)
    assert counted[1][0] == 0
    assert counted[2] == counted[3]
