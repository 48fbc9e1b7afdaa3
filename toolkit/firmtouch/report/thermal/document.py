"""The sections of a thermal study's report, in order."""

from __future__ import annotations

from importlib.metadata import version

from firmtouch.report.document import Document
from firmtouch.report.thermal import (
    frequency,
    head,
    heat,
    method,
    neighbours,
    parts,
    requirements,
    responses,
    search,
    sensor,
    telling,
    tolerances,
)
from firmtouch.thermal.study import Study


def study_document(study: Study) -> Document:
    """Write the report of a study."""
    analysis = study.analysis
    sections = (
        head.section(study),
        requirements.section(analysis),
        requirements.binding_section(analysis),
        sensor.section(analysis),
        responses.section(analysis),
        frequency.section(analysis),
        telling.section(analysis),
        neighbours.section(analysis),
        heat.section(analysis),
        tolerances.section(analysis),
        search.section(study),
        parts.section(analysis),
        method.section(analysis),
    )
    file = analysis.file
    return Document(
        title=analysis.spec.title,
        subtitle=f"Thermal touch sensor · model {file.name} · SHA-256 {file.sha256[:12]}…",
        footer=f"firmtouch {version('firmtouch')} · sensor file SHA-256 {file.sha256}",
        sections=tuple(each for each in sections if each is not None),
    )
