"""From a URDF to a design: all of `firmtouch design` on a seven-joint arm, and its gains alone, each in a new process."""

from __future__ import annotations

import sys
import tempfile

from tests.benchmarks.measure import ROOT, Figure, run

MODEL = "models/panda_plane.yaml"
WHOLE, GAINS = 15, 2
RUNS = 3
FIND_GAINS = (
    "import firmtouch, firmtouch.design; "
    f"firmtouch.design.find_gains(firmtouch.read_model({MODEL!r}).with_method('poles'))"
)


def figures() -> list[Figure]:
    """Give the least of some runs: what it takes when nothing else disturbs it."""
    with tempfile.TemporaryDirectory() as out:
        design = [str(ROOT / ".venv/bin/firmtouch"), "design", MODEL, "--out", out]
        whole = [run(design) for _ in range(RUNS)]
    gains = [run([sys.executable, "-c", FIND_GAINS]) for _ in range(RUNS)]
    return [
        Figure(f"`design {MODEL}`", min(whole), "<=", WHOLE, "s", "all of it: region search, proof, simulations, PDF"),
        Figure("its gains alone", min(gains), "<=", GAINS, "s", "pole assignment, with the start of Python"),
    ]
