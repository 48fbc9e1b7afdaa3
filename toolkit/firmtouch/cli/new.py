"""`firmtouch new NAME`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from firmtouch.errors import InputError


def run(arguments: argparse.Namespace) -> int:
    """Write NAME.yaml."""
    from firmtouch.modelfile.template import model_template

    name = arguments.name.removesuffix(".yaml")
    path = Path(f"{name}.yaml")
    if not path.name.removesuffix(".yaml").strip() or not name.isprintable():
        raise InputError("a name was expected, such as `polisher`")
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(model_template(path.stem))
    except FileExistsError:
        raise InputError(f"{path} exists already, and is left as it is") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror or error})") from error
    sys.stdout.write(f"wrote {path}\n")
    sys.stderr.write(f"next: firmtouch check {path} && firmtouch design {path}\n")
    return 0
