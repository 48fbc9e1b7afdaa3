"""Bytes of files: the model file's own, and those of files that it names."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

from firmtouch.errors import InputError
from firmtouch.modelfile.words import shown
from firmtouch.modelfile.yamltext import LARGEST

LARGEST_ATTACHED: Final = 2_000_000
"""Ten times what the URDF of a humanoid takes, in bytes."""
Attached = Callable[[str], tuple[str, bytes]]
"""Reads a file that a model file names: gives the name for messages, and the bytes."""


def beside(path: Path) -> Attached:
    """Read files by their paths relative to another file."""

    def read(named: str) -> tuple[str, bytes]:
        other = path.parent / named
        try:
            usable = other.is_file()
            exists = usable or other.exists()
        except OSError as error:  # a name that is too long, a directory that is closed to us
            raise InputError(f"{shown(str(other), 200)} cannot be read ({error.strerror})") from error
        if not usable:
            raise InputError(
                f"{shown(str(other), 200)} is no file" if exists else f"there is no file {shown(str(other), 200)}"
            )
        return str(other), read_bytes(other, LARGEST_ATTACHED)

    return read


def kept(files: Mapping[str, bytes]) -> Attached:
    """Give files that were kept with a design."""

    def read(named: str) -> tuple[str, bytes]:
        if named not in files:
            raise InputError(f"the file {shown(named, 200)} was not kept")
        return named, files[named]

    return read


def read_bytes(path: Path, largest: int = LARGEST) -> bytes:
    """Read what may be read of a file, and one byte more.

    Raises
    ------
    InputError
        If it cannot be read at all.
    """
    try:
        with path.open("rb") as file:
            return file.read(largest + 1)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else None
        raise InputError(f"{path}: cannot be read ({reason or error})") from error
