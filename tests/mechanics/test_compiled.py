"""Functions as machine code: the same bits, compiled once, and nothing loaded that another user could have put there."""

import logging
import os
import pickle
import subprocess
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

import firmtouch
import firmtouch.mechanics.compiled as module
from firmtouch.mechanics import library_cache
from firmtouch.mechanics.compiled import MOST_INSTRUCTIONS, When, compiled, find_compiler
from firmtouch.mechanics.library_cache import open_cache

MODELS = Path(__file__).parents[2] / "models"
pytestmark = pytest.mark.skipif(find_compiler() is None, reason="there is no C compiler")


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "firmtouch"


@pytest.fixture
def compilations(monkeypatch):
    """Count the calls of the compiler that compile something."""
    find_compiler()
    made, run = [], subprocess.run

    def counted(command, **options):
        made.append(command)
        return run(command, **options)

    monkeypatch.setattr(module.subprocess, "run", counted)
    return made


def swing():
    """Give a function that no earlier test can have compiled into the same cache, and its numbers."""
    x, p = ca.SX.sym("x", 3), ca.SX.sym("p", 2)
    out = [ca.sin(x) * p[0] + x[0] * x[1], ca.cse(x @ x.T / (1 + p[1] ** 2)), ca.diag(x)]
    return {"f": ca.Function("swing", [x, p], out)}


def libraries(cache):
    return sorted(cache.glob("*.so")) if cache.exists() else []


def is_compiled(functions):
    return not functions["f"].is_a("SXFunction")


def same(one, two, rng):
    for _ in range(20):
        x, p = rng.normal(size=3), rng.normal(size=2)
        for mine, other in zip(one["f"](x, p), two["f"](x, p), strict=True):
            np.testing.assert_array_equal(mine.full(), other.full())


def test_the_same_bits(cache, rng):
    functions = swing()
    made = compiled(functions)
    assert is_compiled(made)
    same(made, functions, rng)
    assert [made["f"].sparsity_out(i) for i in range(3)] == [functions["f"].sparsity_out(i) for i in range(3)]


@pytest.mark.slow  # the functions of the 6R arm alone have 13 000 instructions
def test_the_mechanics_of_a_model_to_the_last_bit(cache, plant, rng):
    taken = {name: each for name, each in plant.functions.items() if each.n_instructions() < MOST_INSTRUCTIONS / 4}
    assert {"M", "J", "P_q"} <= set(taken)
    made = compiled(taken)
    q, qdot = rng.normal(size=(2, plant.n))
    for name, each in taken.items():
        assert not made[name].is_a("SXFunction")
        second = {"N0": rng.normal(size=plant.m)}.get(name, qdot)
        inputs = (q, second, plant.p) if each.n_in() == 3 else (q, plant.p)
        np.testing.assert_array_equal(made[name](*inputs).full(), each(*inputs).full())


def test_a_compiled_plant_is_the_same_plant(cache, compilations, rng):
    plant = firmtouch.derive_plant(firmtouch.read_model(MODELS / "planar_2r_wall.yaml").spec)
    fast = plant.compiled()
    q, qdot = rng.uniform(-1, 1, (2, plant.n))
    assert np.array_equal(fast.M(q), plant.M(q))
    assert np.array_equal(fast.theta(q, qdot), plant.theta(q, qdot))
    assert np.array_equal(fast.N0(q, [30.0]), plant.N0(q, [30.0]))
    assert fast.functions is plant.functions


def test_compiled_once(cache, compilations, rng):
    functions = swing()
    assert compiled(functions, when=When.CACHED) == functions  # nothing is there, and nothing is made
    assert (len(compilations), libraries(cache)) == (0, [])
    assert is_compiled(compiled(functions))
    assert len(compilations) == 1
    for when in When:
        found = compiled(functions, when=when)
        assert is_compiled(found)
        same(found, functions, rng)
    assert len(compilations) == 1
    assert len(list(cache.iterdir())) == 2  # the library and its checksum, nothing temporary


def test_another_function_is_another_library(cache):
    functions, x = swing(), ca.SX.sym("x")
    compiled(functions)
    compiled({"f": ca.Function("swing", [x], [2 * x])})
    assert len(libraries(cache)) == 2


def test_derivatives_go_through_what_is_compiled_beside(cache, rng):
    f = swing()["f"]
    made = compiled({"f": f, "J": f.jacobian()})
    x, p = ca.MX.sym("x", 3), ca.MX.sym("p", 2)
    J = ca.Function("J", [x, p], [ca.jacobian(made["f"](x, p)[0], x)])
    numbers = rng.normal(size=3), rng.normal(size=2)
    symbols = ca.SX.sym("x", 3), ca.SX.sym("p", 2)
    wanted = ca.Function("J", [*symbols], [ca.jacobian(f(*symbols)[0], symbols[0])])
    np.testing.assert_array_equal(J(*numbers).full(), wanted(*numbers).full())
    with pytest.raises(RuntimeError, match="Derivatives cannot be calculated"):  # alone, it has none
        ca.jacobian(compiled({"f": f})["f"](x, p)[0], x)


def falls_back(caplog, word):
    functions = swing()
    with caplog.at_level(logging.INFO, logger="firmtouch"):
        assert compiled(functions) == functions
    assert word in caplog.text
    return True


