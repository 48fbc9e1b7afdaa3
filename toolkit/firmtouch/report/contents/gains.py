"""The control law and its gains."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from firmtouch.design import Design
from firmtouch.report.contents.operating_point import as_matrix, as_vector
from firmtouch.report.contents.region_words import is_choice_of_blocks, is_uncertain
from firmtouch.report.document import Code, Equation, Line, Math, Matrices, Paragraph, Section

if TYPE_CHECKING:  # else cvxpy would be loaded for every report
    from firmtouch.synthesis.region import RegionDesign

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
    gains = design.loop.gains
    with_force = bool(np.any(gains.G_f))
    law = "u = g - J^T lambda_d - W (q - q_d) - C dot(q)"
    force = " + J(q_d)^T G_f (lambda - lambda_d)" if with_force else ""
    return Section(
        "Gains",
        (
            Equation(law + force, "(17)" if with_force else "(15)"),
            Matrices(
                (
                    as_matrix("W", gains.W),
                    as_matrix("C", gains.C),
                    as_matrix("G_f", gains.G_f),
                    as_vector("g - J^T lambda_d", gains.bias),
                )
            ),
            Paragraph(_assigned(design) if design.region is None else _searched(design, design.region)),
        ),
    )


def _assigned(design: Design) -> Line:
    """Say how the blocks came about that the poles leave alone."""
    return (
        "The poles fix ",
        Math("W"),
        " and ",
        Math("C"),
        " on the free directions alone. The mixed blocks are chosen ",
        *_policy(design),
        ". The normal blocks are the least ones with which the smallest eigenvalues of ",
        Math("C, K, W"),
        f" reach {design.model.spec.design.normal_blocks.margin:g} of those of their tangent blocks.",
    )


def _policy(design: Design) -> Line:
    asked = design.model.spec.design.normal_blocks
    why, law = _POLICIES[asked.policy]
    weight = f" (here w = {asked.weight:g})" if asked.weight is not None else ""
    return (why, Math(law), weight) if weight else (why, Math(law))


def _searched(design: Design, region: RegionDesign) -> Line:
    """Say what tied the blocks of gains that were searched for."""
    whole: Line = ("The search chose all blocks of ", Math("W"), " and ", Math("C"), " at once. ")
    if region.problem.structure.kind != "full":
        return (
            *whole,
            "The structure of the matrices ties the mixed blocks to the others, so they can neither decouple the force "
            "transient nor reject disturbances by choice.",
        )
    if any(map(is_choice_of_blocks, region.problem.terms)):
        plant = " These equations hold for the nominal plant." if is_uncertain(region) else ""
        return (*whole, "The mixed blocks are tied to the tangent ones ", *_policy(design), f".{plant}")
    if region.force_front is None:
        return (*whole, "Nothing ties the mixed blocks (", Code("free"), ").")
    return (
        "The search chose the blocks on the free directions; a second stage chose the mixed and the normal ones (",
        Code("free"),
        ") for a small transient of the contact force and a small steady-state error of it.",
    )
