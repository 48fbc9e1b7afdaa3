"""`design`: what is asked of the feedback."""

from __future__ import annotations

from typing import Annotated, Any, Final, Literal

from pydantic import Field, ValidationInfo, model_validator

from firmtouch.errors import InputError
from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import Checked, declared, quantity_in, read_all, read_pole, refuse
from firmtouch.modelfile.sections.force_feedback import ForceFeedback
from firmtouch.modelfile.sections.region import RegionSpec
from firmtouch.modelfile.sections.section import Section, ShortSection
from firmtouch.modelfile.words import shown

PoleGroups = tuple[tuple[complex, ...], ...]


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


_POLE_SCHEMA: Final[dict[str, Any]] = {"anyOf": [{"type": "number"}, {"type": "string"}]}
_PAIR_SCHEMA: Final[dict[str, Any]] = {"type": "array", "items": _POLE_SCHEMA, "minItems": 2, "maxItems": 2}
Poles = Annotated[
    PoleGroups, Checked(_poles, {"type": "array", "minItems": 1, "items": {"anyOf": [_POLE_SCHEMA, _PAIR_SCHEMA]}})
]


class NormalBlocks(ShortSection):
    """The blocks of C and W that leave the poles alone; `reject` is short for `{policy: reject}`."""

    short_for = "policy"

    policy: Literal["decouple", "reject", "blend", "free"] = Field(
        "decouple",
        description="decouple: no force transient while the position converges; "
        "reject: least force error under constant disturbances; blend: between them; "
        "free: the search chooses them, region designs only",
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

    method: Literal["poles", "region"] = Field(
        "poles",
        description="how the gains are found. poles: from the poles that are asked for; "
        "region: by a search among all gains that satisfy given conditions",
    )
    poles: Poles | None = Field(
        None,
        description="2(n - m) poles in 1/s; a list inside the list pairs two real ones; for `method: poles`",
    )
    region: RegionSpec | None = Field(None, description="conditions on the loop; for `method: region`")
    force_feedback: ForceFeedback = Field(
        description="G_f: one number, one for each constraint, or a symmetric positive semidefinite matrix; "
        "auto: the largest g I with the margins of `force_path`"
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

    @model_validator(mode="after")
    def _the_method_has_what_it_needs(self) -> DesignSpec:
        if getattr(self, self.method) is None:
            refuse(Problem(f"`method: {self.method}` needs `{self.method}`", at_key=True))
        if self.method == "poles" and self.normal_blocks.policy == "free":
            message = "`free` leaves these blocks to the search of `method: region`; poles need one of the others"
            refuse(Problem(message, path=("normal_blocks", "policy")))
        return self

    @model_validator(mode="after")
    def _force_feedback_within_its_limit(self, info: ValidationInfo) -> DesignSpec:
        if self.force_feedback == "auto":  # it is chosen within the limit
            return self
        limits = (self.region and self.region.force_feedback_limit) or ()
        problems = [
            Problem(
                f"this allows {limit:g} for the constraint `{name}`, and `force_feedback` asks for {row[i]:g}",
                path=("region", "force_feedback_limit", i),
            )
            for i, (name, row, limit) in enumerate(
                zip(declared(info).constraints, self.force_feedback, limits, strict=False)
            )
            if row[i] > limit
        ]
        if problems:
            refuse(*problems)
        return self

    def with_method(self, method: str) -> DesignSpec:
        """Give the same design by another method.

        Raises
        ------
        InputError
            If the file does not hold what that method needs.
        """
        if method not in ("poles", "region"):
            raise InputError(f"there is no method {shown(method)}; there are: poles, region")
        if getattr(self, method) is None:
            raise InputError(f"the file's `design` has no `{method}`, which `--method {method}` needs")
        if method == "poles" and self.normal_blocks.policy == "free":
            raise InputError("the file's `normal_blocks` are `free`, which `--method poles` cannot use")
        return self.model_copy(update={"method": method})
