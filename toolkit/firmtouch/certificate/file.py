"""`certificate.json`, schema `firmtouch.certificate/1`: numbers as hexadecimal floats, sealed by a digest."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from typing import Any, Final, Literal

from pydantic import Field, ValidationError

from firmtouch.certificate.attraction.finding import Finding
from firmtouch.certificate.certificate import Certificate
from firmtouch.certificate.numbers import NotACertificateError, Number, Part, Rows, hexadecimal, matrix
from firmtouch.certificate.question import Claim
from firmtouch.certificate.surroundings_file import SurroundingsPart, surroundings_as_json
from firmtouch.certificate.witness import Multipliers, Witness
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation import Gains

SCHEMA: Final = "firmtouch.certificate/1"
LONGEST: Final = 16_000_000
"""Bytes; a longer file is no certificate."""


class ModelPart(Part):
    """Which model file, and by which method the gains were found."""

    name: str
    sha256: str
    method: Literal["poles", "region"]


class PointPart(Part):
    """The regulation point."""

    q_d: list[Number]
    lambda_d: list[Number]


class GainsPart(Part):
    """W, C, G_f and the constant force."""

    W: Rows
    C: Rows
    G_f: Rows
    bias: list[Number]


class MultiplierPart(Part):
    """F and P of one edge."""

    F: Rows
    P: list[Rows]
    basis: Rows
    unit: Number


class WitnessPart(Part):
    """What the proof of the region begins from."""

    epsilon: Number | None
    multipliers: dict[str, MultiplierPart]


class ClaimPart(Part):
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


class CertificateFile(Part):
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
    surroundings: SurroundingsPart | None
    digest: str

    def sealed(self) -> bool:
        """Tell whether the digest fits the rest."""
        return self.digest == _digest(self.model_dump(mode="json", by_alias=True))


def certificate_as_json(
    certificate: Certificate,
    *,
    model: ModelPart,
    design_sha256: str,
    version: str,
    finding: Finding | None = None,
) -> dict[str, Any]:
    """Give a certificate as plain data for JSON; `finding` is what was proven about the region of attraction."""
    subject = certificate.subject
    gains, op, witness = subject.gains, subject.op, subject.witness
    data: dict[str, Any] = {
        "schema": SCHEMA,
        "firmtouch": version,
        "model": model.model_dump(mode="json"),
        "design_sha256": design_sha256,
        "operating_point": {"q_d": hexadecimal(op.q_d), "lambda_d": hexadecimal(op.lambda_d)},
        "gains": {name: hexadecimal(getattr(gains, name)) for name in ("W", "C", "G_f", "bias")},
        "witness": {
            "epsilon": None if witness.epsilon is None else witness.epsilon.hex(),
            "multipliers": {
                name: {
                    "F": hexadecimal(each.F),
                    "P": [hexadecimal(P) for P in each.P],
                    "basis": hexadecimal(each.basis),
                    "unit": each.unit.hex(),
                }
                for name, each in witness.multipliers.items()
            },
        },
        "certified": certificate.certified,
        "claims": [_claim(each) for each in certificate.claims],
        "surroundings": None if finding is None else surroundings_as_json(finding),
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
    return Gains(matrix(part.W), matrix(part.C), matrix(part.G_f), frozen(part.bias))


def witness_in(file: CertificateFile) -> Witness:
    """Give what a file's proof of the region begins from."""
    multipliers = {
        name: Multipliers(matrix(each.F), tuple(matrix(P) for P in each.P), matrix(each.basis), each.unit)
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
