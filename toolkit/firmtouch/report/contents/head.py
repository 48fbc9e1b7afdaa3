"""The head of the report: verdict, warnings, the numbers one looks for first, and the picture."""

from __future__ import annotations

import numpy as np

from firmtouch.design import Design
from firmtouch.mechanics import Array, Scene
from firmtouch.modelfile.vector_units import units_of
from firmtouch.report.contents.prose import prose
from firmtouch.report.contents.region_words import is_uncertain, slowest
from firmtouch.report.contents.verdict import verdict
from firmtouch.report.document import Block, Callout, Card, Cards, Figure, Paragraph, Section
from firmtouch.report.figures import mechanism_picture
from firmtouch.report.figures.extent import force_label, shown_forces
from firmtouch.report.numbers import number


def section(design: Design) -> Section:
    """Write the head."""
    blocks: list[Block] = [Callout("good" if design.certificate.certified else "warning", prose(verdict(design)))]
    blocks += [Callout("warning", prose(each)) for each in design.warnings]
    if design.model.spec.description:
        blocks.append(Paragraph((design.model.spec.description,)))
    blocks.append(_cards(design))
    if design.scene is not None:
        blocks.append(_picture(design.scene))
    return Section("", tuple(blocks))


def _cards(design: Design) -> Cards:
    loop, errors, units = design.loop, design.steady_state.force, units_of(design.model.spec)
    at_worst = " at worst" if design.region is not None and is_uncertain(design.region) else ""
    cards = [
        Card(f"{loop.operating_point.n} / {loop.operating_point.m}", "", "coordinates / constraints"),
        Card(number(-4 / slowest(design), 3), "s", f"settling time to 2 %{at_worst}"),
        Card(number(float(np.linalg.norm(loop.gains.W, 2)), 3), units.stiffness, "largest stiffness ‖W‖"),
        Card(number(float(loop.full.K[0]), 3), units.stiffness, "least eigenvalue of (14)"),
    ]
    if errors.given:
        position, force = errors.worst_position.value, errors.worst_constraint_force.value
        cards.append(Card(number(position, 3), units.coordinate, "worst position error under disturbance"))
        cards.append(Card(number(force, 3), units.multiplier, "worst force error under disturbance"))
    return Cards(tuple(cards))


def _picture(scene: Scene) -> Figure:
    forces = [f"{each.constraint.replace('_', ' ')}: {force_label(each)}" for each in shown_forces(scene)]
    caption = "The mechanism at q_d"
    if scene.ghosts:
        caption += ", and in pale where the constraints let it go"
    if forces:
        caption += f". Red: the contact force on the mechanism ({'; '.join(forces)})"
    if scene.patches:
        caption += ". Dashed: the surface's tangent plane where it is touched, with its normal n"
    if scene.held:
        caption += ". The box stands for what joined frames hold between them; its height and depth mean nothing"
    alt = f"Drawing of the mechanism: {', '.join(_seen(scene))}"
    return Figure(mechanism_picture(scene), prose(f"{caption}."), alt, 0.82)


def _seen(scene: Scene) -> list[str]:
    """List what is drawn, for those who cannot see it."""
    surfaces = len(scene.walls) + len(scene.rounds) + len(scene.patches)
    counted = (
        (len(scene.lines), "chain of links", "chains of links"),
        (surfaces, "surface that it touches", "surfaces that it touches"),
        (len(scene.held), "body held between two joined frames", "bodies held between joined frames"),
        (len(scene.rails), "rail or rod", "rails or rods"),
        (len(shown_forces(scene)), "contact force", "contact forces"),
    )
    found = [f"{count} {one if count == 1 else many}" for count, one, many in counted if count]
    reaches = [
        f"chain {i} from ({_place(line[0])}) m to ({_place(line[-1])}) m" for i, line in enumerate(scene.lines, start=1)
    ]
    return [*found, *reaches]


def _place(point: Array) -> str:
    return ", ".join(number(float(each), 2) for each in np.round(point, 3))
