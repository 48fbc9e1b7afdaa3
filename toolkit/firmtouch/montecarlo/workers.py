"""Runs on many cores: labels -> records, in whatever order they are done."""

from __future__ import annotations

import signal
import tempfile
import threading
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Final

from firmtouch.montecarlo.record import Label, Record
from firmtouch.montecarlo.study import Study, run_labelled

BATCHES: Final = 50
"""Into how many batches the runs are cut for each process..."""
LARGEST_BATCH: Final = 5
"""...and how many runs one holds at most: what is lost if all is stopped."""
AHEAD: Final = 3
"""How many batches each of the other processes is given ahead."""
IDLE: Final = 20
"""Seconds after which a process without work ends: where the main one was killed, the others shall not stay."""
ONE_THREAD: Final = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}


def run_all(study: Study, labels: Sequence[Label], *, jobs: int) -> Iterator[list[Record]]:
    """Run labels in batches; gives the records of each batch as it is done.

    A run depends on the study and its label alone, so the records are the same for any number of `jobs` (processes).
    This process is one of them, and has many runs done before the others have started.
    """
    size = max(1, min(LARGEST_BATCH, len(labels) // (BATCHES * jobs)))
    batches = deque(labels[i : i + size] for i in range(0, len(labels), size))
    if jobs == 1 or len(batches) < 2:
        yield from (run_batch(study, each) for each in batches)
        return
    import joblib
    from joblib.externals.loky import ProcessPoolExecutor

    with tempfile.TemporaryDirectory(prefix="firmtouch-") as folder:
        path = str(Path(folder) / "study")
        joblib.dump(study, path)  # once, and not with every batch: it may be large
        others = ProcessPoolExecutor(jobs - 1, timeout=IDLE, initializer=_ignore_interrupts, env=ONE_THREAD)
        pending: set[Future[list[Record]]] = set()
        try:
            while batches or pending:
                while batches and len(pending) < AHEAD * (jobs - 1):
                    pending.add(others.submit(_run_from, path, batches.popleft()))
                if batches:
                    yield run_batch(study, batches.popleft())
                done, pending = wait(pending, timeout=0 if batches else None, return_when=FIRST_COMPLETED)
                yield from (each.result() for each in done)
        finally:
            others.shutdown(wait=False, kill_workers=bool(batches or pending))


def run_batch(study: Study, labels: Sequence[Label]) -> list[Record]:
    """Run labels one after the other, in this process."""
    records = []
    for each in labels:
        with _uninterrupted():
            records.append(run_labelled(study, each)[0])
    return records


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Let an interrupt wait for the end of a run: an integrator takes one for a failure of its equations."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    waiting: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: waiting.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if waiting:
        raise KeyboardInterrupt


def _ignore_interrupts() -> None:
    """Leave them to the main process, which ends the others."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _run_from(path: str, labels: Sequence[Label]) -> list[Record]:
    study = _study(path)
    return [run_labelled(study, each)[0] for each in labels]


@lru_cache(maxsize=1)
def _study(path: str) -> Study:
    """Load the study once in each process."""
    import joblib

    study = joblib.load(path)
    assert isinstance(study, Study)
    return study
