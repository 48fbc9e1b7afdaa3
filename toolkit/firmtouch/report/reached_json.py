"""What inverse kinematics found -> plain data of `design.json`."""

from __future__ import annotations

import math
from typing import Any

from firmtouch.regulation.inverse_kinematics import Reached


def reached_as_json(reached: Reached) -> dict[str, Any]:
    """Give all configurations, the one that was taken first; SI."""
    return {
        "because": reached.because,
        "isolated": reached.isolated,
        "starts": reached.starts,
        "solutions": [
            {
                "q": each.q.tolist(),
                "manipulability": each.manipulability,
                "least_singular_value": each.least_singular_value,
                "limit_margin": each.margin if math.isfinite(each.margin) else None,
            }
            for each in reached.solutions
        ],
    }
