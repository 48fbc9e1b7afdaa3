"""The verdict in one sentence, for reports and for the terminal."""

from __future__ import annotations

from firmtouch.design import Design
from firmtouch.report.numbers import complex_number, number


def verdict(design: Design) -> str:
    """Say what was found, in one sentence."""
    spec = design.model.spec
    matrices = "C, K and W are positive definite" if design.loop.full.holds else (
        "C and K are positive definite on the directions that the constraints leave free"
    )  # fmt: skip
    return (
        f"Designed: the gains put {_poles(design)}, {matrices}, "
        f"and all {len(design.checks.results)} model checks hold; "
        f"after any small disturbance the mechanism returns to q_d and its constraint force"
        f"{'s' if spec.m > 1 else ''} to lambda_d{settling(design)}."
    )


def settling(design: Design) -> str:
    """Say how soon: the slowest pole fades to 2 % in 4 / |Re s|, more or less."""
    slowest = max(pole.real for pole in design.achieved)
    return f", to 2 % within about {number(-4 / slowest, 2)} s" if slowest < 0 else ""


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
