"""A sensor file -> a checked specification: layers, touch, drive, requirements; errors at `file:line:column`."""

from firmtouch.thermal.sensorfile.read import SensorFile, catalogue_schema, parse_sensor, read_sensor, sensor_schema
from firmtouch.thermal.sensorfile.specification import SensorSpec

__all__ = ["SensorFile", "SensorSpec", "catalogue_schema", "parse_sensor", "read_sensor", "sensor_schema"]
