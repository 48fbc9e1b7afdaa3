"""How many processes a command may use."""

from __future__ import annotations


def processes(jobs: int | None) -> int:
    """Give what `--jobs` says, or one for each core."""
    if jobs is not None:
        return jobs
    from joblib import cpu_count

    return int(cpu_count())
