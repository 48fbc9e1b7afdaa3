"""What is found about the region of attraction of a finished design, by all that is tried, with the reasons."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from firmtouch.certificate.attraction.attraction import Attraction, NotProvenError, find_attraction
from firmtouch.certificate.attraction.joint_box import JointBox, find_joint_box
from firmtouch.certificate.attraction.whole_box import MOST_JOINTS, WholeBox, find_whole_box
from firmtouch.regulation import ClosedLoop

MOST_COORDINATES: Final = 6
"""With more of them, nothing is tried: cells grow in number too fast."""


@dataclass(frozen=True, slots=True)
class Finding:
    """A region of attraction and a box of joint coordinates, each where one was proven; `reasons` for what was not."""

    attraction: Attraction | None
    box: JointBox | WholeBox | None
    reasons: tuple[str, ...]


def look_around(loop: ClosedLoop) -> Finding:
    """Search for both."""
    if loop.operating_point.n > MOST_COORDINATES:
        return Finding(None, None, (f"it is looked for with up to {MOST_COORDINATES} coordinates",))
    reasons: list[str] = []
    attraction, box = None, None
    try:
        attraction = find_attraction(loop)
    except NotProvenError as error:
        reasons.append(error.reason)
    try:
        box = find_whole_box(loop) if loop.operating_point.n <= MOST_JOINTS else find_joint_box(loop)
    except NotProvenError as error:
        reasons.append(error.reason)
    return Finding(attraction, box, tuple(reasons))
