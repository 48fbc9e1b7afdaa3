"""What a report says, section by section: `Design` -> `Document`."""

from firmtouch.report.contents.document import design_document

__all__ = ["design_document"]
