"""The head of the report: verdict, warnings, the numbers one looks for first, and the picture."""

from __future__ import annotations

import numpy as np

from firmtouch.design import Design
from firmtouch.mechanics import Scene
from firmtouch.report.contents.verdict import verdict
from firmtouch.report.document import Block, Callout, Card, Cards, Figure, Paragraph, Section
from firmtouch.report.figures import mechanism_picture
from firmtouch.report.figures.mechanism import force_label, shown_forces
from firmtouch.report.numbers import number


def section(design: Design) -> Section:
    """Write the head."""
    blocks: list[Block] = [Callout("good", (verdict(design),))]
    blocks += [Callout("warning", (each,)) for each in design.warnings]
    if design.model.spec.description:
        blocks.append(Paragraph((design.model.spec.description,)))
    blocks.append(_cards(design))
    if design.scene is not None:
        blocks.append(_picture(design.scene))
    return Section("", tuple(blocks))


def _cards(design: Design) -> Cards:
    op, errors = design.loop.operating_point, design.steady_state
    slowest = max(pole.real for pole in design.achieved)
    cards = [
        Card(f"{op.n} / {op.m}", "", "coordinates / constraints"),
        Card(number(-4 / slowest, 3), "s", "settling time to 2 %"),
        Card(number(float(np.linalg.norm(design.loop.gains.W, 2)), 3), _stiffness(design), "largest stiffness ‖W‖"),
        Card(number(float(design.loop.full.K[0]), 3), _stiffness(design), "least eigenvalue of (14)"),
    ]
    if errors.force.given:
        unit = "rad" if _stiffness(design) == "N m/rad" else "m" if _stiffness(design) == "N/m" else ""
        cards.append(Card(number(errors.force.worst_position.value, 3), unit, "worst position error under disturbance"))
        unit = _force_unit(design)
        worst = errors.force.worst_constraint_force.value
        cards.append(Card(number(worst, 3), unit, "worst force error under disturbance"))
    return Cards(tuple(cards))


def _stiffness(design: Design) -> str:
    units = {each.unit for each in design.model.spec.coordinates.values()}
    return {frozenset({"rad"}): "N m/rad", frozenset({"m"}): "N/m"}.get(frozenset(units), "SI")


def _force_unit(design: Design) -> str:
    units = {each.unit for each in design.model.spec.constraints.values()}
    return {frozenset({"m"}): "N", frozenset({"rad"}): "N m"}.get(frozenset(units), "SI")


def _picture(scene: Scene) -> Figure:
    forces = [f"{each.constraint}: {force_label(each)}" for each in shown_forces(scene)]
    caption = "The mechanism at q_d"
    if scene.ghosts:
        caption += ", and in pale where the constraints let it go"
    if forces:
        caption += f". Red: the contact force on the mechanism ({'; '.join(forces)})"
    alt = f"Drawing of the mechanism with {len(scene.lines)} chains of links touching {len(scene.walls + scene.rounds)} surfaces"
    return Figure(mechanism_picture(scene), f"{caption}.", alt, 0.82)
