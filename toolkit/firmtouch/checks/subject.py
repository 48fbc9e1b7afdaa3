"""What the checks look at: the plant, the configuration reached, and random states near it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from firmtouch.errors import NoDesignError
from firmtouch.mechanics import Array, Plant, derive_plant
from firmtouch.mechanics.arrays import frozen
from firmtouch.modelfile import ModelSpec
from firmtouch.regulation.operating_point import OperatingPoint, constraint_force_of, locate
from firmtouch.regulation.projection import OffSurfaceError, Projection

SEED: Final = 19930201
"""Any fixed number would do: the same model shall give the same figures on every machine."""
REACH: Final = 0.2
"""How far around q_d the random configurations lie, in rad or m."""


@dataclass(frozen=True, slots=True)
class Subject:
    """A model under check; `missed` is set where the constraints could not be met, and q_d is then the nearest try."""

    plant: Plant
    projection: Projection
    lambda_d: Array
    missed: NoDesignError | None

    @property
    def q_d(self) -> Array:
        """The configuration at which the checks are made."""
        return self.projection.q

    def states(self, count: int = 8) -> Iterator[tuple[Array, Array]]:
        """Draw configurations near q_d, q_d itself first, and velocities."""
        rng = np.random.default_rng(SEED)
        for i in range(count):
            away = rng.uniform(-REACH, REACH, self.plant.n) * (i > 0)
            yield frozen(self.q_d + away), frozen(rng.uniform(-1, 1, self.plant.n))


def subject_at(op: OperatingPoint) -> Subject:
    """Check the model of an operating point that was found already."""
    return Subject(op.plant, Projection(op.q_d, op.residual, op.moved, op.reached), op.lambda_d, None)


def make_subject(spec: ModelSpec) -> Subject:
    """Derive the plant and go as far towards the operating point as the model allows."""
    plant = derive_plant(spec)
    missed: NoDesignError | None = None
    try:
        projection = locate(plant)
    except OffSurfaceError as error:
        projection, missed = error.projection, error
    given = spec.operating_point.lambda_d
    if given is not None:
        lambda_d = frozen([given[name] for name in spec.constraints])
    else:
        J = plant.J(projection.q)
        usable = bool(np.all(np.isfinite(J)))
        lambda_d = constraint_force_of(plant, J)[2] if usable else frozen(np.zeros(plant.m))
    return Subject(plant, projection, lambda_d, missed)


def relative(difference: Array, *sizes: Array) -> float:
    """Give the largest entry of a difference, relative to the largest entry of what is compared (or to 1e-9)."""
    scale = max((float(np.max(np.abs(each), initial=0.0)) for each in sizes), default=1.0)
    return float(np.max(np.abs(difference), initial=0.0)) / max(scale, 1e-9)
