"""How much of a region design's search is the solver's own time: a planar 7R arm with its tip on a wall, full matrices.

The rest is cvxpy's compiling, the setting of eps, and the check of every attempt from its finished gains.
"""

from __future__ import annotations

import json
import math

from tests.benchmarks.measure import Figure

import firmtouch
from firmtouch.synthesis.region.convex import ConvexSearch, Found
from firmtouch.synthesis.region.problem import RegionProblem, build_problem
from firmtouch.synthesis.region.programme import Stopwatch

JOINTS = 7
LENGTH, CENTRE = 0.4, 0.18
GUESS = (1.2, -0.4, -0.3, -0.3, -0.2, -0.2, -0.1)
REACH = LENGTH * sum(math.cos(sum(GUESS[: i + 1])) for i in range(JOINTS))
"""Where the wall stands, so that the guess touches it."""
PAYLOAD = ["0.5 kg", "1.5 kg"]
REPETITIONS = 3


def model_text(*, uncertain: bool) -> bytes:
    """Write the model file: a chain of equal links with a payload at its tip, which touches x = d."""
    names = [f"q{i}" for i in range(1, JOINTS + 1)]
    definitions, bodies, before = {}, {}, "[0*l, 0*l]"
    for i, name in enumerate(names, start=1):
        definitions[f"a{i}"] = f"a{i - 1} + {name}" if i > 1 else name
        along = f"[cos(a{i}), sin(a{i})]"
        definitions[f"p{i}"] = f"{before} + l*{along}"
        centre = f"{before} + c*{along}"
        bodies[f"link{i}"] = {"mass": "m", "inertia": "I", "centre_of_mass": centre, "orientation": f"a{i}"}
        before = f"p{i}"
    bodies["payload"] = {"mass": "mp", "inertia": "Ip", "centre_of_mass": before, "orientation": f"a{JOINTS}"}
    payload = {"value": "1 kg", "interval": PAYLOAD} if uncertain else "1 kg"
    document = {
        "schema": "firmtouch.model/1",
        "title": f"A planar {JOINTS}R arm on a wall",
        "parameters": {
            "l": f"{LENGTH} m",
            "c": f"{CENTRE} m",
            "m": "2 kg",
            "I": "0.03 kg*m^2",
            "mp": payload,
            "Ip": "0.002 kg*m^2",
            "d": f"{REACH!r} m",
        },
        "coordinates": dict.fromkeys(names, "rad"),
        "definitions": definitions,
        "mechanism": {"gravity": "[0, -9.81]", "bodies": bodies},
        "constraints": {"wall": {"expression": f"d - x({before})", "unit": "m"}},
        "operating_point": {"guess": dict(zip(names, GUESS, strict=True)), "lambda_d": {"wall": 20}},
        "design": {
            "method": "region",
            "region": {"structure": "full", "decay": 3, "damping": 0.6, "bandwidth": 30},
            "force_feedback": 0.5,
        },
    }
    return json.dumps(document).encode()


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
