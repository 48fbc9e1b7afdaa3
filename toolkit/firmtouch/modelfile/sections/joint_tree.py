"""What all mechanisms have in common that are trees of joints: their joints are the coordinates."""

from __future__ import annotations

from firmtouch.modelfile.sections.section import Section
from firmtouch.modelfile.sections.variables import Coordinate


class Robot(Section):
    """A mechanism that is a tree of joints."""

    def coordinates(self) -> dict[str, Coordinate]:
        """Give the coordinates, under names that expressions can use."""
        raise NotImplementedError

    def frames(self) -> tuple[str, ...]:
        """Give the frames that constraints can name."""
        raise NotImplementedError

    def tools(self) -> tuple[str, ...]:
        """Give the frames that are tools."""
        raise NotImplementedError
