"""What a pad feels of its neighbours' heat."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from firmtouch.thermal.analysis.felt import Felt
from firmtouch.thermal.pad import object_crosstalk
from firmtouch.thermal.stack import Base


@dataclass(frozen=True, slots=True)
class Crosstalk:
    """What a neighbour's heat does at a time (s) after both touched an object.

    `neighbour`: the rise of the object's face under the next pad's centre, of that under the pad itself.
    """

    object: str
    time: float
    neighbour: float


def crosstalk_of(felt: Felt, at: float) -> tuple[Crosstalk, ...]:
    """Give the cross-talk of each object at a time (s); none without a pitch."""
    pad = felt.sensor.pad
    if pad is None or math.isinf(pad.pitch):
        return ()
    found = {}
    for each in felt.sensor.scenarios:
        if not isinstance(each.touch.object, Base):
            material, t = each.touch.object.material, np.array([at])
            share = float(object_crosstalk(material, pad.radius, pad.pitch, t)[0])
            found[each.object] = Crosstalk(each.object, at, share)
    return tuple(found.values())
