"""Tables of materials, thermistors and RTDs, and contacts, each row with its source and tolerance."""

from firmtouch.thermal.tables.capacity import heat_capacity
from firmtouch.thermal.tables.catalogue import Catalogue, parse_catalogue, read_catalogue
from firmtouch.thermal.tables.values import ContactPreset, HeatCapacity, Part, TableMaterial

__all__ = [
    "Catalogue",
    "ContactPreset",
    "HeatCapacity",
    "Part",
    "TableMaterial",
    "heat_capacity",
    "parse_catalogue",
    "read_catalogue",
]
