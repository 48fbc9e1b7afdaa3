"""`firmtouch schema`."""

from __future__ import annotations

import argparse
import json
import sys


def run(arguments: argparse.Namespace) -> int:
    """Print the JSON Schema of model files, or of scenario files."""
    from firmtouch.modelfile.json_schema import model_schema, scenario_schema

    schema = scenario_schema() if arguments.scenario else model_schema()
    json.dump(schema, sys.stdout, indent=2)
    sys.stdout.write("\n")
    return 0
