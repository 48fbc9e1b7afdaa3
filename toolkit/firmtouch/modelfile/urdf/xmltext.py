"""Bytes of an XML file -> elements with their attributes, and where each stands.

A file can only hold elements: document types, and with them every entity, are refused where they begin, so nothing can
be fetched, included or multiplied. Comments, text and processing instructions say nothing in URDF and are passed over.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Final, NoReturn
from xml.parsers import expat

from firmtouch.errors import Diagnostic, ModelFileError
from firmtouch.modelfile.urdf.robot import Place
from firmtouch.modelfile.words import shown

LARGEST: Final = 2_000_000
"""Bytes; a humanoid with two hands has a tenth of it."""
DEEPEST: Final = 32
MOST_ELEMENTS: Final = 50_000
UTF_8: Final = ("utf-8", "utf8", "us-ascii", "ascii")
_ATTRIBUTE: Final = re.compile(rb"""\s+([^\s=]+)\s*=\s*("[^"]*"|'[^']*')""")
_TAG: Final = re.compile(rb"<[^\s/>]+")


@dataclass(frozen=True, slots=True)
class Element:
    """An element; its tag begins at the byte `offset`, which is at `place`."""

    tag: str
    attributes: dict[str, str]
    offset: int
    place: Place
    children: list[Element] = field(default_factory=list)

    def all(self, tag: str) -> list[Element]:
        """Give the children of one tag."""
        return [each for each in self.children if each.tag == tag]


@dataclass(frozen=True, slots=True)
class XmlDocument:
    """The root element of a file; `name` is the file's name in messages."""

    name: str
    content: bytes
    root: Element

    def place(self, element: Element, attribute: str | None = None) -> Place:
        """Give the line and column of an element, or of the value of one of its attributes where that is written."""
        tag = _TAG.match(self.content, element.offset)
        end = tag.end() if tag and attribute is not None else None
        while end is not None and (found := _ATTRIBUTE.match(self.content, end)):
            if found[1].decode() == attribute:
                return _further(element.place, self.content[element.offset : found.start(2) + 1])
            end = found.end()
        return element.place


def read_xml(content: bytes, name: str) -> XmlDocument:
    """Read the elements of an XML file.

    Raises
    ------
    ModelFileError
        If it is too large, no UTF-8, no XML, has a document type, or is nested deeper than any robot.
    """
    if len(content) > LARGEST:
        _fail(name, b"", 0, f"a file of more than {LARGEST} bytes, which is more than is read")
    content = content.removeprefix(b"\xef\xbb\xbf")
    try:
        content.decode("utf-8")
    except UnicodeDecodeError as error:
        message = f"no UTF-8 text (byte 0x{content[error.start]:02x}): is this a URDF file?"
        _fail(name, content, error.start, message)
    if not content.strip():
        _fail(name, content, 0, "the file is empty; a URDF file holds one `<robot>`")
    if b"\0" in content:  # expat would take it for UTF-16
        _fail(name, content, content.index(b"\0"), "a null byte; only UTF-8 text is read")
    return XmlDocument(name, content, _Builder(name, content).root())


def _further(place: Place, content: bytes) -> Place:
    """Give the place behind some text that begins at a place."""
    lines = content.replace(b"\r\n", b"\n").replace(b"\r", b"\n").split(b"\n")
    line, column = place
    start = column if len(lines) == 1 else 1
    return line + len(lines) - 1, start + len(lines[-1].decode("utf-8", "replace"))


def _fail(name: str, content: bytes, offset: int, message: str) -> NoReturn:
    raise ModelFileError((Diagnostic(name, *_further((1, 1), content[:offset]), message),))


class _Builder:
    """Builds the elements from expat's events."""

    def __init__(self, name: str, content: bytes) -> None:
        self._name, self._content = name, content
        self._open: list[Element] = []
        self._roots: list[Element] = []
        self._count = 0
        self._at, self._place = 0, (1, 1)
        self._parser = expat.ParserCreate("utf-8")
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.XmlDeclHandler = self._declaration
        self._parser.StartDoctypeDeclHandler = self._doctype

    def root(self) -> Element:
        try:
            self._parser.Parse(self._content, True)
        except expat.ExpatError as error:
            reason = expat.errors.messages[error.code] if error.code in expat.errors.messages else str(error)
            _fail(self._name, self._content, max(self._parser.ErrorByteIndex, 0), f"no valid XML: {reason}")
        return self._roots[0]

    def _refuse(self, message: str, offset: int | None = None) -> NoReturn:
        _fail(self._name, self._content, self._parser.CurrentByteIndex if offset is None else offset, message)

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        self._count += 1
        if self._count > MOST_ELEMENTS:
            self._refuse(f"more than {MOST_ELEMENTS} elements, which is more than is read")
        if len(self._open) >= DEEPEST:
            self._refuse(f"elements nested more than {DEEPEST} deep")
        # Counted on from the last element, so that a large file of one line is not counted again for each.
        offset = self._parser.CurrentByteIndex
        self._place, self._at = _further(self._place, self._content[self._at : offset]), offset
        element = Element(tag, attributes, offset, self._place)
        (self._open[-1].children if self._open else self._roots).append(element)
        self._open.append(element)

    def _end(self, _tag: str) -> None:
        self._open.pop()

    def _declaration(self, _version: str, encoding: str | None, _standalone: int) -> None:
        if encoding is not None and encoding.lower() not in UTF_8:
            self._refuse(f"the encoding {shown(encoding)}; only UTF-8 is read")

    def _doctype(self, *_: object) -> None:
        # expat tells of it where its name or its first entity ends.
        start = self._content.rfind(b"<!DOCTYPE", 0, self._parser.CurrentByteIndex + 9)
        message = "a document type (`<!DOCTYPE`), which could define entities; URDF has none: take it out"
        self._refuse(message, max(start, 0))
