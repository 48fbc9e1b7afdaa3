"""How much of a region design's search is the solver's own time: a planar 7R arm with its tip on a wall, full matrices.

The rest is cvxpy's compiling, the setting of eps, and the check of every attempt from its finished gains.
"""

from __future__ import annotations

from tests.benchmarks.chain import chain_on_wall
from tests.benchmarks.measure import Figure

import firmtouch
from firmtouch.synthesis.region.convex import ConvexSearch, Found
from firmtouch.synthesis.region.problem import RegionProblem, build_problem
from firmtouch.synthesis.region.programme import Stopwatch

JOINTS = 7
PAYLOAD = ["0.5 kg", "1.5 kg"]
REPETITIONS = 3


def model_text(*, uncertain: bool) -> bytes:
    """Write the model file: with a payload at the chain's tip, and a region to be found."""
    payload = {"value": "1 kg", "interval": PAYLOAD} if uncertain else "1 kg"
    region = {"structure": "full", "decay": 3, "damping": 0.6, "bandwidth": 30}
    return chain_on_wall(JOINTS, {"method": "region", "region": region, "force_feedback": 0.5}, payload=payload)


def problem(*, uncertain: bool) -> RegionProblem:
    spec = firmtouch.parse_model(model_text(uncertain=uncertain), name="arm").spec
    return build_problem(firmtouch.find_operating_point(firmtouch.derive_plant(spec)), spec)


def timed(asked: RegionProblem) -> tuple[float, Found]:
    """Compile and search once; the time is that of `SearchRecord.total_time`."""
    watch = Stopwatch()
    found = ConvexSearch(asked).run()
    assert found.best.status.has_gains
    return watch.read(), found


def figures() -> list[Figure]:
    made = []
    for uncertain, payload in ((False, "known payload"), (True, f"{PAYLOAD[0]} to {PAYLOAD[1]}")):
        asked = problem(uncertain=uncertain)
        timed(asked)  # loads the libraries
        total, found = min((timed(asked) for _ in range(REPETITIONS)), key=lambda each: each[0] / each[1].solver_time)
        solver = found.solver_time
        detail = f"{total:.2f} s against {solver:.2f} s in {found.solves} solves (best of {REPETITIONS}, warm)"
        made.append(Figure(f"{JOINTS}R, {payload}: search / solver", total / solver, "<=", 3, "", detail))
    return made
