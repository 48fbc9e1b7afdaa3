"""A `Design` or a `Study` -> JSON, HTML and PDF. Nothing is computed in here.

Names are loaded when they are first used: the report of a fingertip needs no mechanics, nor that of a robot heat.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import Any

    from firmtouch.report.contents import design_document
    from firmtouch.report.contents.verdict import verdict
    from firmtouch.report.design_json import design_as_json
    from firmtouch.report.html import render_html
    from firmtouch.report.pdf import render_pdf
    from firmtouch.report.thermal_json import study_as_json
    from firmtouch.report.write import write_files

_HOME_OF = {
    "design_as_json": "design_json",
    "design_document": "contents",
    "render_html": "html",
    "render_pdf": "pdf",
    "study_as_json": "thermal_json",
    "verdict": "contents.verdict",
    "write_files": "write",
}

__all__ = [
    "design_as_json",
    "design_document",
    "render_html",
    "render_pdf",
    "study_as_json",
    "verdict",
    "write_files",
]


def __getattr__(name: str) -> Any:  # noqa: ANN401  # whatever the name stands for
    home = _HOME_OF.get(name)
    if home is None:
        raise AttributeError(f"module 'firmtouch.report' has no attribute {name!r}")
    return getattr(importlib.import_module(f"firmtouch.report.{home}"), name)
