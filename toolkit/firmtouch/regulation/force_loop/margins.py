"""The scalar loops 1 + g L(s) = 0 of the force feedback [T8]: which g is stable, with what margins, and the largest g.

With a rigid contact (37) becomes (I + G_f L(s)) dlambda = what moves it from outside, and G_f is symmetric: it falls
apart into one such loop for each eigenvalue g >= 0 of G_f.

All is exact, from two facts about L = exp(-j phase) / attenuation: neither ever falls, and at g = 0 the loop is stable.
So a root can cross the imaginary axis (sampled: the unit circle) only where the phase is an odd multiple of pi, with
g = attenuation there, and the first such frequency w_c has the smallest g: stable if and only if
g < attenuation(w_c). Without a low-pass this is g < 1.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.modelfile.sections.force_path import ForceMargins
from firmtouch.regulation.force_loop.path import ForcePath

_POINTS: Final = 65
_ROUNDS: Final = 9
"""Each round looks at 65 points and keeps two of the intervals: nine make 2^-45 of the first."""


@dataclass(frozen=True, slots=True)
class LoopMargins:
    """One loop 1 + gain * L(s) = 0; it is stable for gains below `bound`.

    `gain_margin` = bound / gain; `delay_margin`, in s, the further delay that makes it unstable; `modulus_margin`, the
    least |1 + gain * L|, the distance of the Nyquist curve from -1. Infinite where nothing limits them; of a loop that
    is not stable, the last two are 0. Sampled: a further delay counts by its phase, which is exact for whole samples.
    """

    gain: float
    bound: float
    gain_margin: float
    delay_margin: float
    modulus_margin: float

    @property
    def stable(self) -> bool:
        """Tell whether the loop is stable."""
        return self.gain < self.bound


def crossing(path: ForcePath, angle: float, further_delay: float = 0.0) -> float:
    """Give the least frequency (rad/s) with a phase lag of `angle` (0 < angle <= pi); infinite if there is none.

    The phase never falls, so bisection ends at neighbouring floats.
    """
    pure = path.delay + further_delay
    if path.sample:
        low, high = 0.0, path.highest  # where the phase is (1 + steps) pi
    elif pure:
        low, high = 0.0, angle / pure
    else:
        return float(np.tan(angle) / path.lag) if path.lag and angle < np.pi / 2 else np.inf
    while low < (middle := (low + high) / 2) < high:
        if float(path.phase(middle)) + middle * further_delay < angle:
            low = middle
        else:
            high = middle
    return high


def stability_bound(path: ForcePath, further_delay: float = 0.0) -> float:
    """Give the gain below which, and only below which, 1 + g L = 0 is stable [T8]; infinite if all are."""
    w_c = crossing(path, np.pi, further_delay)
    return float(path.attenuation(w_c)) if np.isfinite(w_c) else np.inf


def loop_margins(path: ForcePath, gain: float) -> LoopMargins:
    """Give the margins of the loop of one eigenvalue `gain` >= 0 of G_f."""
    bound = stability_bound(path)
    stable = gain < bound
    return LoopMargins(
        gain=gain,
        bound=bound,
        gain_margin=bound / gain if gain > 0 else np.inf,
        delay_margin=_delay_margin(path, gain) if stable else 0.0,
        modulus_margin=_modulus_margin(path, gain) if stable else 0.0,
    )


def _delay_margin(path: ForcePath, gain: float) -> float:
    """Give (pi - phase) / w where gain * |L| = 1: below, the loop's gain is greater, and above it is smaller."""
    if path.ideal:
        return np.inf if gain < 1 else 0.0
    if gain <= 1:  # gain * |L| < 1 at all w > 0, and no delay changes that
        return np.inf
    excess = np.sqrt((gain - 1) * (gain + 1))
    if path.sample:
        half_sine = excess * path.decay / (2 * np.sqrt(1 - path.decay))
        w = 2 * float(np.arcsin(min(half_sine, 1.0))) / path.sample
    else:
        w = excess / path.lag
    return float((np.pi - path.phase(w)) / w)


def _modulus_margin(path: ForcePath, gain: float) -> float:
    """Find the least |1 + gain * L| of a stable loop.

    With r = gain / attenuation it is |1 + r exp(-j phase)|. Up to a phase of pi/2 this is at least 1; from pi on,
    where r stays below its value r_c < 1 there, it is at least 1 - r <= 1 - r_c. So the least lies between the two.
    """
    low, high = crossing(path, np.pi / 2), crossing(path, np.pi)
    if not np.isfinite(high):  # the curve keeps to the right of the imaginary axis, and ends at 0 or at gain
        return 1.0 + gain if path.ideal else 1.0
    return _least(lambda w: np.abs(1 + gain * path.response(w)), low, high)


def admissible_gain(path: ForcePath, margins: ForceMargins) -> float:
    """Give the largest gain with all the margins that are asked for; infinite if nothing limits it.

    Each margin falls as the gain grows, so the least of three limits is the answer:

    - gain margin m: bound / m;
    - delay margin t: the bound with a further delay of t;
    - modulus margin r: for each phase pi - x with sin x <= r, the ray meets the disc of radius r about -1 at
      cos x - sqrt(r^2 - sin^2 x), and g is the least of attenuation times that.

    The last is so because the Nyquist curve up to w_c is star-shaped about 0, and -1 outside: as it grows it keeps
    what it held, and the distance of -1 from it can only fall.

    Without a low-pass a delay margin alone gives 1, where any gain below bears all delays and 1 itself none.
    """
    limits = [np.inf]
    if margins.gain is not None:
        limits.append(stability_bound(path) / margins.gain)
    if margins.delay is not None:
        limits.append(stability_bound(path, margins.delay))
    if margins.modulus is not None:
        limits.append(_largest_with_modulus(path, margins.modulus))
    return float(min(limits))


def _largest_with_modulus(path: ForcePath, modulus: float) -> float:
    low, high = crossing(path, np.pi - np.arcsin(modulus)), crossing(path, np.pi)
    if not np.isfinite(high):
        return np.inf

    def meets(w: Array) -> Array:
        x = np.pi - path.phase(w)
        return np.asarray(path.attenuation(w) * (np.cos(x) - np.sqrt(np.maximum(modulus**2 - np.sin(x) ** 2, 0.0))))

    return _least(meets, low, high)


def _least(value: Callable[[Array], Array], low: float, high: float) -> float:
    """Find the least value on an interval: 64 parts, then 64 of the two about the least point, and so on."""
    best = np.inf
    for _ in range(_ROUNDS):
        points = np.linspace(low, high, _POINTS)
        values = value(points)
        i = int(np.argmin(values))
        best = min(best, float(values[i]))
        low, high = float(points[max(i - 1, 0)]), float(points[min(i + 1, _POINTS - 1)])
    return best
