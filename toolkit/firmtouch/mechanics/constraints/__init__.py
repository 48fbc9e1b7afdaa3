"""The rows of Phi(q), Eq. (1): expressions of the file, and constraints on frames of a robot, one sort a module.

In all of them a row's sign is that of growing phi: lambda > 0 pushes the mechanism there.
"""

from __future__ import annotations

from firmtouch.mechanics.arm import Arm
from firmtouch.mechanics.constraints.contact import contact_rows
from firmtouch.mechanics.constraints.join import join_rows
from firmtouch.mechanics.constraints.rail import rail_rows
from firmtouch.mechanics.constraints.rod import rod_rows
from firmtouch.mechanics.constraints.row import Row, row_of
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile import ModelSpec
from firmtouch.modelfile.sections.constraint import Constraint, Entry
from firmtouch.modelfile.sections.frames import Join, OnFrames, RailContact, Rod, SurfaceContact


def constraints_of(spec: ModelSpec, symbols: Symbols, arm: Arm | None) -> list[Row]:
    """Give the rows of Phi in the order of `spec.constraints`."""
    return [row for entry in spec.entries.values() for row in _rows(entry, symbols, arm)]


def _rows(entry: Entry, symbols: Symbols, arm: Arm | None) -> list[Row]:
    if isinstance(entry, Constraint):
        return [row_of(symbols.scalar(entry.expression), symbols.q)]
    assert arm is not None, "the file's reader lets frames be named for robots alone"
    rows = _all_rows(entry, arm)
    wanted = entry.rows("")
    return [row for row, each in zip(rows, entry.all_rows(), strict=True) if each.name("") in wanted]


def _all_rows(entry: OnFrames, arm: Arm) -> list[Row]:
    q = arm.symbols.q
    match entry:
        case SurfaceContact():
            return contact_rows(entry, arm)
        case RailContact():
            return [row_of(each, q) for each in rail_rows(entry, arm)]
        case Rod():
            return [row_of(each, q) for each in rod_rows(entry, arm)]
        case Join():
            return [row_of(each, q) for each in join_rows(entry, arm)]
        case _:
            raise AssertionError(entry)
