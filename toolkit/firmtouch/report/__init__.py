"""A `Design` -> `design.json`, HTML and PDF. Nothing is computed in here."""

from firmtouch.report.contents import design_document
from firmtouch.report.contents.verdict import verdict
from firmtouch.report.design_json import design_as_json
from firmtouch.report.html import render_html
from firmtouch.report.pdf import render_pdf
from firmtouch.report.write import write_files

__all__ = ["design_as_json", "design_document", "render_html", "render_pdf", "verdict", "write_files"]
