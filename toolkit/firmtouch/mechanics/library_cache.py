"""Where compiled libraries are kept: a directory that this user alone can write to.

What is loaded from it runs as this user. So nothing is taken from a directory, or as a file, that belongs to somebody
else or that others may write to; and a library is only loaded if it is the one whose checksum was written down after
it, because a file that was cut off can crash the process that loads it.
"""

from __future__ import annotations

import hashlib
import os
import stat
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

OTHERS_WRITE: Final = stat.S_IWGRP | stat.S_IWOTH
MOST_LIBRARIES: Final = 200
"""Of up to 2 MB each. What has not been used for the longest time goes first."""
LEFT_OVER: Final = 24 * 3600.0
"""Seconds after which a temporary file is one of a process that was killed."""


@dataclass(frozen=True, slots=True)
class LibraryCache:
    """A directory with `<key>.so` and `<key>.sha256`."""

    directory: Path

    def find(self, key: str) -> Path | None:
        """Give a library's path, if it is there, ours alone, and whole."""
        library, checksum = self._paths(key)
        if not (_ours(library, stat.S_ISREG) and _ours(checksum, stat.S_ISREG)):
            return None
        try:
            whole = hashlib.sha256(library.read_bytes()).hexdigest() == checksum.read_text(encoding="ascii").strip()
        except (OSError, UnicodeDecodeError):
            return None
        if not whole:
            return None
        with suppress(OSError):
            os.utime(library)  # used now
        return library

    @contextmanager
    def writing(self, key: str) -> Iterator[Path]:
        """Give a path to write a library to; it takes its place in one step, so that processes do not meet.

        Raises
        ------
        OSError
            If the directory cannot be written to.
        """
        library, checksum = self._paths(key)
        made = [self._temporary(), self._temporary()]
        try:
            yield made[0]
            made[1].write_text(hashlib.sha256(made[0].read_bytes()).hexdigest(), encoding="ascii")
            for each, place in zip(made, (library, checksum), strict=True):
                each.chmod(0o600)  # a linker makes the file anew, as the umask says
                each.replace(place)
        finally:
            for each in made:
                with suppress(OSError):
                    each.unlink(missing_ok=True)

    def tidy(self) -> None:
        """Delete the libraries that have not been used for the longest time, and what killed processes left over."""
        with suppress(OSError):  # another process may tidy up at the same time
            by_use = sorted(self.directory.glob("*.so"), key=lambda each: each.stat().st_mtime, reverse=True)
            for library in by_use[MOST_LIBRARIES:]:
                for each in self._paths(library.stem):
                    each.unlink(missing_ok=True)
            for each in self.directory.glob("*.tmp"):
                if time.time() - each.stat().st_mtime > LEFT_OVER:
                    each.unlink(missing_ok=True)

    def _paths(self, key: str) -> tuple[Path, Path]:
        return self.directory / f"{key}.so", self.directory / f"{key}.sha256"

    def _temporary(self) -> Path:
        number, name = tempfile.mkstemp(dir=self.directory, suffix=".tmp")
        os.close(number)
        return Path(name)


def open_cache() -> LibraryCache | None:
    """Open `firmtouch` in $XDG_CACHE_HOME, or in ~/.cache, and make it where it is missing; None if it is not ours."""
    named = Path(os.environ.get("XDG_CACHE_HOME", ""))
    try:
        directory = (named if named.is_absolute() else Path.home() / ".cache") / "firmtouch"
        directory.mkdir(mode=0o700, parents=True, exist_ok=True)
    except (OSError, RuntimeError):  # the latter where there is no home
        return None
    return LibraryCache(directory) if _ours(directory, stat.S_ISDIR) else None


def _ours(path: Path, kind: Callable[[int], bool]) -> bool:
    """Tell whether a path is of a kind, no link, this user's, and closed to the writing of others."""
    try:
        found = path.lstat()
    except OSError:
        return False
    return kind(found.st_mode) and found.st_uid == os.getuid() and not found.st_mode & OTHERS_WRITE
