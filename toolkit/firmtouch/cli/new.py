"""`firmtouch new NAME`."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from firmtouch.errors import InputError


def run(arguments: argparse.Namespace) -> int:
    """Write NAME.yaml."""
    name = arguments.name.removesuffix(".yaml")
    path = Path(f"{name}.yaml")
    if not path.name.removesuffix(".yaml").strip() or not name.isprintable():
        raise InputError("a name was expected, such as `polisher`")
    text = _text(arguments, path)
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise InputError(f"{path} exists already, and is left as it is") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror or error})") from error
    sys.stdout.write(f"wrote {path}\n")
    sys.stderr.write(f"next: firmtouch check {path} && firmtouch design {path}\n")
    return 0


def _text(arguments: argparse.Namespace, path: Path) -> str:
    if arguments.urdf is not None:
        return _robot(arguments.urdf, arguments.tool, path)
    if arguments.tool is not None:
        raise InputError("`--tool` is a link of a robot: give its `--urdf` too")
    from firmtouch.modelfile.template import model_template

    return model_template(path.stem)


def _robot(urdf: str, tool: str | None, path: Path) -> str:
    """Write a model of a robot whose tool touches a plane where the arm can move well."""
    from firmtouch.modelfile.sections.robot import coordinates_of
    from firmtouch.modelfile.template import robot_template
    from firmtouch.modelfile.urdf import read_urdf, select_moving

    robot = read_urdf(urdf)
    moving = select_moving(robot, tools=() if tool is None else (tool,))
    tool = tool or moving.links[-1]
    moving = select_moving(robot, tools=(tool,))
    from firmtouch.mechanics.tree import grow_tree, placement
    from firmtouch.regulation.comfort import comfortable_start

    start = comfortable_start(grow_tree(moving, placement(), (0.0, 0.0, -9.81)), tool)
    coordinates = coordinates_of(moving)
    return robot_template(
        path.stem,
        urdf=os.path.relpath(urdf, path.parent),
        tool=tool,
        guess=dict(zip(coordinates, start.q.tolist(), strict=True)),
        units={name: each.unit for name, each in coordinates.items()},
        point=start.position.tolist(),
        axis=start.axis.tolist(),
    )
