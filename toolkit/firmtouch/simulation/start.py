"""A consistent start: the given one, put onto the true constraints and along them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from firmtouch.mechanics import Array, Plant
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation import OperatingPoint
from firmtouch.regulation.projection import RANK, Projection, project
from firmtouch.simulation.scenario import Start
from firmtouch.simulation.world import World


@dataclass(frozen=True, slots=True)
class TrueSurface:
    """The constraints of a world: R Phi(q) + E (q - q_d) - Delta = 0 at its parameters."""

    plant: Plant
    world: World
    q_d: Array

    def Phi(self, q: Array) -> Array:
        """Give the constraint functions, m."""
        world = self.world
        return frozen(world.R @ self.plant.Phi(q) + world.E @ (q - self.q_d) - world.Delta)

    def J(self, q: Array) -> Array:
        """Give their gradients, m x n."""
        return frozen(self.world.R @ self.plant.J(q) + self.world.E)


def true_surface(op: OperatingPoint, world: World) -> TrueSurface:
    """Give the constraints of a world."""
    return TrueSurface(op.plant.with_parameters(world.p), world, op.q_d)


def consistent_start(op: OperatingPoint, world: World, start: Start) -> tuple[Projection, Array]:
    """Project q onto the true constraints and q' onto their tangent space, each by the least change.

    Raises
    ------
    OffSurfaceError
        If the constraints cannot be met near q; its `projection` says how far it came.
    """
    surface = true_surface(op, world)
    projection = project(surface, start.q)
    J = surface.J(projection.q)
    qdot = start.qdot - np.linalg.lstsq(J, J @ start.qdot, rcond=RANK)[0]
    return projection, frozen(qdot)
