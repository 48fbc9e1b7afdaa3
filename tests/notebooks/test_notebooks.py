"""Every notebook runs from top to bottom, and ends with the numbers that it is known for."""

import json
from pathlib import Path

import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient

NOTEBOOKS = Path(__file__).parents[2] / "notebooks"

# What each notebook prints last, with the tolerance that its text promises.
EXPECTED = {
    "01_first_design": {
        # The wall is 0.62 m away: 0.5 cos q1 + 0.45 cos(q1 + q2) = 0.62 at the point nearest to the guess.
        "q_d": ([1.22011, -1.30885], 1e-5),
        "W": ([[138.25631, 34.33443], [34.33443, 28.69718]], 1e-5),
        "poles": ([-8, -6], 1e-9),
        "worst_position": (0.1313505, 1e-6),
        "orders": ([1, 1], 0.08),  # first-order predictions; the second-order term shifts the observed order a little
    },
    # What a solver finds agrees to about 1e-4 between versions of it, and what bisections find to their own accuracy.
    "02_region_design": {
        "W": ([78.409, 87.723, 69.939], 5e-3),  # the least gains: a flat minimum over eps
        "damping": ([0.68968], 5e-3),
        "tolerated": ([4.243], 1e-2),  # bisected to half a percent
        "leaves": ([4.25], 2e-2),  # read off a grid of 0.05 kg
        "force_errors": ([1.919, 1.066], 2e-2),  # convex programmes for given poles, which move with eps
        "least_size": (244.48, 5e-3),
        "greatest_margin": (25.88, 1e-2),  # at the edge of what eps allows
        "conflict": ([141.4, 0.01682], 2e-2),  # bisected to one percent
    },
    # Counts are exact; proven figures are as sharp as floats estimate them, and cells end where rounding lets them.
    "03_proof": {
        "claims": ([19, 19], 0),
        "K_min": ([2.1694], 1e-4),
        "decay": ([9, 9], 1e-5),
        "spoilt": ([1, 1], 0),
        "differences": ([2, 9], 0),
        "level": ([0.97155, 0.078336], 2e-2),
        "half_width": ([0.20883], 0.1),  # the last step of the search is bisected twice
    },
    # Integrated to 1e-10, and printed to five digits. A bound is told as (half of it, 1): anything from 0 to it.
    "04_simulation": {
        "good": (5, 0),
        "peaks": ([7.3728, 2.3135, 0.60338], 1e-4),
        "orders": ([1.1772, 1.0678, 1.0054, 0.99271], 1e-3),  # differences of a thousandth of what is integrated
        "deviations": ([0.36115, 0.042292], 1e-3),
        "drift": (0.5e-8, 1),
        "balance": ([1e-5] * 3, 1),  # Simpson's rule over 4 ms, poles up to 15 1/s
        "kept": (0.5e-8, 1),
        "left": ([0.89556, 0.88179, 0.86918, 0.86714, 0.86692], 1e-3),  # a rest, but for exp(-9 * 3)
        "ratios": ([0.95, 1.05], 1e-5),  # exact: each step is -g times the one before
        "bound": ([1.51979], 1e-4),  # sqrt(1 + (w_c tau_f)^2)
        "swings": ([0.0502, 72.03], 0.05),  # the largest at the instants that are kept, a few in each period
        "lost": ([0.355, 1 / 6], 1e-3),  # 2 N * 1.05^72 / 2.05 > 30 N + 2 N / 2.05; 60 sin(pi t) = 30
        "workshop": ([30.518, 0.42195], 1e-2),  # 1000 samples of drawn noise
        "mujoco": ([0.0018903, 0.03001], 1e-2),  # what MuJoCo's default contact gives way may change with it
    },
    # Poses are met to rounding; where a curve of solutions has most room is searched, and so are the gains.
    "05_real_arm": {
        "tool": ([0.5, 0.1, 0.1, -1], 1e-9),
        "swing_moves_the_tool": (0.5e-8, 1),  # central differences
        "manipulability": ([0.048563, 0.048563], 1e-3),  # as told, and from the differences: a flat maximum
        "elbow": (0.5e-2, 1),
        "hold": ([-13.056, 3.8057], 1e-2),
        "worst": ([0.36281, 0.76045, 0.10396, 0.19242], 1e-2),  # of a minimum of |W| over mode shapes
        "W": ([88.696, 40.17, 84.69, 26.644, 14.835, 27.451, 5.137], 2e-2),  # a flat minimum over eps
        "certified": (1, 0),
        "tolerated": ([2.4844], 2e-2),
        "good": (4, 0),
    },
}


LONG = {"04_simulation", "02_region_design", "03_proof", "05_real_arm"}
"""Searches and proofs of half a minute each."""


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, id=path.stem, marks=pytest.mark.slow if path.stem in LONG else ())
        for path in sorted(NOTEBOOKS.glob("*.ipynb"))
    ],
)
def test_a_notebook_runs_and_its_numbers_are_right(path):
    notebook = nbformat.read(path, as_version=4)
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(NOTEBOOKS)}}).execute()
    results = json.loads(notebook.cells[-1].outputs[0]["text"])
    assert results.keys() == EXPECTED[path.stem].keys()
    for name, (value, tolerance) in EXPECTED[path.stem].items():
        np.testing.assert_allclose(results[name], value, rtol=tolerance, err_msg=name)
