"""Arms that both simulators can express."""

from pathlib import Path

import pytest

import firmtouch

ROOT = Path(__file__).parents[2]
ARMS = ("planar_2r_circle", "planar_2r_wall", "planar_3r_circle", "planar_3r_wall", "spatial_3r_sphere")


@pytest.fixture(scope="session", params=ARMS)
def arm(request, loop_of) -> firmtouch.ClosedLoop:
    """An arm that is the same one for MuJoCo in motion too."""
    return loop_of(firmtouch.read_model(ROOT / "models" / f"{request.param}.yaml"))


@pytest.fixture(scope="session", params=(*ARMS, "spatial_6r_plane"))
def resting_arm(request, loop_of) -> firmtouch.ClosedLoop:
    """An arm that is the same one for MuJoCo at rest; one has geared rotors."""
    return loop_of(firmtouch.read_model(ROOT / "models" / f"{request.param}.yaml"))


@pytest.fixture(scope="session")
def shipped():
    """Read a shipped model, or one with a few words of its text replaced."""

    def read(name: str, *replacements: tuple[str, str]) -> firmtouch.ModelFile:
        text = (ROOT / "models" / f"{name}.yaml").read_text(encoding="utf-8")
        for old, new in replacements:
            assert old in text
            text = text.replace(old, new)
        return firmtouch.parse_model(text.encode(), name=name)

    return read


@pytest.fixture(scope="session")
def wall(shipped, loop_of) -> firmtouch.ClosedLoop:
    return loop_of(shipped("planar_2r_wall"))


@pytest.fixture(scope="session")
def grinder(shipped):
    """The arm with six joints, with the rotors of its wrist motors taken out, which turn faster than the joints."""
    text = (ROOT / "models" / "spatial_6r_plane.yaml").read_text(encoding="utf-8")
    start, end = text.index("    # The motors of roll and bend"), text.index("    # A uniform ball, so that")
    return firmtouch.parse_model((text[:start] + text[end:]).encode(), name="grinder")
