"""A `Design` or a thermal `Study` -> JSON, HTML and PDF. Nothing is computed in here.

Names are loaded when they are first used: a thermal report needs nothing of mechanisms, and the other way round.
"""

from __future__ import annotations

import importlib

TYPE_CHECKING = False

if TYPE_CHECKING:
    from typing import Any, Final

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


def __getattr__(name: str) -> Any:  # noqa: ANN401  # whatever the name stands for
    home = _HOME_OF.get(name)
    if home is None:
        raise AttributeError(f"module 'firmtouch.report' has no attribute {name!r}")
    return getattr(importlib.import_module(f"firmtouch.report.{home}"), name)


def __dir__() -> list[str]:
    return __all__
