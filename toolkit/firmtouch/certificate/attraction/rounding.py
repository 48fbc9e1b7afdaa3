"""From balls to floats, on the safe side."""

from __future__ import annotations

import numpy as np

from firmtouch.mechanics.balls import Ball


def lower(x: Ball) -> float:
    """Give a float that is certainly not above."""
    return float(np.nextafter(float(x.lower()), -np.inf)) if x.is_finite() else -np.inf


def upper(x: Ball) -> float:
    """Give a float that is certainly not below."""
    return float(np.nextafter(float(x.upper()), np.inf)) if x.is_finite() else np.inf
