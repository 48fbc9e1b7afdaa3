"""The force loop: what the way of the force signal allows [T8], and a contact that gives way [T9]."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from firmtouch.design import Design
from firmtouch.regulation.force_loop import AskedMargin, ForceLoop, ForcePath, LoopMargins, StiffnessSweep
from firmtouch.regulation.force_loop.sweep import APART, LEEWAY, SOFTEST, STIFFEST
from firmtouch.report.contents.region_words import pole_pair
from firmtouch.report.document import Block, Code, Equation, Figure, Line, Math, Paragraph, Section, Table
from firmtouch.report.figures.force_loop import nyquist_picture, stiffness_picture
from firmtouch.report.numbers import number


def section(design: Design) -> Section:
    """Write the force loop; without a force path in the file it is short."""
    force = design.force_loop
    blocks: list[Block] = [*_path(force)]
    if force.given:
        blocks += [_table(force), Paragraph(_admissible(force)), _nyquist(force)]
    blocks += _contact(design, force)
    return Section("Force loop", tuple(blocks))


def _path(force: ForceLoop) -> Iterator[Block]:
    if not force.given:
        yield Paragraph(
            (
                "With a rigid contact and a force signal that comes at once, every ",
                Math("G_f >= 0"),
                " is stable [T7]. What bounds it is the way of the signal: give ",
                Code("force_path"),
                " in the file, and its margins are told here. A signal one sample late allows less than 1.",
            )
        )
        return
    yield Paragraph(
        (
            f"The measured force comes through {_in_words(force.path)}. With a rigid contact, force feedback is a loop "
            "of its own beside (38); along the eigenvectors of ",
            Math("G_f"),
            " it falls apart into scalar ones [T8]:",
        )
    )
    yield Equation('(I + G_f L) delta lambda = "what moves the force", quad 1 + g_i L = 0', "[T8]")
    yield Equation(_transfer_function(force.path), "[T8]")


def _in_words(path: ForcePath) -> str:
    parts = []
    if path.lag:
        cycles = number(1 / path.lag / (2 * np.pi), 3)
        parts.append(f"a low-pass of {cycles} Hz (a lag of {_milliseconds(path.lag)})")
    if path.sample:
        parts.append(f"a controller that samples every {_milliseconds(path.sample)} and holds its output")
    if path.delay:
        samples = f" ({path.steps} sample{'s' * (path.steps != 1)})" if path.sample else ""
        parts.append(f"a{' further' if path.sample else ''} delay of {_milliseconds(path.delay)}{samples}")
    return ", and ".join((", ".join(parts[:-1]), parts[-1])) if len(parts) > 1 else parts[0]


def _transfer_function(path: ForcePath) -> str:
    if path.sample:
        late = f"z^(-{1 + path.steps})"
        if not path.lag:
            return f"L(z) = {late}"
        return f"L(z) = {late} (1 - a) / (1 - a z^(-1)), quad a = {1 - path.decay:.4f}"
    late = "e^(-s tau)" if path.delay else "1"
    return f"L(s) = {late} / (1 + s tau_f)" if path.lag else f"L(s) = {late}"


def _table(force: ForceLoop) -> Table:
    headings: tuple[Line, ...] = (
        ("loop",), (Math("g_i"),), ("stable below",), ("gain margin",), ("delay margin",), ("modulus margin",),
    )  # fmt: skip
    rows = [(f"{i}", *_figures(each)) for i, each in enumerate(force.loops, start=1)]
    if force.asked is not None:
        asked = {each.name: each for each in force.verdicts}
        gain, delay, modulus = (asked.get(name) for name in ("gain", "delay", "modulus"))
        rows.append(
            (
                "asked",
                "",
                "",
                f"≥ {number(gain.asked, 3)}" if gain else "",
                f"≥ {_milliseconds(delay.asked)}" if delay else "",
                f"≥ {number(modulus.asked, 3)}" if modulus else "",
            )
        )
        rows.append(("kept", "", "", *(_kept(each) for each in (gain, delay, modulus))))
    caption: Line = (
        "One row for each eigenvalue of ",
        Math("G_f"),
        ": by what factor it may grow, what further delay it bears, and how far the Nyquist curve keeps from −1.",
    )
    return Table(headings, tuple(tuple((cell,) for cell in row) for row in rows), frozenset(range(1, 6)), caption)


def _kept(margin: AskedMargin | None) -> str:
    return "" if margin is None else "yes" if margin.kept else "NO"


def _milliseconds(seconds: float) -> str:
    return f"{number(1e3 * seconds, 3)} ms"


def _figures(loop: LoopMargins) -> tuple[str, ...]:
    if not loop.stable:
        return number(loop.gain), number(loop.bound), number(loop.gain_margin, 3), "unstable", "unstable"
    return (
        number(loop.gain),
        "any" if np.isinf(loop.bound) else number(loop.bound),
        number(loop.gain_margin, 3),
        "any delay" if np.isinf(loop.delay_margin) else _milliseconds(loop.delay_margin),
        number(loop.modulus_margin, 3),
    )


def _admissible(force: ForceLoop) -> Line:
    kept = "the margins asked for" if force.asked is not None else "a gain margin of 2 and a modulus margin of 0.5"
    if np.isinf(force.admissible):
        return (f"Every G_f = g I has {kept}.",)
    return (
        "The largest ",
        Math("G_f = g I"),
        f" with {kept} has g = {number(force.admissible)}. It would divide every steady force error by ",
        f"{number(1 + force.admissible, 3)}.",
    )


def _nyquist(force: ForceLoop) -> Figure:
    modulus = force.asked.modulus if force.asked is not None else None
    disc = " No curve may enter the green circle: that is the modulus margin asked for." if modulus else ""
    return Figure(
        nyquist_picture(force.path, [each.gain for each in force.loops], modulus),
        (f"Nyquist curves of the force loops, from frequency 0 up; −1 must stay outside (to the left).{disc}",),
        f"Nyquist curves of {len(force.loops)} force loops about the origin, with the point −1",
        0.7,
    )


def _contact(design: Design, force: ForceLoop) -> Iterator[Block]:
    yield Paragraph(
        (
            "No contact is rigid. If the surface gives way with a stiffness ",
            Math("k_e"),
            f" of {number(SOFTEST)} to {number(STIFFEST)} {_unit(design)}, the poles are the roots of",
        )
    )
    signal = "I + G_f L(s)" if force.given else "I + G_f"
    yield Equation(f"M s^2 + C s + K + k_e J^T ({signal}) J = 0", "[T9]")
    sampled = "(here over one sample of the controller, exactly). " if force.path.sample else ""
    yield Paragraph((sampled, _stability(force.sweep, _unit(design)), " ", _kept_from(force.sweep, _unit(design))))
    if force.given and force.sweep.points:
        if force.stable and force.sweep.unstable:
            yield Paragraph(
                (
                    "A stiff contact swings, with no more damping than ",
                    Math("C"),
                    " gives it, and a force signal that comes late feeds the swing. A rigid contact has no such "
                    "motion, so the bound of [T8] is needed there, and not enough here.",
                )
            )
        if force.contact is not None:
            yield Paragraph(_stated(force, _unit(design)))
        yield _over_stiffness(design, force)


def _stability(sweep: StiffnessSweep, unit: str) -> str:
    if not sweep.points:
        return "They cannot be computed here: the delay is too long."
    if not sweep.unstable:
        return f"All poles are stable{_as_far(sweep, unit)}."
    spans = []
    for each in sweep.unstable:
        if each.low == 0 and np.isinf(each.high):
            spans.append("all along the sweep")
        elif each.low == 0:
            spans.append(f"up to {_rounded(each.high)} {unit}")
        elif np.isinf(each.high):
            spans.append(f"from {_rounded(each.low)} {unit} on")
        else:
            spans.append(f"from {_rounded(each.low)} to {_rounded(each.high)} {unit}")
    return f"The loop is unstable {' and '.join(spans)}{_as_far(sweep, unit)}."


def _rounded(stiffness: float) -> str:
    """Write a stiffness with three figures, whatever its size."""
    return number(float(f"{stiffness:.2e}"))


def _as_far(sweep: StiffnessSweep, unit: str) -> str:
    """Say where a sweep ended that did not come to its end."""
    last = float(sweep.stiffness[-1])
    ended = last < STIFFEST * (1 - 1e-9)
    return f" (the delay is too long for poles beyond {_rounded(last)} {unit} to be computed)" if ended else ""


def _kept_from(sweep: StiffnessSweep, unit: str) -> str:
    what = (
        f"The poles that tend to those of (38) are in the region (to {LEEWAY:.0%})"
        if sweep.by_region
        else f"The slowest of the poles that tend to those of (38) is within {APART:.0%} of its place"
    )
    if not sweep.points:
        return ""
    if np.isinf(sweep.kept_from):
        return f"{what} nowhere up to the end of the sweep."
    return f"{what} {f'from {_rounded(sweep.kept_from)} {unit} on' if sweep.kept_from else 'all along'}."


def _stated(force: ForceLoop, unit: str) -> Line:
    assert force.contact is not None
    poles = force.contact.poles
    if poles is None:
        return ("The delay is too long for the poles of the file's contact to be computed.",)
    values = ", ".join(number(float(each)) for each in dict.fromkeys(poles.stiffness.tolist()))
    state = "stable" if poles.stable else "unstable"
    found = f"For the contact of the file, {values} {unit}, the loop is {state}, its slowest pole at "
    found += f"{pole_pair(poles.poles[0])} 1/s"
    critical = force.contact.critical_gain
    if np.isinf(critical):
        return (f"{found}; no force feedback that was tried makes it unstable.",)
    if critical == 0:
        return (f"{found}; without force feedback it is unstable too.",)
    return (f"{found}; with ", Math("G_f = g I"), f" it is unstable from g = {number(critical)} on.")


def _over_stiffness(design: Design, force: ForceLoop) -> Figure:
    poles = force.contact.poles if force.contact is not None else None
    region = design.model.spec.design.region if force.sweep.by_region else None
    shaded = " Shaded: unstable." if force.sweep.unstable else ""
    return Figure(
        stiffness_picture(
            force.sweep,
            _unit(design),
            [] if poles is None else poles.stiffness.tolist(),
            decay=None if region is None else region.decay,
        ),
        (f"Real parts of the poles over the contact's stiffness, and those of (38) as dotted lines.{shaded}",),
        f"Real parts of the poles for {len(force.sweep.points)} stiffnesses of the contact",
        0.85,
    )


def _unit(design: Design) -> str:
    """Name the unit of k_e: the common factor counts in the unit that each constraint has."""
    units = {each.unit for each in design.model.spec.constraints.values()}
    names = [name for unit, name in (("m", "N/m"), ("rad", "N m/rad")) if unit in units]
    return " or ".join(names) if len(names) == len(units) else "in SI"
