"""The stack in cross-section: to scale, and beside it with thin layers magnified and thick ones cut."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from functools import lru_cache
from itertools import accumulate
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from firmtouch.report.figures.canvas import (
    ARM,
    FAINT,
    FORCE,
    HALO,
    INK,
    MUTED,
    SURFACE,
    SURFACE_EDGE,
    as_svg,
    new_figure,
    styled,
)
from firmtouch.report.figures.thermal.heights import Heights, readable_heights, true_heights

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH: Final = 6.4
"""Of the picture, in inches, as all lengths here."""
ROW: Final = 0.17
"""Least height of an entry, so that its words touch no others."""
LEAST, MORE = 2.3, 0.1
TRUE, READ = (0.12, 0.62), (1.15, 2.95)
"""Where both columns begin and end."""
WORDS, SIZES = 3.08, 6.34
"""Where names begin, and where sizes end."""
APART: Final = 0.12
"""Least distance of words that stand side by side."""
OBJECT, GAP, BACKING, TITLE = 0.3, 0.2, 0.3, 0.22
NARROW: Final = 0.03
"""Of a column: what is less high has no guide line."""
TINTS: Final = ("#d5e3ef", "#f2e2c9", "#d6eadc", "#e8d6ea", "#f4efcb", "#cfe9ec", "#efd8d2", "#dfdfea")
FONT: Final = 7.8


@dataclass(frozen=True, slots=True)
class Band:
    """An entry of the stack as it is drawn; a film or a joint has no thickness that counts, but may have words."""

    name: str
    material: str
    thickness: float | None
    size: str
    kind: str


@dataclass(frozen=True, slots=True)
class Plane:
    """A plane: the middle of a film, or the inner face of a layer."""

    entry: int
    inner: bool


@dataclass(frozen=True, slots=True)
class StackView:
    """What a picture of a stack shows, from what is touched inward, in words."""

    touched: str
    contact: str
    bands: tuple[Band, ...]
    sensed: Plane
    heated: Plane | None
    backing: str
    backing_kind: str


def layout_of(view: StackView) -> Heights:
    """Give the heights (inches) of the readable column."""
    thicknesses = [each.thickness for each in view.bands]
    return readable_heights(thicknesses, max(LEAST, MORE + 1.02 * ROW * len(view.bands)), ROW)


def stack_picture(view: StackView) -> str:
    """Draw a stack."""
    with styled():
        return as_svg(draw_stack(view), "stack")


def draw_stack(view: StackView) -> Figure:
    """Draw a stack; within `styled()`."""
    layout = layout_of(view)
    room = sum(layout.heights)
    height = TITLE + OBJECT + GAP + room + BACKING + 0.06
    figure = new_figure(WIDTH, height, layout=None)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_xlim(0, WIDTH)
    axes.set_ylim(height, 0)  # downwards is inward
    axes.axis("off")
    top = TITLE + OBJECT + GAP
    edges = top + np.concatenate([[0.0], np.cumsum(layout.heights)])
    true = top + np.concatenate([[0.0], np.cumsum(true_heights([each.thickness for each in view.bands], room))])
    colours = _colours(view)
    columns = [(READ, edges)] if layout.to_scale else [(TRUE, true), (READ, edges)]
    for sides, places in columns:
        _bands(axes, view, sides, places, colours)
        _ends(axes, view, sides, top, float(places[-1]))
    if not layout.to_scale:
        _guides(axes, true, edges, room)
    for i in layout.cut:
        _cut(axes, float(edges[i] + edges[i + 1]) / 2)
    _planes(axes, view, edges)
    _write(axes, view, edges)
    for (sides, _), words in zip(columns[::-1], ("thin layers magnified", "to scale"), strict=False):
        _title(axes, sides, "to scale" if layout.to_scale else words)
    return figure


def _colours(view: StackView) -> list[str]:
    materials = list(dict.fromkeys(each.material for each in view.bands if each.kind == "layer"))
    of = {name: TINTS[i % len(TINTS)] for i, name in enumerate(materials)}
    plain = {"film": "#9fb0bf", "joint": HALO}
    return [plain.get(each.kind) or of[each.material] for each in view.bands]


def _bands(axes: Any, view: StackView, sides: tuple[float, float], places: Any, colours: list[str]) -> None:  # noqa: ANN401  # matplotlib
    from matplotlib.patches import Rectangle

    left, right = sides
    for band, colour, above, below in zip(view.bands, colours, places[:-1], places[1:], strict=True):
        hatch = "...." if band.kind == "joint" and below > above else None
        axes.add_patch(
            Rectangle(
                (left, above),
                right - left,
                below - above,
                facecolor=colour,
                edgecolor=MUTED,
                linewidth=0.6,
                hatch=hatch,
            )
        )


def _ends(axes: Any, view: StackView, sides: tuple[float, float], top: float, bottom: float) -> None:  # noqa: ANN401  # matplotlib
    """Draw what is touched above, and what is behind below."""
    from matplotlib.patches import Rectangle

    left, right = sides
    style: dict[str, Any] = {"facecolor": SURFACE, "edgecolor": SURFACE_EDGE, "linewidth": 0.8}
    axes.add_patch(Rectangle((left, TITLE), right - left, OBJECT, hatch="///", **style))
    if view.backing_kind == "air":
        axes.plot([left, right], [bottom, bottom], color=INK, linewidth=1.0)
        return
    hatch = {"base": "xxxx", "half_space": "", "adiabatic": "...."}[view.backing_kind]
    plain: dict[str, Any] = {"facecolor": FAINT, "edgecolor": MUTED, "linewidth": 0.8}
    axes.add_patch(Rectangle((left, bottom), right - left, BACKING, hatch=hatch, **plain))
    axes.plot([left, right], [top, top], color=INK, linewidth=1.2)


def _guides(axes: Any, true: Any, edges: Any, room: float) -> None:  # noqa: ANN401  # matplotlib
    """Lead from the one column to the other, but for what lies close together."""
    last = -np.inf
    for i, (a, b) in enumerate(zip(true, edges, strict=True)):
        if a - last >= NARROW * room or i == len(true) - 1:
            axes.plot([TRUE[1], READ[0]], [a, b], color=MUTED, linewidth=0.6, linestyle=(0, (3, 2)))
            last = a


def _cut(axes: Any, middle: float) -> None:  # noqa: ANN401  # matplotlib
    """Mark a layer as cut short by a broken line across it."""
    x = np.linspace(READ[0] - 0.05, READ[1] + 0.05, 41)
    zigzag = 0.018 * np.where(np.arange(x.size) % 2, 1, -1)
    for offset, colour, width in ((0.0, HALO, 3.4), (-0.024, MUTED, 0.7), (0.024, MUTED, 0.7)):
        axes.plot(x, middle + zigzag + offset, color=colour, linewidth=width, zorder=4)


def _planes(axes: Any, view: StackView, edges: Any) -> None:  # noqa: ANN401  # matplotlib
    """Mark the sensed plane in the left half of the column, the heated one in its right half."""
    marks: list[tuple[Plane, str, str, float, Any]] = [(view.sensed, ARM, "sensed", 0.27, "-")]
    if view.heated is not None:
        marks.append((view.heated, FORCE, "heated", 0.73, (0, (4, 2))))
    for plane, colour, words, part, dash in marks:
        y = edges[plane.entry + 1] if plane.inner else (edges[plane.entry] + edges[plane.entry + 1]) / 2
        axes.plot([READ[0] - 0.06, READ[1] + 0.06], [y, y], color=colour, linewidth=1.7, linestyle=dash, zorder=5)
        axes.text(
            READ[0] + part * (READ[1] - READ[0]), y, words, color=colour, fontsize=FONT, fontweight="bold", ha="center",
            va="center", zorder=6, bbox={"facecolor": HALO, "edgecolor": "none", "pad": 0.6, "alpha": 0.9},
        )  # fmt: skip


def _write(axes: Any, view: StackView, edges: Any) -> None:  # noqa: ANN401  # matplotlib
    """Write beside each entry what it is; rows are so high that no words meet."""
    style: dict[str, Any] = {"fontsize": FONT, "va": "center", "color": INK, "parse_math": False}
    room = SIZES - WORDS
    axes.text(WORDS, TITLE + OBJECT / 2, shortened(view.touched, room), **style)
    axes.text(WORDS, TITLE + OBJECT + GAP / 2, view.contact, **(style | {"color": MUTED}))
    for i, band in enumerate(view.bands):
        middle = float(edges[i] + edges[i + 1]) / 2
        axes.plot([READ[1] + 0.03, WORDS - 0.03], [middle, middle], color=MUTED, linewidth=0.5)
        axes.text(WORDS, middle, _called(band, room - width_of(band.size) - APART), **style)
        axes.text(SIZES, middle, band.size, ha="right", **style)
    axes.text(WORDS, float(edges[-1]) + BACKING / 2, shortened(view.backing, room), **style)


def _called(band: Band, room: float) -> str:
    """Name an entry and its material; where both do not fit, each is cut to its half."""
    if not band.material or band.material == band.name:
        return shortened(band.name, room)
    whole = f"{band.name} · {band.material}"
    if width_of(whole) <= room:
        return whole
    half = (room - width_of(" · ")) / 2
    name = shortened(band.name, max(half, 2 * half - width_of(band.material)))
    return f"{name} · {shortened(band.material, 2 * half - width_of(name))}"


def width_of(words: str) -> float:
    """Measure words (inches), letter by letter."""
    return sum(map(_letter, words))


@lru_cache(maxsize=1024)
def _letter(letter: str) -> float:
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    width, _, _ = text_to_path.get_text_width_height_descent(letter, FontProperties(size=FONT), ismath=False)
    return float(width) / 72


def shortened(words: str, room: float) -> str:
    """Cut words that are wider than their room (inches)."""
    if width_of(words) <= room:
        return words
    places = list(accumulate(map(_letter, words), initial=_letter("…")))
    return f"{words[: max(bisect_right(places, room) - 1, 0)]}…"


def _title(axes: Any, sides: tuple[float, float], words: str) -> None:  # noqa: ANN401  # matplotlib
    axes.text(sum(sides) / 2, TITLE / 2, words, fontsize=FONT, color=MUTED, ha="center", va="center")
