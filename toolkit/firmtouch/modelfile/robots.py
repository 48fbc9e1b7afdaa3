"""The robot that a model file names: read before the rest, since its joints are the coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, ConfigDict

from firmtouch.errors import InputError
from firmtouch.modelfile.declarations import Declarations, declarations
from firmtouch.modelfile.diagnostics import validated
from firmtouch.modelfile.expression import Kind
from firmtouch.modelfile.files import Attached
from firmtouch.modelfile.sections.joint_tree import Robot
from firmtouch.modelfile.sections.mechanism import Mechanism
from firmtouch.modelfile.units import parse_unit
from firmtouch.modelfile.urdf import UrdfRobot, parse_urdf
from firmtouch.modelfile.yamltext import Document


class Robots:
    """Reads the URDF files that a model file names, each once, and keeps their bytes in `files`."""

    def __init__(self, attached: Attached | None) -> None:
        self._attached = attached
        self.files: dict[str, bytes] = {}
        self._robots: dict[str, UrdfRobot] = {}

    def read(self, named: str) -> UrdfRobot:
        """Read a file by the path that the model file gives."""
        if self._attached is None:
            raise InputError("this file stands alone here, so no other one can be read")
        if named not in self._robots:
            file, self.files[named] = self._attached(named)
            self._robots[named] = parse_urdf(self.files[named], file=file)
        return self._robots[named]


class _Head(BaseModel):
    model_config = ConfigDict(extra="ignore", arbitrary_types_allowed=True)

    mechanism: Mechanism


def declared_with_robot(document: Document, robots: Robots) -> Declarations:
    """Read what a file declares, with the joints and frames of the robot that it names, if its mechanism is one.

    Raises
    ------
    ModelFileError
        With the mistakes of `mechanism` alone, or of the robot's own file: nothing else can be read without it.
    """
    known = declarations(document.data, Declarations(attached=robots.read))
    mechanism = document.data.get("mechanism")
    if not isinstance(mechanism, Mapping) or not {"urdf", "planar_chain"} & mechanism.keys():
        return known
    robot: Any = validated(document, _Head, known).mechanism
    if not isinstance(robot, Robot):
        return known
    joints = robot.coordinates()
    kinds = {name: Kind(parse_unit(each.unit).dimension) for name, each in joints.items()}
    beside = Declarations(
        coordinates=kinds, joints=joints, frames=robot.frames(), tools=robot.tools(), attached=robots.read
    )
    return declarations(document.data, beside)
