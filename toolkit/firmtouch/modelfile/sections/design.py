"""`design`: what is asked of the feedback."""

from __future__ import annotations

import math
from typing import Annotated, Any, Final, Literal

from pydantic import Field, ValidationInfo, model_validator

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import Checked, declared, quantity_in, read_all, read_pole, refuse
from firmtouch.modelfile.sections.section import Section, ShortSection

PoleGroups = tuple[tuple[complex, ...], ...]
STRONGEST: Final = 1e6


def _poles(raw: object, info: ValidationInfo) -> PoleGroups:
    if not isinstance(raw, list) or not raw:
        refuse(Problem("a list of poles was expected, such as `[-4, -5]` or `[-4+3j, -4-3j]`, in 1/s"))
    groups = tuple(read_all(enumerate(raw), lambda _, each: _pole_group(each)).values())
    flat = [pole for group in groups for pole in group]
    problems = [
        Problem(f"the pole {pole:.6g} has no conjugate; complex poles come in pairs")
        for pole in dict.fromkeys(flat)
        if pole.imag and flat.count(pole) != flat.count(pole.conjugate())
    ]
    known = declared(info)
    n, m = len(known.coordinates), len(known.constraints)
    if len(flat) != 2 * (n - m) and n > m:
        problems.append(
            Problem(f"{len(flat)} poles; {n} coordinates and {m} constraints leave 2(n - m) = {2 * (n - m)}")
        )
    if problems:
        refuse(*problems)
    return groups


def _pole_group(raw: object) -> tuple[complex, ...]:
    if not isinstance(raw, list):
        return (read_pole(raw),)
    if len(raw) != 2:
        refuse(Problem(f"a group of {len(raw)}; poles are grouped in twos, or not at all"))
    pair = tuple(read_all(enumerate(raw), lambda _, each: read_pole(each)).values())
    if (pair[0].imag or pair[1].imag) and pair[0] != pair[1].conjugate():
        refuse(Problem("a group of two poles is a conjugate pair, or both are real"))
    return pair


def _force_feedback(raw: object, info: ValidationInfo) -> tuple[tuple[float, ...], ...]:
    m = len(declared(info).constraints)
    if not isinstance(raw, list):
        return _diagonal([_gain(raw)] * m)
    if len(raw) != m:
        refuse(Problem(f"{len(raw)} force-feedback gains for {m} constraint{'s' * (m != 1)}"))
    if not any(isinstance(row, list) for row in raw):
        return _diagonal([_gain(each, i) for i, each in enumerate(raw)])
    matrix = tuple(_row(row, i, m) for i, row in enumerate(raw))
    for i, row in enumerate(matrix):
        for j in range(i):
            if row[j] != matrix[j][i]:
                refuse(Problem("G_f must be symmetric", path=(i, j)))
            if row[j] ** 2 > row[i] * matrix[j][j]:
                refuse(Problem("G_f must be positive semidefinite; this entry is too large", path=(i, j)))
    return matrix


def _row(raw: object, i: int, m: int) -> tuple[float, ...]:
    if not isinstance(raw, list) or len(raw) != m:
        refuse(Problem(f"G_f is {m} x {m}: a list of {m} numbers was expected", path=(i,)))
    return tuple(_gain(each, i, j, least=0 if i == j else -STRONGEST) for j, each in enumerate(raw))


def _diagonal(gains: list[float]) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(gain if i == j else 0.0 for j in range(len(gains))) for i, gain in enumerate(gains))


def _gain(raw: object, *path: int, least: float = 0.0) -> float:
    if isinstance(raw, bool) or not isinstance(raw, int | float) or not math.isfinite(raw):
        refuse(Problem("a plain number was expected: force-feedback gains have no unit", path=path))
    if not least <= raw <= STRONGEST:
        refuse(Problem(f"a force-feedback gain of {raw:g}; it must lie between {least:g} and {STRONGEST:g}", path=path))
    return float(raw)


_POLE_SCHEMA: Final[dict[str, Any]] = {"anyOf": [{"type": "number"}, {"type": "string"}]}
_PAIR_SCHEMA: Final[dict[str, Any]] = {"type": "array", "items": _POLE_SCHEMA, "minItems": 2, "maxItems": 2}
_GAINS_SCHEMA: Final[dict[str, Any]] = {
    "type": "array",
    "items": {"anyOf": [{"type": "number"}, {"type": "array", "items": {"type": "number"}}]},
}
Poles = Annotated[
    PoleGroups, Checked(_poles, {"type": "array", "minItems": 1, "items": {"anyOf": [_POLE_SCHEMA, _PAIR_SCHEMA]}})
]
ForceFeedback = Annotated[
    tuple[tuple[float, ...], ...], Checked(_force_feedback, {"anyOf": [{"type": "number"}, _GAINS_SCHEMA]})
]


class NormalBlocks(ShortSection):
    """The blocks of C and W that leave the poles alone; `reject` is short for `{policy: reject}`."""

    short_for = "policy"

    policy: Literal["decouple", "reject", "blend"] = Field(
        "decouple",
        description="decouple: no force transient while the position converges; "
        "reject: least force error under constant disturbances; blend: between them",
    )
    weight: Annotated[float, quantity_in("1", least=0, most=1)] | None = Field(
        None, description="for `blend`: 1 is decouple, 0 is reject"
    )
    margin: Annotated[float, quantity_in("1", least=1e-6, most=0.999)] = Field(
        0.5, description="least eigenvalue asked for of C, K and W, as a part of that of its tangent block"
    )

    @model_validator(mode="after")
    def _weight_belongs_to_blend(self) -> NormalBlocks:
        if (self.weight is not None) != (self.policy == "blend"):
            refuse(Problem("`weight` belongs to `policy: blend`, and that policy needs it"))
        return self


class DesignSpec(Section):
    """How the gains are found, and on which level they must hold."""

    method: Literal["poles"] = Field("poles", description="how the gains are found")
    poles: Poles = Field(description="2(n - m) poles in 1/s; a list inside the list pairs two real ones")
    force_feedback: ForceFeedback = Field(
        description="G_f: one number, one for each constraint, or a symmetric positive semidefinite matrix"
    )
    normal_blocks: NormalBlocks = NormalBlocks()
    level: Literal["full", "tangent"] = Field(
        "full",
        description="full: C, K and W positive definite (the paper's conditions); "
        "tangent: C and K on the directions that the constraints leave free",
    )
    modes: Literal["least_gain", "plant"] = Field(
        "least_gain",
        description="which mode shapes get the poles: those that need the least W, or the plant's own",
    )
