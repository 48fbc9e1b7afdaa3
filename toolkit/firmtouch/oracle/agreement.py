"""Whether what MuJoCo simulates is our mechanism."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import casadi as ca
import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import call_vector
from firmtouch.mechanics.symbols import Symbols
from firmtouch.oracle.export import MujocoExport
from firmtouch.oracle.library import NotExpressibleError
from firmtouch.oracle.machine import Machine
from firmtouch.oracle.surfaces import JointSum

SAME: Final = 1e-10
"""How far figures may differ, relative to their size (points: in metres): both sides round, and nothing else."""
SAMPLES: Final = 20


@dataclass(frozen=True, slots=True)
class Agreement:
    """The largest differences between MuJoCo's figures and ours, each relative to ours (points: in metres).

    `gravity` is theta(q, 0) = P_q.
    """

    M: float
    theta: float
    gravity: float
    points: float

    @property
    def in_motion(self) -> float:
        """The largest of all."""
        return max(self.M, self.theta, self.at_rest)

    @property
    def at_rest(self) -> float:
        """The largest of those on which a rest depends: inertia is none of them."""
        return max(self.gravity, self.points)


def compare_export(export: MujocoExport) -> Agreement:
    """Compare M, theta, gravity and contact points with ours, at random configurations (+-1 rad or m) and speeds.

    Raises
    ------
    NotExpressibleError
        If MuJoCo refuses the mechanism.
    """
    machine, plant = Machine(export), export.plant
    rng = np.random.default_rng(1993)
    symbols = Symbols(plant.spec)
    points = {
        j: ca.Function("point", [symbols.q, symbols.p], [ca.densify(symbols.column(touch.point))])
        for j, touch in enumerate(export.touches)
        if not isinstance(touch, JointSum)
    }
    worst = np.zeros(4)
    for _ in range(SAMPLES):
        q, qdot = export.at + rng.uniform(-1, 1, plant.n), rng.uniform(-1, 1, plant.n)
        machine.place(q, qdot)
        M, theta = _apart(machine.M(), plant.M(q)), _apart(machine.theta(), plant.theta(q, qdot))
        away = [0.0]
        for j, function in points.items():
            ours = call_vector(function, q, plant.p)
            away.append(float(np.abs(machine.point(j)[: ours.size] - ours).max()))
        machine.place(q, np.zeros(plant.n))
        worst = np.maximum(worst, [M, theta, _apart(machine.theta(), plant.P_q(q)), max(away)])
    return Agreement(*map(float, worst))


def check_export(export: MujocoExport) -> Agreement:
    """Compare, and insist that the mechanism is ours in motion.

    Raises
    ------
    NotExpressibleError
        If any figure differs by more than rounding.
    """
    agreement = compare_export(export)
    if not agreement.in_motion <= SAME:
        raise NotExpressibleError(
            f"as a tree of joints it is another mechanism: MuJoCo's M differs by {agreement.M:.3g}, theta by "
            f"{agreement.theta:.3g} (relative), contact points by {agreement.points:.3g} m"
        )
    return agreement


def check_export_at_rest(export: MujocoExport) -> Agreement:
    """Compare, and insist that the mechanism is ours at rest, where inertia plays no part.

    Raises
    ------
    NotExpressibleError
        If gravity or a contact point differs by more than rounding.
    """
    agreement = compare_export(export)
    if not agreement.at_rest <= SAME:
        raise NotExpressibleError(
            f"as a tree of joints it is another mechanism even at rest: MuJoCo's gravity differs by "
            f"{agreement.gravity:.3g} (relative), contact points by {agreement.points:.3g} m"
        )
    return agreement


def _apart(theirs: Array, ours: Array) -> float:
    return float(np.abs(theirs - ours).max() / (np.abs(ours).max() or 1.0))
