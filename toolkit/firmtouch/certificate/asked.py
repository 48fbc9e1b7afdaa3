"""What a model file asks of the gains, and of which plants, as far as it can be proven."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from firmtouch.certificate.edges import Edge, EdgeKind
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.modelfile import ModelSpec
from firmtouch.modelfile.sections.region import LambdaUncertainty, RegionSpec
from firmtouch.modelfile.vector_units import Units, units_of
from firmtouch.regulation.uncertainty import uncertain_parameters

MOVED: Final = 1e-4
"""What assigned poles may miss, relatively: double ones move by the square root of rounding."""


@dataclass(frozen=True, slots=True)
class Causes:
    """How large the causes of steady-state errors may be; 1 in SI where the file does not say."""

    disturbance: Array
    offset: Array
    rotation: float
    tilt: float


@dataclass(frozen=True, slots=True)
class Asked:
    """What is to be proven: the level of positivity, K >= mu D, the edges of the region, bounds, and the plants.

    `region` has the rest of what a region design asks for; it is None for a pole assignment.
    """

    level: str
    mu: float
    D: Array
    edges: tuple[Edge, ...]
    causes: Causes
    region: RegionSpec | None
    intervals: Mapping[str, tuple[float, float]]
    forces: LambdaUncertainty | None
    units: Units


def asked_of(spec: ModelSpec) -> Asked:
    """Read it from a model file, for the method that its design names."""
    design, region = spec.design, spec.design.region if spec.design.method == "region" else None
    units = units_of(spec)
    ones = (1.0,) * spec.n
    mu, D = (0.0, ones) if region is None else region.margin(spec.coordinates, same_unit=bool(units.stiffness))
    uncertain = region.uncertainty if region is not None else None
    return Asked(
        level=design.level,
        mu=mu,
        D=frozen(D),
        edges=_slowest(spec) if region is None else _edges(region),
        causes=_causes(spec),
        region=region,
        intervals={} if region is None else uncertain_parameters(spec),
        forces=None if uncertain is None else uncertain.lambda_d,
        units=units,
    )


def _slowest(spec: ModelSpec) -> tuple[Edge, ...]:
    """Take from assigned poles that none is slower than the slowest one asked for; a double pole may move a little."""
    poles = [pole for group in spec.design.poles or () for pole in group]
    rate = min((-pole.real for pole in poles), default=0.0)
    return (Edge(EdgeKind.DECAY, (1 - MOVED) * rate),) if rate > 0 else ()


def _edges(region: RegionSpec) -> tuple[Edge, ...]:
    values = {EdgeKind.DECAY: region.decay, EdgeKind.DAMPING: region.damping, EdgeKind.BANDWIDTH: region.bandwidth}
    return tuple(Edge(kind, value) for kind, value in values.items() if value is not None)


def _causes(spec: ModelSpec) -> Causes:
    bounds = spec.bounds
    disturbance, offset = bounds.disturbance, bounds.offset
    return Causes(
        disturbance=frozen([1.0 if disturbance is None else disturbance[name] for name in spec.coordinates]),
        offset=frozen([1.0 if offset is None else offset[name] for name in spec.constraints]),
        rotation=1.0 if bounds.rotation is None else bounds.rotation,
        tilt=1.0 if bounds.tilt is None else bounds.tilt,
    )
