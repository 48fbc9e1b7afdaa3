"""`firmtouch check` under observation: nothing may be run, written or left unanswered, and not for long."""

from __future__ import annotations

import contextlib
import faulthandler
import io
import os
import signal
import sys
import sysconfig
import warnings
from collections.abc import Iterator
from pathlib import Path

from firmtouch.cli import main

MODELS = {path.stem: path for path in sorted((Path(__file__).parents[2] / "models").glob("*.yaml"))}
LONGEST = 5.0
"""Seconds of processor time that one file may take. Wall time would blame a file for what else the machine does."""
PYDANTIC = ("Input should", "Field required", "Value error", "validation error", "List should", "Tuple should")
"""Words that are for programmers."""
HOPELESS = 120.0
"""Seconds of wall time after which the whole test run is ended, with a traceback: for loops that no signal reaches."""


class TooSlow(BaseException):
    """Raised by the timer; no `except Exception` of a library may swallow it."""


class Canary:
    """An audit hook that writes down what a model file must never cause. It cannot be removed, so it can be silent."""

    INSTALLED = tuple({sysconfig.get_paths()[name] for name in ("stdlib", "purelib", "platlib")})
    OURS = str(Path(__file__).parents[2] / "toolkit")
    FORBIDDEN = ("os.system", "os.exec", "os.posix_spawn", "os.fork", "os.spawn", "os.remove", "os.rename", "os.mkdir", "subprocess.", "socket.", "ctypes.dlopen", "shutil.")  # fmt: skip

    def __init__(self) -> None:
        self.watching = False
        self.seen: list[str] = []
        sys.addaudithook(self._hear)

    def _hear(self, event: str, arguments: tuple[object, ...]) -> None:
        if self.watching and self._is_harm(event, arguments):
            self.seen.append(f"{event} {str(arguments)[:200]}")

    def _is_harm(self, event: str, arguments: tuple[object, ...]) -> bool:
        if event == "open":
            _, mode, flags = arguments
            return bool(set(str(mode or "")) & set("wax+")) or bool(int(flags or 0) & (os.O_WRONLY | os.O_RDWR))
        if event == "compile":
            return not self._is_library(str(arguments[1]))
        if event == "exec":
            return not self._is_library(str(getattr(arguments[0], "co_filename", "")))
        return event.startswith(self.FORBIDDEN)

    def _is_library(self, filename: str) -> bool:
        """Tell whether code is that of a module: some are imported only when a check first needs them."""
        return filename.startswith((*self.INSTALLED, self.OURS, "<frozen"))

    @contextlib.contextmanager
    def watch(self) -> Iterator[list[str]]:
        """Watch, and give what was seen."""
        self.seen, self.watching = [], True
        try:
            yield self.seen
        finally:
            self.watching = False


@contextlib.contextmanager
def watchdog(what: str) -> Iterator[None]:
    """Interrupt what takes too long, and say what it was."""

    def bark(*_: object) -> None:
        raise TooSlow(f"{what} takes more than {LONGEST:g} s")

    before = signal.signal(signal.SIGPROF, bark)
    faulthandler.dump_traceback_later(HOPELESS, exit=True, file=sys.__stderr__)
    signal.setitimer(signal.ITIMER_PROF, LONGEST)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        faulthandler.cancel_dump_traceback_later()
        signal.signal(signal.SIGPROF, before)


def survive(content: bytes, where: str, path: Path, canary: Canary) -> int:
    """Check a file of this content, and hold the program to its promises; give the exit code."""
    path.write_bytes(content)
    out, talk = io.StringIO(), io.StringIO()
    with (
        warnings.catch_warnings(record=True) as warned,
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(talk),
        canary.watch() as seen,
        watchdog(where),
    ):
        warnings.simplefilter("always")
        code = main(["check", str(path)])
    assert code in (0, 1, 2), where
    assert seen == [], where
    assert [str(each.message) for each in warned] == [], where
    assert "Traceback" not in out.getvalue() + talk.getvalue(), where
    if code == 2 or (code == 1 and out.getvalue() == ""):  # what a robot cannot reach has no checks
        assert talk.getvalue(), where
        assert out.getvalue() == "", where
        assert all(line.startswith(f"{path}:") for line in talk.getvalue().splitlines()), where
        assert all(line.isprintable() for line in talk.getvalue().splitlines()), where
        assert not any(words in talk.getvalue() for words in PYDANTIC), where
    else:
        assert "checks hold" in out.getvalue() or "checks fail" in out.getvalue(), where
        assert talk.getvalue() == "", where
    return code
