"""What is wrong with a piece of text, and where in it."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Problem:
    """A mistake `offset` characters into a text; `path` leads to that text from where the problem is reported."""

    message: str
    offset: int = 0
    path: tuple[str | int, ...] = ()

    def below(self, *path: str | int) -> Problem:
        """Give the same problem as seen from further up."""
        return Problem(self.message, self.offset, (*path, *self.path))


class ExpressionError(Exception):
    """One or more problems of an expression; never leaves `firmtouch.modelfile`."""

    def __init__(self, *problems: Problem) -> None:
        self.problems = problems
        super().__init__("; ".join(each.message for each in problems))


def did_you_mean(word: str, choices: Iterable[str]) -> str:
    """End a message with the nearest choice, or with nothing where none is near."""
    near = difflib.get_close_matches(word[:64], list(choices), n=1, cutoff=0.6)
    return f"; did you mean `{near[0]}`?" if near else ""


def shown(text: str, limit: int = 40) -> str:
    """Quote a piece of a file for a message: one line, printable, not longer than `limit`."""
    clean = "".join(each if each.isprintable() else "\N{REPLACEMENT CHARACTER}" for each in text)
    return f"`{clean}`" if len(clean) <= limit else f"`{clean[: limit - 1]}…`"
