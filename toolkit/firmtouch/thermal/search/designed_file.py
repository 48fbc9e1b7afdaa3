"""A sensor file with other values in it: what a search found, written where the file has its own."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any, Final

from firmtouch.thermal.fields import ABSOLUTE_ZERO
from firmtouch.thermal.search.variables import UNITS
from firmtouch.thermal.sensorfile.drive import USES
from firmtouch.thermal.sensorfile.read import SensorFile
from firmtouch.thermal.sensorfile.specification import SensorSpec
from firmtouch.thermal.sensorfile.touch import LEVELS

PREFIXES: Final = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "u"), (1e-9, "n"))
SHORT: Final = {"drive": "mode", "contact": "nominal"}
"""Sections that may be one word, and which of their entries that is."""
WIDE: Final = 4096


def quantity(value: float, unit: str) -> str:
    """Write a quantity as a file has it: `2.5 um`, `50 kW/m^2/K`, `36 degC`."""
    if unit == "K":
        return f"{value + ABSOLUTE_ZERO:.6g} degC"
    factor, prefix = next(((f, p) for f, p in PREFIXES if abs(value) >= f * (1 - 1e-12)), PREFIXES[-1])
    return f"{value / factor:.6g} {prefix}{unit}"


def designed_text(file: SensorFile, design: SensorSpec, values: Mapping[tuple[str, ...], float | int | str]) -> str:
    """Write a sensor file again with the values of a design, its comments kept and its `search:` left out.

    `values` are those that the search chose, by their paths; `design` is the specification that has them.
    """
    from ruamel.yaml import YAML

    yaml = YAML()  # keeps comments and order; the text was read and checked before
    yaml.width, yaml.preserve_quotes = WIDE, True
    data = yaml.load(file.document.text)
    for path, value in values.items():
        written: Any = quantity(value, UNITS[path[-1]]) if isinstance(value, float) else value
        if path[0] == "stack":
            entry = next(each for each in data["stack"] if each.get("name") == path[1])
            entry.get("film", entry)[path[-1]] = written
        elif path == ("contact", "pressure"):
            data["contact"]["pressure"] = [quantity(each, "Pa") for each in design.contact.pressure or ()]
        elif path[0] == "contact":
            levels = {level: getattr(design.contact, level) for level in LEVELS}
            found = {level: quantity(h, "W/m^2/K") for level, h in levels.items() if h is not None}
            data["contact"] = {**_section(data, "contact"), **found}
        else:
            section = _section(data, path[0])
            section[path[-1]] = written
            data[path[0]] = section
    data.pop("search", None)
    _keep_what_belongs(data, design)
    text = io.StringIO()
    chosen = ", ".join(" ".join(path[1:] if path[0] == "stack" else path).replace("_", " ") for path in values)
    text.write(f"# Found by a search; chosen were: {chosen}.\n")
    yaml.dump(data, text)
    return text.getvalue()


def _section(data: Any, name: str) -> Any:  # noqa: ANN401  # ruamel's mapping
    """Give a section as a mapping, where the file has one word for it."""
    found = data.get(name)
    if hasattr(found, "keys"):
        return found
    return {} if found is None or name == "contact" else {SHORT[name]: found}


def _keep_what_belongs(data: Any, design: SensorSpec) -> None:  # noqa: ANN401  # ruamel's mapping
    """Leave out what does not go with the chosen mode of the drive."""
    drive = data.get("drive")
    if not hasattr(drive, "keys"):
        return
    needed, usable = USES[design.drive.mode]
    for name in [each for each in drive if each not in {"mode", *needed, *usable}]:
        del drive[name]
