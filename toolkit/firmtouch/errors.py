"""The one family of errors that firmtouch raises for what a user can get wrong.

`InputError` means that the question was wrong (exit code 2), `NoDesignError` that the answer is no (exit code 1).
Each error carries its evidence as fields; its text says what was found, what was expected, and what to do.
"""

from __future__ import annotations

from dataclasses import dataclass


class FirmtouchError(Exception):
    """Base of every error that firmtouch raises on purpose."""


class InputError(FirmtouchError):
    """The question was wrong: a file, a path or an argument cannot be used."""


class NoDesignError(FirmtouchError):
    """The answer is no: the model is well formed, but what it asks for does not exist or was not reached."""


@dataclass(frozen=True, slots=True, order=True)
class Diagnostic:
    """One mistake in a file, at a line and a column that both count from one."""

    file: str
    line: int
    column: int
    message: str

    def __str__(self) -> str:
        """Write it as compilers and editors do."""
        return f"{self.file}:{self.line}:{self.column}: {self.message}"


class ModelFileError(InputError):
    """All mistakes of one model file, in the order of the file."""

    def __init__(self, diagnostics: tuple[Diagnostic, ...]) -> None:
        self.diagnostics = tuple(sorted(set(diagnostics)))
        super().__init__("\n".join(str(each) for each in self.diagnostics))
