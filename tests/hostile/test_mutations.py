"""Thousands of damaged model files through `firmtouch check`: always an answer, never a crash, and nothing is run."""

from __future__ import annotations

import os
import signal
from collections import Counter
from collections.abc import Callable, Sequence

import pytest
from tests.hostile.harness import MODELS, TooSlow, survive, watchdog
from tests.hostile.mutations import mutate

FAST, FAST_CHUNK = 600, 60
SLOW, SLOW_CHUNK = 20_000, 500


ROBOTS = [name for name, path in MODELS.items() if "urdf:" in path.read_text(encoding="utf-8")]
ROBOTS_SLOW, ROBOTS_CHUNK = 400, 40
BY_SIZE = sorted(MODELS.keys() - set(ROBOTS), key=lambda name: MODELS[name].stat().st_size)
TURNS = (*BY_SIZE, *BY_SIZE[: 2 * len(BY_SIZE) // 3])
"""Small models are checked sooner, and have their turn twice."""


@pytest.fixture
def survive_all(tmp_path, canary, capfd, record_property) -> Callable[..., None]:
    """Check a range of damaged files; how many had which exit code is kept for `--junitxml`."""

    def run(start: int, count: int, turns: Sequence[str] = TURNS) -> None:
        codes: Counter[int] = Counter()
        for i in range(start, start + count):
            name = turns[i % len(turns)]
            mutation = mutate(MODELS[name].read_bytes(), f"{name}:{i}")
            what = f"{mutation.seed} ({', '.join(mutation.steps)})"
            codes[survive(mutation.content, what, tmp_path / "damaged.yaml", canary)] += 1
        record_property("codes", dict(codes))
        # What C and C++ libraries print goes past Python.
        assert capfd.readouterr() == ("", "")
        # Some files must be refused and some must still be models: damage that makes only rubbish tests little.
        assert codes[2] > 0
        assert codes[0] > 0

    return run


@pytest.mark.parametrize("start", range(0, FAST, FAST_CHUNK))
def test_damaged_models_are_answered(start, survive_all):
    survive_all(start, FAST_CHUNK)


@pytest.mark.slow
@pytest.mark.parametrize("start", range(0, SLOW, SLOW_CHUNK))
def test_twenty_thousand_damaged_models_are_answered(start, survive_all):
    survive_all(start, SLOW_CHUNK)


@pytest.mark.slow
@pytest.mark.parametrize("start", range(0, ROBOTS_SLOW, ROBOTS_CHUNK))
def test_damaged_models_of_robots_are_answered(start, survive_all, tmp_path):
    (tmp_path / "urdf").symlink_to(MODELS[ROBOTS[0]].parent / "urdf")
    survive_all(start, ROBOTS_CHUNK, ROBOTS)


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
