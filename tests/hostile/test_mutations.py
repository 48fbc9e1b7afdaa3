"""Thousands of damaged model files through `firmtouch check`: always an answer, never a crash, and nothing is run."""

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

import pytest
from tests.hostile.mutations import Mutation, mutate

from firmtouch.cli import main

MODELS = {path.stem: path for path in sorted((Path(__file__).parents[2] / "models").glob("*.yaml"))}
LONGEST = 5.0
"""Seconds of processor time that one file may take. Wall time would blame a file for what else the machine does."""
HOPELESS = 120.0
"""Seconds of wall time after which the whole test run is ended, with a traceback: for loops that no signal reaches."""
FAST, FAST_CHUNK = 600, 60
SLOW, SLOW_CHUNK = 20_000, 500


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


@pytest.fixture(scope="session")
def canary() -> Canary:
    """Everything that is imported late is imported before the canary listens."""
    with contextlib.redirect_stdout(io.StringIO()):
        assert main(["check", *map(str, MODELS.values())]) == 0
    return Canary()


@contextlib.contextmanager
def watchdog(seed: str) -> Iterator[None]:
    """Fail with the seed when a file takes too long."""

    def bark(*_: object) -> None:
        raise TooSlow(f"{seed} takes more than {LONGEST:g} s")

    before = signal.signal(signal.SIGPROF, bark)
    faulthandler.dump_traceback_later(HOPELESS, exit=True, file=sys.__stderr__)
    signal.setitimer(signal.ITIMER_PROF, LONGEST)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        faulthandler.cancel_dump_traceback_later()
        signal.signal(signal.SIGPROF, before)


def survive(mutation: Mutation, path: Path, canary: Canary) -> int:
    """Check one damaged file; give the exit code."""
    path.write_bytes(mutation.content)
    out, talk = io.StringIO(), io.StringIO()
    with (
        warnings.catch_warnings(record=True) as warned,
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(talk),
        canary.watch() as seen,
        watchdog(mutation.seed),
    ):
        warnings.simplefilter("always")
        code = main(["check", str(path)])
    where = f"{mutation.seed}, {', '.join(mutation.steps)}"
    assert code in (0, 1, 2), where
    assert seen == [], where
    assert [str(each.message) for each in warned] == [], where
    assert "Traceback" not in out.getvalue() + talk.getvalue(), where
    if code == 2:
        assert out.getvalue() == "", where
        assert all(line.startswith(f"{path}:") for line in talk.getvalue().splitlines()), where
        assert all(line.isprintable() for line in talk.getvalue().splitlines()), where
        # The words of pydantic, which are for programmers.
        assert not any(words in talk.getvalue() for words in ("Input should", "Field required", "Value error")), where
    else:
        assert "checks hold" in out.getvalue() or "checks fail" in out.getvalue(), where
        assert talk.getvalue() == "", where
    return code


def survive_all(start: int, count: int, path: Path, canary: Canary, capfd: pytest.CaptureFixture[str]) -> None:
    codes = {0: 0, 1: 0, 2: 0}
    names = sorted(MODELS)
    sources = {name: MODELS[name].read_bytes() for name in names}
    for i in range(start, start + count):
        name = names[i % len(names)]
        mutation = mutate(sources[name], f"{name}:{i}")
        try:
            codes[survive(mutation, path, canary)] += 1
        except BaseException as error:
            error.add_note(f"mutation {mutation.seed}: {', '.join(mutation.steps)}")
            raise
    # What C and C++ libraries print goes past Python.
    assert capfd.readouterr() == ("", "")
    # Of any sixty files some are refused and some are still models; a harness that makes only rubbish tests little.
    assert codes[2] > 0
    assert codes[0] > 0
    if os.environ.get("FIRMTOUCH_COUNT_CODES"):
        sys.__stderr__.write(f"\n{start}: {codes}\n")


@pytest.mark.parametrize("start", range(0, FAST, FAST_CHUNK))
def test_damaged_models_are_answered(start, tmp_path, canary, capfd):
    survive_all(start, FAST_CHUNK, tmp_path / "damaged.yaml", canary, capfd)


@pytest.mark.slow
@pytest.mark.parametrize("start", range(0, SLOW, SLOW_CHUNK))
def test_twenty_thousand_damaged_models_are_answered(start, tmp_path, canary, capfd):
    survive_all(start, SLOW_CHUNK, tmp_path / "damaged.yaml", canary, capfd)


def test_the_same_seed_makes_the_same_damage():
    source = next(iter(MODELS.values())).read_bytes()
    assert mutate(source, "a:1") == mutate(source, "a:1")
    assert mutate(source, "a:1").content != mutate(source, "a:2").content


def test_the_canary_sings(canary, tmp_path):
    with canary.watch() as seen:
        exec(compile("1", "<model>", "eval"))
        os.system("true")
        (tmp_path / "file").write_text("")
    assert [each.split()[0] for each in seen] == ["compile", "exec", "os.system", "open"]
    exec("1")
    assert len(seen) == 4


def test_the_watchdog_barks():
    with pytest.raises(TooSlow, match="the seed takes more than"), watchdog("the seed"):
        signal.setitimer(signal.ITIMER_PROF, 0.01)
        while True:
            pass
