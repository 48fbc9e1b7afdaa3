"""The gains of controllers (15) and (17)."""

from __future__ import annotations

from dataclasses import dataclass

from firmtouch.mechanics import Array


@dataclass(frozen=True, slots=True)
class Gains:
    """u = bias - W (q - q_d) - C q' + J(q_d)^T G_f (lambda - lambda_d), Eq. (17).

    W, C (n x n) and G_f (m x m) are symmetric; `bias` = g - J^T lambda_d (n) carries gravity and makes the contact
    force.
    """

    W: Array
    C: Array
    G_f: Array
    bias: Array
