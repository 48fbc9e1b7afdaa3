"""The bridge to pydantic: types made of one reading function, and problems that carry their place.

Each reading reports all its mistakes in one `PydanticCustomError` whose context holds `Problem`s; `read` turns them
into `file:line:column`. `Declarations` come in as pydantic's validation context.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, NoReturn, TypeVar

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from firmtouch.modelfile.declarations import Declarations
from firmtouch.modelfile.expression import Problem

K = TypeVar("K", bound=str | int)
T = TypeVar("T")


def refuse(*problems: Problem) -> NoReturn:
    """Report problems as pydantic wants it."""
    raise PydanticCustomError("problems", "{first}", {"first": problems[0].message, "problems": problems})


@contextmanager
def under(*path: str | int) -> Iterator[None]:
    """Report problems from inside as standing further down the file."""
    try:
        yield
    except PydanticCustomError as error:
        refuse(*(each.below(*path) for each in problems_of(error.context)))


def problems_of(context: Mapping[str, Any] | None) -> tuple[Problem, ...]:
    """Get the problems out of a pydantic error's context; none for an error of pydantic's own."""
    return tuple((context or {}).get("problems", ()))


def read_all(entries: Iterable[tuple[K, Any]], read: Callable[[K, Any], T]) -> dict[K, T]:
    """Read entries one by one, and report the problems of all of them together."""
    values: dict[K, T] = {}
    problems: list[Problem] = []
    for key, raw in entries:
        try:
            values[key] = read(key, raw)
        except PydanticCustomError as error:
            problems += (problem.below(key) for problem in problems_of(error.context))
    if problems:
        refuse(*problems)
    return values


def declared(info: ValidationInfo) -> Declarations:
    """Give the file's declarations; without a file there are none."""
    return info.context if isinstance(info.context, Declarations) else Declarations()


@dataclass(frozen=True, slots=True, eq=False)
class Checked:
    """A pydantic type made of one function from the raw entry to the value, and of its JSON Schema."""

    read: Callable[[Any, ValidationInfo], Any]
    schema: dict[str, Any]

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Validate with `read` alone."""
        return core_schema.with_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Describe what may be written."""
        return self.schema
