"""A model file -> `ModelSpec`, or all its mistakes at once as `file:line:column`."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from firmtouch.errors import Diagnostic, InputError, ModelFileError
from firmtouch.modelfile.declarations import declarations
from firmtouch.modelfile.expression.problem import did_you_mean, shown
from firmtouch.modelfile.fields import problems_of
from firmtouch.modelfile.specification import ModelSpec
from firmtouch.modelfile.yamltext import LARGEST, Document, read_yaml


@dataclass(frozen=True, slots=True)
class ModelFile:
    """A specification and where it came from: the file's name without its ending, and the SHA-256 of its bytes."""

    name: str
    sha256: str
    spec: ModelSpec


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
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST + 1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    return parse_model(content, name=path.stem, file=str(path))


def parse_model(content: bytes, *, name: str, file: str | None = None) -> ModelFile:
    """Check the bytes of a model file; `file` is its name in messages."""
    document = read_yaml(content, file or name)
    mistakes = list(document.mistakes)
    try:
        spec = ModelSpec.model_validate(document.data, context=declarations(document.data))
    except ValidationError as error:
        for details in error.errors(include_url=False):
            mistakes.extend(_located(details, document))
    if mistakes:
        raise ModelFileError(tuple(mistakes))
    return ModelFile(name, hashlib.sha256(content).hexdigest(), spec)


def _located(details: ErrorDetails, document: Document) -> Iterator[Diagnostic]:
    location, at_key = _location(details), details["loc"][-1:] == ("[key]",)
    problems = problems_of(details.get("ctx"))
    for problem in problems:
        yield document.diagnostic((*location, *problem.path), problem.message, offset=problem.offset, key=at_key)
    if not problems:
        message, path, at_key = _own_words(details, location)
        yield document.diagnostic(path, message, key=at_key)


def _location(details: ErrorDetails) -> tuple[str | int, ...]:
    """Drop from pydantic's location what the file does not hold: its mark of a key, and the tag of the mechanism."""
    location = tuple(each for each in details["loc"] if each != "[key]")
    return ("mechanism", *location[2:]) if location[:1] == ("mechanism",) else location


def _own_words(details: ErrorDetails, path: tuple[str | int, ...]) -> tuple[str, tuple[str | int, ...], bool]:
    """Say what pydantic found, where to point, and whether to point at the key."""
    context: dict[str, Any] = details.get("ctx", {})
    match details["type"]:
        case "missing":
            return f"`{path[-1]}` is missing here", path[:-1], True
        case "extra_forbidden":
            key, choices = str(path[-1]), _fields_at(path[:-1])
            return f"unknown key {shown(key)}; there are: {', '.join(choices)}{did_you_mean(key, choices)}", path, True
        case "model_type" | "dict_type" | "model_attributes_type":
            return f"a mapping `name: value` was expected, not {_sort(details['input'])}", path, False
        case "tuple_type" | "list_type":
            return f"a list was expected, not {_sort(details['input'])}", path, False
        case "literal_error":
            wanted = str(context["expected"]).replace("'", "`")
            choices = [each.strip("`") for each in wanted.replace(" or ", ", ").split(", ")]
            given = str(details["input"])
            return f"{shown(given)} is not possible here; expected {wanted}{did_you_mean(given, choices)}", path, False
        case "too_short" | "too_long":
            bound = context.get("min_length", context.get("max_length"))
            least = "at least" if details["type"] == "too_short" else "at most"
            return f"{context.get('actual_length')} entries where {least} {bound} are needed", path, False
        case _:
            return details["msg"], path, False


def _sort(value: object) -> str:
    match value:
        case None:
            return "nothing"
        case dict():
            return "a mapping"
        case list():
            return "a list"
        case _:
            return shown(str(value))


def _fields_at(location: tuple[str | int, ...]) -> list[str]:
    """Find the keys that exist at a place of the specification, by walking the classes."""
    from typing import get_args

    def classes(annotation: Any) -> Iterator[Any]:  # noqa: ANN401  # a type expression
        fields = getattr(annotation, "model_fields", None)
        if fields is not None:
            yield annotation
        for each in get_args(annotation):
            yield from classes(each)

    here: list[Any] = [ModelSpec]
    for each in location:
        fields = [field for cls in here for name, field in cls.model_fields.items() if each in (name, field.alias)]
        here = [cls for field in fields for cls in classes(field.annotation)] or here
    return list(dict.fromkeys(field.alias or name for cls in here for name, field in cls.model_fields.items()))
