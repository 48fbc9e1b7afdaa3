"""A `Design` or a thermal `Study` -> JSON, HTML and PDF. Nothing is computed in here.

Names are loaded when they are first used: a thermal report needs nothing of mechanisms, and the other way round.
"""

from __future__ import annotations

from firmtouch.lazy_names import loader

TYPE_CHECKING = False

if TYPE_CHECKING:
    from typing import Final

    from firmtouch.report.contents import design_document
    from firmtouch.report.contents.verdict import verdict
    from firmtouch.report.design_json import design_as_json
    from firmtouch.report.html import render_html
    from firmtouch.report.pdf import render_pdf
    from firmtouch.report.thermal import study_document, study_verdict
    from firmtouch.report.thermal_json import study_as_json
    from firmtouch.report.write import write_files

_HOME_OF: Final = {
    "design_as_json": "design_json",
    "design_document": "contents",
    "render_html": "html",
    "render_pdf": "pdf",
    "study_as_json": "thermal_json",
    "study_document": "thermal",
    "study_verdict": "thermal",
    "verdict": "contents.verdict",
    "write_files": "write",
}

__all__ = [
    "design_as_json",
    "design_document",
    "render_html",
    "render_pdf",
    "study_as_json",
    "study_document",
    "study_verdict",
    "verdict",
    "write_files",
]

__getattr__ = loader(__name__, _HOME_OF)


def __dir__() -> list[str]:
    return __all__
