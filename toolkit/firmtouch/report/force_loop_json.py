"""`ForceLoop` -> its part of `design.json`: numbers in SI, infinite ones as null."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from firmtouch.regulation.force_loop import ContactPoles, ForceLoop, StiffnessSweep


def force_loop_as_json(force: ForceLoop) -> dict[str, Any]:
    """Give a force loop as plain data for JSON."""
    path, contact = force.path, force.contact
    return {
        "path": {"given": force.given, "delay": path.delay, "lag": path.lag, "sample": path.sample},
        "loops": [
            {
                "gain": each.gain,
                "bound": _finite(each.bound),
                "gain_margin": _finite(each.gain_margin),
                "delay_margin": _finite(each.delay_margin),
                "modulus_margin": each.modulus_margin,
                "stable": each.stable,
            }
            for each in force.loops
        ],
        "asked": {
            each.name: {"asked": each.asked, "least": _finite(each.least), "kept": each.kept} for each in force.verdicts
        },
        "admissible": _finite(force.admissible),
        "sweep": _sweep(force.sweep),
        "contact": None
        if contact is None
        else {
            "poles": None if contact.poles is None else _contact(contact.poles),
            "critical_gain": _finite(contact.critical_gain),
        },
    }


def _sweep(sweep: StiffnessSweep) -> dict[str, Any]:
    return {
        "stiffness": sweep.stiffness.tolist(),
        "poles": [_pairs(each.poles) for each in sweep.points],
        "tangent": [_pairs(each.tangent) for each in sweep.points],
        "stable": [each.stable for each in sweep.points],
        "kept": [each.kept for each in sweep.points],
        "unstable": [[each.low, _finite(each.high)] for each in sweep.unstable],
        "kept_from": _finite(sweep.kept_from),
        "kept_by": "region" if sweep.by_region else "poles",
    }


def _contact(contact: ContactPoles) -> dict[str, Any]:
    return {
        "stiffness": contact.stiffness.tolist(),
        "poles": _pairs(contact.poles),
        "tangent": _pairs(contact.tangent),
        "stable": contact.stable,
        "kept": contact.kept,
    }


def _pairs(poles: Iterable[complex]) -> list[list[float]]:
    return [[each.real, each.imag] for each in poles]


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
