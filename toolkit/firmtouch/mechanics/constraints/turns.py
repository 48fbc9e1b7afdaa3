"""How far a frame is turned against another, as rows that a small turn w changes by its components."""

from __future__ import annotations

import casadi as ca


def axis_turns(R: ca.SX) -> list[ca.SX]:
    """Give -R_23 and R_13: the turns about x and y, zero where the z axes coincide (or oppose)."""
    return [-R[1, 2], R[0, 2]]


def all_turns(R: ca.SX) -> list[ca.SX]:
    """Give 2 sin(angle / 2) times the axis: zero at no turn alone, and no number at half a turn.

    The vector of (R - R^T) / 2, which is sin(angle) times the axis, would be zero at half a turn too: a configuration
    that meets nothing, in which its rows depend on each other.
    """
    cosine = ca.sqrt(1 + ca.trace(R))  # 2 cos(angle / 2)
    double = (R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1])  # 2 sin(angle) times the axis
    return [each / cosine for each in double]


def turns(R: ca.SX, hold: str) -> list[ca.SX]:
    """Give the rows for what is held: `point`, `axis` or `frame`."""
    match hold:
        case "axis":
            return axis_turns(R)
        case "frame":
            return all_turns(R)
        case _:
            return []
