"""`firmtouch simulate MODEL_OR_DESIGN`."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from firmtouch.cli import GOOD, NO
from firmtouch.cli.console import results_console, working
from firmtouch.cli.target import load_target
from firmtouch.errors import InputError

if TYPE_CHECKING:
    from firmtouch.modelfile import ModelFile
    from firmtouch.regulation import ClosedLoop
    from firmtouch.simulation.scenario import Scenario
    from firmtouch.simulation.trial import Run


def run(arguments: argparse.Namespace) -> int:
    """Simulate, write the files, and print what came of each scenario."""
    with working(f"reading {arguments.target}") as progress:
        model, loop = load_target(arguments.target, progress)
        progress("reading the scenarios")
        scenarios = _chosen(_scenarios(arguments.scenario, model, loop), arguments.only)
        from firmtouch.regulation.projection import OffSurfaceError
        from firmtouch.report import write_files
        from firmtouch.simulation.trial import run_all

        runs: list[Run] = []
        for each in scenarios:
            progress(f"simulating {each.name}")
            try:
                runs += run_all(loop, [each], tolerance=arguments.tolerance)
            except OffSurfaceError as error:
                raise InputError(f"scenario `{each.name}` cannot start where it shall: {error}") from error
        contents = _contents(model, loop, tuple(runs))
        folder = Path(arguments.out) if arguments.out is not None else Path("reports") / model.name / "simulation"
        progress("writing")
        paths = write_files(folder, contents)
    if arguments.json:
        sys.stdout.write(contents["simulation.json"].decode())
    else:
        _print(tuple(runs), loop)
        for path in paths:
            results_console().print(f"  {path}", markup=False, soft_wrap=True)
    return GOOD if all(each.trajectory.outcome.good for each in runs) else NO


def _scenarios(file: str | None, model: ModelFile, loop: ClosedLoop) -> tuple[Scenario, ...]:
    """Read a scenario file for the model, or take the usual scenarios."""
    if file is None:
        from firmtouch.regulation import steady_state_errors
        from firmtouch.simulation.usual import usual_scenarios

        return usual_scenarios(loop, steady_state_errors(loop, model.spec.bounds))
    from firmtouch.modelfile.scenarios import read_scenarios
    from firmtouch.simulation.from_file import scenarios_of

    return scenarios_of(read_scenarios(file, model), loop)


def _chosen(scenarios: tuple[Scenario, ...], only: str | None) -> tuple[Scenario, ...]:
    if only is None:
        return scenarios
    found = tuple(each for each in scenarios if each.name == only)
    if not found:
        raise InputError(f"no scenario `{only}`; there are: {', '.join(each.name for each in scenarios)}")
    return found


def _contents(model: ModelFile, loop: ClosedLoop, runs: tuple[Run, ...]) -> dict[str, bytes]:
    from firmtouch.report import render_html
    from firmtouch.report.contents.simulation import simulation_document
    from firmtouch.report.simulation_json import simulation_as_json, trajectory_as_csv

    op = loop.operating_point
    data = simulation_as_json(model, op, runs)
    contents = {"simulation.json": (json.dumps(data, indent=1, allow_nan=False) + "\n").encode()}
    contents["simulation.html"] = render_html(simulation_document(model, op, runs)).encode()
    for each in runs:
        contents[f"{each.trajectory.scenario.name}.csv"] = trajectory_as_csv(each.trajectory, op).encode()
    return contents


def _print(runs: tuple[Run, ...], loop: ClosedLoop) -> None:
    from rich.table import Table
    from rich.text import Text

    from firmtouch.modelfile.vector_units import units_of

    op = loop.operating_point
    units = units_of(op.plant.spec)
    limited = any(each.trajectory.scenario.feedback.limits is not None for each in runs)
    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("", "scenario", "what came of it"):
        table.add_column(heading, overflow="fold")
    drives = "% of a limit" if limited else units.joint_force
    force = "contact force" if op.m == 1 else "largest force error"
    for heading, unit in (("error", units.coordinate), (force, units.multiplier), ("drives", drives)):
        table.add_column(f"{heading}, {unit}" if unit else heading, justify="right")
    for each in runs:
        trajectory, limits = each.trajectory, each.trajectory.scenario.feedback.limits
        good = trajectory.outcome.good
        largest = np.max(np.abs(trajectory.u if limits is None else 100 * trajectory.u / limits))
        table.add_row(
            Text("ok", "green") if good else Text("FAILS", "bold red"),
            trajectory.scenario.name,
            Text(trajectory.reason),
            f"{np.max(np.abs(trajectory.q - op.q_d)):.3g}",
            f"{trajectory.lambda_.min():.4g} to {trajectory.lambda_.max():.4g}"
            if op.m == 1
            else f"{np.max(np.abs(trajectory.lambda_ - op.lambda_d)):.3g}",
            f"{largest:.3g}",
        )
    results_console().print(table)
