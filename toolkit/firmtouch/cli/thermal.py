"""`firmtouch thermal SENSOR`."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from firmtouch.cli import GOOD, NO
from firmtouch.cli.console import results_console, talk_console, working
from firmtouch.cli.processes import processes
from firmtouch.errors import InputError

if TYPE_CHECKING:
    from firmtouch.thermal.sensorfile import SensorFile
    from firmtouch.thermal.study import Study


def run(arguments: argparse.Namespace) -> int:
    """Analyse or design a sensor, write the files, and print the verdict and what is asked."""
    if arguments.jobs is not None and arguments.jobs < 1:
        raise InputError(f"`--jobs {arguments.jobs}`: at least one process is needed")
    with working(f"reading {arguments.sensor}") as progress:
        file = _read(arguments)
        progress("loading the thermal tools")
        from firmtouch.report.write import write_files
        from firmtouch.thermal.study import study_sensor

        jobs = 1 if file.spec.search is None else processes(arguments.jobs)
        study = study_sensor(file, jobs=jobs, tell=progress)
        contents = _contents(study, progress, pdf=not arguments.no_pdf)
        folder = Path(arguments.out) if arguments.out is not None else Path("reports") / file.name
        progress("writing")
        paths = write_files(folder, contents)
    code = GOOD if study.verdict == "met" else NO
    if arguments.json:
        sys.stdout.write(contents["thermal.json"].decode())
        return code
    _print(study)
    for path in paths:
        results_console().print(f"  {path}", markup=False, soft_wrap=True)
    return code


def _read(arguments: argparse.Namespace) -> SensorFile:
    from firmtouch.thermal.sensorfile import read_sensor
    from firmtouch.thermal.tables import read_catalogue

    return read_sensor(arguments.sensor, read_catalogue(*arguments.catalogue) if arguments.catalogue else None)


def _contents(study: Study, progress: Callable[[str], None], *, pdf: bool) -> dict[str, bytes]:
    from firmtouch.report.html import render_html
    from firmtouch.report.pdf import render_pdf
    from firmtouch.report.thermal import study_document
    from firmtouch.report.thermal_json import responses_as_csv, study_as_json

    contents = {
        "thermal.json": (json.dumps(study_as_json(study), indent=1, allow_nan=False) + "\n").encode(),
        "responses.csv": responses_as_csv(study.analysis).encode(),
    }
    if study.search is not None:
        from firmtouch.thermal.search.designed_file import designed_text

        analysis = study.analysis
        contents["sensor.yaml"] = designed_text(analysis.file, analysis.spec, study.search.chosen.values).encode()
    progress("drawing the report")
    document = study_document(study)
    progress("setting report.html")
    contents["report.html"] = render_html(document).encode()
    if pdf:
        progress("setting report.pdf")
        contents["report.pdf"] = render_pdf(document)
    return contents


def _print(study: Study) -> None:
    """Print the verdict, a table of what is asked, and what binds."""
    from rich.markup import escape
    from rich.table import Table

    from firmtouch.report.thermal import binding_lines, requirement_rows, study_verdict
    from firmtouch.report.thermal.words import tidied

    console = results_console()
    console.print(study_verdict(study), markup=False, soft_wrap=not console.is_terminal)
    for warning in study.analysis.warnings:
        talk = talk_console()
        talk.print(f"warning: {tidied(warning)}", style="yellow", markup=False, soft_wrap=not talk.is_terminal)
    rows = requirement_rows(study.analysis)
    if not rows:
        return
    table = Table(box=None, pad_edge=False)
    for heading in ("", "requirement", "asked", "reached", "margin", "worst in"):
        table.add_column(heading, justify="right" if heading in {"asked", "reached", "margin"} else "left")
    for each in rows:
        cells = (each.name, each.asked, each.reached, each.margin, each.where)
        table.add_row("[green]ok[/]" if each.met else "[red]no[/]", *map(escape, cells))
    console.print(table)
    if study.analysis.binding is not None:
        for line in binding_lines(study.analysis.binding):
            console.print(f"  {line}", markup=False, soft_wrap=not console.is_terminal)
