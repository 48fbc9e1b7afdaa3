"""The loop of the force feedback: the sensor's path [T8], contact that is not rigid [T9]."""

from firmtouch.regulation.force_loop.path import ForcePath, force_path_of

__all__ = ["ForcePath", "force_path_of"]
