"""What the hostile tests share."""

import contextlib
import io

import pytest
from tests.hostile.harness import MODELS, Canary

from firmtouch.cli import main


@pytest.fixture(scope="session")
def canary() -> Canary:
    """A canary that begins to listen when all that is imported late has been imported."""
    with contextlib.redirect_stdout(io.StringIO()):
        assert main(["check", str(MODELS["planar_2r_wall"]), str(MODELS["spatial_3r_sphere"])]) == 0
    return Canary()
