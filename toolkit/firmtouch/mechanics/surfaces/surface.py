"""What every surface can do: its signed distance, its normal, and how the distance bends."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from firmtouch.mechanics.surfaces import (
    cone,
    cylinder,
    ellipsoid,
    height_field,
    implicit,
    plane,
    sphere,
    superellipsoid,
    torus,
)
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile.sections.surface import (
    Cone,
    Cylinder,
    Ellipsoid,
    HeightField,
    Implicit,
    Plane,
    Sphere,
    Superellipsoid,
    SurfaceSpec,
    Torus,
)


@dataclass(frozen=True, slots=True)
class Bend:
    """A signed distance at a point, in m: `value`, `gradient` (3), and `hessian` (3 x 3, in 1/m)."""

    value: ca.SX
    gradient: ca.SX
    hessian: ca.SX


def signed_distance(surface: SurfaceSpec, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give s(x) in m of a point x (3) of the world: zero on the surface, growing outwards (`side: inside`: inwards).

    |grad s| = 1 on the surface, so its multiplier is the normal force in newtons. It is the true distance for plane,
    sphere, cylinder, cone and torus, and f / |grad f| otherwise, which has the true gradient on the surface and the
    true curvature along it, and differs from the distance by O(s^2). Parameters stay symbols.
    """
    return _side(surface) * _distance(surface, x, symbols)


def normal(surface: SurfaceSpec, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give the unit normal (3) in the world, grad s / |grad s| on the surface, towards growing s.

    Off the surface it is that of the level set f through x, where s = f / |grad f|.
    """
    return _side(surface) * _normal(surface, x, symbols)


def bend(surface: SurfaceSpec, x: ca.SX, symbols: Symbols) -> Bend:
    """Give s with its first two derivatives by x.

    Through the coordinates of a mechanism, x(q), they are J = (grad s)^T x_q and
    Phi'' = x_q^T s'' x_q + sum_k (grad s)_k x_k''. For a height field this is a tenth of the instructions of what
    CasADi makes of s(x(q)), and never more for the others.
    """
    if surface.height_field is not None:
        return Bend(*height_field.expand(surface.height_field, x, symbols))
    at = ca.SX.sym("x", 3)
    s = signed_distance(surface, at, symbols)
    hessian, gradient = ca.hessian(s, at)
    return Bend(*ca.substitute([s, gradient, hessian], [at], [x]))


def _side(surface: SurfaceSpec) -> int:
    return -1 if getattr(surface.shape, "side", "outside") == "inside" else 1


def _distance(surface: SurfaceSpec, x: ca.SX, symbols: Symbols) -> ca.SX:
    match surface.shape:
        case Plane() as shape:
            return plane.distance(shape, x, symbols)
        case Sphere() as shape:
            return sphere.distance(shape, x, symbols)
        case Cylinder() as shape:
            return cylinder.distance(shape, x, symbols)
        case Cone() as shape:
            return cone.distance(shape, x, symbols)
        case Torus() as shape:
            return torus.distance(shape, x, symbols)
        case Ellipsoid() as shape:
            return ellipsoid.distance(shape, x, symbols)
        case Superellipsoid() as shape:
            return superellipsoid.distance(shape, x, symbols)
        case Implicit() as shape:
            return implicit.distance(shape, x, symbols)
        case HeightField() as shape:
            return height_field.distance(shape, x, symbols)


def _normal(surface: SurfaceSpec, x: ca.SX, symbols: Symbols) -> ca.SX:
    match surface.shape:
        case Plane() as shape:
            return plane.normal(shape, x, symbols)
        case Sphere() as shape:
            return sphere.normal(shape, x, symbols)
        case Cylinder() as shape:
            return cylinder.normal(shape, x, symbols)
        case Cone() as shape:
            return cone.normal(shape, x, symbols)
        case Torus() as shape:
            return torus.normal(shape, x, symbols)
        case Ellipsoid() as shape:
            return ellipsoid.normal(shape, x, symbols)
        case Superellipsoid() as shape:
            return superellipsoid.normal(shape, x, symbols)
        case Implicit() as shape:
            return implicit.normal(shape, x, symbols)
        case HeightField() as shape:
            return height_field.normal(shape, x, symbols)
