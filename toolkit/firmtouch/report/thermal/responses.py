"""How the signal responds to a touch, object by object."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from firmtouch.report.document import Block, Figure, Line, Paragraph, Section, Table
from firmtouch.report.figures.thermal import Curve, Panel, responses_picture
from firmtouch.report.numbers import number
from firmtouch.report.thermal.words import LEVELS, SIGNALS, breakable, quantity, unit_words
from firmtouch.thermal.analysis import Analysis, Felt, ScenarioResponse

MOST_DRAWN: Final = 8
"""Curves that can be told apart."""
USUAL: Final = "nominal"


def shown_objects(analysis: Analysis) -> tuple[str, ...]:
    """List the objects whose curves are drawn: all, or of many some from the fastest to the slowest."""
    own = [each for each in _of(analysis, analysis.sensor.drive.mode) if each.scenario.level == USUAL]
    if len(own) <= MOST_DRAWN:
        return tuple(each.scenario.object for each in own)
    ordered = sorted(own, key=lambda each: each.rise_10_90)
    kept = {ordered[round(i)].scenario.object for i in np.linspace(0, len(own) - 1, MOST_DRAWN)}
    return tuple(each.scenario.object for each in own if each.scenario.object in kept)


def _of(analysis: Analysis, mode: str) -> tuple[ScenarioResponse, ...]:
    return tuple(each for each in analysis.responses if each.drive == mode)


def section(analysis: Analysis) -> Section:
    """Write the step responses."""
    drive, felt, open_loop = analysis.sensor.drive, analysis.felt, analysis.open_loop
    blocks: list[Block] = [
        Paragraph(
            (
                f"The signal is the change of the {SIGNALS[drive.unit]} after the touch. Rise times are measured by "
                f"the end value, which is the extremum of the signal within a window of {quantity(felt.window, 's')}; "
                "10–90 % and 63 % differ by far, as the last part of a response is diffusion. Recovery is the time "
                "after the release until less than a tenth of the end value is left.",
            )
        ),
        _figure(analysis),
    ]
    own = _of(analysis, drive.mode)
    blocks.append(_table(own))
    if open_loop is not None:
        blocks.append(
            Paragraph(("For comparison, the temperature of the same sensor without its loop, at constant power:",))
        )
        blocks.append(_table(_of(analysis, open_loop.sensor.drive.mode)))
    return Section("Step responses", tuple(blocks))


def _figure(analysis: Analysis) -> Figure:
    names, drive = shown_objects(analysis), analysis.sensor.drive
    panels = [Panel(_title(drive.unit, loop=analysis.open_loop is not None), _curves(analysis.felt, analysis, names))]
    if analysis.open_loop is not None:
        panels.append(Panel("temperature at constant power, no loop", _curves(analysis.open_loop, analysis, names)))
    asked = analysis.spec.requirements.rise_time
    line = asked.at_most if asked is not None else None
    of_all = len(analysis.spec.objects)
    many = f" ({len(names)} of {of_all} objects)" if len(names) < of_all else ""
    caption = f"Responses in the usual contact{many}, each by its own end value; dots at 10 % and 90 %."
    if line is not None:
        caption += f" Dashed: {quantity(line, 's')}, the rise time that is asked for."
    alt = f"Step responses over time for {', '.join(names)}"
    return Figure(
        responses_picture(names, panels, line), (caption,), alt, 1.0 if len(panels) > 1 else 0.69, len(panels)
    )


def _title(unit: str, *, loop: bool) -> str:
    return f"{SIGNALS[unit]}, in the loop" if loop else SIGNALS[unit]


def _curves(felt: Felt, analysis: Analysis, names: Sequence[str]) -> tuple[Curve, ...]:
    found = {
        each.scenario.object: each for each in _of(analysis, felt.sensor.drive.mode) if each.scenario.level == USUAL
    }
    rows = {each.object: i for i, each in enumerate(felt.sensor.scenarios) if each.level == USUAL}
    curves = []
    for name in names:
        response = found[name]
        share = felt.values[rows[name]] / response.end_value if response.end_value else 0 * felt.t
        marks = ((response.start, 0.1), (response.end, 0.9))
        curves.append(Curve(felt.t, share, tuple(each for each in marks if 0 < each[0] < math.inf)))
    return tuple(curves)


def _table(responses: Sequence[ScenarioResponse]) -> Table:
    first = responses[0]
    per = {"K": {"K": "", "W/m^2": "W/m²K"}, "W/m^2": {"K": "K m²/W", "W/m^2": ""}}[first.per][first.unit]
    gain = f"gain, {per}" if per else "gain"
    headings: tuple[Line, ...] = (
        ("object",), ("contact",), (f"h, {unit_words('W/m^2/K')}",), ("10–90 %",), ("63 %",), ("end value",), (gain,),
        ("recovery",),
    )  # fmt: skip
    rows: list[tuple[Line, ...]] = []
    for each in responses:
        cells = (
            each.scenario.object,
            LEVELS[each.scenario.level],
            number(each.scenario.touch.conductance, 3),
            _seconds(each.rise_10_90),
            _seconds(each.rise_63),
            quantity(each.end_value, each.unit),
            number(each.gain, 3),
            _seconds(each.recovery),
        )
        rows.append(tuple((breakable(cell),) for cell in cells))
    return Table(headings, tuple(rows), frozenset(range(2, 8)))


def _seconds(value: float) -> str:
    return "never" if math.isinf(value) else quantity(value, "s")
