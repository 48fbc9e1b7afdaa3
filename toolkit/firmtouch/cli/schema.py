"""`firmtouch schema`."""

from __future__ import annotations

import argparse
import json
import sys
from typing import Any


def run(arguments: argparse.Namespace) -> int:
    """Print the JSON Schema of model files, or of another sort."""
    json.dump(_schema(arguments), sys.stdout, indent=2)
    sys.stdout.write("\n")
    return 0


def _schema(arguments: argparse.Namespace) -> dict[str, Any]:
    if arguments.sensor or arguments.catalogue:
        from firmtouch.thermal.sensorfile import catalogue_schema, sensor_schema

        return sensor_schema() if arguments.sensor else catalogue_schema()
    from firmtouch.modelfile.json_schema import model_schema, scenario_schema

    return scenario_schema() if arguments.scenario else model_schema()
