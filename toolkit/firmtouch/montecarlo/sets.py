"""From how wide sets a study draws: a scenario file's `draw`, or else the model's intervals and bounds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from firmtouch.errors import Diagnostic, ModelFileError
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.modelfile import ModelSpec
from firmtouch.modelfile.scenarios import ScenarioFile
from firmtouch.modelfile.sections.draw import DrawSpec
from firmtouch.regulation import OperatingPoint
from firmtouch.simulation.scenario import Scenario

BESIDE: Final = 0.1
"""Half width of the box of starts by default, in rad or m."""


@dataclass(frozen=True, slots=True)
class Sets:
    """What each run draws, uniformly, around a scenario; zeros (and no parameters) are what is not drawn. All in SI.

    `position` and `velocity` (n) are half widths of boxes around its start, before that is put onto the surface.
    `parameters` are intervals. `disturbance` (n) and `offset` (m) are semi-axes of ellipsoids, `tilt` and `rotation`
    angles in rad: |E| <= tilt |J| and |Omega| <= rotation for R = exp(Omega), in 2-norms.
    """

    position: Array
    velocity: Array
    parameters: dict[str, tuple[float, float]]
    disturbance: Array
    offset: Array
    tilt: float
    rotation: float


def sets_of(op: OperatingPoint, base: Scenario, file: ScenarioFile | None = None) -> Sets:
    """Give the sets that a scenario file's `draw` names, and for all else the model's intervals and bounds.

    A parameter that the scenario sets itself is drawn only if `draw` names it.

    Raises
    ------
    ModelFileError
        If `draw` names a parameter without an interval, and gives none.
    """
    model = op.plant.spec
    spec = DrawSpec() if file is None or file.draw is None else file.draw
    bounds = model.bounds
    rotation = bounds.rotation if spec.rotation is None else spec.rotation
    tilt = bounds.tilt if spec.tilt is None else spec.tilt
    return Sets(
        position=_vector(spec.position, model.coordinates, BESIDE),
        velocity=_vector(spec.velocity, model.coordinates),
        parameters=_parameters(op, base, spec, file),
        disturbance=_vector(bounds.disturbance if spec.disturbance is None else spec.disturbance, model.coordinates),
        offset=_vector(bounds.offset if spec.offset is None else spec.offset, model.constraints),
        tilt=tilt or 0.0,
        rotation=(rotation or 0.0) if op.m > 1 else 0.0,
    )


def _parameters(
    op: OperatingPoint, base: Scenario, spec: DrawSpec, file: ScenarioFile | None
) -> dict[str, tuple[float, float]]:
    model = op.plant.spec
    known = intervals(model)
    if spec.parameters is None:
        set_by_scenario = dict(zip(model.parameters, base.world.p != op.plant.p, strict=True))
        return {name: each for name, each in known.items() if not set_by_scenario[name]}
    missing = [name for name, each in spec.parameters.items() if each is None and name not in known]
    if missing and file is not None:
        place = file.document.place(("draw", "parameters"))
        message = (
            f"`{missing[0]}` has no `interval` in the model; give one here, as in `{{{missing[0]}: [3 kg, 5 kg]}}`"
        )
        raise ModelFileError((Diagnostic(file.document.name, *place, message),))
    return {name: known[name] if each is None else each for name, each in spec.parameters.items()}


def intervals(model: ModelSpec) -> dict[str, tuple[float, float]]:
    """Give all intervals of a model's parameters, in SI."""
    return {
        name: (each.interval[0].value, each.interval[1].value)
        for name, each in model.parameters.items()
        if each.interval is not None
    }


def _vector(values: Mapping[str, float] | None, names: Mapping[str, object], default: float = 0.0) -> Array:
    return frozen(np.full(len(names), default) if values is None else [values[name] for name in names])
