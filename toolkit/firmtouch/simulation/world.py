"""What the model does not know: how the true plant and its surroundings differ from it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation import OperatingPoint


@dataclass(frozen=True, slots=True)
class Disturbance:
    """A generalised force on the mechanism, Eq. (21): d from `start` to `end`, times sin(omega (t - start) + phase).

    With omega = 0 there is no sine: a constant force, a step (`start` > 0) or a pulse (`end` < inf). SI, d in R^n.
    """

    d: Array
    start: float = 0.0
    end: float = math.inf
    omega: float = 0.0
    phase: float = 0.0

    def acts(self, t: float) -> bool:
        """Tell whether it acts just after t."""
        return self.start <= t < self.end


@dataclass(frozen=True, slots=True)
class World:
    """The true plant: parameters `p`, and constraints R Phi(q) + E (q - q_d) = Delta for Phi(q) = 0.

    So its gradients are R J + E: an offset Delta (m), Eq. (28); a rotation R (m x m, orthogonal), Eq. (33); a tilt E
    (m x n). `bias_error` (n) is g_hat - g, wrong gravity in the controller's constant part. All in SI.
    """

    p: Array
    Delta: Array
    R: Array
    E: Array
    bias_error: Array
    disturbances: tuple[Disturbance, ...] = ()

    @property
    def sinusoids(self) -> tuple[Disturbance, ...]:
        """Those disturbances that swing."""
        return tuple(each for each in self.disturbances if each.omega)

    @property
    def changes(self) -> tuple[float, ...]:
        """When a disturbance begins or ends, in order."""
        times = {time for each in self.disturbances for time in (each.start, each.end)}
        return tuple(sorted(time for time in times if 0 < time < math.inf))

    def steady_force(self, t: float) -> Array:
        """Add up what does not swing just after t, n."""
        total = np.zeros_like(self.bias_error)
        for each in self.disturbances:
            if not each.omega and each.acts(t):
                total = total + each.d
        return frozen(total)


def nominal_world(op: OperatingPoint, *disturbances: Disturbance) -> World:
    """Give the world of the model itself, with disturbances."""
    n, m = op.n, op.m
    Delta, R, E, bias_error = (frozen(each) for each in (np.zeros(m), np.eye(m), np.zeros((m, n)), np.zeros(n)))
    return World(op.plant.p, Delta, R, E, bias_error, disturbances)


def tilted(op: OperatingPoint, world: World, d: Array) -> World:
    """Tilt the surface normals so that E^T lambda_d = d, by the E of least norm; lambda_d must not be zero."""
    return replace(world, E=frozen(np.outer(op.lambda_d, d) / (op.lambda_d @ op.lambda_d)))
