"""How far off, and how fast, the mechanism may start: the proven region of attraction [T10]."""

from __future__ import annotations

from firmtouch.certificate.attraction import Attraction, JointBox, Limit, WholeBox
from firmtouch.design import Design, Surroundings
from firmtouch.report.contents.prose import prose
from firmtouch.report.document import Block, Equation, Figure, Line, Paragraph, Section, Table
from firmtouch.report.figures.attraction import attraction_picture
from firmtouch.report.numbers import bound

_LIMITS = {
    Limit.BOX: "The search ended at its largest box; the region may be larger.",
    Limit.POINT: "The region ends where another equilibrium may be, or where the surface turns away from its tangent "
    "space at q_d.",
    Limit.CELLS: "The search ended with the number of cells that it may take; the region may be larger.",
}


def section(design: Design) -> Section | None:
    """Write what is proven about the surroundings of q_d, if it was looked at."""
    around = design.surroundings
    if around is None:
        return None
    found = around.finding
    blocks: list[Block] = []
    if design.certificate.subject.plants.vary:
        blocks.append(Paragraph(("All of this section is about the nominal plant.",)))
    if found.attraction is not None:
        blocks += [*_statement(found.attraction), _table(design, found.attraction, found.box)]
        limit = _LIMITS.get(found.attraction.limit)
        if limit:
            blocks.append(Paragraph(prose(limit)))
        blocks += _picture(found.attraction, around)
    if found.reasons:
        subject = "No region of attraction" if found.attraction is None else "No box of joint coordinates"
        blocks.append(Paragraph(prose(f"{subject} was proven: {'; '.join(found.reasons)}.")))
    return Section("Region of attraction", tuple(blocks))


def _statement(found: Attraction) -> tuple[Block, ...]:
    return (
        Paragraph(
            prose(
                "How small is a small disturbance? For controller (15), and for (11) with any force feedback, the "
                "Lyapunov function"
            )
        ),
        Equation("V = 1/2 dot(q)^T M(q) dot(q) + P_(c d)(q), quad dot(V) = -dot(q)^T C dot(q)", "(9)"),
        Paragraph(
            prose(
                "never grows. Every start on the surface next to q_d with "
                f"V < c = {bound(found.level, upwards=False)} J comes to rest at q_d: where V can stay there is no "
                "other equilibrium, and no way out below c. Both are proven by covering the surface with cells in ball "
                "arithmetic, without samples [T10]. For (17) this is open; near q_d it is the same to first order."
            )
        ),
    )


def _table(design: Design, found: Attraction, box: WholeBox | JointBox | None) -> Table:
    length, speed = _units(design)
    headings: tuple[Line, ...] = (("start",), ("proven for",), ("every joint within",), ("every speed below",))
    rows: list[tuple[Line, ...]] = [
        (("at rest",), ("the surface connected with q_d there",), (_least(found.distance, length),), ("at rest",)),
        (("at q_d",), ("any direction along the surface",), ("at q_d",), (_least(found.speeds.all_joints, speed),)),
        (
            ("both at once",),
            ("as both rows above",),
            (_least(found.together.distance, length),),
            (_least(found.together.speed, speed),),
        ),
    ]
    if box is not None:
        whole = isinstance(box, WholeBox)
        where = "all of the surface in this box" if whole else "the surface connected with q_d in this box"
        energy = f"V < {bound(box.level, upwards=False)} J"
        rows.append(((energy,), (where,), (_least(box.half_width, length),), ("as V allows",)))
    lines = tuple(tuple(prose(str(cell[0])) for cell in row) for row in rows)
    return Table(headings, lines, frozenset({2, 3}), wide=frozenset({1}))


def _units(design: Design) -> tuple[str, str]:
    units = {each.unit for each in design.model.spec.coordinates.values()}
    length = units.pop() if len(units) == 1 else "rad or m"
    return length, f"{length}/s" if length != "rad or m" else "rad/s or m/s"


def _least(value: float, unit: str) -> str:
    return f"{bound(value, upwards=False, figures=3)} {unit}"


def _picture(found: Attraction, around: Surroundings) -> list[Block]:
    comparison = around.comparison
    if comparison is None:
        return []
    caption = (
        "What is proven (green), and starts at rest that were simulated with controller (15): how much the proof gives "
        "away. Where a mark is missing, the surface has turned away."
    )
    alt = "The proven region over the free directions, with simulated starts that converge or do not"
    return [Figure(attraction_picture(found, comparison), (caption,), alt, 0.66)]
