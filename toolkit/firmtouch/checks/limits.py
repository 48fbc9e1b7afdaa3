"""Checks of the joints' limits: q_d lies within them, and the drives can hold it there."""

from __future__ import annotations

import math

import numpy as np

from firmtouch.checks.result import CheckResult, at_least, at_most, told
from firmtouch.checks.subject import Subject
from firmtouch.regulation.operating_point import outside_limits


def within_limits(subject: Subject) -> CheckResult:
    """q_d lies between the limits of all joints."""
    coordinates = subject.plant.spec.coordinates
    if all(each.limits is None for each in coordinates.values()):
        return told("joint limits", "none are given")
    margins = {
        name: min(value - each.lower, each.upper - value)
        for (name, each), value in zip(coordinates.items(), subject.q_d.tolist(), strict=True)
        if each.limits is not None
    }
    nearest = min(margins, key=lambda name: margins[name])
    detail = "; ".join(outside_limits(subject.plant, subject.q_d)) or f"nearest to its limit is `{nearest}`"
    return at_least("joint limits", margins[nearest], 0.0, detail)


def drives_hold(subject: Subject) -> CheckResult:
    """|g - J^T lambda_d| at q_d stays within every drive's effort."""
    plant, name = subject.plant, "drives hold q_d"
    efforts = np.array([each.effort.value if each.effort else math.inf for each in plant.spec.coordinates.values()])
    if not np.any(np.isfinite(efforts)):
        return told(name, "no `effort` is given")
    load = plant.P_q(subject.q_d) - plant.J(subject.q_d).T @ subject.lambda_d
    shares = np.abs(load) / efforts
    worst = int(np.argmax(shares))
    joint = list(plant.spec.coordinates)[worst]
    detail = f"`{joint}` needs {abs(load[worst]):.3g} of its {efforts[worst]:.3g} for weight and contact force"
    return at_most(name, float(shares[worst]), 1.0, detail)
