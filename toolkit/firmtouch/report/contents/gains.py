"""The control law and its gains."""

from __future__ import annotations

import numpy as np

from firmtouch.design import Design
from firmtouch.report.contents.operating_point import as_matrix
from firmtouch.report.document import Equation, Math, Matrices, Paragraph, Section

_POLICIES = {
    "decouple": (
        "so that the contact force does not move, to first order, while the position converges: ",
        "K_12 = M_12 M_22^(-1) K_22, quad C_12 = M_12 M_22^(-1) C_22",
    ),
    "reject": ("so that constant disturbances disturb the contact force least: ", "K_12 = 0, quad C_12 = 0"),
    "blend": (
        "between decoupling the force transient (weight 1) and rejecting disturbances (weight 0): ",
        "K_12 = w M_12 M_22^(-1) K_22, quad C_12 = w M_12 M_22^(-1) C_22",
    ),
}


def section(design: Design) -> Section:
    """Write the gains."""
    gains, asked = design.loop.gains, design.model.spec.design
    with_force = bool(np.any(gains.G_f))
    law = "u = g - J^T lambda_d - W (q - q_d) - C dot(q)"
    force = " + J(q_d)^T G_f (lambda - lambda_d)" if with_force else ""
    why, blocks_law = _POLICIES[asked.normal_blocks.policy]
    weight = f" (here w = {asked.normal_blocks.weight:g})" if asked.normal_blocks.weight is not None else ""
    return Section(
        "Gains",
        (
            Equation(law + force, "(17)" if with_force else "(15)"),
            Matrices(
                (
                    as_matrix("W", gains.W),
                    as_matrix("C", gains.C),
                    as_matrix("G_f", gains.G_f),
                    as_matrix("g - J^T lambda_d", gains.bias),
                )
            ),
            Paragraph(
                (
                    "The poles fix ",
                    Math("W"),
                    " and ",
                    Math("C"),
                    " on the free directions alone. The mixed blocks are chosen ",
                    f"{why}",
                    Math(blocks_law),
                    f"{weight}. The normal blocks are the least ones with which the smallest eigenvalues of ",
                    Math("C, K, W"),
                    f" reach {asked.normal_blocks.margin:g} of those of their tangent blocks.",
                )
            ),
        ),
    )
