"""Data of a file -> one of the frozen sections, or all its mistakes at once as `file:line:column`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Final, TypeVar

from pydantic import BaseModel, Tag, ValidationError
from pydantic_core import ErrorDetails

from firmtouch.errors import Diagnostic, ModelFileError
from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import problems_of
from firmtouch.modelfile.words import listed, shown
from firmtouch.modelfile.yamltext import Document

MOST_MISTAKES: Final = 100
KEY_MARK: Final = "[key]"
"""What pydantic ends a location with where it means the key."""
TAGGED: Final[dict[str | int, int]] = {"mechanism": 1, "constraints": 2}
"""How deep under a section pydantic puts the tag of the form that it read."""
UNTOLD: Final = ("bodies", "expression")
"""The forms that are taken where no key tells another one."""
PAIRS: Final = {
    "interval": "two quantities were expected, as in `[3.5 kg, 5.0 kg]`",
    "limits": "two positions were expected, as in `[-120 deg, 120 deg]`",
    "between": "two frames were expected, as in `[left_tool, right_tool]`",
    "join": "two frames were expected, as in `[left_tool, right_tool]`",
}
"""What is told of a list that should have two entries."""
T = TypeVar("T", bound=BaseModel)


def validated(document: Document, root: type[T], known: object) -> T:
    """Read a document as what it should be; `known` are the names that its entries may use, as its fields expect them.

    Raises
    ------
    ModelFileError
        With every mistake, each at its line and column.
    """
    errors: list[ErrorDetails] = []
    found: T | None = None
    try:
        found = root.model_validate(document.data, context=known)
    except ValidationError as error:
        errors = error.errors(include_url=False)
    if found is None or document.mistakes:
        raise ModelFileError(_diagnostics(errors, document, root))
    return found


def _diagnostics(errors: list[ErrorDetails], document: Document, root: type[BaseModel]) -> tuple[Diagnostic, ...]:
    """Locate all mistakes, those of YAML too, and word the first hundred.

    A value that YAML's reading refused already is now missing, which deserves no second message.
    """
    refused = {(each.line, each.column): Problem(each.message) for each in document.mistakes}
    located = [(*place, problem) for place, problem in refused.items()]
    located += [
        (line, column, problem)
        for details in errors
        for line, column, problem in _located(details, document, root)
        if (line, column) not in refused
    ]
    located.sort(key=lambda each: each[:2])
    if len(located) > MOST_MISTAKES:
        line, column, _ = located[MOST_MISTAKES]
        rest = Problem(f"and {len(located) - MOST_MISTAKES} more mistakes from here on")
        located = [*located[:MOST_MISTAKES], (line, column, rest)]
    return tuple(Diagnostic(document.name, line, column, each.in_words()) for line, column, each in located)


def _located(details: ErrorDetails, document: Document, root: type[BaseModel]) -> Iterator[tuple[int, int, Problem]]:
    if details["loc"][:1] == ("coordinates",) and len(details["loc"]) > 1 and ("coordinates",) not in document.values:
        return  # a robot's joints are not written here; what their names meet is told where that is
    if details["type"] == "too_short" and len(details["input"]) >= details["ctx"]["min_length"]:
        return  # there are enough entries; those that could not be read are told themselves
    problems = problems_of(details.get("ctx"))
    location = _location(details["loc"], ours=bool(problems))
    for problem in problems or (_own_words(details, location, root),):
        path = (*location, *problem.path) if problems else problem.path
        yield *document.place(path, offset=problem.offset, key=problem.at_key), problem


def _location(location: tuple[str | int, ...], *, ours: bool) -> tuple[str | int, ...]:
    """Drop from pydantic's location what the file does not hold: the tags of unions, the mark of a key of ours."""
    if ours and location[-1:] == (KEY_MARK,):
        location = location[:-1]
    tag = TAGGED.get(location[0]) if location else None
    if tag is None or location[tag:][:1] == (KEY_MARK,):
        return location
    return (*location[:tag], *location[tag + 1 :])


