"""The verdict in one sentence, for reports and for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from firmtouch.design import Design
from firmtouch.report.contents.region_words import loops, region_words, slowest, varied
from firmtouch.report.numbers import complex_number, number

if TYPE_CHECKING:  # else cvxpy would be loaded for every report
    from firmtouch.synthesis.region import RegionDesign


def verdict(design: Design) -> str:
    """Say what was found, in one sentence."""
    spec = design.model.spec
    matrices = "C, K and W are positive definite" if all(each.full.holds for each in loops(design)) else (
        "C and K are positive definite on the directions that the constraints leave free"
    )  # fmt: skip
    return (
        f"{_standing(design)}: {_loop(design)}, {matrices}, "
        f"and all {len(design.checks.results)} model checks hold; "
        f"{_signal(design)}after any small disturbance the mechanism returns to q_d and its constraint force"
        f"{'s' if spec.m > 1 else ''} to lambda_d{settling(design)}."
    )


def _signal(design: Design) -> str:
    """Say under which condition the promise is made, where the file's own force path or contact breaks it."""
    force = design.force_loop
    if not force.stable:
        return "with the file's `force_path` the force loop is unstable; only with a force signal that came at once, "
    if force.contact is not None and force.contact.poles is not None and not force.contact.poles.stable:
        return "at the file's `contact_stiffness` the loop is unstable; only with a rigid contact, "
    return ""


def _standing(design: Design) -> str:
    """Say whether it is proven."""
    if design.certificate.certified:
        return "Certified"
    missing, count = len(design.certificate.open), len(design.certificate.claims)
    return f"Not certified ({missing} of {count} claims are not proven)"


def settling(design: Design) -> str:
    """Say how soon: the slowest pole fades to 2 % in 4 / |Re s|, more or less."""
    rate = slowest(design)
    return f", to 2 % within about {number(-4 / rate, 2)} s" if rate < 0 else ""


def _loop(design: Design) -> str:
    """Say where the poles are, or in which region, and for which plants."""
    if design.region is None:
        return f"the gains put {_poles(design)}"
    plants = varied(design.region, design.model.spec)
    return f"{f'for {plants} ' if plants else ''}the gains {_kept(design.region)}"


def _kept(region: RegionDesign) -> str:
    edges = region_words(region)
    return f"keep all poles in the asked region ({edges})" if edges else "meet all that was asked of the loop"


def _poles(design: Design) -> str:
    """Name up to four poles, conjugates together; of more, their number and range."""
    upper = [pole for pole in design.requested if pole.imag >= 0]
    if len(upper) > 4:
        low, high = (number(f(abs(pole) for pole in design.requested), 3) for f in (min, max))
        return f"all {len(design.requested)} poles where they were asked for, {low} to {high} rad/s from the origin"
    listed = [_name(pole, upper.count(pole)) for pole in dict.fromkeys(upper)]
    return f"the pole{'s' if len(design.requested) > 1 else ''} at {_enumerated(listed)} 1/s"


def _name(pole: complex, count: int) -> str:
    times = {1: "", 2: " (twice)"}.get(count, f" ({count} times)")
    return complex_number(pole).replace(" + ", " ± ") + times


def _enumerated(words: list[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
