"""What is wrong with a piece of text, and where in it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from firmtouch.modelfile.words import did_you_mean


@dataclass(frozen=True, slots=True)
class Problem:
    """A mistake `offset` characters into a text; `path` leads to that text from where the problem is reported.

    `at_key` says that it is about the key there, not about the value. `near` is a word and the choices among which it
    was not; they are compared only when the problem is told.
    """

    message: str
    offset: int = 0
    path: tuple[str | int, ...] = ()
    at_key: bool = False
    near: tuple[str, tuple[str, ...]] = ("", ())

    def below(self, *path: str | int) -> Problem:
        """Give the same problem as seen from further up."""
        return replace(self, path=(*path, *self.path))

    def in_words(self) -> str:
        """Write the message, and the choice that was perhaps meant."""
        return self.message + did_you_mean(*self.near)


class ExpressionError(Exception):
    """One or more problems of an expression; never leaves `firmtouch.modelfile`."""

    def __init__(self, *problems: Problem) -> None:
        self.problems = problems
        super().__init__("; ".join(each.message for each in problems))
