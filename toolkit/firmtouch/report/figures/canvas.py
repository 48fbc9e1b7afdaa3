"""One look for all figures, and SVG that is the same on every machine."""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING, Any, Final, Literal

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INK: Final = "#1b2733"
MUTED: Final = "#6b7a88"
FAINT: Final = "#d9e0e6"
SURFACE: Final = "#e9e3d6"
SURFACE_EDGE: Final = "#8a7a55"
ARM: Final = "#2b5c8a"
FORCE: Final = "#c2382b"
GOOD: Final = "#2f7d4f"
HALO: Final = "#ffffff"

_STYLE: Final[dict[str, Any]] = {
    "svg.hashsalt": "firmtouch",
    "svg.fonttype": "path",
    "font.family": "DejaVu Sans",
    "mathtext.fontset": "dejavusans",
    "font.size": 9,
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": FAINT,
    "grid.linewidth": 0.6,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "legend.frameon": False,
    "hatch.linewidth": 0.6,
}


def styled() -> Any:  # noqa: ANN401  # matplotlib's context manager
    """Draw within this context."""
    import matplotlib as mpl

    return mpl.rc_context(_STYLE)  # type: ignore[arg-type]  # its keys are Literals


def new_figure(width: float, height: float, *, layout: Literal["constrained"] | None = "constrained") -> Figure:
    """Make a figure, in inches, without any window or global state; what is laid out by hand is drawn twice as fast."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout=layout)


def as_svg(figure: Figure, prefix: str, *, within: tuple[float, float, float, float] | None = None) -> str:
    """Give a figure as SVG; the prefix keeps ids apart when several stand on one page.

    What lies outside of `within` (left, bottom, right, top, in inches) is cut off.
    """
    from matplotlib.transforms import Bbox

    buffer = io.StringIO()
    part: dict[str, Any] = {"bbox_inches": Bbox.from_extents(*within)} if within else {}
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None}, transparent=True, **part)
    text = buffer.getvalue()
    svg = re.sub(r"<metadata>.*?</metadata>", "", text[text.index("<svg") :], flags=re.DOTALL)
    svg = re.sub(r'\bid="([^"]+)"', rf'id="{prefix}-\1"', svg)
    svg = re.sub(r'(xlink:href|href)="#([^"]+)"', rf'\1="#{prefix}-\2"', svg)
    return re.sub(r"url\(#([^)]+)\)", rf"url(#{prefix}-\1)", svg)
