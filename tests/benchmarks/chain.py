"""A planar chain of equal links that touches a wall with its tip: the arm that benchmarks of any size are about."""

from __future__ import annotations

import json
import math
from typing import Any

REACH = 2.8
"""Length of the whole chain, in m."""
FIRST, BENT = 1.2, 1.9
"""The first joint's angle, and by how much all others together turn back, in rad."""


def chain_on_wall(joints: int, design: dict[str, Any], payload: object = None) -> bytes:
    """Write the model file; a payload is a parameter as files have them, or nothing."""
    names, length = [f"q{i}" for i in range(1, joints + 1)], REACH / joints
    guess = [FIRST, *[-BENT / (joints - 1)] * (joints - 1)]
    wall = length * sum(math.cos(sum(guess[: i + 1])) for i in range(joints))  # so that the guess touches it
    definitions, bodies, before = {}, {}, "[0*l, 0*l]"
    for i, name in enumerate(names, start=1):
        definitions[f"a{i}"] = f"a{i - 1} + {name}" if i > 1 else name
        along = f"[cos(a{i}), sin(a{i})]"
        definitions[f"p{i}"] = f"{before} + l*{along}"
        centre = f"{before} + 0.45*l*{along}"
        bodies[f"link{i}"] = {"mass": "m", "inertia": "I", "centre_of_mass": centre, "orientation": f"a{i}"}
        before = f"p{i}"
    parameters: dict[str, object] = {"l": f"{length!r} m", "m": "2 kg", "I": "0.03 kg*m^2", "d": f"{wall!r} m"}
    if payload is not None:
        parameters |= {"mp": payload, "Ip": "0.002 kg*m^2"}
        bodies["payload"] = {"mass": "mp", "inertia": "Ip", "centre_of_mass": before, "orientation": f"a{joints}"}
    document = {
        "schema": "firmtouch.model/1",
        "title": f"A planar {joints}R arm on a wall",
        "parameters": parameters,
        "coordinates": dict.fromkeys(names, "rad"),
        "definitions": definitions,
        "mechanism": {"gravity": "[0, -9.81]", "bodies": bodies},
        "constraints": {"wall": {"expression": f"d - x({before})", "unit": "m"}},
        "operating_point": {"guess": dict(zip(names, guess, strict=True)), "lambda_d": {"wall": 20}},
        "design": design,
    }
    return json.dumps(document).encode()
