"""From a URDF to a design: all of `firmtouch design` on a seven-joint arm, and its gains alone, each in a new process."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Sequence

from tests.benchmarks.measure import ROOT, Figure, run

MODEL = "models/panda_plane.yaml"
WHOLE, GAINS = 15, 2
FEWEST, MOST = 2, 8
FIND_GAINS = (
    f"import firmtouch as ft; spec = ft.read_model({MODEL!r}).with_method('poles').spec; "
    "ft.assign_poles(ft.find_operating_point(ft.derive_plant(spec)), spec.design)"
)


def least(command: Sequence[str], bound: float) -> tuple[float, str]:
    """Take the least of some runs: an absolute time is the program's only while the machine does nothing else."""
    times: list[float] = []
    while len(times) < FEWEST or (min(times) > bound and len(times) < MOST):
        times.append(run(command))
    return min(times), "least of " + ", ".join(f"{each:.2f}" for each in times) + " s"


def figures() -> list[Figure]:
    with tempfile.TemporaryDirectory() as out:
        whole, runs = least([str(ROOT / ".venv/bin/firmtouch"), "design", MODEL, "--out", out], WHOLE)
    gains, others = least([sys.executable, "-c", FIND_GAINS], GAINS)
    return [
        Figure(
            f"`design {MODEL}`", whole, "<=", WHOLE, "s", f"{runs}: region search, margins, proof, simulations, reports"
        ),
        Figure("its gains alone", gains, "<=", GAINS, "s", f"{others}: pole assignment, with the start of Python"),
    ]
