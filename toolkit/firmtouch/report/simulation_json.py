"""Simulations as plain data: JSON (schema `firmtouch.simulation/1`), and a CSV table of a trajectory. All in SI."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from firmtouch.modelfile import ModelFile
from firmtouch.regulation import OperatingPoint
from firmtouch.simulation.steady import SimulatedError, SimulatedSteadyState
from firmtouch.simulation.trajectory import Trajectory
from firmtouch.simulation.trial import Run

SCHEMA: Final = "firmtouch.simulation/1"


def simulation_as_json(model: ModelFile, op: OperatingPoint, runs: Sequence[Run]) -> dict[str, Any]:
    """Give what came of some scenarios."""
    return {
        "schema": SCHEMA,
        "model": {"name": model.name, "title": model.spec.title, "sha256": model.sha256},
        "coordinates": list(model.spec.coordinates),
        "constraints": list(model.spec.constraints),
        "scenarios": [run_as_json(each.trajectory, op) for each in runs],
    }


def run_as_json(trajectory: Trajectory, op: OperatingPoint) -> dict[str, Any]:
    """Give what came of one run, without its instants."""
    scenario, limits = trajectory.scenario, trajectory.scenario.feedback.limits
    rest = trajectory.rest
    return {
        "name": scenario.name,
        "title": scenario.title,
        "controller": scenario.feedback.controller.value,
        "duration": scenario.duration,
        "outcome": trajectory.outcome.name.lower(),
        "reason": trajectory.reason,
        "end_time": float(trajectory.t[-1]),
        "start_moved": trajectory.moved,
        "largest_position_error": float(np.max(np.abs(trajectory.q - op.q_d))),
        "largest_force_error": float(np.max(np.abs(trajectory.lambda_ - op.lambda_d))),
        "least_lambda": trajectory.lambda_.min(axis=0).tolist(),
        "greatest_lambda": trajectory.lambda_.max(axis=0).tolist(),
        "largest_u": np.max(np.abs(trajectory.u), axis=0).tolist(),
        "largest_part_of_limit": None if limits is None else float(np.max(np.abs(trajectory.u) / limits)),
        "drift": float(np.max(np.abs(trajectory.Phi))),
        "final_q": trajectory.q[-1].tolist(),
        "final_lambda": trajectory.lambda_[-1].tolist(),
        "equilibrium": None if rest is None else {"q": rest.q.tolist(), "lambda": rest.lambda_.tolist()},
    }


def steady_state_as_json(simulated: SimulatedSteadyState) -> dict[str, Any]:
    """Give the simulated table."""
    return {
        name: dict(zip(("position", "constraint_force"), map(_error, getattr(simulated, name)), strict=True))
        for name in ("force", "offset", "rotation", "tilt")
    }


def trajectory_as_csv(trajectory: Trajectory, op: OperatingPoint) -> str:
    """Write a run's instants, one a line: t, q, q', lambda, u, Phi."""
    coordinates, constraints = list(op.plant.spec.coordinates), list(op.plant.spec.constraints)
    header = ["t", *coordinates, *(f"{each}_dot" for each in coordinates), *(f"lambda_{each}" for each in constraints)]
    header += [*(f"u_{each}" for each in coordinates), *(f"phi_{each}" for each in constraints)]
    rows = np.column_stack(
        [trajectory.t, trajectory.q, trajectory.qdot, trajectory.lambda_, trajectory.u, trajectory.Phi]
    )
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows([float(each) for each in row] for row in rows)
    return text.getvalue()


def _error(error: SimulatedError | None) -> dict[str, Any] | None:
    if error is None:
        return None
    return {
        "outcome": error.outcome.name.lower(),
        "parts_of_cause": error.parts.tolist(),
        "effects": error.effects.tolist(),
        "relative_deviations": error.deviations.tolist(),
        "order": None if math.isnan(error.order) else error.order,
    }
