"""How well objects are told apart, and where the noise is from."""

from __future__ import annotations

import math
from collections.abc import Iterator

from firmtouch.report.document import Block, Line, Math, Paragraph, Section, Table
from firmtouch.report.numbers import number
from firmtouch.report.thermal.sensor import prior_words
from firmtouch.report.thermal.words import LEVELS, quantity
from firmtouch.thermal.analysis import Analysis


def section(analysis: Analysis) -> Section | None:
    """Write what is told apart, where that is asked."""
    if not analysis.discrimination and not analysis.range:
        return None
    return Section("Telling objects apart", tuple(_blocks(analysis)))


def _blocks(analysis: Analysis) -> Iterator[Block]:
    unknown = prior_words(analysis)
    known = "What is not known in use, but for a standard deviation: " + unknown if unknown else (
        "Everything about the touch but the object is taken to be known"
    )  # fmt: skip
    yield Paragraph(
        (
            Math("d'"),
            " is the distance of two signals in standard deviations, of all samples since the touch together. "
            f"{known}. The noise is white; no detector can do better.",
        )
    )
    yield from _pairs(analysis)
    yield from _range(analysis)
    yield from _noise(analysis)


def _pairs(analysis: Analysis) -> Iterator[Block]:
    asked = analysis.spec.requirements.discrimination
    if not analysis.discrimination or asked is None:
        return
    headings: tuple[Line, ...] = (
        ("pair",), ("contact",), (Math("d'"), f" after {quantity(asked.time, 's')}"),
        (f"d′ ≥ {number(asked.d_prime)} after",),
    )  # fmt: skip
    rows: list[tuple[Line, ...]] = []
    for each in analysis.discrimination:
        told = f"not in {quantity(analysis.felt.window, 's')}" if math.isinf(each.told_after) else (
            quantity(each.told_after, "s")
        )  # fmt: skip
        pair, level = f"{each.first} and {each.second}", LEVELS[each.level]
        rows.append(((pair,), (level,), (number(each.d_prime, 3),), (told,)))
    yield Table(headings, tuple(rows), frozenset({2, 3}))


def _range(analysis: Analysis) -> Iterator[Block]:
    asked = analysis.spec.requirements.range
    if not analysis.range or asked is None:
        return
    yield Paragraph(
        (
            "How well an effusivity e is known, of objects with a usual ρc: the standard deviation of ln e after "
            f"{quantity(asked.time, 's')}, by Cramér and Rao (asked: at most {number(asked.sd)}).",
        )
    )
    levels = list(dict.fromkeys(each.level for each in analysis.range))
    spreads = {(each.effusivity, each.level): each.spread for each in analysis.range}
    headings: tuple[Line, ...] = (("e, W√s/m²K",), *((f"sd(ln e), {LEVELS[each]} contact",) for each in levels))
    rows: list[tuple[Line, ...]] = [
        ((number(e, 3),), *((number(spreads[e, level], 3),) for level in levels))
        for e in dict.fromkeys(each.effusivity for each in analysis.range)
    ]
    yield Table(headings, tuple(rows), frozenset(range(1 + len(levels))))


def _noise(analysis: Analysis) -> Iterator[Block]:
    readout, total = analysis.sensor.readout, analysis.signal_noise
    if readout is None or total is None:
        return
    unit, signal = analysis.sensor.drive.unit, ""
    if unit == "W/m^2":
        signal = f"The loop makes a noise of {quantity(total, unit)} of it, in one sample of its power."
    elif total != readout.noise:
        signal = f"The difference of two pads has {quantity(total, unit)}."
    if readout.sources is None:
        yield Paragraph(
            (f"The noise of the temperature is {quantity(readout.noise, 'K')}, as measured. {signal}".strip(),)
        )
        return
    yield Paragraph((f"Where the noise of one sample is from, in a bandwidth of {quantity(readout.bandwidth, 'Hz')}:",))
    volts, kelvins = readout.sources.voltage, readout.sources.netd
    headings: tuple[Line, ...] = (("source",), ("at the bridge",), ("as temperature",))
    rows: list[tuple[Line, ...]] = [
        (("the resistances (Johnson)",), (quantity(volts.johnson, "V"),), (quantity(kelvins.johnson, "K"),)),
        (("amplifier",), (quantity(volts.amplifier, "V"),), (quantity(kelvins.amplifier, "K"),)),
        (("quantisation",), (quantity(volts.quantisation, "V"),), (quantity(kelvins.quantisation, "K"),)),
        (("together",), (quantity(volts.total, "V"),), (quantity(kelvins.total, "K"),)),
    ]
    yield Table(headings, tuple(rows), frozenset({1, 2}), (signal,) if signal else ())
