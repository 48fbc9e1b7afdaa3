"""The sections of a design's report, in order."""

from __future__ import annotations

from importlib.metadata import version

from firmtouch.design import Design
from firmtouch.report.contents import checks, errors, gains, head, mechanism, operating_point, poles, positivity
from firmtouch.report.document import Document


def design_document(design: Design) -> Document:
    """Write the report of a design."""
    parts = (head, mechanism, operating_point, gains, poles, positivity, errors, checks)
    model = design.model
    return Document(
        title=model.spec.title,
        subtitle=f"Position and force regulation · model {model.name} · SHA-256 {model.sha256[:12]}…",
        footer=f"firmtouch {version('firmtouch')} · model file SHA-256 {model.sha256}",
        sections=tuple(part.section(design) for part in parts),
    )
