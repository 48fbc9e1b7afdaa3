"""Names and texts."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Annotated, Final

from pydantic import ValidationInfo

from firmtouch.modelfile.declarations import Declarations
from firmtouch.modelfile.expression import CONSTANTS, FUNCTIONS, Problem
from firmtouch.modelfile.fields.checked import Checked, declared, refuse
from firmtouch.modelfile.words import listed, shown

NAME: Final = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,31}")
RESERVED: Final = frozenset({*FUNCTIONS, *CONSTANTS, "dot"} - {"x", "y", "z"})
LONGEST_TEXT: Final = 2000


def _label(raw: object) -> str:
    if not isinstance(raw, str) or not NAME.fullmatch(raw):
        message = f"{shown(str(raw))} is no name; names are a letter and up to 31 letters, digits or `_`"
        refuse(Problem(message, at_key=True))
    return raw


Label = Annotated[str, Checked(lambda raw, _: _label(raw), {"type": "string", "pattern": f"^{NAME.pattern}$"})]
"""The name of a constraint, a body, a line: not a value that an expression could use."""


def new_name(raw: object, known: Declarations) -> str:
    """Check a name that the file declares."""
    name = _label(raw)
    if name in RESERVED:
        refuse(Problem(f"`{name}` is the name of a function or a constant; choose another", at_key=True))
    spaces = {"parameter": known.parameters, "coordinate": known.coordinates, "definition": known.definitions}
    homes = [kind for kind, names in spaces.items() if name in names]
    if len(homes) > 1:
        refuse(Problem(f"`{name}` is declared twice, as a {' and as a '.join(homes)}", at_key=True))
    return name


NewName = Annotated[
    str, Checked(lambda raw, info: new_name(raw, declared(info)), {"type": "string", "pattern": f"^{NAME.pattern}$"})
]
"""A name that the file declares here."""


def _text(raw: object, info: ValidationInfo) -> str:  # noqa: ARG001  # the signature is pydantic's
    if not isinstance(raw, str) or not raw.strip() or len(raw) > LONGEST_TEXT:
        refuse(Problem(f"a text was expected (not empty, at most {LONGEST_TEXT} characters)"))
    if not all(each.isprintable() or each.isspace() for each in raw):
        refuse(Problem("a text with characters that cannot be printed"))
    return " ".join(raw.split())


Text = Annotated[str, Checked(_text, {"type": "string", "minLength": 1, "maxLength": LONGEST_TEXT})]


def check_keys(given: Iterable[str], choices: Iterable[str], what: str, *, complete: bool) -> None:
    """Refuse keys that are not among the choices, and, if it shall be complete, choices that are missing."""
    given, choices = tuple(given), tuple(choices)
    problems = [
        Problem(
            f"{shown(each)} is no {what}; there are: {listed(choices)}", path=(each,), at_key=True, near=(each, choices)
        )
        for each in given
        if each not in choices
    ]
    missing = [each for each in choices if each not in given] if complete else []
    if missing:
        problems.append(Problem(f"no entry for the {what} {listed(f'`{each}`' for each in missing)}"))
    if problems:
        refuse(*problems)
