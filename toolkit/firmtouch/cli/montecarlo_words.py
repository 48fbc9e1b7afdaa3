"""What `firmtouch montecarlo` prints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from firmtouch.cli.console import results_console
from firmtouch.simulation.trajectory import Outcome

if TYPE_CHECKING:
    import numpy as np
    from rich.console import Console

    from firmtouch.modelfile import ModelSpec
    from firmtouch.montecarlo import Record, Sets, Study, Summary
    from firmtouch.montecarlo.summary import Worst

MEANINGS: Final = {each.name.lower(): each.value for each in Outcome} | {
    "off_surface": "started where the true surface cannot be reached"
}
MOST_SHOWN: Final = 3


class Words:
    """The units of a model, as they are printed; where they are mixed, all of them."""

    def __init__(self, model: ModelSpec) -> None:
        """Find them."""
        from firmtouch.modelfile.vector_units import units_of

        units = units_of(model)
        self.coordinate = units.coordinate or "rad or m"
        self.joint_force = units.joint_force or "N m or N"
        self.offset = units.offset or "m or rad"
        self.force = units.multiplier or "N or N m"

    def figure(self, record: Record, name: str) -> str:
        """Write one of a record's figures."""
        value = getattr(record, name)
        if name == "torque":
            return f"{100 * value:.3g} % of it"
        return f"{value:.3g} {self.coordinate if name == 'distance' else self.force}"


def print_answer(study: Study, summary: Summary, *, seconds: float, again: str, at_least: float | None) -> None:
    """Print what was drawn, what came of it, the worst runs, and the verdict on the proof."""
    console = results_console()
    print_draw(console, study)
    _print_fraction(console, summary, seconds, at_least)
    for name, count in sorted(summary.counts.items(), key=lambda each: -each[1]):
        console.print(f"  {count:6d}  {MEANINGS[name]}", markup=False)
    if summary.off_surface:
        console.print(f"  {summary.off_surface:6d}  {MEANINGS['off_surface']}: not counted", markup=False)
    _print_worst(console, summary.worst, Words(study.loop.operating_point.plant.spec))
    if any(each.records for each in summary.worst):
        console.print(f"one of them again: {again} NUMBER", markup=False, soft_wrap=True)
    _print_verdict(console, study, summary, again)


def print_draw(console: Console, study: Study) -> None:
    """Print what is drawn, and from where."""
    base, model = study.base, study.loop.operating_point.plant.spec
    console.print(
        f"Around `{base.name}`, controller ({base.feedback.controller.value}), {base.duration:.3g} s each, "
        f"seed {study.seed}. Drawn, uniformly:",
        markup=False,
        soft_wrap=True,
    )
    for name, words in _draws(study.sets, model):
        console.print(f"  {name:<12} {words}", markup=False, soft_wrap=True)


def _draws(sets: Sets, model: ModelSpec) -> list[tuple[str, str]]:
    words, coordinates, constraints = Words(model), list(model.coordinates), list(model.constraints)
    lines = []
    if sets.position.any():
        lines.append(
            ("start", f"q within {_each(sets.position, coordinates, '±')} {words.coordinate} of the scenario's")
        )
    if sets.velocity.any():
        lines.append(("velocity", f"q' within {_each(sets.velocity, coordinates, '±')} rad/s or m/s of the scenario's"))
    for name, (low, high) in sets.parameters.items():
        lines.append((name, f"{low:.4g} to {high:.4g} {model.parameters[name].unit}"))
    if sets.disturbance.any():
        lines.append(("force", f"a constant one, up to {_each(sets.disturbance, coordinates)} {words.joint_force}"))
    if sets.offset.any():
        lines.append(("offset", f"of the surface, up to {_each(sets.offset, constraints)} {words.offset}"))
    if sets.tilt:
        lines.append(("tilt", f"of the surface, up to {sets.tilt:.3g} rad"))
    if sets.rotation:
        lines.append(("rotation", f"of the constraints, up to {sets.rotation:.3g} rad"))
    return lines or [("nothing", "all runs are the same")]


def _each(values: np.ndarray, names: list[str], sign: str = "") -> str:
    """Write one figure if all are the same, else one for each name."""
    if len(set(values.tolist())) == 1:
        return f"{sign}{values[0]:.3g}"
    return ", ".join(f"{name} {sign}{value:.3g}" for name, value in zip(names, values.tolist(), strict=True))


def _print_fraction(console: Console, summary: Summary, seconds: float, at_least: float | None) -> None:
    low, high = summary.interval
    console.print(
        f"\n{summary.converged} of {summary.runs} runs converged: {percent(summary.fraction)}, "
        f"and with 95 % confidence {percent(low)} to {percent(high)} of all ({seconds:.3g} s)",
        style="bold",
        markup=False,
        soft_wrap=True,
    )
    if at_least is not None:
        reached = low >= at_least
        words = "reached" if reached else "NOT reached"
        style = "green" if reached else "bold red"
        console.print(f"at least {percent(at_least)} was asked for: {words}", style=style, markup=False)


def percent(part: float) -> str:
    """Write a part with one digit after the point, and never 100 % for less, nor 0 % for more."""
    text = f"{100 * part:.1f}"
    if text == "100.0" and part < 1:
        text = "99.9"
    if text == "0.0" and part > 0:
        text = "0.1"
    return f"{text.removesuffix('.0')} %"


def _print_worst(console: Console, worst: tuple[Worst, ...], words: Words) -> None:
    from rich.table import Table

    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("worst runs", "number", "how far", "what came of it"):
        table.add_column(heading, justify="right" if heading == "number" else "left", overflow="fold")
    for each in worst:
        for i, record in enumerate(each.records[:MOST_SHOWN]):
            table.add_row("" if i else each.name, str(record.label), words.figure(record, each.figure), record.reason)
    if table.row_count:
        console.print()
        console.print(table)


def _print_verdict(console: Console, study: Study, summary: Summary, again: str) -> None:
    """Say whether the runs agree with the proof."""
    if not study.regions:
        console.print(
            "\nNothing is proven here to hold the runs against; give a finished design's folder, or `--prove`.",
            markup=False,
            soft_wrap=True,
        )
        return
    where = " and ".join(each.words for each in study.regions)
    count = summary.inside - len(summary.contradictions)
    console.print()
    if not summary.contradictions:
        console.print(
            f"All {count} further starts inside the proven region ({where}) converged, as they must.",
            style="green",
            markup=False,
            soft_wrap=True,
        )
    for each in summary.contradictions:
        console.print(
            f"CONTRADICTION: run {each.label} starts inside the proven region, with V = {each.V:.4g} J of "
            f"{each.level:.4g} J, and did not converge: it {each.reason}. Again: {again} {each.label}",
            style="bold red",
            markup=False,
            soft_wrap=True,
        )
    if summary.contradictions:
        console.print(
            f"The other {count} starts inside it converged. Keep this folder: it shows a mistake in the proof or in "
            "the simulation.",
            markup=False,
            soft_wrap=True,
        )
    if summary.pulled:
        console.print(
            f"In {summary.pulled} of them a one-sided contact had to pull: the proof holds while the contact lasts.",
            markup=False,
            soft_wrap=True,
        )
