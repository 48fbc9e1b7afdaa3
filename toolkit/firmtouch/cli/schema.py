"""`firmtouch schema`."""

from __future__ import annotations

import argparse
import json
import sys


def run(arguments: argparse.Namespace) -> int:  # noqa: ARG001  # all commands have one signature
    """Print the JSON Schema of model files."""
    from firmtouch.modelfile.json_schema import model_schema

    json.dump(model_schema(), sys.stdout, indent=2)
    sys.stdout.write("\n")
    return 0
