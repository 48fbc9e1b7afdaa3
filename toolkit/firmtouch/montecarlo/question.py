"""What a study asks, as plain data: two studies with the same question have the same runs."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from importlib.metadata import version
from typing import Any, Final

import numpy as np

from firmtouch.modelfile import Expression, ModelFile
from firmtouch.montecarlo.study import Study

LIBRARIES: Final = ("firmtouch", "casadi", "numpy")
"""Another version of these may give other figures."""


def question_of(study: Study, model: ModelFile) -> dict[str, Any]:
    """Give the question of a study, with everything that its runs depend on."""
    loop = study.loop
    op, gains = loop.operating_point, loop.gains
    numbers = (op.q_d, op.lambda_d, gains.W, gains.C, gains.G_f, gains.bias)
    digest = hashlib.sha256(b"".join(np.ascontiguousarray(each).tobytes() for each in numbers)).hexdigest()
    return {
        "seed": study.seed,
        "model": {"name": model.name, "sha256": model.sha256},
        "gains_sha256": digest,
        "scenario": plain(study.base),
        "draw": plain(study.sets),
        "proven": [
            {"level": each.level, "half_width": plain(each.half_width), "whole": each.whole} for each in study.regions
        ],
        "versions": {each: version(each) for each in LIBRARIES},
    }


def plain(value: Any) -> Any:  # noqa: ANN401  # any value, any JSON
    """Give a value of ours as plain data for JSON; what is infinite becomes null."""
    if isinstance(value, Expression):
        return value.text
    if is_dataclass(value) and not isinstance(value, type):
        return {each.name: plain(getattr(value, each.name)) for each in fields(value)}
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, Mapping):
        return {str(name): plain(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [plain(each) for each in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value


def differences(there: Mapping[str, Any], here: Mapping[str, Any], path: str = "") -> Iterator[str]:
    """Say in which entries two questions differ, as `seed (5 there, 1 here)`."""
    for name in {**there, **here}:
        a, b = there.get(name), here.get(name)
        if a == b:
            continue
        where = f"{path}{name}"
        if isinstance(a, Mapping) and isinstance(b, Mapping):
            yield from differences(a, b, f"{where}.")
        elif isinstance(a, str | int | float | None) and isinstance(b, str | int | float | None):
            yield f"{where} ({_short(a)} there, {_short(b)} here)"
        else:
            yield where


def _short(value: object) -> str:
    text = "none" if value is None else str(value)
    return text if len(text) <= 40 else f"{text[:12]}..."
