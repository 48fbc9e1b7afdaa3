"""Colours and dashes by which the lines of many coordinates are told apart, and the legend that names them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

from firmtouch.report.figures.canvas import INK, MUTED

Dash = Literal["-"] | tuple[float, tuple[float, ...]]
DASHES: Final[tuple[Dash, ...]] = ("-", (0, (4, 1.4)), (0, (1.2, 1.1)), (0, (5, 1.2, 1.2, 1.2)))
COLOURS: Final = ("#2b5c8a", "#c07a1f", "#2f7d4f", "#8a3f8f", "#1b9aaa", "#8c5a4a", "#5a6f8c", "#7c6f2c")
APART: Final = (*COLOURS[:6], "#c23f6e", "#20262c")
"""Colours of up to eight curves that cross each other, of which no two are alike."""
LETTER, HANDLE = 0.062, 0.5
"""Widths of a letter of the legend, and of the line beside it with its gaps, in inches."""
ROW: Final = 0.155
"""Height of a row of the legend, in inches."""


@dataclass(frozen=True, slots=True)
class Style:
    """How a line is drawn."""

    colour: str
    dash: Dash = "-"


@dataclass(frozen=True, slots=True)
class Key:
    """An entry of the legend."""

    label: str
    style: Style


@dataclass(frozen=True, slots=True)
class Styles:
    """A style for each of some names, and the entries of a legend that explain them."""

    lines: tuple[Style, ...]
    keys: tuple[Key, ...]


def styles_of(names: Sequence[str], colours: Sequence[str]) -> Styles:
    """Give each name a style of its own: colours first, then dashes.

    Arms whose joints have the same names after the arm's (`left_elbow`, `right_elbow`) share the colours, and each
    arm has its dash.
    """
    arms = _arms(names)
    if arms:
        joints = list(dict.fromkeys(name.partition("_")[2] for name in names))
        if len(arms) <= len(DASHES) and len(joints) <= len(colours):
            of_joint = dict(zip(joints, colours, strict=False))
            of_arm = dict(zip(arms, DASHES, strict=False))
            parts = [name.partition("_") for name in names]
            lines = tuple(Style(of_joint[joint], of_arm[arm]) for arm, _, joint in parts)
            keys = [Key(_words(joint), Style(colour)) for joint, colour in of_joint.items()]
            return Styles(lines, (*keys, *(Key(_words(arm), Style(INK, dash)) for arm, dash in of_arm.items())))
    lines = tuple(Style(colours[i % len(colours)], DASHES[i // len(colours) % len(DASHES)]) for i in range(len(names)))
    return Styles(lines, tuple(Key(_words(name), style) for name, style in zip(names, lines, strict=True)))


def _arms(names: Sequence[str]) -> tuple[str, ...]:
    """Find the arms of which all have the same joints; none where there are not several."""
    joints: dict[str, list[str]] = {}
    for name in names:
        arm, _, joint = name.partition("_")
        joints.setdefault(arm, []).append(joint)
    found = list(joints.values())
    alike = len(found) > 1 and len(found[0]) > 1 and all(found[0]) and all(each == found[0] for each in found)
    return tuple(joints) if alike else ()


def _words(name: str) -> str:
    return name.replace("_", " ")


def legend_rows(keys: Sequence[Key], width: float) -> int:
    """Say how many rows a legend has within a width (inches)."""
    return math.ceil(len(keys) / _columns(keys, width))


def draw_legend(figure: Any, keys: Sequence[Key], width: float) -> None:  # noqa: ANN401  # matplotlib
    """Name the lines once for all panels, row by row, the first row first."""
    from matplotlib.lines import Line2D

    rows = legend_rows(keys, width)
    columns = math.ceil(len(keys) / rows)  # rows of one length
    handles = [_line(each.style) for each in keys]
    labels = [each.label for each in keys]
    empty = rows * columns - len(keys)
    handles += [Line2D([], [], linestyle="none")] * empty
    labels += [""] * empty
    order = [i * columns + j for j in range(columns) for i in range(rows)]  # matplotlib goes down the columns
    legend = figure.legend(
        [handles[i] for i in order],
        [labels[i] for i in order],
        loc="lower center",
        ncols=columns,
        fontsize=7.5,
        handlelength=2.0,
        columnspacing=1.2,
        labelspacing=0.35,
        borderpad=0.1,
    )
    for each in legend.get_texts():
        each.set_parse_math(False)  # names of a file are never formulas


def _line(style: Style) -> Any:  # noqa: ANN401  # matplotlib
    from matplotlib.lines import Line2D

    if style.colour == MUTED:  # broad and pale, as it lies behind the others
        return Line2D([], [], color=MUTED, alpha=0.45, linewidth=2.6)
    return Line2D([], [], color=style.colour, linestyle=style.dash, linewidth=1.4)


def _columns(keys: Sequence[Key], width: float) -> int:
    widest = max(len(each.label) for each in keys)
    return max(1, min(len(keys), int(width / (LETTER * widest + HANDLE))))
