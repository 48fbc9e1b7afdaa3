"""Runs on many cores: labels -> records, in whatever order they are done."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Final

from firmtouch.montecarlo.record import Label, Record
from firmtouch.montecarlo.study import Study, run_labelled

BATCHES: Final = 40
"""Into how many batches the runs are cut for each process..."""
LARGEST_BATCH: Final = 20
"""...and how many runs one holds at most: what is lost if all is stopped."""


def run_all(study: Study, labels: Sequence[Label], *, jobs: int) -> Iterator[list[Record]]:
    """Run labels in batches; gives the records of each batch as it is done.

    A run depends on the study and its label alone, so the records are the same for any number of `jobs` (processes).
    """
    size = max(1, min(LARGEST_BATCH, len(labels) // (BATCHES * jobs)))
    batches = [labels[i : i + size] for i in range(0, len(labels), size)]
    if jobs == 1 or len(batches) < 2:
        for each in batches:
            yield _run(study, each)
        return
    import joblib

    with tempfile.TemporaryDirectory(prefix="firmtouch-") as folder:
        path = str(Path(folder) / "study")
        joblib.dump(study, path)  # once, and not with every batch: it may be large
        with joblib.parallel_config(backend="loky", inner_max_num_threads=1):
            workers = joblib.Parallel(n_jobs=jobs, return_as="generator_unordered", batch_size=1)
            yield from workers(joblib.delayed(_run_from)(path, each) for each in batches)


def _run(study: Study, labels: Sequence[Label]) -> list[Record]:
    return [run_labelled(study, each)[0] for each in labels]


def _run_from(path: str, labels: Sequence[Label]) -> list[Record]:
    return _run(_study(path), labels)


@lru_cache(maxsize=1)
def _study(path: str) -> Study:
    """Load the study once in each process."""
    import joblib

    study = joblib.load(path)
    assert isinstance(study, Study)
    return study
