"""A specification -> `Plant`: the Lagrangian (1)-(4) by CasADi and, to be shown, by SymPy."""

from firmtouch.mechanics.arrays import Array
from firmtouch.mechanics.drawn_scene import draw_scene
from firmtouch.mechanics.plant import Plant, derive_plant
from firmtouch.mechanics.scene import Scene

__all__ = ["Array", "Plant", "Scene", "derive_plant", "draw_scene"]
