"""`certificate.json`, schema `firmtouch.certificate/1`: numbers as hexadecimal floats, sealed by a digest."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from typing import Annotated, Any, Final, Literal

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, PlainSerializer, ValidationError

from firmtouch.certificate.certificate import Certificate
from firmtouch.certificate.question import Claim
from firmtouch.certificate.witness import Multipliers, Witness
from firmtouch.errors import InputError
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation import Gains

SCHEMA: Final = "firmtouch.certificate/1"
LONGEST: Final = 16_000_000
"""Bytes; a longer file is no certificate."""


class NotACertificateError(InputError):
    """The file is not a certificate of this schema."""


def _read_hex(raw: object) -> float:
    if not isinstance(raw, str):
        raise ValueError("a hexadecimal float was expected, as in `0x1.8p+1`")  # noqa: TRY004  # pydantic's way
    try:
        value = float.fromhex(raw)
    except OverflowError as error:
        raise ValueError("too large for a binary64 number") from error
    if not math.isfinite(value):
        raise ValueError("a finite number was expected")
    if value.hex() != raw:
        raise ValueError(f"a hexadecimal float was expected in its one way of writing it, `{value.hex()}`")
    return value


Number = Annotated[float, BeforeValidator(_read_hex), PlainSerializer(lambda value: value.hex())]
Rows = list[list[Number]]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class ModelPart(_Part):
    """Which model file, and by which method the gains were found."""

    name: str
    sha256: str
    method: Literal["poles", "region"]


class PointPart(_Part):
    """The regulation point."""

    q_d: list[Number]
    lambda_d: list[Number]


class GainsPart(_Part):
    """W, C, G_f and the constant force."""

    W: Rows
    C: Rows
    G_f: Rows
    bias: list[Number]


class MultiplierPart(_Part):
    """F and P of one edge."""

    F: Rows
    P: list[Rows]
    basis: Rows
    unit: Number


class WitnessPart(_Part):
    """What the proof of the region begins from."""

    epsilon: Number | None
    multipliers: dict[str, MultiplierPart]


class ClaimPart(_Part):
    """One claim; `figure` is null where nothing is proven."""

    name: str
    statement: str
    scope: str
    relation: Literal[">", "<"]
    asked: Number | None
    figure: Number | None
    unit: str
    route: str
    verdict: Literal["proven", "refuted", "undecided"]
    bits: int


class CertificateFile(_Part):
    """A whole certificate as it stands in a file."""

    schema_: Literal["firmtouch.certificate/1"] = Field(alias="schema")
    firmtouch: str
    model: ModelPart
    design_sha256: str
    operating_point: PointPart
    gains: GainsPart
    witness: WitnessPart
    certified: bool
    claims: list[ClaimPart]
    digest: str

    def sealed(self) -> bool:
        """Tell whether the digest fits the rest."""
        return self.digest == _digest(self.model_dump(mode="json", by_alias=True))


def certificate_as_json(
    certificate: Certificate, *, model: ModelPart, design_sha256: str, version: str
) -> dict[str, Any]:
    """Give a certificate as plain data for JSON."""
    subject = certificate.subject
    gains, op, witness = subject.gains, subject.op, subject.witness
    data: dict[str, Any] = {
        "schema": SCHEMA,
        "firmtouch": version,
        "model": model.model_dump(mode="json"),
        "design_sha256": design_sha256,
        "operating_point": {"q_d": _hex(op.q_d), "lambda_d": _hex(op.lambda_d)},
        "gains": {name: _hex(getattr(gains, name)) for name in ("W", "C", "G_f", "bias")},
        "witness": {
            "epsilon": None if witness.epsilon is None else witness.epsilon.hex(),
            "multipliers": {
                name: {
                    "F": _hex(each.F),
                    "P": [_hex(P) for P in each.P],
                    "basis": _hex(each.basis),
                    "unit": each.unit.hex(),
                }
                for name, each in witness.multipliers.items()
            },
        },
        "certified": certificate.certified,
        "claims": [_claim(each) for each in certificate.claims],
    }
    return data | {"digest": _digest(data)}


def read_certificate(content: bytes, name: str) -> CertificateFile:
    """Read a file's content.

    Raises
    ------
    NotACertificateError
        If it is no certificate: other text, cut off, of a foreign schema, or with values of the wrong kind.
    """
    if len(content) > LONGEST:
        raise NotACertificateError(f"{name}: no certificate: longer than {LONGEST} bytes")
    try:
        data = json.loads(content, parse_constant=_refuse_constant, object_pairs_hook=_once)
    except (ValueError, RecursionError) as error:
        where = f"{name}:{error.lineno}:{error.colno}" if isinstance(error, json.JSONDecodeError) else name
        said = error.msg if isinstance(error, json.JSONDecodeError) else str(error) or "nested too deeply"
        raise NotACertificateError(f"{where}: no certificate: {said}") from error
    if not isinstance(data, dict) or data.get("schema") != SCHEMA:
        found = data.get("schema") if isinstance(data, dict) else None
        raise NotACertificateError(f"{name}: no certificate: its schema is {found!r}, and `{SCHEMA}` was expected")
    try:
        return CertificateFile.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(each) for each in first["loc"])
        raise NotACertificateError(f"{name}: no certificate: `{where}`: {first['msg']}") from error


def gains_in(file: CertificateFile) -> Gains:
    """Give the gains of a file.

    Raises
    ------
    NotACertificateError
        If rows differ in length.
    """
    part = file.gains
    return Gains(_matrix(part.W), _matrix(part.C), _matrix(part.G_f), frozen(part.bias))


def witness_in(file: CertificateFile) -> Witness:
    """Give what a file's proof of the region begins from."""
    multipliers = {
        name: Multipliers(_matrix(each.F), tuple(_matrix(P) for P in each.P), _matrix(each.basis), each.unit)
        for name, each in file.witness.multipliers.items()
    }
    return Witness(file.witness.epsilon, multipliers)


def _claim(claim: Claim) -> dict[str, Any]:
    return {
        "name": claim.name,
        "statement": claim.words,
        "scope": claim.scope.value,
        "relation": claim.relation,
        "asked": None if claim.asked is None else float(claim.asked).hex(),
        "figure": float(claim.figure).hex() if math.isfinite(claim.figure) else None,
        "unit": claim.unit,
        "route": claim.route,
        "verdict": claim.verdict.value,
        "bits": claim.bits,
    }


def _hex(values: Array) -> Any:  # noqa: ANN401  # nested lists
    return [_hex(each) for each in values] if np.ndim(values) else float(values).hex()


def _matrix(rows: Rows) -> Array:
    if len({len(row) for row in rows}) > 1:
        raise NotACertificateError("no certificate: a matrix whose rows differ in length")
    return frozen(rows)


def _digest(data: Mapping[str, Any]) -> str:
    """Hash everything but the digest itself, in one fixed way of writing it."""
    rest = {name: value for name, value in data.items() if name != "digest"}
    return hashlib.sha256(json.dumps(rest, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def _refuse_constant(constant: str) -> None:
    raise ValueError(f"{constant} is no number here")


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        raise ValueError("a key that stands twice")
    return found
