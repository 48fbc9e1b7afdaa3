"""`firmtouch check MODEL...`."""

from __future__ import annotations

import argparse
import json
import math
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from firmtouch.cli import GOOD, NO, WRONG
from firmtouch.cli.console import results_console, working
from firmtouch.errors import InputError, NoDesignError

if TYPE_CHECKING:
    from firmtouch.checks import CheckReport, CheckResult

SCHEMA = "firmtouch.check/1"


def run(arguments: argparse.Namespace) -> int:
    """Check every model; one that cannot be read, or has no configuration to be checked at, stops no other."""
    code, told = GOOD, []
    for path in map(Path, arguments.models):
        try:
            with working(f"checking {path}"):
                report = _check(path)
        except InputError as error:
            sys.stderr.write(f"{error}\n")
            told.append({"model": str(path), "error": str(error)})
            code = WRONG
            continue
        except NoDesignError as error:
            sys.stderr.write(f"{path}: no operating point: {error}\n")
            told.append({"model": str(path), "error": str(error)})
            code = max(code, NO)
            continue
        told.append(_as_json(report, path))
        code = max(code, GOOD if report.holds else NO)
        if not arguments.json:
            _print(report, path)
    if arguments.json:
        json.dump({"schema": SCHEMA, "models": told}, sys.stdout, indent=2)
        sys.stdout.write("\n")
    return code


def _check(path: Path) -> CheckReport:
    """Read first: a file with mistakes does not wait for the numeric libraries."""
    from firmtouch.modelfile import read_model

    model = read_model(path)
    from firmtouch.checks import check_model

    return check_model(model)[0]


def _print(report: CheckReport, path: Path) -> None:
    from rich.table import Table
    from rich.text import Text

    title = Text(os.fsencode(path).decode(errors="replace"))  # a path may hold bytes that are no text
    table = Table(title=title, title_justify="left", box=None, pad_edge=False, header_style="bold")
    for heading in ("", "check", "figure", "bound", "found"):
        table.add_column(heading, justify="right" if heading == "figure" else "left", overflow="fold")
    for each in report.results:
        mark = Text("ok", "green") if each.holds else Text("FAILS", "bold red")
        figure = "" if each.relation == "-" else f"{each.figure:.3g}"
        bound = "" if each.relation == "-" else f"{each.relation} {each.bound:.3g}"
        table.add_row(mark, each.name, figure, bound, Text(each.detail))
    results_console().print(table)
    verdict = (
        f"all {len(report.results)} checks hold"
        if report.holds
        else f"{len(report.failed)} of {len(report.results)} checks fail"
    )
    results_console().print(Text(verdict, "green" if report.holds else "bold red"), "\n", sep="")


def _as_json(report: CheckReport, path: Path) -> dict[str, Any]:
    checks = [_result_as_json(each) for each in report.results]
    return {"model": report.model, "file": str(path), "holds": report.holds, "checks": checks}


def _result_as_json(result: CheckResult) -> dict[str, Any]:
    return {
        "name": result.name,
        "holds": result.holds,
        "figure": result.figure if math.isfinite(result.figure) else None,
        "relation": result.relation,
        "bound": result.bound if math.isfinite(result.bound) else None,
        "detail": result.detail,
    }
