"""Surfaces that a point may have to stay on, one file each: their signed distances as CasADi expressions."""

from firmtouch.mechanics.surfaces.patch import inside_domain, patch
from firmtouch.mechanics.surfaces.surface import Bend, bend, bend_along, normal, signed_distance

__all__ = ["Bend", "bend", "bend_along", "inside_domain", "normal", "patch", "signed_distance"]
