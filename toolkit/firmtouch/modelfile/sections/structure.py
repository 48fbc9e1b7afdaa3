"""`structure`: which entries of the gains W and C may differ from zero."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Annotated, Any, Final

from pydantic import ValidationInfo

from firmtouch.modelfile.declarations import MOST_COORDINATES
from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import Checked, declared, refuse, under
from firmtouch.modelfile.words import listed, shown

Pattern = tuple[tuple[bool, ...], ...]
FORMS: Final = "`full`, `diagonal`, `{block: [[q1, q2], [q3]]}`, `{banded: 1}` or `{pattern: [[q1, q2]]}`"


@dataclass(frozen=True, slots=True)
class Structure:
    """A symmetric pattern, true where an entry may differ from zero; the diagonal always may.

    `kind` is full, diagonal, block, banded or pattern, and `text` is what was written.
    """

    kind: str
    text: str
    pattern: Pattern

    @classmethod
    def full(cls, n: int) -> Structure:
        """Allow all entries."""
        return cls("full", "full", _banded_pattern(n, n))

    @classmethod
    def diagonal(cls, n: int) -> Structure:
        """Allow the diagonal alone."""
        return cls("diagonal", "diagonal", _banded_pattern(n, 0))


def _structure(raw: object, info: ValidationInfo) -> Structure:
    names = tuple(declared(info).coordinates)
    n = len(names)
    if n > MOST_COORDINATES:  # the file is refused for its coordinates
        return Structure("full", "full", ())
    if raw == "full":
        return Structure.full(n)
    if raw == "diagonal":
        return Structure.diagonal(n)
    if not isinstance(raw, dict) or len(raw) != 1:
        near = (raw, ("full", "diagonal")) if isinstance(raw, str) else ("", ())
        refuse(Problem(f"a structure is {FORMS}", near=near))
    ((kind, entry),) = raw.items()
    if kind not in _READERS:
        choices = tuple(_READERS)
        message = f"{shown(kind)} is no structure; it is {FORMS}"
        refuse(Problem(message, path=(kind,), at_key=True, near=(kind, choices)))
    with under(kind):
        return _READERS[kind](entry, names)


def _block(raw: object, names: tuple[str, ...]) -> Structure:
    groups = _groups(raw, names, "a list of groups of coordinates was expected, as in `[[q1, q2], [q3]]`")
    seen: set[str] = set()
    problems = []
    for i, group in enumerate(groups):
        for j, name in enumerate(group):
            if name in seen:
                problems.append(Problem(f"`{name}` stands in the blocks twice", path=(i, j)))
            seen.add(name)
    missing = [name for name in names if name not in seen]
    if missing:
        problems.append(Problem(f"no block holds {listed(f'`{name}`' for name in missing)}"))
    if problems:
        refuse(*problems)
    return Structure("block", f"block: {_written(groups)}", _coupled(names, groups))


def _banded(raw: object, names: tuple[str, ...]) -> Structure:
    widest = len(names) - 1
    if isinstance(raw, bool) or not isinstance(raw, int) or not 0 <= raw <= widest:
        refuse(Problem(f"a number of diagonals beside the main one was expected, from 0 to n - 1 = {widest}"))
    return Structure("banded", f"banded: {raw}", _banded_pattern(len(names), raw))


def _pattern(raw: object, names: tuple[str, ...]) -> Structure:
    if raw == []:
        refuse(Problem("an empty pattern; write `diagonal`"))
    pairs = _groups(raw, names, "a list of pairs of coordinates was expected, as in `[[q1, q2], [q2, q3]]`")
    seen: set[frozenset[str]] = set()
    problems = []
    for i, pair in enumerate(pairs):
        if len(pair) != 2 or pair[0] == pair[1]:
            problems.append(Problem("two different coordinates were expected; the diagonal needs no entry", path=(i,)))
        elif frozenset(pair) in seen:
            problems.append(Problem(f"`{pair[0]}` and `{pair[1]}` stand in the pattern twice", path=(i,)))
        seen.add(frozenset(pair))
    if problems:
        refuse(*problems)
    return Structure("pattern", f"pattern: {_written(pairs)}", _coupled(names, pairs))


_READERS: Final[dict[str, Callable[[object, tuple[str, ...]], Structure]]] = {
    "block": _block,
    "banded": _banded,
    "pattern": _pattern,
}


def _groups(raw: object, names: tuple[str, ...], expected: str) -> tuple[tuple[str, ...], ...]:
    """Read lists of coordinates."""
    if not isinstance(raw, list) or not raw:
        refuse(Problem(expected))
    problems = [Problem(expected, path=(i,)) for i, group in enumerate(raw) if not isinstance(group, list) or not group]
    problems += [
        Problem(
            f"{shown(str(name))} is no coordinate; there are: {listed(names)}", path=(i, j), near=(str(name), names)
        )
        for i, group in enumerate(raw)
        if isinstance(group, list)
        for j, name in enumerate(group)
        if name not in names
    ]
    if problems:
        refuse(*problems)
    return tuple(tuple(group) for group in raw)


def _written(groups: Iterable[Iterable[str]]) -> str:
    return f"[{', '.join('[' + ', '.join(group) + ']' for group in groups)}]"


def _banded_pattern(n: int, width: int) -> Pattern:
    return tuple(tuple(abs(i - j) <= width for j in range(n)) for i in range(n))


def _coupled(names: tuple[str, ...], groups: Iterable[Iterable[str]]) -> Pattern:
    """Couple the coordinates of each group."""
    together = {(a, b) for group in groups for a in group for b in group}
    return tuple(tuple(a == b or (a, b) in together for b in names) for a in names)


_LISTS: Final[dict[str, Any]] = {
    "type": "array",
    "minItems": 1,
    "items": {"type": "array", "minItems": 1, "items": {"type": "string"}},
}
_PAIRS: Final[dict[str, Any]] = {
    **_LISTS,
    "items": {"type": "array", "minItems": 2, "maxItems": 2, "items": {"type": "string"}},
}


def _one_key(key: str, entry: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "properties": {key: entry}, "required": [key], "additionalProperties": False}


AnyStructure = Annotated[
    Structure,
    Checked(
        _structure,
        {
            "anyOf": [
                {"enum": ["full", "diagonal"]},
                _one_key("block", _LISTS),
                _one_key("banded", {"type": "integer", "minimum": 0}),
                _one_key("pattern", _PAIRS),
            ]
        },
    ),
]
