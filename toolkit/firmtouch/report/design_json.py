"""`Design` -> `design.json`, schema `firmtouch.design/1`: numbers in SI, full precision."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

from firmtouch.design import Design
from firmtouch.mechanics import Array
from firmtouch.modelfile import ModelFile
from firmtouch.regulation import SteadyStateError
from firmtouch.regulation.closed_loop import Positivity
from firmtouch.report.force_loop_json import force_loop_as_json
from firmtouch.report.reached_json import reached_as_json
from firmtouch.report.region_json import region_as_json
from firmtouch.report.simulation_json import run_as_json, steady_state_as_json

SCHEMA: Final = "firmtouch.design/1"


def design_as_json(design: Design) -> dict[str, Any]:
    """Give a design as plain data for JSON."""
    model, loop = design.model, design.loop
    op, gains = loop.operating_point, loop.gains
    errors = design.steady_state
    return {
        "schema": SCHEMA,
        "model": {
            "name": model.name,
            "title": model.spec.title,
            "n": op.n,
            "m": op.m,
            "sha256": model.sha256,
            "coordinates": list(model.spec.coordinates),
            "constraints": list(model.spec.constraints),
            "source": model.document.text,
            **_attached(model),
        },
        "operating_point": {
            "q_d": op.q_d.tolist(),
            "lambda_d": op.lambda_d.tolist(),
            "f_d": op.f_d.tolist(),
            "M": op.M.tolist(),
            "J": op.J.tolist(),
            "gravity_gradient": op.g.tolist(),
            "P_qq": op.P_qq.tolist(),
            **({} if op.reached is None else {"reached": reached_as_json(op.reached)}),
            "constraint_hessians": op.constraint_hessians.tolist(),
            "N0": op.N0.tolist(),
        },
        "gains": {name: getattr(gains, name).tolist() for name in ("W", "C", "G_f", "bias")},
        "poles": {
            "requested": _pairs(design.requested),
            "achieved": _pairs(design.achieved),
            "residual": design.residual if design.requested else None,
        },
        "positivity": {"full": _positivity(loop.full), "tangent": _positivity(loop.tangent)},
        "steady_state": {name: _error(getattr(errors, name)) for name in ("force", "offset", "rotation", "tilt")},
        "force_loop": force_loop_as_json(design.force_loop),
        **(region_as_json(design.region) if design.region is not None else {}),
        **({"simulation": _simulation(design)} if design.trial is not None else {}),
        "certified": design.certificate.certified,
        "checks": [{"name": each.name, "holds": each.holds} for each in design.checks.results],
        "warnings": list(design.warnings),
    }


def _simulation(design: Design) -> dict[str, Any] | None:
    trial, op = design.trial, design.loop.operating_point
    if trial is None:
        return None
    return {
        "scenarios": [run_as_json(each.trajectory, op) for each in trial.runs],
        "steady_state": steady_state_as_json(trial.steady_state),
    }


def _attached(model: ModelFile) -> dict[str, Any]:
    """Give the text of the files that the model names, so that a design can be read back without them."""
    files = {name: content.decode("utf-8", "surrogateescape") for name, content in model.attached.items()}
    return {"files": files} if files else {}


def _pairs(poles: Iterable[complex]) -> list[list[float]]:
    return [[each.real, each.imag] for each in poles]


def _positivity(level: Positivity) -> dict[str, Any]:
    least = {f"{name}_min": float(getattr(level, name)[0]) for name in ("K", "C", "W")}
    return {"holds": level.holds, **least}


def _error(error: SteadyStateError) -> dict[str, Any]:
    position, force = error.worst_position, error.worst_constraint_force
    return {
        "position": error.position.tolist(),
        "constraint_force": error.constraint_force.tolist(),
        "bound": _plain(error.bound),
        "bound_given": error.given,
        "worst_position": position.value,
        "worst_position_cause": position.cause.tolist(),
        "worst_position_effect": position.effect.tolist(),
        "worst_constraint_force": force.value,
        "worst_constraint_force_cause": force.cause.tolist(),
        "worst_constraint_force_effect": force.effect.tolist(),
    }


def _plain(bound: float | Array) -> float | list[float]:
    return bound if isinstance(bound, float) else [float(each) for each in bound]
