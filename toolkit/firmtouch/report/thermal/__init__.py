"""What the report of a thermal study says, section by section: `Study` -> `Document`."""

from firmtouch.report.thermal.document import study_document
from firmtouch.report.thermal.requirements import RequirementRow, binding_lines, requirement_rows
from firmtouch.report.thermal.verdict import study_verdict

__all__ = ["RequirementRow", "binding_lines", "requirement_rows", "study_document", "study_verdict"]
