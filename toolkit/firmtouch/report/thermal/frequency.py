"""Frequency responses, the loop's margins, and the rational models."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from firmtouch.report.document import Block, Code, Figure, Line, Math, Paragraph, Section, Table
from firmtouch.report.figures.thermal import BodeCurve, BodePanel, bode_picture
from firmtouch.report.numbers import complex_number, number
from firmtouch.report.thermal.responses import shown_objects
from firmtouch.report.thermal.words import breakable, quantity, unit_words
from firmtouch.thermal.analysis import Analysis, RationalModel
from firmtouch.thermal.loop_reduction import LoopReduction

TURN: Final = 2 * math.pi
WHOLE: Final = {
    "W/m^2/K": "heater power by T_o − T_s, W/m²K",
    "K/K": "temperature by T_o − T_s, K/K",
    "K m^2/W": "temperature by heater power, K m²/W",
}


def section(analysis: Analysis) -> Section:
    """Write the frequency responses."""
    return Section("Frequency response", tuple(_blocks(analysis)))


def _blocks(analysis: Analysis) -> Iterator[Block]:
    spectra = analysis.spectra
    unit = spectra.signals[0].unit
    text = "The exact transfer function H(jω) of the signal for each object, in the usual contact."
    if unit == "W/m^2/K":
        text += " What is warmer than the sensor saves heater power, so that its phase begins near −180°."
    if unit == "K m^2/W":
        text += " The part of the signal that the difference in temperature makes besides is not in it."
    yield Paragraph((text,))
    yield _figure(analysis)
    headings: tuple[Line, ...] = (("object",), ("largest |H|",), ("bandwidth",))
    rows: list[tuple[Line, ...]] = [
        (
            (each.object,),
            (quantity(float(each.magnitude.max()), each.unit.replace("K/K", "1")),),
            (_hertz(each.bandwidth),),
        )
        for each in spectra.signals
    ]
    caption: Line = ("Bandwidth: the highest frequency at which |H| is at least its largest value by √2.",)
    yield Table(headings, tuple(rows), frozenset({1, 2}), caption)
    yield from _margins(analysis)
    yield from _rational(analysis)


def _figure(analysis: Analysis) -> Figure:
    spectra, names = analysis.spectra, shown_objects(analysis)
    f, degrees = spectra.omega / TURN, 180 / math.pi
    signals = [BodeCurve(e.object, f, e.magnitude, e.phase * degrees) for e in spectra.signals if e.object in names]
    panels = [BodePanel(WHOLE[spectra.signals[0].unit], tuple(signals))]
    if spectra.loops:
        loops = [
            BodeCurve(e.object, f, e.magnitude, e.phase * degrees)
            for e in spectra.loops
            if e.object is None or e.object in names
        ]
        panels.append(BodePanel("loop L = K Z F", tuple(loops), unity=True))
    caption = "Bode diagrams: magnitude above, phase below."
    if spectra.loops:
        caption += " Right: the loop's L; the dashed lines are |L| = 1 and −180°."
    alt = f"Bode diagram of the signal{' and of the loop' if spectra.loops else ''} for {', '.join(names)}"
    return Figure(bode_picture(names, panels), (caption,), alt, 1.0 if len(panels) > 1 else 0.69, len(panels))


def _hertz(omega: float) -> str:
    return "no limit" if math.isinf(omega) else quantity(omega / TURN, "Hz")


def _margins(analysis: Analysis) -> Iterator[Block]:
    loops = analysis.spectra.loops
    if not loops:
        return
    yield Paragraph(("What the loop bears, with nothing before it and with each object in the usual contact:",))
    headings: tuple[Line, ...] = (
        ("touched",), ("crossover",), ("gain margin",), ("phase margin",), ("modulus margin",)
    )  # fmt: skip
    rows: list[tuple[Line, ...]] = []
    for each in loops:
        gain = "no limit" if math.isinf(each.gain_margin) else f"× {number(each.gain_margin, 3)}"
        phase = "no limit" if math.isinf(each.phase_margin) else f"{number(math.degrees(each.phase_margin), 3)}°"
        cross = "none" if math.isinf(each.crossover) else quantity(each.crossover / TURN, "Hz")
        rows.append(((each.object or "nothing",), (cross,), (gain,), (phase,), (number(each.modulus_margin, 3),)))
    caption: Line = (
        f"The least modulus margin |1 + L| in all contacts is {number(analysis.loop_margin, 3)}; "
        "0.5 is a usual demand.",
    )
    yield Table(headings, tuple(rows), frozenset({1, 2, 3, 4}), caption)


def _around_loop(models: Sequence[RationalModel]) -> str:
    if not isinstance(models[0].reduction, LoopReduction):
        return ""
    return (
        " Of a loop these are the two ways to the sensor, from the object and from the heater; the loop is closed "
        "around them exactly, and has complex poles too."
    )


def _rational(analysis: Analysis) -> Iterator[Block]:
    models = analysis.rational
    if not models:
        return
    late = models[0].dead_time
    yield Paragraph(
        (
            "Diffusion has no rational transfer function. For python-control, each response is fitted by ",
            Math("sum_i r_i slash (s - p_i)"),
            " with real poles, evenly spaced in the logarithm of time and so stable by construction (",
            Code("state_space()"),
            " of each reduction).",
            _around_loop(models),
            f" The dead time of {quantity(late, 's')} goes before it." if late else "",
            " The error is the largest of the unit step response over the times in which the model holds.",
        )
    )
    unit = unit_words(models[0].unit) if models[0].unit != "K/K" else "K/K"
    headings: tuple[Line, ...] = (
        ("object",), ("poles",), ("slowest, 1/s",), ("fastest, 1/s",), (f"error, {unit}",), ("relative",),
        ("holds from",), ("to",),
    )  # fmt: skip
    rows: list[tuple[Line, ...]] = []
    for each in models:
        found = each.reduction
        cells = (
            each.object,
            str(found.poles.size),
            complex_number(complex(found.poles[np.abs(found.poles).argmin()]), 3),
            complex_number(complex(found.poles[np.abs(found.poles).argmax()]), 3),
            number(found.error, 2),
            number(found.relative_error, 2),
            quantity(found.earliest, "s"),
            quantity(found.window, "s"),
        )
        rows.append(tuple((breakable(cell),) for cell in cells))
    yield Table(headings, tuple(rows), frozenset(range(1, 8)))
