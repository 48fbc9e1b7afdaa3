"""Words for messages: a piece of a file, quoted so that it cannot harm a terminal, and the nearest name."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from itertools import islice
from typing import Final

LONGEST_WORD: Final = 64
MOST_CHOICES: Final = 500
"""More names than this are not searched: every comparison takes some microseconds."""


def did_you_mean(word: str, choices: Iterable[str]) -> str:
    """End a message with the nearest choice, or with nothing where none is near."""
    near = difflib.get_close_matches(word[:LONGEST_WORD], list(islice(choices, MOST_CHOICES)), n=1, cutoff=0.6)
    return f"; did you mean {shown(near[0])}?" if near else ""


def shown(text: str, limit: int = 40) -> str:
    """Quote a piece of a file for a message: one line, printable, not longer than `limit`."""
    return f"`{_printable(text)}`" if len(text) <= limit else f"`{_printable(text[: limit - 1])}…`"


def _printable(text: str) -> str:
    return "".join(each if each.isprintable() else "\N{REPLACEMENT CHARACTER}" for each in text)


def listed(words: Iterable[str], most: int = 12) -> str:
    """Join words with commas, and count those that are too many to name."""
    words = list(words)
    more = f" and {len(words) - most} more" if len(words) > most else ""
    return ", ".join(map(_printable, words[:most])) + more
