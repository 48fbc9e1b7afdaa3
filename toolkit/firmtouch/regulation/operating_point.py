"""The regulation point (q_d, lambda_d): from the file's words, and what the theory needs there."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from firmtouch.errors import NoDesignError
from firmtouch.mechanics import Array, Plant
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation.inverse_kinematics import Reached
from firmtouch.regulation.projection import NEAR_SURFACE, RANK, OffSurfaceError, Projection, project, short
from firmtouch.regulation.reaching import BeyondGridError, beyond_grids, reach_configuration
from firmtouch.regulation.redundancy import DependentConstraintsError, remedy_for, row_dependencies

IN_RANGE: Final = 1e-6
"""The part of f_d, relative to it, that may lie outside the range of J^T: file values are rounded."""


@dataclass(frozen=True, slots=True)
class OperatingPoint:
    """(q_d, lambda_d) and the plant there; N0 = P_qq - sum of lambda_dj Phi_j'', the stiffness that the plant brings.

    `moved` is how far the projection moved the file's configuration, `residual` the largest |Phi| left; `reached` tells
    of the inverse kinematics, where q_d was found so.
    """

    plant: Plant
    q_d: Array
    lambda_d: Array
    f_d: Array
    M: Array
    J: Array
    g: Array
    P_qq: Array
    constraint_hessians: Array
    N0: Array
    residual: float
    moved: float
    reached: Reached | None = None

    @property
    def n(self) -> int:
        """The number of coordinates."""
        return self.plant.n

    @property
    def m(self) -> int:
        """The number of constraints."""
        return self.plant.m


class ForceOutOfRangeError(NoDesignError):
    """f_d is no constraint force: `part` of it (relative) lies outside the range of J^T."""

    def __init__(self, part: float, outside: Array) -> None:
        self.part, self.outside = part, outside
        super().__init__(
            f"f_d is no constraint force: {part:.2%} of it lies outside the range of J^T (the part {short(outside)}); "
            "the constraints can only carry f_d = J^T lambda_d, so give `lambda_d` instead"
        )


class OutsideLimitsError(NoDesignError):
    """q_d lies outside of joint limits; `joints` says which ones, and by how much."""

    def __init__(self, joints: tuple[str, ...]) -> None:
        self.joints = joints
        super().__init__(f"q_d lies outside of joint limits: {'; '.join(joints)}")


def find_operating_point(plant: Plant) -> OperatingPoint:
    """Find (q_d, lambda_d) as the file asks for it.

    Raises
    ------
    OffSurfaceError
        If the constraints cannot be met, or a stated q_d misses them.
    BeyondGridError
        If a contact lies beyond the grid of its height field.
    OutsideLimitsError
        If q_d is not where the joints can be.
    DependentConstraintsError
        If J(q_d) has not full row rank.
    ForceOutOfRangeError
        If a given f_d is not in the range of J^T.
    """
    spec = plant.spec.operating_point
    q_d = locate(plant)
    beyond = beyond_grids(plant, q_d.q)
    if beyond:
        raise BeyondGridError(beyond)
    outside = outside_limits(plant, q_d.q)
    if outside:
        raise OutsideLimitsError(outside)
    J = plant.J(q_d.q)
    found = row_dependencies(plant, J)
    if found.rows:
        raise DependentConstraintsError(found.rank, found.words, remedy_for(plant, q_d.q, found))
    if spec.lambda_d is not None:
        lambda_d = frozen([spec.lambda_d[name] for name in plant.spec.constraints])
    else:
        part, missing, lambda_d = constraint_force_of(plant, J)
        if part > IN_RANGE:
            raise ForceOutOfRangeError(part, missing)
    return operating_point_at(plant, q_d, lambda_d)


def operating_point_at(plant: Plant, projection: Projection, lambda_d: Array) -> OperatingPoint:
    """Evaluate the plant at a configuration on the constraints."""
    q_d = projection.q
    J, P_qq, Phi_qq = plant.J(q_d), plant.P_qq(q_d), plant.Phi_qq(q_d)
    return OperatingPoint(
        plant=plant,
        q_d=q_d,
        lambda_d=lambda_d,
        f_d=frozen(J.T @ lambda_d),  # Eq. (6)
        M=plant.M(q_d),
        J=J,
        g=plant.P_q(q_d),
        P_qq=P_qq,
        constraint_hessians=Phi_qq,
        N0=plant.N0(q_d, lambda_d),
        residual=projection.residual,
        moved=projection.moved,
        reached=projection.reached,
    )


def locate(plant: Plant) -> Projection:
    """Find q_d on the constraints from the file's `q_d`, `guess` or `reach`."""
    spec = plant.spec.operating_point
    if spec.reach is not None:
        reached = reach_configuration(plant)
        return replace(project(plant, reached.q), moved=0.0, reached=reached)
    given = spec.q_d if spec.q_d is not None else spec.guess
    assert given is not None
    start = frozen([given[name] for name in plant.spec.coordinates])
    if spec.q_d is not None:
        missed = float(np.max(np.abs(plant.Phi(start))))
        if not missed <= NEAR_SURFACE:
            at = Projection(start, missed, 0.0)
            raise OffSurfaceError(
                f"q_d misses the constraints by {missed:.3g} (largest |phi|, in its unit); "
                "correct it, or write `guess` instead of `q_d` to have it projected",
                at,
            )
    return project(plant, start)


def constraint_force_of(plant: Plant, J: Array) -> tuple[float, Array, Array]:
    """Solve f_d = J^T lambda_d: the relative part outside the range of J^T, that part itself, and lambda_d."""
    given = plant.spec.operating_point.f_d
    assert given is not None
    f_d = np.array([given[name] for name in plant.spec.coordinates])
    lambda_d = np.linalg.lstsq(J.T, f_d, rcond=RANK)[0]
    outside = f_d - J.T @ lambda_d
    size = float(np.linalg.norm(f_d))
    return (float(np.linalg.norm(outside)) / size if size else 0.0), frozen(outside), frozen(lambda_d)


def outside_limits(plant: Plant, q: Array) -> tuple[str, ...]:
    """Say which joints are outside of their limits."""
    found = []
    for value, (name, each) in zip(q.tolist(), plant.spec.coordinates.items(), strict=True):
        if not each.lower <= value <= each.upper:
            found.append(
                f"`{name}` at {value:.4g} {each.unit}, and its limits are {each.lower:.4g} to {each.upper:.4g}"
            )
    return tuple(found)
