"""`mechanism` as a chain of equal links in the plane, for studies of scale."""

from __future__ import annotations

from typing import Annotated, Final

from pydantic import Field

from firmtouch.modelfile.declarations import MOST_COORDINATES
from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import Checked, quantity_in, refuse
from firmtouch.modelfile.sections.joint_tree import Robot
from firmtouch.modelfile.sections.section import Section
from firmtouch.modelfile.sections.variables import Coordinate

COUNT: Final = {"type": "integer", "minimum": 1, "maximum": MOST_COORDINATES}


def _count(raw: object) -> int:
    if not isinstance(raw, int) or isinstance(raw, bool) or not 1 <= raw <= MOST_COORDINATES:
        refuse(Problem(f"a whole number from 1 to {MOST_COORDINATES} was expected"))
    return raw


class ChainSpec(Section):
    """n equal uniform rods in the x-y plane, hinged about z one to the next, hanging from the origin."""

    n: Annotated[int, Checked(lambda raw, _: _count(raw), COUNT)] = Field(description="the number of links")
    length: Annotated[float, quantity_in("m", least=1e-9)] = Field(description="of one link")
    mass: Annotated[float, quantity_in("kg", least=1e-9)] = Field(description="of one link")
    gravity: Annotated[float, quantity_in("m/s^2")] = Field(9.81, description="against y")


class ChainMechanism(Robot):
    """A chain of equal links in the plane, for studies of scale; its frames are `link1` to `linkn`, and `tip`."""

    planar_chain: ChainSpec

    def coordinates(self) -> dict[str, Coordinate]:
        """Give q1 to qn."""
        return {f"q{i + 1}": Coordinate(unit="rad") for i in range(self.planar_chain.n)}

    def frames(self) -> tuple[str, ...]:
        """Give the links and the tip."""
        return (*(f"link{i + 1}" for i in range(self.planar_chain.n)), "tip")

    def tools(self) -> tuple[str, ...]:
        """Give the tip."""
        return ("tip",)
