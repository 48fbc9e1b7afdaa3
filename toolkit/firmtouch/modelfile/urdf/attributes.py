"""Attributes of elements as words and numbers; every mistake is kept at its place, and reading goes on."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Final

from firmtouch.errors import Diagnostic, ModelFileError
from firmtouch.modelfile.urdf.robot import Triple
from firmtouch.modelfile.urdf.xmltext import Element, XmlDocument
from firmtouch.modelfile.words import did_you_mean, shown

MOST_MISTAKES: Final = 100
LARGEST_SIZE: Final = 1e9
"""Lengths, angles, masses and inertias beyond this (in SI) are no robot's, and their products might overflow."""
_NUMBER: Final = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")


class Attributes:
    """Reads a document's attributes and gathers what is wrong with them."""

    def __init__(self, document: XmlDocument) -> None:
        self._document = document
        self._mistakes: list[Diagnostic] = []

    def refuse(self, element: Element, message: str, attribute: str | None = None) -> None:
        """Keep a mistake; too many of them end the reading."""
        place = self._document.place(element, attribute)
        self._mistakes.append(Diagnostic(self._document.name, *place, message))
        if len(self._mistakes) >= MOST_MISTAKES:
            self.finish()

    def finish(self) -> None:
        """Raise what was wrong, if anything was."""
        if self._mistakes:
            raise ModelFileError(tuple(self._mistakes))

    def word(self, element: Element, name: str, what: str) -> str:
        """Read a name that must be there; `what` says whose it is."""
        word = element.attributes.get(name, "").strip()
        if not word:
            self.refuse(element, f"{what} has no `{name}`", name)
        return word

    def number(self, element: Element, name: str, default: float | None = None, *, largest: float = math.inf) -> float:
        """Read a finite number, of at most this size."""
        text = element.attributes.get(name)
        if text is None and default is not None:
            return default
        if text is None:
            self.refuse(element, f"`<{element.tag}>` has no `{name}`")
            return math.nan
        return self._numbers(element, name, text, 1, largest)[0]

    def triple(self, element: Element, name: str, default: Triple) -> Triple:
        """Read three finite numbers that are sizes."""
        text = element.attributes.get(name)
        if text is None:
            return default
        x, y, z = self._numbers(element, name, text, 3, LARGEST_SIZE)
        return x, y, z

    def known(self, element: Element, names: Sequence[str]) -> None:
        """Refuse attributes that look like misspelt ones of these, which then are missing; others are other tools'."""
        missing = [each for each in names if each not in element.attributes]
        for name in element.attributes:
            if name not in names and (near := did_you_mean(name, missing)):
                self.refuse(element, f"`<{element.tag}>` has no attribute {shown(name)}{near}", name)

    def only(self, element: Element, tag: str, what: str) -> Element | None:
        """Give the one child of a tag, or None; a second one is refused."""
        found = element.all(tag)
        for each in found[1:]:
            self.refuse(each, f"a second `<{tag}>` of {what}")
        return found[0] if found else None

    def known_children(self, element: Element, tags: Sequence[str], what: str) -> None:
        """Refuse children that look like misspelt ones of these, and macros; others belong to other tools.

        What is misspelt is missing, but for a robot's elements, of which there are many.
        """
        missing = [each for each in tags if element.tag == "robot" or not element.all(each)]
        for child in element.children:
            if child.tag.startswith("xacro:"):
                message = f"{shown(child.tag)} is a macro; expand the file first: `xacro FILE > robot.urdf`"
                self.refuse(child, message)
            elif child.tag not in tags and (near := did_you_mean(child.tag, missing)):
                self.refuse(child, f"{what} has no {shown(f'<{child.tag}>')}{near}")

    def _numbers(self, element: Element, name: str, text: str, count: int, largest: float) -> list[float]:
        words = text.split()
        wrong = next((each for each in words if not _NUMBER.fullmatch(each)), None)
        wanted = "a number" if count == 1 else f"{count} numbers"
        if "${" in text or "$(" in text:
            message = f"{shown(text)} is a macro's expression; expand the file first: `xacro FILE > robot.urdf`"
        elif wrong is not None:
            message = f"{shown(wrong)} is no number; `{name}` takes {wanted}"
        elif len(words) != count:
            message = f"`{name}` takes {wanted}, not {len(words)}"
        elif any(math.isinf(float(each)) or abs(float(each)) > largest for each in words):
            message = f"{shown(text)} is too large"
        else:
            return [float(each) for each in words]
        self.refuse(element, message, name)
        return [math.nan] * count
