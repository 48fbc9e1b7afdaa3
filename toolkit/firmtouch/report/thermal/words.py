"""Sizes and names of a thermal study in words: 0.388 ms, 36 °C, 2.73 %."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from typing import Final

from firmtouch.report.document import Code, Line, Span
from firmtouch.report.numbers import number
from firmtouch.thermal.analysis import Outcome
from firmtouch.thermal.fields import ABSOLUTE_ZERO
from firmtouch.thermal.sensorfile import SensorSpec

PREFIXES: Final = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"), (1e-12, "p"))
SMALL: Final = frozenset({"s", "m", "W", "K", "V"})
"""Units that have prefixes for what is less than 1; those of `LARGE` have them for what is 1000 or more."""
LARGE: Final = frozenset({"W", "W/m^2", "W/m^2/K", "Hz", "V", "Pa", "ohm"})
UNITS: Final = {
    "W/m^2": "W/m²",
    "W/m^2/K": "W/m²K",
    "J/m^2/K": "J/m²K",
    "W s^(1/2)/m^2/K": "W√s/m²K",
    "K m^2/W": "K m²/W",
    "ohm": "Ω",
    "1": "",
}
MODES: Final = {
    "constant_power": "constant heater power",
    "constant_temperature": "a loop that holds the temperature",
    "pulse": "a pulse of heater power",
    "two_temperature": "two pads at different temperatures",
}
SIGNALS: Final = {"K": "temperature", "W/m^2": "heater power by area"}
LEVELS: Final = {"low": "bad", "nominal": "usual", "high": "good"}
"""What a contact is called that is low, nominal or high."""
METRICS: Final = {"10-90": "10–90 % rise time", "63 %": "time to 63 %", "d_prime": "time until told apart"}
PERCENT: Final = frozenset({"crosstalk", "feedback"})
NOTHING: Final = 1e-9
"""Of what is asked or reached: a margin that is less is rounding."""
LONG: Final = 20
"""Letters of a name that may need two lines in a table."""
_POWER: Final = re.compile(r"-?[0-9.]+e[+-][0-9]+(?= W/m²)")
_SIZE: Final = re.compile(r"\b([he]) = ([0-9][0-9.]*(?:e[+-]?[0-9]+)?)")


def unit_words(unit: str) -> str:
    """Write a unit."""
    return UNITS.get(unit, unit)


def quantity(value: float, unit: str, figures: int = 3) -> str:
    """Write a size with a prefix that makes it readable: 0.000388 s as 388 µs."""
    if not math.isfinite(value) or value == 0:
        return f"{number(value)} {unit_words(unit)}".rstrip()
    value = float(f"{value:.{figures - 1}e}")
    size = abs(value)
    if (size < 1 and unit in SMALL) or (size >= 1000 and unit in LARGE):
        factor, prefix = next((each for each in PREFIXES if size >= each[0] * (1 - 1e-9)), PREFIXES[-1])
        return f"{number(value / factor, figures)} {prefix}{unit_words(unit)}"
    return f"{number(value, max(figures, 4) if size >= 1000 else figures)} {unit_words(unit)}".rstrip()


def celsius(kelvin: float) -> str:
    """Write a temperature in degrees Celsius."""
    return f"{number(round(kelvin + ABSOLUTE_ZERO, 2))} °C"


def percent(share: float, figures: int = 3) -> str:
    """Write a share."""
    return f"{number(100 * share, figures)} %"


def outcome_words(outcome: Outcome, value: float) -> str:
    """Write what is asked or reached of a requirement."""
    if math.isinf(value):
        return "never" if outcome.unit == "s" else number(value)
    if outcome.name == "surface_temperature":
        return celsius(value)
    return percent(value) if outcome.name in PERCENT else quantity(value, outcome.unit)


def margin_words(outcome: Outcome) -> str:
    """Write by how much a requirement is met, with its sign."""
    margin = outcome.margin
    if not math.isfinite(margin):
        return "–"
    if abs(margin) <= NOTHING * max(abs(outcome.asked), abs(outcome.reached)):
        return "0"
    text = percent(margin) if outcome.name in PERCENT else quantity(margin, outcome.unit)
    return f"+{text}" if margin > 0 else text


def requirement_words(outcome: Outcome, spec: SensorSpec) -> str:
    """Name a requirement, with the metric and the time that it is measured by."""
    asked, name = spec.requirements, outcome.name
    if name == "rise_time" and asked.rise_time is not None:
        return METRICS[asked.rise_time.metric]
    if name == "discrimination" and asked.discrimination is not None:
        return f"d′ after {quantity(asked.discrimination.time, 's')}"
    if name == "range" and asked.range is not None:
        return f"sd(ln e) after {quantity(asked.range.time, 's')}"
    names = {
        "crosstalk": "cross-talk",
        "surface_temperature": "temperature of the touched face",
        "power_pad": "power of a pad",
        "power_array": "power of all pads",
        "self_heating": "rise by the reading's own heat",
        "feedback": "electro-thermal feedback P|α|/δ",
        "loop_margin": "modulus margin of the loop",
        "recovery": "recovery after a touch",
        "pitch": "pitch",
        "thickness": "thickness of the stack",
    }
    return names[name]


def place_words(where: str) -> str:
    """Write the scenario in which something is worst; its numbers as all others are written."""
    found = _SIZE.sub(lambda match: f"{match[1]} = {number(float(match[2]))}", where)
    found = found.replace("W s^½/m²K", "W√s/m²K")
    return re.sub(r", (low|nominal|high) h$", lambda match: f", {LEVELS[match[1]]} contact", found)


def tidied(text: str) -> str:
    """Write the powers of a sentence as all other numbers are written: 1.39e+05 W/m² as 1.39×10⁵ W/m²."""
    return _POWER.sub(lambda match: number(float(match[0])), text)


def coded(text: str) -> Line:
    """Set what stands between backticks as names of a file."""
    spans: list[Span] = []
    for i, part in enumerate(text.split("`")):
        if part:
            spans.append(Code(part) if i % 2 else part)
    return tuple(spans)


def enumerated(words: Iterable[str]) -> str:
    """Write `a, b and c`."""
    listed = list(words)
    return listed[0] if len(listed) == 1 else f"{', '.join(listed[:-1])} and {listed[-1]}"


def range_words(values: Iterable[float], unit: str) -> str:
    """Write from the least to the most of some sizes."""
    listed = sorted(values)
    low, high = quantity(listed[0], unit), quantity(listed[-1], unit)
    return low if low == high else f"{low} to {high}"


def breakable(text: str) -> str:
    """Let a long name break after its underscores, where a column is narrow."""
    return text.replace("_", "_\N{ZERO WIDTH SPACE}") if len(text) > LONG else text
