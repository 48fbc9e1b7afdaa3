"""Bytes of a YAML file -> plain data, and where each piece of it stands.

Only plain data can come out: mappings with text keys, sequences, text, numbers, booleans, null. Tags, anchors and
aliases, several documents, and nesting beyond any model are refused before anything is built from them.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any, Final

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import AliasEvent, CollectionEndEvent, CollectionStartEvent, DocumentStartEvent, ScalarEvent
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode
from ruamel.yaml.reader import ReaderError

from firmtouch.errors import Diagnostic, ModelFileError
from firmtouch.modelfile.words import shown

LARGEST: Final = 200_000
DEEPEST: Final = 16
_LINE_BREAK: Final = re.compile(r"\r\n?|\n")
MOST_ENTRIES: Final = 5000
"""Ten times what the largest mechanism needs; each entry costs ruamel about 0.1 ms."""
Path = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Document:
    """The data of a file, the nodes that its values and keys came from, and what was wrong with it already."""

    name: str
    text: str
    data: Any
    values: dict[Path, Node]
    keys: dict[Path, Node]
    mistakes: tuple[Diagnostic, ...]

    def place(self, path: Path, *, offset: int = 0, key: bool = False) -> tuple[int, int]:
        """Give the line and column `offset` characters into the value at `path`, or those of its key.

        A path that leads further down than the file does gives the deepest part that exists.
        """
        while path and path not in self.values:
            path, offset = path[:-1], 0
            key = not isinstance(self.values.get(path), ScalarNode)
        node = self.keys.get(path) if key else None
        if node is None:
            node = self.values[path]
        return _position(self.text, node, offset)


def read_yaml(content: bytes, name: str) -> Document:
    """Read a YAML document; `name` is the file's name in messages.

    Raises
    ------
    ModelFileError
        If it is no text, no YAML, empty, too large, or uses what plain data cannot hold. Keys that stand twice and
        numbers that are not finite do not stop the reading; they are listed in `Document.mistakes`.
    """
    text = _decoded(content, name)
    try:
        _refuse_what_is_not_plain(text, name)
        root = YAML(typ="safe", pure=True).compose(text)
    except ReaderError as error:
        _fail(name, *_line_and_column(text, error.position), f"a character that YAML does not allow ({error.reason})")
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
        reason = " ".join(str(each) for each in (error.context, error.problem) if each)
        _fail(name, line, column, f"no valid YAML: {reason}")
    except (YAMLError, ValueError) as error:
        _fail(name, 1, 1, f"no valid YAML: {str(error).splitlines()[0]}")
    if root is None:
        _fail(name, 1, 1, "the file is empty; `firmtouch new NAME` writes one to start from")
    if not isinstance(root, MappingNode):
        _fail(name, 1, 1, "a model file is a mapping of `title:`, `coordinates:`, `mechanism:` and so on")
    builder = _Builder(name)
    data = builder.build(root, ())
    return Document(name, text, data, builder.values, builder.keys, tuple(builder.mistakes))


def _fail(name: str, line: int, column: int, message: str) -> None:
    raise ModelFileError((Diagnostic(name, line, column, message),))


def _decoded(content: bytes, name: str) -> str:
    if len(content) > LARGEST:
        _fail(name, 1, 1, f"a file of {len(content)} bytes; at most {LARGEST} are read")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start]
        line, column = before.count(b"\n") + 1, error.start - (before.rfind(b"\n") + 1) + 1
        _fail(name, line, column, f"no UTF-8 text (byte 0x{content[error.start]:02x}): is this a model file?")
    if not text.strip():
        _fail(name, 1, 1, "the file is empty; `firmtouch new NAME` writes one to start from")
    return text


def _refuse_what_is_not_plain(text: str, name: str) -> None:
    depth, documents, entries = 0, 0, 0
    for event in YAML(typ="safe", pure=True).parse(text):
        line, column = event.start_mark.line + 1, event.start_mark.column + 1
        if isinstance(event, DocumentStartEvent):
            documents += 1
            if documents > 1:
                _fail(name, line, column, "a second document; a model file holds one")
            if event.version not in (None, (1, 2)):
                _fail(name, line, column, "another YAML than 1.2, where words and numbers would mean something else")
        if isinstance(event, AliasEvent) or getattr(event, "anchor", None) is not None:
            _fail(name, line, column, "anchors and aliases are not read here; write the value out")
        if (
            isinstance(event, ScalarEvent | CollectionStartEvent)
            and event.ctag is not None
            and str(event.ctag) != "None"
        ):
            _fail(name, line, column, f"the tag {shown(str(event.ctag))}; a model file is plain data, without tags")
        depth += isinstance(event, CollectionStartEvent) - isinstance(event, CollectionEndEvent)
        if depth > DEEPEST:
            _fail(name, line, column, f"nested more than {DEEPEST} deep")
        entries += isinstance(event, ScalarEvent | CollectionStartEvent)
        if entries > MOST_ENTRIES:
            _fail(name, line, column, f"more than {MOST_ENTRIES} keys and values")


class _Builder:
    """Builds plain data from nodes, and remembers where each piece stands."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.values: dict[Path, Node] = {}
        self.keys: dict[Path, Node] = {}
        self.mistakes: list[Diagnostic] = []

    def refuse(self, node: Node, message: str) -> None:
        self.mistakes.append(Diagnostic(self.name, node.start_mark.line + 1, node.start_mark.column + 1, message))

    def build(self, node: Node, path: Path) -> Any:  # noqa: ANN401  # plain data of any shape
        self.values[path] = node
        if isinstance(node, MappingNode):
            return self._mapping(node, path)
        if isinstance(node, SequenceNode):
            return [self.build(each, (*path, i)) for i, each in enumerate(node.value)]
        assert isinstance(node, ScalarNode)
        return self._scalar(node)

    def _mapping(self, node: MappingNode, path: Path) -> dict[str, Any]:
        data: dict[str, Any] = {}
        for key_node, value_node in node.value:
            key = key_node.value if isinstance(key_node, ScalarNode) else None
            if key is None:
                self.refuse(key_node, "a key that is no text")
            elif key in data:
                line = self.keys[(*path, key)].start_mark.line + 1
                self.refuse(key_node, f"{shown(key)} stands here twice; first in line {line}")
            else:
                self.keys[(*path, key)] = key_node
                data[key] = self.build(value_node, (*path, key))
        return data

    def _scalar(self, node: ScalarNode) -> Any:  # noqa: ANN401  # text, a number, a boolean or null
        kind = str(node.tag).rpartition(":")[2]
        text = str(node.value)
        match kind:
            case "null":
                return None
            case "bool":
                return text.lower() == "true"
            case "int" | "float":
                return self._number(text, node)
            case _:
                return text

    def _number(self, text: str, node: ScalarNode) -> float | int | str:
        try:
            value = (
                int(text)
                if text.lstrip("+-").isdigit() and len(text) < 17
                else float(text.lower().replace(".n", "n").replace(".i", "i"))
            )
        except ValueError:
            return text
        if not math.isfinite(value):
            self.refuse(node, f"{shown(text)} is no finite number")
            return 0.0
        return value


def _line_and_column(text: str, index: int) -> tuple[int, int]:
    starts = [each.end() for each in _LINE_BREAK.finditer(text[:index])]
    return len(starts) + 1, index - (starts[-1] if starts else 0) + 1


def _position(text: str, node: Node, offset: int) -> tuple[int, int]:
    """Find where the character `offset` of a scalar's value stands: folding and quoting change white space only."""
    start = node.start_mark.index
    block = isinstance(node, ScalarNode) and node.style in ("|", ">")
    if not isinstance(node, ScalarNode) or (offset == 0 and not block):
        return node.start_mark.line + 1, node.start_mark.column + 1
    value, end = str(node.value), node.end_mark.index
    # The text of a block begins below its `|` or `>-`, that of a quoted scalar behind the quote.
    at = text.find("\n", start) if block else start + (node.style is not None)
    for wanted in value[: offset + 1]:
        if wanted.isspace():
            continue
        found = text.find(wanted, at, end)
        if found < 0:
            break
        at = found + 1
    return _line_and_column(text, max(at - 1, start))
