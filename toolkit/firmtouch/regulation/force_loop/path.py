"""L(s), the way of the measured force [T8]: a low-pass, a delay, a sampled controller."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from firmtouch.mechanics import Array
from firmtouch.modelfile import ModelSpec
from firmtouch.modelfile.sections.force_path import ForcePathSpec


@dataclass(frozen=True, slots=True)
class ForcePath:
    """What lies between the contact force and the controller: `delay`, `lag` and `sample` in s; 0 is none of it.

    Continuous (`sample` = 0): L(s) = exp(-s delay) / (1 + s lag).

    Sampled: the force is measured at t_k, as the input held since t_(k-1) has made it, through the low-pass, which is
    analogue and stands before the sampler; it is used `steps` samples later. For an input that is held, with
    a = exp(-sample / lag) (0 without a lag):

        L(z) = z^-(1 + steps) (1 - a) / (1 - a z^-1)

    Both are written as L = exp(-j phase(w)) / attenuation(w): the phase grows from 0 and the attenuation from 1, each
    without ever falling, and this is all that [T8] needs.
    """

    delay: float = 0.0
    lag: float = 0.0
    sample: float = 0.0

    @property
    def steps(self) -> int:
        """The delay in samples, beside the one sample that a held input always takes; 0 where nothing is sampled."""
        return round(self.delay / self.sample) if self.sample else 0

    @property
    def ideal(self) -> bool:
        """Tell whether L = 1."""
        return not (self.delay or self.lag or self.sample)

    @property
    def decay(self) -> float:
        """1 - a of the sampled low-pass: what one sample leaves of a step's way; 1 without a lag."""
        return -float(np.expm1(-self.sample / self.lag)) if self.lag and self.sample else 1.0

    @property
    def highest(self) -> float:
        """The frequency (rad/s) where the Nyquist curve ends: half the sampling rate, or infinity."""
        return np.pi / self.sample if self.sample else np.inf

    def phase(self, w: Array | float) -> Array:
        """Give the phase lag in rad at frequencies w (rad/s) up to `highest`, unwrapped."""
        if not self.sample:
            return np.asarray(w * self.delay + np.arctan(w * self.lag))
        angle = w * self.sample
        # arg(e^(j angle) - a), its real part as (1 - a) - (1 - cos): no digits are lost where both are small
        rest = np.arctan2(np.sin(angle), self.decay - 2 * np.sin(angle / 2) ** 2)
        return np.asarray(self.steps * angle + rest)

    def attenuation(self, w: Array | float) -> Array:
        """Give 1 / |L| at frequencies w (rad/s) up to `highest`."""
        if not self.sample:
            return np.asarray(np.hypot(1, w * self.lag))
        turn = 2 * np.sqrt(1 - self.decay) * np.sin(w * self.sample / 2)
        return np.asarray(np.hypot(1, turn / self.decay))

    def response(self, w: Array | float) -> NDArray[np.complex128]:
        """Give L at frequencies w in rad/s, up to `highest`."""
        return np.asarray(np.exp(-1j * self.phase(w)) / self.attenuation(w))


def force_path_of(spec: ModelSpec) -> ForcePath | None:
    """Read the force path of a model file; None if the file has none."""
    return None if spec.force_path is None else as_force_path(spec.force_path)


def as_force_path(given: ForcePathSpec) -> ForcePath:
    """Read a force path as it stands in a file."""
    lag = 1 / given.bandwidth if given.bandwidth else 0.0
    return ForcePath(delay=given.delay or 0.0, lag=lag, sample=given.sample or 0.0)
