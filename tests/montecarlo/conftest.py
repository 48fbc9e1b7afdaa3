"""What tests of Monte Carlo studies share."""

from functools import cache
from pathlib import Path

import pytest

import firmtouch
from firmtouch.montecarlo import build_study, sets_of
from firmtouch.montecarlo.study import nominal_scenario

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def models():
    """A shipped model by its name."""
    return cache(lambda name: firmtouch.read_model(ROOT / "models" / f"{name}.yaml"))


@pytest.fixture(scope="session")
def circle(models, loop_of) -> firmtouch.ClosedLoop:
    """An arm with two joints on a circle: its next equilibrium is 0.159 rad away."""
    return loop_of(models("planar_2r_circle"))


@pytest.fixture(scope="session")
def study(circle):
    """A study of it, with what its file says."""
    base = nominal_scenario(circle)
    return build_study(circle, base, sets_of(circle.operating_point, base), seed=5)