def _own_words(details: ErrorDetails, path: tuple[str | int, ...], root: type[BaseModel]) -> Problem:
    """Say what pydantic found, and where in the file.

    These are all the types of error that the specification's classes can give; their fields word their own.
    """
    match details["type"]:
        case "missing" if isinstance(path[-1], str):
            return Problem(f"`{path[-1]}` is missing here", path=path[:-1], at_key=True)
        case "extra_forbidden":
            return _unknown_key(details, path, root)
        case "model_type" | "dict_type":
            return Problem(f"a mapping `name: value` was expected, not {_sort(details['input'])}", path=path)
        case "literal_error":
            return _no_choice(details, path)
        case "tuple_type" | "too_short" | "too_long" if path[-1] in PAIRS:
            return Problem(PAIRS[str(path[-1])], path=path)
        case "missing" if path[-2] in PAIRS:
            return Problem(PAIRS[str(path[-2])], path=path[:-1])
        case "too_short" | "too_long":
            return Problem(_count(details), path=path)
        case "tuple_type":
            return Problem(f"a list was expected, not {_sort(details['input'])}", path=path)
        case "bool_type":
            return Problem(f"`true` or `false` was expected, not {_sort(details['input'])}", path=path)
        case _:
            return Problem(f"{_sort(details['input'])} is not possible here", path=path)


def _unknown_key(details: ErrorDetails, path: tuple[str | int, ...], root: type[BaseModel]) -> Problem:
    """Name the keys that there are: those of the form that was read, and all where no key told one."""
    key, every = str(path[-1]), _fields_at(path[:-1], root)
    loc = details["loc"]
    depth = TAGGED.get(loc[0], len(loc))
    tag = str(loc[depth]) if depth == len(path) - 1 and len(loc) == len(path) + 1 else None
    of_form = every if tag is None else _fields_at(path[:-1], root, tag)
    if key in every:
        message = f"{shown(key)} does not go with {shown(str(tag))}; there are: {listed(of_form, len(of_form))}"
        return Problem(message, path=path, at_key=True)
    choices = every if tag in UNTOLD else of_form
    message = f"unknown key {shown(key)}; there are: {listed(choices, len(choices))}"
    return Problem(message, path=path, at_key=True, near=(key, choices))


def _no_choice(details: ErrorDetails, path: tuple[str | int, ...]) -> Problem:
    wanted = str(details["ctx"]["expected"]).replace("'", "`")
    choices = tuple(wanted.replace("`", "").replace(" or ", ", ").split(", "))
    given = details["input"] if isinstance(details["input"], str) else ""
    if given in choices:  # a number in quotation marks
        return Problem(f"the text {shown(given)} is not possible here; expected the number", path=path)
    message = f"{_sort(details['input'])} is not possible here; expected {wanted}"
    return Problem(message, path=path, near=(given, choices))


def _count(details: ErrorDetails) -> str:
    given, context = len(details["input"]), details["ctx"]
    if "min_length" in context:
        return f"{given or 'no'} entries where at least {context['min_length']} is needed"
    return f"{given} entries where at most {context['max_length']} are read"


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


def _fields_at(location: tuple[str | int, ...], root: type[BaseModel], tag: str | None = None) -> tuple[str, ...]:
    """Find the keys that exist at a place of the specification, by walking the classes; of one form, with a tag."""
    from typing import get_args

    def classes(annotation: Any) -> Iterator[Any]:  # noqa: ANN401  # a type expression
        parts = get_args(annotation)
        forms = [each.tag for each in parts if isinstance(each, Tag)]
        if tag is not None and forms and tag not in forms:
            return
        if getattr(annotation, "model_fields", None) is not None:
            yield annotation
        for each in parts:
            yield from classes(each)

    here: list[Any] = [root]
    for each in location:
        fields = [field for cls in here for name, field in cls.model_fields.items() if each in (name, field.alias)]
        here = [cls for field in fields for cls in classes(field.annotation)] or here
    return tuple(dict.fromkeys(field.alias or name for cls in here for name, field in cls.model_fields.items()))
