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
    after = f"firmtouch thermal {path}" if arguments.sensor else f"firmtouch check {path} && firmtouch design {path}"
    sys.stderr.write(f"next: {after}\n")
    return 0


def _text(arguments: argparse.Namespace, path: Path) -> str:
    if arguments.sensor:
        if arguments.urdf is not None or arguments.tool is not None:
            raise InputError("a sensor has no robot: `--sensor` goes with neither `--urdf` nor `--tool`")
        from firmtouch.thermal.sensorfile.template import sensor_template

        return sensor_template(path.stem)
    if arguments.urdf is not None:
        from firmtouch.modelfile.urdf import read_urdf
        from firmtouch.regulation.first_model import first_robot_model

        place = os.path.relpath(arguments.urdf, path.parent)
        return first_robot_model(path.stem, read_urdf(arguments.urdf), place, tool=arguments.tool)
    if arguments.tool is not None:
        raise InputError("`--tool` is a link of a robot: give its `--urdf` too")
    from firmtouch.modelfile.template import model_template

    return model_template(path.stem)
