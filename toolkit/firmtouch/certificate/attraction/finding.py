"""What is found about the region of attraction of a finished design, by all that is tried, with the reasons."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from firmtouch.certificate.attraction.attraction import Attraction, NotProvenError, find_attraction
from firmtouch.certificate.attraction.joint_box import JointBox, find_joint_box
from firmtouch.certificate.attraction.whole_box import MOST_JOINTS, WholeBox, find_whole_box
from firmtouch.regulation import ClosedLoop

MOST_DIRECTIONS: Final = 3
"""A box of joint coordinates is looked for with up to so many free directions."""
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
    attraction: Attraction | None = None
    box: JointBox | WholeBox | None = None
    op = loop.operating_point
    free = op.n - op.m
    try:
        attraction = find_attraction(loop)
    except NotProvenError as error:
        reasons.append(error.reason)
    try:
        if op.n <= MOST_JOINTS:
            box = find_whole_box(loop)
        elif free <= MOST_DIRECTIONS:
            box = find_joint_box(loop)
        else:
            reasons.append(f"it is looked for with up to {MOST_DIRECTIONS} free directions")
    except NotProvenError as error:
        reasons.append(error.reason)
    return Finding(attraction, box, tuple(reasons))
