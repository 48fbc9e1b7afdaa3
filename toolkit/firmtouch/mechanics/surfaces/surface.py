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
    """A signed distance in m, its `gradient` and its `hessian`: by a point x (3), or by coordinates q (n)."""

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

    Those of a height field are written out, in balls tightly on its knots too; CasADi's own would not be tight there,
    and are eight times as many instructions through the coordinates of a large arm.
    """
    if surface.height_field is not None:
        return Bend(*height_field.expand(surface.height_field, x, symbols))
    at = ca.SX.sym("x", 3)
    s = signed_distance(surface, at, symbols)
    hessian, gradient = ca.hessian(s, at)
    return Bend(*ca.substitute([s, gradient, hessian], [at], [x]))


def bend_along(surface: SurfaceSpec, x: ca.SX, q: ca.SX, symbols: Symbols) -> Bend:
    """Give phi(q) = s(x(q)) with its first two derivatives by q (n): a row of J, and Phi''.

    phi_q = x_q^T s_x,  phi_qq = x_q^T s_xx x_q + sum_k (s_x)_k (x_k)_qq.
    """
    at_x, x_q, g = bend(surface, x, symbols), ca.jacobian(x, q), ca.SX.sym("g", 3)
    carried = ca.substitute(ca.hessian(ca.dot(g, x), q)[0], g, at_x.gradient)
    return Bend(at_x.value, x_q.T @ at_x.gradient, x_q.T @ at_x.hessian @ x_q + carried)


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
