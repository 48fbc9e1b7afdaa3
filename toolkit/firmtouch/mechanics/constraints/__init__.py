"""The rows of Phi(q), Eq. (1): expressions of the file, and constraints on frames of a robot, one sort a module.

In all of them a row's sign is that of growing phi: lambda > 0 pushes the mechanism there.
"""

from __future__ import annotations

import casadi as ca

from firmtouch.mechanics.arm import Arm
from firmtouch.mechanics.constraints.contact import contact_rows
from firmtouch.mechanics.constraints.join import join_rows
from firmtouch.mechanics.constraints.rail import rail_rows
from firmtouch.mechanics.constraints.rod import rod_rows
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile import ModelSpec
from firmtouch.modelfile.sections.constraint import Constraint, Entry
from firmtouch.modelfile.sections.frames import Join, OnFrames, RailContact, Rod, SurfaceContact


def constraints_of(spec: ModelSpec, symbols: Symbols, arm: Arm | None) -> ca.SX:
    """Give Phi, m: the rows in the order of `spec.constraints`."""
    return ca.vertcat(*(row for entry in spec.entries.values() for row in _rows(entry, symbols, arm)))


def _rows(entry: Entry, symbols: Symbols, arm: Arm | None) -> list[ca.SX]:
    if isinstance(entry, Constraint):
        return [symbols.scalar(entry.expression)]
    assert arm is not None, "the file's reader lets frames be named for robots alone"
    rows = _all_rows(entry, arm)
    wanted = entry.rows("")
    return [row for row, each in zip(rows, entry.all_rows(), strict=True) if each.name("") in wanted]


def _all_rows(entry: OnFrames, arm: Arm) -> list[ca.SX]:
    match entry:
        case SurfaceContact():
            return contact_rows(entry, arm)
        case RailContact():
            return rail_rows(entry, arm)
        case Rod():
            return rod_rows(entry, arm)
        case Join():
            return join_rows(entry, arm)
        case _:
            raise AssertionError(entry)
