"""A scenario file, read for the model that it belongs to."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from firmtouch.modelfile.diagnostics import validated
from firmtouch.modelfile.files import read_bytes
from firmtouch.modelfile.read import ModelFile
from firmtouch.modelfile.sections.draw import DrawSpec
from firmtouch.modelfile.sections.scenario import ScenarioFileSpec, ScenarioSpec
from firmtouch.modelfile.yamltext import Document, read_yaml


@dataclass(frozen=True, slots=True)
class ScenarioFile:
    """The scenarios of a file, by name, and what is drawn around them; `document` knows where each entry stands."""

    scenarios: dict[str, ScenarioSpec]
    draw: DrawSpec | None
    document: Document = field(compare=False, repr=False)


def read_scenarios(path: Path | str, model: ModelFile) -> ScenarioFile:
    """Read and check a scenario file; its names and units are the model's.

    Raises
    ------
    ModelFileError
        With every mistake, each at its line and column.
    InputError
        If the file cannot be read at all.
    """
    return parse_scenarios(read_bytes(Path(path)), model, file=str(path))


def parse_scenarios(content: bytes, model: ModelFile, *, file: str) -> ScenarioFile:
    """Check the bytes of a scenario file; `file` is its name in messages."""
    document = read_yaml(content, file, "scenario")
    found = validated(document, ScenarioFileSpec, model.declared)
    return ScenarioFile(dict(found.scenarios), found.draw, document)