@pytest.mark.parametrize(
    ("CC", "word"),
    [
        ("/nonexistent/cc", "no C compiler"),
        ("'", "no C compiler"),  # not even words of a shell
        ("false", "no C compiler"),
        ("sh -c '[ \"$0\" = --version ]'", "sh failed: without a word"),
        ("sh -c '[ \"$0\" = --version ] || { echo no luck >&2; exit 1; }'", "sh failed: no luck"),
    ],
)
def test_without_a_compiler_that_works(cache, monkeypatch, caplog, CC, word):
    monkeypatch.setenv("CC", CC)
    assert falls_back(caplog, word)
    assert list(cache.glob("*")) == []


def test_without_any_compiler(cache, monkeypatch, caplog):
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", "/nonexistent")
    assert falls_back(caplog, "no C compiler")


def test_a_compiler_that_makes_nothing(cache, monkeypatch, caplog):
    monkeypatch.setenv("CC", "echo")
    assert falls_back(caplog, "cannot be loaded")


def test_the_compiler_that_is_named_is_taken(monkeypatch):
    first = find_compiler().command[0]
    monkeypatch.setenv("CC", f"{first} -g")
    assert find_compiler().command == (first, "-g")
    assert find_compiler().identity.startswith(os.path.realpath(first))


def test_what_is_too_long_is_left(cache, compilations, monkeypatch, caplog):
    monkeypatch.setattr(module, "MOST_INSTRUCTIONS", swing()["f"].n_instructions() - 1)
    assert falls_back(caplog, "take too long")
    assert compilations == []


def test_no_place_for_a_cache(monkeypatch, caplog, tmp_path):
    file = tmp_path / "file"
    file.write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(file))
    assert falls_back(caplog, "no cache")


def test_the_cache_is_made_for_this_user_alone(cache, monkeypatch):
    before = os.umask(0o002)  # with which a linker lets the group write
    try:
        compiled(swing())
    finally:
        os.umask(before)
    assert cache.stat().st_mode & 0o777 == 0o700
    assert {each.stat().st_mode & 0o777 for each in cache.iterdir()} == {0o600}


def test_a_path_that_is_not_absolute_is_no_cache(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", "here")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert open_cache().directory == tmp_path / ".cache" / "firmtouch"


@pytest.mark.parametrize("content", [b"", b"no library", None])
def test_a_broken_library_is_made_anew(cache, compilations, rng, content):
    functions = swing()
    compiled(functions)
    (library,) = libraries(cache)
    # To load one that is cut off would end this process.
    library.write_bytes(library.read_bytes()[:5000] if content is None else content)
    assert compiled(functions, when=When.CACHED) == functions
    again = compiled(functions)
    assert is_compiled(again)
    assert len(compilations) == 2
    same(again, functions, rng)


def test_a_library_that_does_not_load_is_left(cache, caplog):
    functions = swing()
    compiled(functions)
    (library,) = libraries(cache)
    with open_cache().writing(library.stem) as target:
        target.write_bytes(b"whole, but no library")
    with caplog.at_level(logging.INFO, logger="firmtouch"):
        assert compiled(functions) == functions
    assert "cannot be loaded" in caplog.text


@pytest.mark.parametrize("which", ["library", "checksum", "directory"])
@pytest.mark.parametrize("how", ["writable", "foreign", "link"])
def test_what_others_could_have_written_is_not_loaded(cache, monkeypatch, which, how, tmp_path):
    functions = swing()
    compiled(functions)
    (library,) = libraries(cache)
    path = {"library": library, "checksum": library.with_suffix(".sha256"), "directory": cache}[which]
    if how == "writable":
        path.chmod(path.stat().st_mode | 0o002)
    elif how == "link":
        path.rename(tmp_path / "elsewhere")
        path.symlink_to(tmp_path / "elsewhere")
    elif os.getuid() == 0:
        os.chown(path, 12345, -1)
    else:
        monkeypatch.setattr(os, "getuid", lambda: 12345)
    assert compiled(functions, when=When.CACHED) == functions


def test_two_processes_may_write_the_same_library(cache):
    shared = open_cache()
    with shared.writing("key") as one:
        one.write_bytes(b"first")
        with shared.writing("key") as two:
            two.write_bytes(b"second")
            assert shared.find("key") is None
        assert shared.find("key").read_bytes() == b"second"
    assert shared.find("key").read_bytes() == b"first"
    with pytest.raises(ZeroDivisionError), shared.writing("key") as three:
        three.write_bytes(b"half of")
        raise ZeroDivisionError  # what fails on the way leaves all as it was
    assert shared.find("key").read_bytes() == b"first"
    assert len(list(cache.iterdir())) == 2


def test_the_cache_does_not_grow_for_ever(cache, monkeypatch):
    monkeypatch.setattr(library_cache, "MOST_LIBRARIES", 2)
    functions = swing()
    compiled(functions)
    kept = open_cache()
    for age, key in enumerate(("old", "older", "oldest"), start=1):
        with kept.writing(key) as target:
            target.write_bytes(b"")
        os.utime(cache / f"{key}.so", (1e9 - age, 1e9 - age))
    left, fresh = cache / "left.tmp", cache / "fresh.tmp"
    for each in (left, fresh):
        each.write_bytes(b"")
    os.utime(left, (1e9, 1e9))
    assert kept.find("older") is not None  # which is a use of it
    kept.tidy()
    (ours,) = [each.stem for each in libraries(cache) if each.stem != "older"]
    names = {each.name for each in cache.iterdir()}
    assert names == {f"{ours}.so", f"{ours}.sha256", "older.so", "older.sha256", "fresh.tmp"}
    assert is_compiled(compiled(functions, when=When.CACHED))


def test_compiled_functions_can_be_sent_to_another_process(cache, rng):
    functions = swing()
    same(pickle.loads(pickle.dumps(compiled(functions))), functions, rng)
