"""`firmtouch montecarlo ... --run K`: one run once more."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from firmtouch.cli import GOOD, NO
from firmtouch.cli.console import results_console, working
from firmtouch.cli.montecarlo_words import MEANINGS, Words
from firmtouch.errors import InputError

if TYPE_CHECKING:
    from firmtouch.montecarlo import Record, Study


def run_again(arguments: argparse.Namespace, study: Study, question: Mapping[str, Any], folder: Path) -> int:
    """Run it, write its table, and say whether it is what the folder holds."""
    from firmtouch.montecarlo import run_labelled
    from firmtouch.montecarlo.answer import drawn_as_json
    from firmtouch.montecarlo.journal import read_runs
    from firmtouch.montecarlo.record import read_label, record_as_json
    from firmtouch.report.simulation_json import trajectory_as_csv
    from firmtouch.report.write import write_files

    label = read_label(arguments.once_more)
    if label.proven and not study.regions:
        raise InputError(f"run {label} would start inside a proven region, and none is known here (`--prove`)")
    known = read_runs(folder, question).get(label)
    with working(f"running {label}"):
        record, trajectory = run_labelled(study, label)
    drawn = drawn_as_json(study, label)
    op = study.loop.operating_point
    contents = {} if trajectory is None else {f"run-{label}.csv": trajectory_as_csv(trajectory, op).encode()}
    paths = write_files(folder, contents)
    same = None if known is None else record_as_json(known) == record_as_json(record)
    if arguments.json:
        told = record_as_json(record) | {"drawn": drawn, "as_recorded": same}
        sys.stdout.write(json.dumps(told, indent=1, allow_nan=False) + "\n")
    else:
        _print(study, record, drawn, MEANINGS[record.outcome])
        if same is not None:
            words = "the same as recorded, bit for bit" if same else "NOT what is recorded: another machine, perhaps"
            results_console().print(words, style="green" if same else "bold red", markup=False)
        for path in paths:
            results_console().print(f"  {path}", markup=False, soft_wrap=True)
    return NO if label.proven and not record.converged else GOOD


def _print(study: Study, record: Record, drawn: Mapping[str, Any], meaning: str) -> None:
    from rich.table import Table

    spec = study.loop.operating_point.plant.spec
    table = Table(box=None, pad_edge=False, show_header=False)
    coordinates, constraints = list(spec.coordinates), list(spec.constraints)
    table.add_row("q", _named(drawn["start"]["q"], coordinates))
    table.add_row("q'", _named(drawn["start"]["qdot"], coordinates))
    for name, value in drawn.get("parameters", {}).items():
        table.add_row(name, f"{value:.4g}")
    if drawn.get("d"):
        table.add_row("force", _named(drawn["d"], coordinates))
    if not record.label.proven:
        table.add_row("offset", _named(drawn["Delta"], constraints))
        for name, row in zip(constraints, drawn["E"], strict=True):
            table.add_row(f"tilt, {name}", _named(row, coordinates))
        if len(constraints) > 1:
            for name, row in zip(constraints, drawn["R"], strict=True):
                table.add_row(f"rotation, {name}", _named(row, constraints))
    console = results_console()
    console.print(f"Run {record.label} of seed {study.seed}; drawn, in SI:", markup=False)
    console.print(table)
    console.print(f"\n{record.reason} ({meaning})", style="bold", markup=False, soft_wrap=True)
    console.print(_figures(record, Words(spec)), markup=False, soft_wrap=True)


def _figures(record: Record, words: Words) -> str:
    parts = [
        f"farthest from q_d {record.farthest:.3g} {words.coordinate}",
        f"at the end {record.distance:.3g} from rest",
        f"largest force error {record.force:.3g} {words.force}",
    ]
    if record.torque is not None:
        parts.append(f"up to {100 * record.torque:.3g} % of a drive's limit")
    if record.V is not None:
        parts.append(f"V = {record.V:.4g} J at the start, {record.level:.4g} J proven")
    return "; ".join(parts)


def _named(values: list[float], names: list[str]) -> str:
    return ", ".join(f"{name} {value:.4g}" for name, value in zip(names, values, strict=True))
