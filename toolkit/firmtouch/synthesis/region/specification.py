"""The words of a model file -> the terms of a design."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.modelfile import ModelSpec
from firmtouch.modelfile.sections.region import NO_WEIGHT, GainBound, RegionSpec
from firmtouch.modelfile.sections.region import TorqueLimit as TorqueSpec
from firmtouch.modelfile.vector_units import joint_units, units_of
from firmtouch.regulation.force_loop.choice import force_feedback_of
from firmtouch.synthesis.region.terms.bandwidth import Bandwidth
from firmtouch.synthesis.region.terms.damping import Damping
from firmtouch.synthesis.region.terms.decay import Decay
from firmtouch.synthesis.region.terms.force_errors import DisturbanceForceError, OffsetForceError
from firmtouch.synthesis.region.terms.gain_bounds import GainEntry, GainNorm, TorqueLimit
from firmtouch.synthesis.region.terms.guaranteed_cost import GuaranteedCost
from firmtouch.synthesis.region.terms.normal_blocks import MixedBlocks
from firmtouch.synthesis.region.terms.positivity import Positivity
from firmtouch.synthesis.region.terms.tangent_stiffness import PositionError
from firmtouch.synthesis.region.terms.term import Term


def terms_of(spec: ModelSpec) -> tuple[Term, ...]:
    """Give all terms of a file's region design; positivity is always among them."""
    region = spec.design.region
    assert region is not None
    return (
        *_pole_region(region),
        _positivity(spec, region),
        *_gain_bounds(spec, region),
        *_costs(spec, region),
        *_errors(spec, region),
        *_normal_blocks(spec, region),
    )


def _pole_region(region: RegionSpec) -> Iterator[Term]:
    if region.decay is not None:
        yield Decay(asked=region.decay)
    if region.damping is not None:
        yield Damping(asked=region.damping)
    if region.bandwidth is not None:
        yield Bandwidth(asked=region.bandwidth)


def _positivity(spec: ModelSpec, region: RegionSpec) -> Term:
    unit = units_of(spec).stiffness
    mu, D = region.margin(spec.coordinates, same_unit=bool(unit))
    mixed = len(set(D)) > 1 or (mu > 0 and not unit)
    return Positivity(asked=mu, unit="of D" if mixed else unit, level=spec.design.level, D=frozen(D))


def _gain_bounds(spec: ModelSpec, region: RegionSpec) -> Iterator[Term]:
    units, names = units_of(spec), list(spec.coordinates)
    bounds: dict[str, GainBound | None] = {"W": region.W, "C": region.C}
    for which, bound in bounds.items():
        if bound is not None and bound.norm is not None:
            unit = units.stiffness if which == "W" else units.damping
            yield GainNorm(name=f"norm of {which}", asked=bound.norm, unit=unit, which=which)
        for coordinate, most in ((bound.joints if bound else None) or {}).items():
            own = joint_units(spec.coordinates[coordinate].unit)
            unit = own.stiffness if which == "W" else own.damping
            name = f"{which} of {coordinate}"
            yield GainEntry(name=name, asked=most, unit=unit, which=which, joint=names.index(coordinate))
    for label, limit in region.torque.items():
        yield from _torque_limits(spec, label, limit)


def _torque_limits(spec: ModelSpec, label: str, limit: TorqueSpec) -> Iterator[Term]:
    still = dict.fromkeys(spec.coordinates, 0.0)
    for i, (coordinate, declared) in enumerate(spec.coordinates.items()):
        yield TorqueLimit(
            name=f"torque of {coordinate}, {label}",
            asked=limit.at_most[coordinate],
            unit=joint_units(declared.unit).joint_force,
            joint=i,
            position=_by_coordinate(limit.position or still, spec),
            velocity=_by_coordinate(limit.velocity or still, spec),
        )


def _costs(spec: ModelSpec, region: RegionSpec) -> Iterator[Term]:
    if region.cost is not None:
        cost, free = region.cost, dict.fromkeys(spec.coordinates, NO_WEIGHT)
        yield GuaranteedCost(
            asked=np.inf if cost.at_most is None else cost.at_most,
            position=_by_coordinate(cost.position, spec),
            velocity=_by_coordinate(cost.velocity or free, spec),
            torque=_by_coordinate(cost.torque, spec),
            start_position=_by_coordinate(cost.start_position, spec),
            start_velocity=_by_coordinate(cost.start_velocity, spec),
        )


def _errors(spec: ModelSpec, region: RegionSpec) -> Iterator[Term]:
    units = units_of(spec)
    if region.position_error is not None and spec.bounds.disturbance is not None:
        semi_axes = _by_coordinate(spec.bounds.disturbance, spec)
        yield PositionError(asked=region.position_error, unit=units.coordinate, semi_axes=semi_axes)
    asked = region.force_error
    Lambda = np.linalg.inv(np.eye(spec.m) + force_feedback_of(spec.design))
    if asked is not None and asked.disturbance is not None and spec.bounds.disturbance is not None:
        yield DisturbanceForceError(
            asked=asked.disturbance,
            unit=units.multiplier,
            semi_axes=_by_coordinate(spec.bounds.disturbance, spec),
            feedback=frozen(Lambda),
        )
    if asked is not None and asked.offset is not None and spec.bounds.offset is not None:
        semi_axes = frozen([spec.bounds.offset[name] for name in spec.constraints])
        yield OffsetForceError(asked=asked.offset, unit=units.multiplier, semi_axes=semi_axes, feedback=frozen(Lambda))


def _normal_blocks(spec: ModelSpec, region: RegionSpec) -> Iterator[Term]:
    """Full matrices alone have mixed blocks that may be chosen."""
    policy = spec.design.normal_blocks
    weight = {"decouple": 1.0, "reject": 0.0, "blend": policy.weight}.get(policy.policy)
    if region.structure.kind == "full" and weight is not None:
        yield MixedBlocks(weight=weight)


def _by_coordinate(values: Mapping[str, float], spec: ModelSpec) -> Array:
    return frozen([values[name] for name in spec.coordinates])
