"""A sensor file -> `SensorFile`, or all its mistakes at once as `file:line:column`; and its JSON Schema."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from firmtouch.errors import Diagnostic, ModelFileError
from firmtouch.modelfile.diagnostics import validated
from firmtouch.modelfile.files import read_bytes
from firmtouch.modelfile.json_schema import schema_of
from firmtouch.modelfile.yamltext import Document, read_yaml
from firmtouch.thermal.sensorfile.specification import SensorSpec
from firmtouch.thermal.tables.catalogue import Catalogue, read_catalogue
from firmtouch.thermal.tables.rows import CatalogueFileSpec


@dataclass(frozen=True, slots=True)
class SensorFile:
    """A sensor's specification and where it came from: the file's name without its ending, the SHA-256 of its bytes.

    `catalogue` has the tables' rows and the file's own, `document` knows where in the file each entry stands.
    """

    name: str
    sha256: str
    spec: SensorSpec
    document: Document = field(compare=False, repr=False)
    catalogue: Catalogue = field(repr=False)

    def mistake(self, message: str, *paths: tuple[str | int, ...]) -> ModelFileError:
        """Make the error of a mistake that was found later, told at each of these entries."""
        places = (self.document.place(path) for path in paths)
        return ModelFileError(tuple(Diagnostic(self.document.name, *place, message) for place in places))


def read_sensor(path: Path | str, catalogue: Catalogue | None = None) -> SensorFile:
    """Read and check a sensor file; its materials, parts and contacts are its own and the catalogue's.

    Raises
    ------
    ModelFileError
        With every mistake, each at its line and column.
    InputError
        If the file cannot be read at all.
    """
    path = Path(path)
    return parse_sensor(read_bytes(path), name=path.stem, file=str(path), catalogue=catalogue)


def parse_sensor(
    content: bytes, *, name: str, file: str | None = None, catalogue: Catalogue | None = None
) -> SensorFile:
    """Check the bytes of a sensor file; `file` is its name in messages, `catalogue` by default the shipped one."""
    known = read_catalogue() if catalogue is None else catalogue
    document = read_yaml(content, file or name, "sensor")
    spec = validated(document, SensorSpec, known.known_with(document.data))
    return SensorFile(name, hashlib.sha256(content).hexdigest(), spec, document, known.plus(spec))


def sensor_schema() -> dict[str, Any]:
    """Give the JSON Schema (draft 2020-12) of a sensor file."""
    return schema_of(SensorSpec, "firmtouch sensor file")


def catalogue_schema() -> dict[str, Any]:
    """Give that of a file of rows for the tables."""
    return schema_of(CatalogueFileSpec, "firmtouch catalogue file")
