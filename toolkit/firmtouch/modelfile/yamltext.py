"""Bytes of a YAML file -> plain data, and where each piece of it stands.

Only plain data can come out: mappings with text keys, sequences, text, numbers, booleans, null. It is built here from
the events of ruamel's parser, as they come: tags, anchors and aliases, a second document, and more or deeper data than
any model has are refused where they begin.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final, NoReturn

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import (
    DocumentStartEvent,
    Event,
    MappingEndEvent,
    MappingStartEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
    StreamEndEvent,
)
from ruamel.yaml.reader import ReaderError

from firmtouch.errors import Diagnostic, ModelFileError
from firmtouch.modelfile.words import shown

LARGEST: Final = 200_000
DEEPEST: Final = 16
_LINE_BREAK: Final = re.compile(r"\r\n?|\n")
_NUMBER: Final = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
_NO_NUMBER: Final = re.compile(r"[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")
_WORDS: Final = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), None),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}
"""The words that are no text in YAML 1.2, where they are not quoted."""
LONGEST_INTEGER: Final = 16
BLOCKS: Final = ("|", ">")
EMPTY: Final = {
    "model": "the file is empty; `firmtouch new NAME` writes one to start from",
    "scenario": "the file is empty; scenarios stand under `scenarios:`, each under its name",
    "sensor": "the file is empty; a sensor's layers stand under `stack:`, from the touched face inward",
    "catalogue": "the file is empty; rows stand under `materials:`, `parts:` and `contacts:`, each under its name",
}
ROOT: Final = {
    "model": "`title:`, `coordinates:`, `mechanism:` and so on",
    "scenario": "`schema:` and `scenarios:`",
    "sensor": "`title:`, `stack:`, `objects:` and so on",
    "catalogue": "`schema:`, `materials:`, `parts:` and `contacts:`",
}
"""What a file of each sort is a mapping of."""
MOST_ENTRIES: Final = 5000
"""Ten times what the largest mechanism needs; each entry costs ruamel about 0.1 ms."""
Path = tuple[str | int, ...]
NOWHERE: Final = -1
"""Where values stand that are not kept: at no index."""


@dataclass(frozen=True, slots=True)
class Document:
    """The data of a file, the events that its values and keys came from, and what was wrong with it already."""

    name: str
    text: str
    data: Any
    values: dict[Path, Event]
    keys: dict[Path, Event]
    mistakes: tuple[Diagnostic, ...]

    def place(self, path: Path, *, offset: int = 0, key: bool = False) -> tuple[int, int]:
        """Give the line and column `offset` characters into the value at `path`, or those of its key.

        A path that leads further down than the file does gives the deepest part that exists: where a section is written
        in its short form, that is the value. A value that is not written at all has the place of its key.
        """
        while path and path not in self.values:
            path = path[:-1]
            key = not isinstance(self.values.get(path), ScalarEvent)
        value = self.values[path]
        nothing = isinstance(value, ScalarEvent) and value.implicit[0] and not value.value
        event = self.keys.get(path, value) if key or nothing else value
        return _position(self.text, event, offset)


def read_yaml(content: bytes, name: str, sort: str = "model") -> Document:
    """Read a YAML document; `name` is the file's name in messages, `sort` what it should be, a key of `ROOT`.

    Raises
    ------
    ModelFileError
        If it is no text, no YAML, empty, too large, or uses what plain data cannot hold. Keys that stand twice and
        numbers that are not finite do not stop the reading; they are listed in `Document.mistakes`.
    """
    text = _decoded(content, name, sort)
    builder = _Builder(name, sort, YAML(typ="safe", pure=True).parse(text))
    try:
        data = builder.document()
    except ReaderError as error:
        _fail(name, *_line_and_column(text, error.position), f"a character that YAML does not allow ({error.reason})")
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
        reason = " ".join(str(each) for each in (error.context, error.problem) if each)
        _fail(name, line, column, f"no valid YAML: {reason}")
    except (YAMLError, ValueError) as error:
        _fail(name, 1, 1, f"no valid YAML: {str(error).splitlines()[0]}")
    return Document(name, text, data, builder.values, builder.keys, tuple(builder.mistakes))


def _fail(name: str, line: int, column: int, message: str) -> NoReturn:
    raise ModelFileError((Diagnostic(name, line, column, message),))


def _decoded(content: bytes, name: str, sort: str) -> str:
    if len(content) > LARGEST:
        _fail(name, 1, 1, f"a file of {len(content)} bytes; at most {LARGEST} are read")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start]
        line, column = before.count(b"\n") + 1, error.start - (before.rfind(b"\n") + 1) + 1
        _fail(name, line, column, f"no UTF-8 text (byte 0x{content[error.start]:02x}): is this a {sort} file?")
    if not text.strip():
        _fail(name, 1, 1, EMPTY[sort])
    return text


class _Builder:
    """Builds plain data from events, and remembers where each piece stands."""

    def __init__(self, name: str, sort: str, events: Iterator[Event]) -> None:
        self.values: dict[Path, Event] = {}
        self.keys: dict[Path, Event] = {}
        self.mistakes: list[Diagnostic] = []
        self._name, self._sort = name, sort
        self._events = events
        self._entries = 0

    def document(self) -> dict[str, Any]:
        """Build the one document of the stream."""
        next(self._events)  # the stream's start
        start = next(self._events)
        if isinstance(start, StreamEndEvent):
            self._fail(start, EMPTY[self._sort], at=(1, 1))
        assert isinstance(start, DocumentStartEvent)
        if start.version not in (None, (1, 2)):
            self._fail(start, "another YAML than 1.2, where words and numbers would mean something else")
        root = next(self._events)
        data = self._build(root, ())
        next(self._events)  # the document's end
        after = next(self._events)
        if not isinstance(after, StreamEndEvent):
            self._fail(after, f"a second document; a {self._sort} file holds one")
        if not isinstance(data, dict):
            self._fail(root, f"a {self._sort} file is a mapping of {ROOT[self._sort]}", at=(1, 1))
        return data

    def _fail(self, event: Event, message: str, *, at: tuple[int, int] | None = None) -> NoReturn:
        _fail(self._name, *(at or _start(event)), message)

    def _refuse(self, event: Event, message: str) -> None:
        self.mistakes.append(Diagnostic(self._name, *_start(event), message))

    def _build(self, event: Event, path: Path) -> Any:  # noqa: ANN401  # plain data of any shape
        self._refuse_what_is_not_plain(event, path)
        self.values[path] = event
        match event:
            case MappingStartEvent():
                return self._mapping(path)
            case SequenceStartEvent():
                return self._sequence(path)
            case ScalarEvent():
                return self._scalar(event)

    def _refuse_what_is_not_plain(self, event: Event, path: Path) -> None:
        if not isinstance(event, ScalarEvent | MappingStartEvent | SequenceStartEvent) or event.anchor is not None:
            self._fail(event, "anchors and aliases are not read here; write the value out")
        if event.ctag is not None and str(event.ctag) != "None":
            self._fail(event, f"the tag {shown(str(event.ctag))}; a {self._sort} file is plain data, without tags")
        if len(path) > DEEPEST:
            self._fail(event, f"nested more than {DEEPEST} deep")
        self._entries += 1
        if self._entries > MOST_ENTRIES:
            self._fail(event, f"more than {MOST_ENTRIES} keys and values")

    def _mapping(self, path: Path) -> dict[str, Any]:
        data: dict[str, Any] = {}
        while not isinstance(event := next(self._events), MappingEndEvent):
            key = self._key(event, path)
            if key is not None and key not in data:
                self.keys[(*path, key)] = event
                data[key] = self._build(next(self._events), (*path, key))
                continue
            if key is not None:
                first, _ = _start(self.keys[(*path, key)])
                self._refuse(event, f"{shown(key)} stands here twice; first in line {first}")
            self._build(next(self._events), (*path, NOWHERE))
        return data

    def _key(self, event: Event, path: Path) -> str | None:
        if isinstance(event, ScalarEvent):
            self._refuse_what_is_not_plain(event, path)
            return str(event.value)
        self._build(event, (*path, NOWHERE))
        self._refuse(event, "a key that is no text")
        return None

    def _sequence(self, path: Path) -> list[Any]:
        data: list[Any] = []
        while not isinstance(event := next(self._events), SequenceEndEvent):
            data.append(self._build(event, (*path, len(data))))
        return data

    def _scalar(self, event: ScalarEvent) -> str | float | int | bool | None:
        text = str(event.value)
        if not event.implicit[0]:  # quoted, or a block
            return text
        if text in _WORDS:
            return _WORDS[text]
        if _NO_NUMBER.fullmatch(text) or (_NUMBER.fullmatch(text) and not math.isfinite(float(text))):
            self._refuse(event, f"{shown(text)} is no finite number")
            return None
        if not _NUMBER.fullmatch(text):
            return text
        return int(text) if text.lstrip("+-").isdigit() and len(text) <= LONGEST_INTEGER else float(text)


def _start(event: Event) -> tuple[int, int]:
    return event.start_mark.line + 1, event.start_mark.column + 1


def _line_and_column(text: str, index: int) -> tuple[int, int]:
    starts = [each.end() for each in _LINE_BREAK.finditer(text[:index])]
    return len(starts) + 1, index - (starts[-1] if starts else 0) + 1


def _position(text: str, event: Event, offset: int) -> tuple[int, int]:
    """Find where the character `offset` of a scalar's value stands: folding and quoting change white space only."""
    if not isinstance(event, ScalarEvent) or (offset == 0 and event.style not in BLOCKS):
        return _start(event)
    value, start, end = str(event.value), event.start_mark.index, event.end_mark.index
    at = start
    if event.style in BLOCKS:  # the text begins below its `|` or `>-`
        line_break = _LINE_BREAK.search(text, start, end)
        at = line_break.end() if line_break else end
    elif not event.implicit[0]:
        at = start + 1  # behind the quote
    for wanted in value[: offset + 1]:
        if wanted.isspace():
            continue
        found = text.find(wanted, at, end)
        if found < 0:
            break
        at = found + 1
    return _line_and_column(text, max(at - 1, start))
