"""The sections of a design's report, in order."""

from __future__ import annotations

from importlib.metadata import version

from firmtouch.design import Design
from firmtouch.report.contents import (
    attraction,
    certificate,
    checks,
    errors,
    force_loop,
    gains,
    head,
    margins,
    mechanism,
    operating_point,
    poles,
    positivity,
    simulation,
    specification,
    uncertainty,
)
from firmtouch.report.document import Document


def design_document(design: Design) -> Document:
    """Write the report of a design."""
    sections = (
        head.section(design),
        mechanism.section(design),
        operating_point.section(design),
        specification.section(design),
        gains.section(design),
        poles.section(design),
        positivity.section(design),
        uncertainty.section(design),
        margins.section(design),
        force_loop.section(design),
        errors.section(design),
        simulation.section(design),
        certificate.section(design),
        attraction.section(design),
        checks.section(design),
    )
    model = design.model
    return Document(
        title=model.spec.title,
        subtitle=f"Position and force regulation · model {model.name} · SHA-256 {model.sha256[:12]}…",
        footer=f"firmtouch {version('firmtouch')} · model file SHA-256 {model.sha256}",
        sections=tuple(each for each in sections if each is not None),
    )
