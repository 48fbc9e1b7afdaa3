"""A model file -> `ModelSpec`, or all its mistakes at once as `file:line:column`."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field, replace
from pathlib import Path

from firmtouch.errors import Diagnostic, InputError, ModelFileError
from firmtouch.modelfile.declarations import declarations
from firmtouch.modelfile.diagnostics import validated
from firmtouch.modelfile.specification import ModelSpec
from firmtouch.modelfile.yamltext import LARGEST, Document, read_yaml


@dataclass(frozen=True, slots=True)
class ModelFile:
    """A specification and where it came from: the file's name without its ending, and the SHA-256 of its bytes.

    `document` knows where in the file each entry stands, for mistakes that only the mechanics can see.
    """

    name: str
    sha256: str
    spec: ModelSpec
    document: Document = field(compare=False, repr=False)

    def with_method(self, method: str) -> ModelFile:
        """Choose among the methods that the file's `design` describes.

        Raises
        ------
        InputError
            If the file does not describe this one.
        """
        design = self.spec.design.with_method(method)
        return replace(self, spec=self.spec.model_copy(update={"design": design}))

    def mistake(self, message: str, *paths: tuple[str | int, ...]) -> ModelFileError:
        """Make the error of a mistake that was found later, told at each of these entries."""
        places = (self.document.place(path) for path in paths)
        return ModelFileError(tuple(Diagnostic(self.document.name, *place, message) for place in places))


def read_model(path: Path | str) -> ModelFile:
    """Read and check a model file.

    Raises
    ------
    ModelFileError
        With every mistake, each at its line and column.
    InputError
        If the file cannot be read at all.
    """
    path = Path(path)
    return parse_model(read_bytes(path), name=path.stem, file=str(path))


def read_bytes(path: Path, largest: int = LARGEST) -> bytes:
    """Read what may be read of a file, and one byte more.

    Raises
    ------
    InputError
        If it cannot be read at all.
    """
    try:
        with path.open("rb") as file:
            return file.read(largest + 1)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else None
        raise InputError(f"{path}: cannot be read ({reason or error})") from error


def parse_model(content: bytes, *, name: str, file: str | None = None) -> ModelFile:
    """Check the bytes of a model file; `file` is its name in messages."""
    document = read_yaml(content, file or name)
    spec = validated(document, ModelSpec, declarations(document.data))
    return ModelFile(name, hashlib.sha256(content).hexdigest(), spec, document)
