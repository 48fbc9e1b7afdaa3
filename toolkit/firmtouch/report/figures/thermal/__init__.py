"""The pictures of a thermal report."""

from firmtouch.report.figures.thermal.bode import BodeCurve, BodePanel, bode_picture
from firmtouch.report.figures.thermal.responses import Curve, Panel, responses_picture
from firmtouch.report.figures.thermal.stack import Band, Plane, StackView, draw_stack, stack_picture

__all__ = [
    "Band",
    "BodeCurve",
    "BodePanel",
    "Curve",
    "Panel",
    "Plane",
    "StackView",
    "bode_picture",
    "draw_stack",
    "responses_picture",
    "stack_picture",
]
