"""The report's pictures, each a function from values to SVG."""

from firmtouch.report.figures.eigenvalues import eigenvalue_chart
from firmtouch.report.figures.force_loop import nyquist_picture, stiffness_picture
from firmtouch.report.figures.front import front_chart
from firmtouch.report.figures.mechanism import mechanism_picture
from firmtouch.report.figures.s_plane import region_plane, s_plane

__all__ = [
    "eigenvalue_chart",
    "front_chart",
    "mechanism_picture",
    "nyquist_picture",
    "region_plane",
    "s_plane",
    "stiffness_picture",
]
