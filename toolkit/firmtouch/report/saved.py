"""`design.json` -> the model and the closed loop that it was written for: the way back of `design_json`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Final

import numpy as np
from pydantic import BaseModel, Field, ValidationError

from firmtouch.errors import InputError
from firmtouch.mechanics import Array, derive_plant
from firmtouch.mechanics.arrays import frozen
from firmtouch.modelfile import ModelFile, parse_model
from firmtouch.modelfile.files import kept
from firmtouch.regulation import ClosedLoop, Gains, close_loop
from firmtouch.regulation.operating_point import operating_point_at
from firmtouch.regulation.projection import ON_SURFACE, Projection
from firmtouch.report.design_json import SCHEMA

LONGEST: Final = 16_000_000
"""Bytes; a longer file is no design."""
LARGEST: Final = 1e15
"""The largest gain, in SI, as in model files."""
ROUNDING: Final = 1e-12
Number = Annotated[float, Field(strict=False, allow_inf_nan=False)]
Rows = list[list[Number]]


class _Model(BaseModel):
    name: str
    source: str
    files: dict[str, str] = {}


class _Point(BaseModel):
    q_d: list[Number]
    lambda_d: list[Number]


class _Gains(BaseModel):
    W: Rows
    C: Rows
    G_f: Rows
    bias: list[Number]


class _Saved(BaseModel):
    """What is read of a design; the rest follows from it."""

    model: _Model
    operating_point: _Point
    gains: _Gains


def read_design(path: Path) -> tuple[ModelFile, ClosedLoop]:
    """Read a design.json, and derive its mechanics again from the model's text that it holds.

    Raises
    ------
    InputError
        If it is no design, or its numbers do not fit its model.
    ModelFileError
        If the model in it has mistakes.
    """
    saved = _read(path)
    files = {name: text.encode("utf-8", "surrogateescape") for name, text in saved.model.files.items()}
    source, place = saved.model.source.encode(), f"{path}:model.source"
    model = parse_model(source, name=saved.model.name, file=place, attached=kept(files))
    n, m, gains = model.spec.n, model.spec.m, saved.gains
    q_d = _shaped(saved.operating_point.q_d, (n,), "operating_point.q_d", path)
    lambda_d = _shaped(saved.operating_point.lambda_d, (m,), "operating_point.lambda_d", path)
    shapes = {"W": (n, n), "C": (n, n), "G_f": (m, m), "bias": (n,)}
    found = {name: _shaped(getattr(gains, name), shape, f"gains.{name}", path) for name, shape in shapes.items()}
    _check_gains(found, path)
    plant = derive_plant(model.spec)
    missed = float(np.max(np.abs(plant.Phi(q_d))))
    if not missed <= 1e3 * ON_SURFACE * max(1.0, float(np.max(np.abs(q_d)))):
        raise InputError(
            f"{path}: q_d misses the constraints by {missed:.3g}; this file was changed, or is not finished"
        )
    op = operating_point_at(plant, Projection(q_d, missed, 0.0), lambda_d)
    return model, close_loop(op, Gains(**found))


def _read(path: Path) -> _Saved:
    try:
        with path.open("rb") as file:
            content = file.read(LONGEST + 1)
        data = json.loads(content if len(content) <= LONGEST else b"too long")
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: no design.json: {error}") from error
    schema = data.get("schema") if isinstance(data, dict) else None
    if schema != SCHEMA:
        raise InputError(f"{path}: no design.json: its schema is {schema!r}, and `{SCHEMA}` was expected")
    if isinstance(data.get("model"), dict) and "source" not in data["model"]:
        raise InputError(
            f"{path}: `model.source`, the model's text, is missing; `firmtouch design MODEL` writes a file that has it"
        )
    try:
        return _Saved.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        raise InputError(f"{path}: no design.json: `{'.'.join(map(str, first['loc']))}`: {first['msg']}") from error


def _check_gains(gains: dict[str, Array], path: Path) -> None:
    """Refuse gains that no design has: the theory is one of symmetric W, C and G_f, and of G_f >= 0."""
    for name, value in gains.items():
        if not np.max(np.abs(value)) <= LARGEST:
            raise InputError(f"{path}: `gains.{name}` has entries beyond {LARGEST:g}")
        if name != "bias" and not np.array_equal(value, value.T):
            raise InputError(f"{path}: `gains.{name}` must be symmetric")
    least = float(np.linalg.eigvalsh(gains["G_f"])[0])
    if least < -ROUNDING * float(np.max(np.abs(gains["G_f"]))):
        raise InputError(f"{path}: `gains.G_f` must not be negative, and has the eigenvalue {least:.3g}")


def _shaped(values: list[float] | Rows, shape: tuple[int, ...], name: str, path: Path) -> Array:
    """Give an array of the shape that the model asks for."""
    ragged = len(shape) == 2 and len({len(row) for row in values if isinstance(row, list)}) > 1
    array = None if ragged else frozen(values)
    if array is None or array.shape != shape:
        raise InputError(f"{path}: `{name}` must have the shape {shape}, as the model asks")
    return array
