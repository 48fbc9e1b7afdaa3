"""What it costs to ask for help, against starting Python at all."""

from __future__ import annotations

import sys
from pathlib import Path

from tests.benchmarks.measure import Figure, alternated

RUNS = 15


def figures() -> list[Figure]:
    firmtouch = str(Path(sys.executable).with_name("firmtouch"))
    nothing, asking = alternated(RUNS, [sys.executable, "-c", "pass"], [firmtouch, "--help"])
    detail = f"{1e3 * asking:.0f} ms against {1e3 * nothing:.0f} ms (medians of {RUNS} runs in turn)"
    return [Figure("firmtouch --help / python -c pass", asking / nothing, "<=", 4, "", detail)]
