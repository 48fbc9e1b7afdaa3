"""Words that the sections of a region design share: what varies, where on the polytope, and what was asked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from firmtouch.design import Design
from firmtouch.modelfile import ModelSpec
from firmtouch.modelfile.vector_units import joint_units, units_of
from firmtouch.regulation import ClosedLoop
from firmtouch.report.contents.prose import prose
from firmtouch.report.document import Line
from firmtouch.report.numbers import complex_number, number, unit

if TYPE_CHECKING:  # else cvxpy would be loaded, which takes a second, for designs that need none
    from firmtouch.synthesis.region import RegionDesign
    from firmtouch.synthesis.region.terms.positivity import Positivity
    from firmtouch.synthesis.region.terms.term import RegionTerm, Term

OF_D: Final = "of D"
"""The unit of the margin of (14) where it counts in multiples of a diagonal matrix D."""
MOST_NAMES: Final = 3


@dataclass(frozen=True, slots=True)
class Edges:
    """The edges of the region that were asked for, in SI."""

    decay: float | None
    damping: float | None
    bandwidth: float | None


def edges(region: RegionDesign) -> Edges:
    """Find the edges among the terms."""
    from firmtouch.synthesis.region.terms.bandwidth import Bandwidth
    from firmtouch.synthesis.region.terms.damping import Damping
    from firmtouch.synthesis.region.terms.decay import Decay

    asked = {type(each): each.asked for each in region.problem.terms}
    return Edges(asked.get(Decay), asked.get(Damping), asked.get(Bandwidth))


def is_choice_of_blocks(term: Term) -> bool:
    """Tell whether a term is the policy for the mixed blocks, which holds or not."""
    from firmtouch.synthesis.region.terms.normal_blocks import MixedBlocks

    return isinstance(term, MixedBlocks)


def is_uncertain(region: RegionDesign) -> bool:
    """Tell whether there is more than one plant."""
    return len(region.vertices) > 1


def loops(design: Design) -> tuple[ClosedLoop, ...]:
    """Give the closed loops of which a design speaks: the nominal one, and those at the vertices, if there are any."""
    return (design.loop,) if design.region is None else (design.region.loop, *design.region.vertices)


def slowest(design: Design) -> float:
    """Give the greatest real part of any pole that the design is about."""
    if design.region is None:
        return max(pole.real for pole in design.achieved)
    return max(pole.real for loop in loops(design) for pole in loop.poles.pencil)


def vertex(region: RegionDesign, index: int) -> Line:
    """Name a vertex of the polytope by the ends of the intervals that made it; no line breaks within one of them."""
    text = str(region.problem.polytope.vertices[index])
    return prose(text.replace("lambda_d.", "lambda_d\u00a0of\u00a0").replace(" = ", "\u00a0=\u00a0"))


def amount(value: float, its_unit: str, figures: int = 4) -> str:
    """Write a value with its unit."""
    shown = "D" if its_unit == OF_D else unit(its_unit)
    return f"{number(value, figures)} {shown}".rstrip()


def pole_pair(pole: complex) -> str:
    """Write a pole, together with its conjugate."""
    return complex_number(complex(pole.real, abs(pole.imag))).replace(" + ", " ± ")


def relation(term: Term) -> str:
    """Write in which sense a term bounds."""
    return "≤" if term.at_most else ">" if term.asked == 0 else "≥"


def positivity(region: RegionDesign) -> Positivity:
    """Give the term of (14), which is always there."""
    from firmtouch.synthesis.region.terms.positivity import Positivity

    return next(each for each in region.problem.terms if isinstance(each, Positivity))


def pole_terms(region: RegionDesign) -> list[RegionTerm]:
    """List the terms that make the region."""
    from firmtouch.synthesis.region.terms.term import RegionTerm

    return [each for each in region.problem.terms if isinstance(each, RegionTerm)]


def region_words(region: RegionDesign) -> str:
    """Write the region in a line: `decay rate ≥ 4 1/s, |s| ≤ 30 rad/s`; empty if none was asked for."""
    parts = [
        f"{each.name.removeprefix('greatest ')} {relation(each)} {amount(each.asked, each.unit)}"
        for each in pole_terms(region)
    ]
    return ", ".join(parts)


def varied(region: RegionDesign, spec: ModelSpec) -> str:
    """Write what varies in a few words: `every m3 from 2 to 3 kg`; empty if nothing does."""
    polytope = region.problem.polytope
    if not is_uncertain(region):
        return ""
    parts = [
        f"{name} from {number(low)} to {amount(high, spec.parameters[name].unit)}"
        for name, (low, high) in polytope.parameters.items()
    ]
    if len(parts) > MOST_NAMES:
        parts = [f"value of {', '.join(polytope.parameters)} in their intervals"]
    if any((polytope.lambda_box or {}).values()) or polytope.lambda_ball:
        parts.append("lambda_d in its range")
    return f"every {' and '.join(parts)}"


def multiplier_unit(spec: ModelSpec, constraint: str) -> str:
    """Give the unit of one constraint's multiplier."""
    coordinate = spec.constraints[constraint].unit
    return joint_units(coordinate).joint_force if coordinate in ("rad", "m") else f"J/({coordinate})"


def force_unit(spec: ModelSpec) -> str:
    """Give the unit of a norm of multipliers."""
    return units_of(spec).multiplier
