"""A model file -> `ModelSpec`, or all its mistakes at once as `file:line:column`."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from firmtouch.errors import Diagnostic, ModelFileError
from firmtouch.modelfile.declarations import Declarations
from firmtouch.modelfile.diagnostics import validated
from firmtouch.modelfile.files import Attached, beside, read_bytes
from firmtouch.modelfile.robots import Robots, declared_with_robot
from firmtouch.modelfile.specification import ModelSpec
from firmtouch.modelfile.yamltext import Document, read_yaml


@dataclass(frozen=True, slots=True)
class ModelFile:
    """A specification and where it came from: the file's name without its ending, and the SHA-256 of its bytes.

    `attached` are the files that it names, by the paths that it gives; the SHA-256 is of their bytes too. `document`
    knows where in the file each entry stands, for mistakes that only the mechanics can see; `declared` are its names.
    """

    name: str
    sha256: str
    spec: ModelSpec
    document: Document = field(compare=False, repr=False)
    declared: Declarations = field(compare=False, repr=False)
    attached: Mapping[str, bytes] = field(default_factory=dict)

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
    return parse_model(read_bytes(path), name=path.stem, file=str(path), attached=beside(path))


def parse_model(content: bytes, *, name: str, file: str | None = None, attached: Attached | None = None) -> ModelFile:
    """Check the bytes of a model file; `file` is its name in messages, `attached` reads the files that it names."""
    document = read_yaml(content, file or name)
    robots = Robots(attached)
    known = declared_with_robot(document, robots)
    spec = validated(document, ModelSpec, known)
    digest = hashlib.sha256(content)
    for each in robots.files.values():
        digest.update(each)
    return ModelFile(name, digest.hexdigest(), spec, document, known, dict(robots.files))
