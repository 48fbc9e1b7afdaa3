"""The tables: what is shipped with the package, and what files add."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any, Final, TypeVar

from pydantic import BaseModel, ValidationError

from firmtouch.modelfile.diagnostics import validated
from firmtouch.modelfile.files import read_bytes
from firmtouch.modelfile.yamltext import Document, read_yaml
from firmtouch.thermal.tables.capacity import heat_capacity
from firmtouch.thermal.tables.rows import (
    BODY,
    TABLES,
    CatalogueFileSpec,
    ContactRow,
    Known,
    MaterialRow,
    PartRow,
    RowsSpec,
)
from firmtouch.thermal.tables.values import REFERENCE, ContactPreset, Part, TableMaterial

SHIPPED: Final = ("materials.yaml", "parts.yaml", "contacts.yaml")
T = TypeVar("T", bound=BaseModel)


@dataclass(frozen=True, slots=True)
class Catalogue:
    """Materials, parts and contacts by name."""

    materials: Mapping[str, TableMaterial] = field(default_factory=dict)
    parts: Mapping[str, Part] = field(default_factory=dict)
    contacts: Mapping[str, ContactPreset] = field(default_factory=dict)

    def plus(self, rows: RowsSpec) -> Catalogue:
        """Add checked rows; one with `overrides: true` takes the place of its namesake."""
        materials = {**self.materials, **{name: material_of(name, row) for name, row in rows.materials.items()}}
        parts = {name: part_of(name, row, materials) for name, row in rows.parts.items()}
        contacts = {name: contact_of(name, row) for name, row in rows.contacts.items()}
        return replace(self, materials=materials, parts={**self.parts, **parts}, contacts={**self.contacts, **contacts})

    def known_with(self, data: Mapping[str, Any]) -> Known:
        """Give the names that a file may use: these rows and its own, found in a first and lenient reading."""
        before = {table: frozenset(getattr(self, table)) for table in TABLES}
        rows = {table: data[table] if isinstance(data.get(table), dict) else {} for table in TABLES}
        materials: dict[str, TableMaterial | None] = {**self.materials}
        for name, raw in rows["materials"].items():
            row = _leniently(MaterialRow, raw, Known())
            materials[name] = None if row is None else material_of(name, row)
        usable = {name: each for name, each in materials.items() if each is not None}
        known = Known(materials, self.parts, self.contacts, before)
        parts: dict[str, Part | None] = {**self.parts}
        for name, raw in rows["parts"].items():
            part = _leniently(PartRow, raw, known)
            parts[name] = None
            if part is not None and (part.body or BODY) in usable:
                parts[name] = part_of(name, part, usable)
        contacts: dict[str, ContactPreset | None] = {**self.contacts}
        for name, raw in rows["contacts"].items():
            contact = _leniently(ContactRow, raw, known)
            contacts[name] = None if contact is None else contact_of(name, contact)
        return Known(materials, parts, contacts, before)


def _leniently(row: type[T], raw: object, known: Known) -> T | None:
    try:
        return row.model_validate(raw, context=known)
    except ValidationError:
        return None


def material_of(name: str, row: MaterialRow) -> TableMaterial:
    """Make a material of its row."""
    return TableMaterial(name, row.k, row.rho, row.c, row.title or name, row.tolerance, row.source)


def contact_of(name: str, row: ContactRow) -> ContactPreset:
    """Make a contact of its row."""
    return ContactPreset(name, row.title or name, row.conductance, row.low, row.high, row.tolerance, row.source)


def part_of(name: str, row: PartRow, materials: Mapping[str, TableMaterial]) -> Part:
    """Make a part of its row, with its heat capacity where that can be found."""
    return Part(
        name=name,
        title=row.title or name,
        kind=row.kind,
        tolerance=row.tolerance,
        source=row.source,
        size=row.size,
        footprint=row.footprint,
        volume=row.volume,
        mass=row.mass,
        resistance=row.resistance,
        resistance_at=REFERENCE if row.resistance_at is None else row.resistance_at,
        B=row.B,
        B_between=row.B_between,
        coefficient=row.coefficient,
        dissipation=row.dissipation,
        time_constant=row.time_constant,
        capacity=heat_capacity(
            materials[row.body or BODY],
            published=row.capacity,
            delta=row.dissipation,
            tau=row.time_constant,
            mass=row.mass,
            volume=row.volume,
        ),
    )


def read_catalogue(*paths: Path | str) -> Catalogue:
    """Give the tables that are shipped, and what files of the schema `firmtouch.catalogue/1` add to them, in order.

    Raises
    ------
    ModelFileError
        With every mistake of a file, each at its line and column: also a row that would silently replace another.
    InputError
        If a file cannot be read at all.
    """
    catalogue = _shipped()
    for each in map(Path, paths):
        catalogue = parse_catalogue(read_bytes(each), catalogue, file=str(each))
    return catalogue


def parse_catalogue(content: bytes, catalogue: Catalogue, *, file: str) -> Catalogue:
    """Add the rows of a file's bytes to a catalogue; `file` is its name in messages."""
    document = read_yaml(content, file, "catalogue")
    return catalogue.plus(_checked(document, catalogue))


def _checked(document: Document, catalogue: Catalogue) -> CatalogueFileSpec:
    return validated(document, CatalogueFileSpec, catalogue.known_with(document.data))


@cache
def _shipped() -> Catalogue:
    catalogue = Catalogue()
    for name in SHIPPED:
        content = resources.files(__package__).joinpath(name).read_bytes()
        catalogue = parse_catalogue(content, catalogue, file=name)
    return catalogue
