"""The report's pictures, each a function from values to SVG; loaded when they are first used."""

from __future__ import annotations

from firmtouch.lazy_names import loader
from firmtouch.report.figures.s_plane import region_plane, s_plane  # a function with its module's name

TYPE_CHECKING = False

if TYPE_CHECKING:
    from typing import Final

    from firmtouch.report.figures.eigenvalues import eigenvalue_chart
    from firmtouch.report.figures.force_loop import nyquist_picture, stiffness_picture
    from firmtouch.report.figures.front import front_chart
    from firmtouch.report.figures.mechanism import mechanism_picture

_HOME_OF: Final = {
    "eigenvalue_chart": "eigenvalues",
    "front_chart": "front",
    "mechanism_picture": "mechanism",
    "nyquist_picture": "force_loop",
    "stiffness_picture": "force_loop",
}

__all__ = [
    "eigenvalue_chart",
    "front_chart",
    "mechanism_picture",
    "nyquist_picture",
    "region_plane",
    "s_plane",
    "stiffness_picture",
]

__getattr__ = loader(__name__, _HOME_OF)
