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
    # Exact responses to 1e-10, printed to five digits; a bound is told as (half of it, 1).
    "06_thermal_touch": {
        # 31.479 and 2.1815 x^2/alpha without an end; the window of 1000 s leaves x/sqrt(pi alpha t) = 3e-4 of the step,
        # of which t90 feels 20 times as much.
        "metrics": ([31.479, 2.1815, 14.430], 7e-3),
        "windows": ([5.0688, 7.9405, 9.3624, 10.092], 1e-4),
        "depth": ([4.9771], 1e-4),
        "contact_temperature": ([22.337742, 29.392362], 1e-7),  # (e1 T1 + e2 T2)/(e1 + e2), given to six digits
        "formula": (0.5e-11, 1),
        "needed": ([38.695, 8502.2], 1e-4),  # rho c L; ln 9 of it over 10 ms
        "worked": ([9.6978, 12.113, 21.860], 1e-4),
        "lump": ([2.1037, 1.7268], 1e-4),  # ln 9 C''/h
        "drives": ([0.19069, 0.38839, 4.9913, 302.99], 1e-3),  # the grid's 2e-5, and some for splines
        "control": ([0.25e-3, 1e-2], 1),  # as fitted: at most 5e-4 of the step, 2 % of the frequency response
        "pulse": ([2.6203, 1.5002, 1.1213, 0.538613], 1e-4),  # the last: 2 q sqrt(t/pi)/(e1 + e2)
        "two_temperatures": ([18, 31], 1e-9),
        "told": ([4.6657, 2.1526, 28.686, 13.219, 136.74, 62.516, 246.89, 110.33, 254.66, 110.58], 1e-4),
        "spreading": ([5.7004, 1.3150, 1.1467], 1e-4),  # Shoup and Szabo
        "pads": ([9.6978, 9.6971, 12.113, 20.559, 21.860, 101.47], 1e-4),
        "chip": ([1.54, 338.37, 0.40921], 1e-3),
        "alone": (0, 0),
        "together": ([5.44, 41.4, 3.47e-6], 2e-2),  # bisected to half a percent, on the coarse grid
        "met": (1, 0),
        # A few hundred drawn designs; the cover is at its thinnest, the gain at its largest.
        "fastest": ([0.193], 5e-2),
    },
}


LONG = {"04_simulation", "02_region_design", "03_proof", "05_real_arm", "06_thermal_touch"}
"""Searches and proofs of ten seconds to half a minute each."""


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
