"""The checker that trusts nobody: a certificate's claims, proven again from the model file and the gains alone."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from firmtouch.certificate.certificate import questions_of
from firmtouch.certificate.decision import Verdict
from firmtouch.certificate.file import CertificateFile, ClaimPart, gains_in, witness_in
from firmtouch.certificate.question import Question, confirm
from firmtouch.certificate.subject import Subject, subject_of
from firmtouch.certificate.surroundings_file import disproven
from firmtouch.mechanics import derive_plant
from firmtouch.mechanics.arrays import frozen
from firmtouch.modelfile import ModelFile
from firmtouch.regulation import Gains, OperatingPoint, close_loop, find_operating_point
from firmtouch.regulation.operating_point import operating_point_at
from firmtouch.regulation.projection import Projection

SAME: Final = 1e-9
"""How far q_d and a lambda_d that is computed may lie from what this machine finds, relatively."""


@dataclass(frozen=True, slots=True)
class Verification:
    """What was proven again, and everything in which the certificate differs from what can be proven."""

    proven: tuple[str, ...]
    differences: tuple[str, ...]

    @property
    def holds(self) -> bool:
        """Tell whether all that the certificate says is true."""
        return not self.differences


def verify(file: CertificateFile, model: ModelFile, design: bytes | None = None) -> Verification:
    """Prove all claims again; `design` is the content of the `design.json` beside the certificate, if there is one.

    Raises
    ------
    InputError
        If the model file cannot be used by the certificate's method.
    NoDesignError
        If the model has no regulation point.
    """
    differences = [*_identity(file, model, design)]
    own = find_operating_point(derive_plant(model.with_method(file.model.method).spec))
    gains = gains_in(file)
    shapes = [*_shapes(file, gains, own)]
    if shapes:
        return Verification((), (*differences, *shapes))
    elsewhere = [*_point(file, own)]
    if elsewhere:
        return Verification((), (*differences, *elsewhere))
    op = operating_point_at(
        own.plant, Projection(frozen(file.operating_point.q_d), own.residual, own.moved),
        frozen(file.operating_point.lambda_d),
    )  # fmt: skip
    subject = subject_of(op, gains, witness_in(file))
    try:
        with np.errstate(all="ignore"):  # of gains that are no gains
            proven, failed = _claims(file, subject)
            around = [] if file.surroundings is None else [*disproven(file.surroundings, close_loop(op, gains))]
    except (np.linalg.LinAlgError, OverflowError) as error:
        return Verification((), (*differences, f"the gains are no gains: {error}"))
    if file.surroundings is not None and not around:
        proven.append("region of attraction")
    return Verification(tuple(proven), (*differences, *failed, *around))


def _identity(file: CertificateFile, model: ModelFile, design: bytes | None) -> Iterator[str]:
    if not file.sealed():
        yield "the digest does not fit: the certificate was changed after it was written"
    if file.model.sha256 != model.sha256:
        told, found = file.model.sha256[:12], model.sha256[:12]
        yield f"it was made for another model file (SHA-256 {told}…, this one has {found}…)"
    if design is None:
        return
    if hashlib.sha256(design).hexdigest() != file.design_sha256:
        yield "the design.json beside it is not the one it was made with"
    if _gains_of(design) != {name: getattr(file.gains, name) for name in ("W", "C", "G_f", "bias")}:
        yield "the gains in the design.json beside it are not those that are certified"


def _gains_of(design: bytes) -> Any:  # noqa: ANN401  # whatever stands there
    try:
        return json.loads(design)["gains"]
    except (ValueError, KeyError, TypeError, RecursionError):
        return None


def _shapes(file: CertificateFile, gains: Gains, op: OperatingPoint) -> Iterator[str]:
    n, m = op.n, op.m
    wanted = {"W": (n, n), "C": (n, n), "G_f": (m, m), "bias": (n,)}
    for name, shape in wanted.items():
        if getattr(gains, name).shape != shape:
            yield f"{name} does not fit a model with {n} coordinates and {m} constraints"
    for name, size in (("q_d", n), ("lambda_d", m)):
        if len(getattr(file.operating_point, name)) != size:
            yield f"{name} does not fit a model with {n} coordinates and {m} constraints"
    for name, each in witness_in(file).multipliers.items():
        t = n - m
        if each.F.shape != (t, 3 * t) or each.basis.shape != (n, t) or {P.shape for P in each.P} != {(2 * t, 2 * t)}:
            yield f"the multipliers of the {name} do not fit this model"


def _point(file: CertificateFile, own: OperatingPoint) -> Iterator[str]:
    """Compare the regulation point with the one that the model file asks for."""
    for name in ("q_d", "lambda_d"):
        told, found = np.array(getattr(file.operating_point, name)), getattr(own, name)
        if np.any(np.abs(told - found) > SAME * (1 + np.abs(found))):
            yield f"{name} is not what the model file asks for"
    given = own.plant.spec.operating_point.lambda_d
    if given is not None and file.operating_point.lambda_d != [given[name] for name in own.plant.spec.constraints]:
        yield "lambda_d is not the one in the model file"


def _claims(file: CertificateFile, subject: Subject) -> tuple[list[str], list[str]]:
    """Hold the file's claims against the questions that the model file poses, in both directions."""
    told = {each.name: each for each in file.claims}
    proven, differences = list[str](), list[str]()
    if len(told) != len(file.claims):
        differences.append("a claim stands twice")
    for question in questions_of(subject):
        claim = told.pop(question.name, None)
        said = _against(question, claim)
        if said is None:
            proven.append(question.name)
        else:
            differences.append(f"{question.name}: {said}")
    differences += [f"{name}: the model file asks for no such claim" for name in told]
    if not file.certified:
        differences.append("the certificate itself says that not every claim was proven")
    return proven, differences


def _against(question: Question, claim: ClaimPart | None) -> str | None:
    """Say in what a claim differs from what is true; nothing if it is proven once more."""
    if claim is None:
        return "the claim is missing"
    told = (claim.statement, claim.scope, claim.relation, claim.asked, claim.unit, claim.route)
    asked = (
        question.words, question.scope.value, question.relation, question.asked, question.unit, question.route
    )  # fmt: skip
    if told != asked:
        changed = [f"{b!r} is told as {a!r}" for a, b in zip(told, asked, strict=True) if a != b]
        return f"the claim was changed: {'; '.join(changed)}"
    if claim.verdict != Verdict.PROVEN.value or claim.figure is None:
        return f"the certificate calls it {claim.verdict}"
    if question.asked is not None and (claim.figure - question.asked) * (1 if claim.relation == ">" else -1) < 0:
        return "its figure is worse than what is asked"
    verdict = confirm(question, claim.figure)
    return None if verdict is Verdict.PROVEN else f"the figure {claim.figure:.6g} is {verdict.value}, not proven"
