"""A scenario file's words -> `Scenario`, for a finished closed loop."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

import numpy as np

from firmtouch.errors import Diagnostic, ModelFileError
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.modelfile.scenarios import ScenarioFile
from firmtouch.modelfile.sections.scenario import DisturbanceSpec, NoiseSpec, ScenarioSpec, StartSpec, SurfaceSpec
from firmtouch.regulation import ClosedLoop, OperatingPoint
from firmtouch.regulation.controllers import Controller, energy_gradient
from firmtouch.regulation.force_loop import ForcePath, force_path_of
from firmtouch.regulation.force_loop.path import as_force_path
from firmtouch.simulation.scenario import Feedback, Noise, Scenario, Start
from firmtouch.simulation.world import Disturbance, World

SETTLED: Final = 16.0
"""How long is simulated by default, in units of 1/|slowest decay rate|: four times what settling to 2 % takes."""
BALANCED: Final = 1e-6
"""How far Pd_q(q_d) may be from f_d, relative to it: file values are rounded."""


def scenarios_of(file: ScenarioFile, loop: ClosedLoop) -> tuple[Scenario, ...]:
    """Make all scenarios of a file.

    Raises
    ------
    ModelFileError
        For what only the finished loop can tell: noise without samples, a P_d that does not hold lambda_d.
    """
    mistakes: list[Diagnostic] = []
    found = []
    for name, spec in file.scenarios.items():
        for path, message in _mistakes(spec, loop):
            place = file.document.place(("scenarios", name, *path), key=True)
            mistakes.append(Diagnostic(file.document.name, *place, message))
        found.append((name, spec))
    if mistakes:
        raise ModelFileError(tuple(mistakes))
    return tuple(scenario_of(name, spec, loop) for name, spec in found)


def scenario_of(name: str, spec: ScenarioSpec, loop: ClosedLoop) -> Scenario:
    """Make one scenario."""
    op = loop.operating_point
    limits = drive_limits(op) if spec.limits else None
    feedback = Feedback(Controller(spec.controller), spec.P_d, _path(spec, op), limits, _noise(spec.noise, op))
    return Scenario(
        name=name,
        title=spec.title or name.replace("_", " "),
        feedback=feedback,
        start=_start(spec.start, op),
        world=_world(spec, op),
        duration=spec.duration or usual_duration(loop),
    )


def usual_duration(loop: ClosedLoop) -> float:
    """Give four times the time that the loop needs to settle, to two digits, in s."""
    slowest = min(abs(each.real) for each in loop.poles.reduced)
    return float(f"{SETTLED / max(slowest, 1e-3):.2g}")


def drive_limits(op: OperatingPoint) -> Array | None:
    """Give the efforts of the model's drives, n (infinite where the file has none); None if it has none at all."""
    efforts = [each.effort for each in op.plant.spec.coordinates.values()]
    if all(each is None for each in efforts):
        return None
    return frozen([np.inf if each is None else each.value for each in efforts])


def _mistakes(spec: ScenarioSpec, loop: ClosedLoop) -> Iterable[tuple[tuple[str, ...], str]]:
    op = loop.operating_point
    if spec.noise is not None and not _path(spec, op).sample:
        yield ("noise",), "noise is drawn once a sample, and nothing is sampled here; give `force_path` a `sample`"
    if spec.P_d is not None:
        off = energy_gradient(op, spec.P_d) - op.f_d
        if np.linalg.norm(off) > BALANCED * (1 + np.linalg.norm(op.f_d)):
            yield (
                ("P_d",),
                (
                    f"its gradient at q_d must be f_d = J^T lambda_d, and is off by {np.max(np.abs(off)):.3g} (in SI): "
                    "with it, (q_d, lambda_d) is no equilibrium"
                ),
            )


def _path(spec: ScenarioSpec, op: OperatingPoint) -> ForcePath:
    if spec.ideal_force_path:
        return ForcePath()
    if spec.force_path is not None:
        return as_force_path(spec.force_path)
    return force_path_of(op.plant.spec) or ForcePath()


def _start(spec: StartSpec, op: OperatingPoint) -> Start:
    names = op.plant.spec.coordinates
    q = op.q_d + _vector(spec.beside_q_d, names) if spec.q is None else _vector(spec.q, names)
    return Start(frozen(q), _vector(spec.velocity, names))


def _world(spec: ScenarioSpec, op: OperatingPoint) -> World:
    model = op.plant.spec
    p = np.array(op.plant.p)
    for name, value in (spec.parameters or {}).items():
        p[list(model.parameters).index(name)] = value
    return World(
        p=frozen(p),
        Delta=_vector(spec.surface.offset, model.constraints),
        R=_rotation(spec.surface, op),
        E=frozen([_vector((spec.surface.tilt or {}).get(name), model.coordinates) for name in model.constraints]),
        bias_error=_vector(spec.gravity_error, model.coordinates),
        disturbances=tuple(_disturbance(each, op) for each in spec.disturbances),
    )


def _rotation(spec: SurfaceSpec, op: OperatingPoint) -> Array:
    R = np.eye(op.m)
    if spec.rotation is not None:
        names = list(op.plant.spec.constraints)
        i, j = (names.index(each) for each in spec.rotation.constraints)
        c, s = np.cos(spec.rotation.angle), np.sin(spec.rotation.angle)
        R[np.ix_([i, j], [i, j])] = [[c, -s], [s, c]]
    return frozen(R)


def _disturbance(spec: DisturbanceSpec, op: OperatingPoint) -> Disturbance:
    return Disturbance(
        d=_vector(spec.force, op.plant.spec.coordinates),
        start=spec.from_,
        end=np.inf if spec.until is None else spec.until,
        omega=spec.frequency or 0.0,
        phase=spec.phase or 0.0,
    )


def _noise(spec: NoiseSpec | None, op: OperatingPoint) -> Noise | None:
    if spec is None:
        return None
    model = op.plant.spec
    return Noise(
        _vector(spec.position, model.coordinates),
        _vector(spec.velocity, model.coordinates),
        _vector(spec.force, model.constraints),
        spec.seed,
    )


def _vector(values: Mapping[str, float] | None, names: Iterable[str]) -> Array:
    """Put values in the order of the names, with zeros for those that are missing."""
    return frozen([(values or {}).get(name, 0.0) for name in names])
