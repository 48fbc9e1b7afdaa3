"""How far a frame is turned against another, as rows that a small turn w changes by its components.

All are 2 sin(angle / 2) times the axis of the turn: zero only where nothing is turned, and not at half a turn too, as
sin(angle) would be.
"""

from __future__ import annotations

import casadi as ca


def axis_turns(R: ca.SX) -> list[ca.SX]:
    """Give the turn of the z axis about x and y: (-R_23, R_13) sqrt(2 / (1 + R_33))."""
    size = ca.sqrt(2 / (1 + R[2, 2]))
    return [-R[1, 2] * size, R[0, 2] * size]


def all_turns(R: ca.SX) -> list[ca.SX]:
    """Give the turn of all axes about x, y and z: the vector of R - R^T over sqrt(1 + trace R)."""
    size = 1 / ca.sqrt(1 + ca.trace(R))
    return [(R[2, 1] - R[1, 2]) * size, (R[0, 2] - R[2, 0]) * size, (R[1, 0] - R[0, 1]) * size]


def turns(R: ca.SX, hold: str) -> list[ca.SX]:
    """Give the rows for what is held: `point`, `axis` or `frame`."""
    match hold:
        case "axis":
            return axis_turns(R)
        case "frame":
            return all_turns(R)
        case _:
            return []
