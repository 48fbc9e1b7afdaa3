"""stub"""
import casadi as ca

def signed_distance(surface, x, symbols):
    if surface.plane is not None:
        n = symbols.column(surface.plane.normal)
        n = n/ca.norm_2(n)
        return ca.dot(n, x - symbols.column(surface.plane.point))
    return ca.norm_2(x - symbols.column(surface.sphere.centre)) - symbols.scalar(surface.sphere.radius)

def normal(surface, x, symbols):
    if surface.plane is not None:
        n = symbols.column(surface.plane.normal)
        return n/ca.norm_2(n)
    v = x - symbols.column(surface.sphere.centre)
    return v/ca.norm_2(v)
