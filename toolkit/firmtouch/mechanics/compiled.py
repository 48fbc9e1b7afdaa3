"""CasADi functions as machine code, where there is a C compiler: generated, compiled, kept in a cache, loaded.

Nothing depends on it but time. Without a compiler, or where anything fails, the functions stay those of CasADi's own
virtual machine, and the logger "firmtouch" is told why. The numbers are the same to the last bit: the compiler may
neither reorder operations (no -ffast-math) nor fuse a product with a sum (-ffp-contract=off), which rounds once
instead of twice. For that reason, and because a home directory may be shared by unlike machines, it does not compile
for the machine at hand either (-march=native); for the 7-joint arm that would save a tenth of a microsecond of 0.8.
"""

from __future__ import annotations

import hashlib
import logging
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import lru_cache
from pathlib import Path
from typing import Final

import casadi as ca

from firmtouch.mechanics.library_cache import LibraryCache, open_cache

COMPILERS: Final = ("cc", "gcc", "clang")
FLAGS: Final = ("-O1", "-ffp-contract=off", "-fPIC", "-shared")
"""Straight code without loops leaves -O2 and -O3 nothing to gain: 0.39 us with each for the 7-joint arm, 5.0, 6.4 and
5.6 us for thirty links, of 23 000 instructions, which take 4.3, 19 and 23 s to compile."""
MOST_INSTRUCTIONS: Final = 25_000
"""Of all functions of a library together. GCC's time grows faster than they do: 0.2 s for 2300, 3 to 4 s for 22 000,
34 s for 81 000."""
PATIENCE: Final = 60.0
"""Seconds after which a compiler is stopped."""

_log = logging.getLogger("firmtouch")


class NotCompiledError(Exception):
    """There is no library; the text says why."""


class When(Enum):
    """Whether compiling is worth its time."""

    CACHED = "only what an earlier run has compiled"
    NOW = "compile what is not there yet"


@dataclass(frozen=True, slots=True)
class Compiler:
    """A C compiler: how it is called, and what it says of itself."""

    command: tuple[str, ...]
    identity: str


def compiled(functions: Mapping[str, ca.Function], *, when: When = When.NOW) -> dict[str, ca.Function]:
    """Give the same functions as machine code, or as they are where that cannot be had.

    They must be of scalar operations (SX) and have names of their own. Derivatives go through where the library has
    them: with `f` there must be `f.jacobian()`, which CasADi looks for under the name `jac_f`. Compiled functions can
    be evaluated and stand in MX expressions; with SX symbols they cannot be called.
    """
    made = list(functions.values())
    assert all(each.is_a("SXFunction") for each in made)
    assert len({each.name() for each in made}) == len(made)
    try:
        library = _library(made, when)
        return {key: ca.external(each.name(), str(library)) for key, each in functions.items()}
    except NotCompiledError as error:
        _log.info("CasADi's virtual machine evaluates: %s", error)
    except RuntimeError as error:  # from CasADi
        _log.info("CasADi's virtual machine evaluates: a library cannot be loaded, %s", _line(str(error)))
    return dict(functions)


def find_compiler() -> Compiler | None:
    """Find the C compiler that $CC names, else one of `COMPILERS` on the PATH; None if it does not run."""
    return _find_compiler(os.environ.get("CC", ""), os.environ.get("PATH", ""))


@lru_cache(maxsize=8)
def _find_compiler(named: str, path: str) -> Compiler | None:
    """Ask once for each environment: it takes a program's start."""
    try:
        words = shlex.split(named)
    except ValueError:
        return None
    for first, *others in [words] if words else [[each] for each in COMPILERS]:
        found = shutil.which(first, path=path)
        if found is None:
            continue
        command = (found, *others)
        try:
            told = _run([*command, "--version"])
        except (OSError, subprocess.SubprocessError):
            continue
        return Compiler(command, f"{os.path.realpath(found)}\n{told}")
    return None


def _library(functions: list[ca.Function], when: When) -> Path:
    """Give the path of a library with the functions."""
    size = sum(each.n_instructions() for each in functions)
    if sys.platform == "win32":  # where files have owners of another kind
        raise NotCompiledError("nothing is compiled on Windows")
    if size > MOST_INSTRUCTIONS:
        raise NotCompiledError(f"{size} instructions would take too long to compile; {MOST_INSTRUCTIONS} are the most")
    compiler = find_compiler()
    if compiler is None:
        raise NotCompiledError("there is no C compiler")
    cache = open_cache()
    if cache is None:
        raise NotCompiledError("there is no cache that only this user can write to")
    source = _source(functions)
    key = _key(source, compiler)
    found = cache.find(key)
    if found is None and when is When.NOW:
        _compile(source, compiler, cache, key)
        cache.tidy()
        found = cache.find(key)
    if found is None:
        raise NotCompiledError("this is not compiled yet")
    return found


def _source(functions: list[ca.Function]) -> str:
    generator = ca.CodeGenerator("firmtouch")
    for each in functions:
        generator.add(each)
    return str(generator.dump())


def _key(source: str, compiler: Compiler) -> str:
    """Give a name that is another one whenever the library could be another one."""
    parts = (source, *compiler.command, compiler.identity, *FLAGS, ca.CasadiMeta.version(), os.uname().machine)
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def _compile(source: str, compiler: Compiler, cache: LibraryCache, key: str) -> None:
    try:
        with cache.writing(key) as target:
            _run([*compiler.command, *FLAGS, "-x", "c", "-", "-o", str(target), "-lm"], source)
    except subprocess.CalledProcessError as error:
        raise NotCompiledError(f"{compiler.command[0]} failed: {_line(error.stderr)}") from error
    except (OSError, subprocess.SubprocessError) as error:
        raise NotCompiledError(f"{compiler.command[0]} failed: {error}") from error


def _run(command: Sequence[str], text: str = "") -> str:
    """Run a compiler with a text on its standard input, and give what it says."""
    done = subprocess.run(  # noqa: S603  # the user's own compiler, without a shell
        command, input=text, capture_output=True, encoding="utf-8", errors="replace", timeout=PATIENCE, check=True
    )
    return done.stdout


def _line(text: str) -> str:
    """Give the first line that says something."""
    return next(iter(text.strip().splitlines()), "without a word")
