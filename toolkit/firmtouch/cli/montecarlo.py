"""`firmtouch montecarlo MODEL_OR_DESIGN`."""

from __future__ import annotations

import argparse
import hashlib
import json
import shlex
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from firmtouch.cli import GOOD, NO
from firmtouch.cli.console import talk_console, working
from firmtouch.cli.processes import processes
from firmtouch.cli.target import load_target
from firmtouch.errors import InputError

if TYPE_CHECKING:
    from firmtouch.modelfile import ModelFile
    from firmtouch.montecarlo import Label, Record, Study
    from firmtouch.montecarlo.proven import Region
    from firmtouch.montecarlo.sets import Sets
    from firmtouch.regulation import ClosedLoop
    from firmtouch.simulation.scenario import Scenario

MOST_RUNS: Final = 1_000_000
LEAST_INSIDE: Final = 50
"""How many runs start inside what is proven: this many, or a tenth of the others."""
SIGN_OF_LIFE: Final = 30.0
"""Seconds between two lines about progress, where there is no terminal to draw a bar on."""


def run(arguments: argparse.Namespace) -> int:
    """Run what is not there yet, write the answer, and print it."""
    _expect_sensible(arguments)
    with working(f"reading {arguments.target}") as progress:
        model, study = _study(arguments, progress)
        from firmtouch.montecarlo.question import question_of

        question = question_of(study, model)
    folder = Path(arguments.out) if arguments.out is not None else Path("reports") / model.name / "montecarlo"
    if arguments.once_more is not None:
        from firmtouch.cli.montecarlo_again import run_again

        return run_again(arguments, study, question, folder)
    records, seconds = _records(arguments, study, question, folder)

    from firmtouch.montecarlo import summarise
    from firmtouch.montecarlo.answer import answer_as_json
    from firmtouch.report.write import write_files

    summary = summarise(records)
    answer = answer_as_json(study, question, summary, at_least=arguments.at_least)
    content = (json.dumps(answer, indent=1, allow_nan=False) + "\n").encode()
    paths = write_files(folder, {"montecarlo.json": content})
    if arguments.json:
        sys.stdout.write(content.decode())
    else:
        from firmtouch.cli.montecarlo_words import print_answer

        print_answer(study, summary, seconds=seconds, again=_again(arguments), at_least=arguments.at_least)
        _print_paths(folder, paths)
    missed = arguments.at_least is not None and summary.interval[0] < arguments.at_least
    return NO if summary.contradictions or missed else GOOD


def _expect_sensible(arguments: argparse.Namespace) -> None:
    for name, least, most in (("runs", 1, MOST_RUNS), ("seed", 0, 2**63), ("jobs", 1, 1024)):
        value = getattr(arguments, name)
        if value is not None and not least <= value <= most:
            raise InputError(f"`--{name} {value}`: a number from {least} to {most} was expected")
    if arguments.at_least is not None and not 0 <= arguments.at_least <= 1:
        raise InputError(f"`--at-least {arguments.at_least:g}`: a part from 0 to 1 was expected, as in 0.99")
    if arguments.name is not None and arguments.scenario is None:
        raise InputError("`--name` chooses among the scenarios of a file; give that by `--scenario FILE`")


def _study(arguments: argparse.Namespace, progress: Callable[[str], None]) -> tuple[ModelFile, Study]:
    model, loop = load_target(arguments.target, progress)
    from firmtouch.montecarlo import build_study

    base, sets = _base(arguments, model, loop)
    regions = _regions(arguments, loop, progress)
    progress("deriving the closed loop")
    return model, build_study(loop, base, sets, seed=arguments.seed, regions=regions, runs=arguments.runs)


def _base(arguments: argparse.Namespace, model: ModelFile, loop: ClosedLoop) -> tuple[Scenario, Sets]:
    """Give the scenario to draw around, and how far."""
    from firmtouch.modelfile.scenarios import read_scenarios
    from firmtouch.montecarlo import sets_of
    from firmtouch.montecarlo.study import nominal_scenario
    from firmtouch.simulation.from_file import scenarios_of

    op = loop.operating_point
    if arguments.scenario is None:
        base = nominal_scenario(loop)
        return base, sets_of(op, base)
    file = read_scenarios(arguments.scenario, model)
    scenarios = {each.name: each for each in scenarios_of(file, loop)}
    if arguments.name is None and len(scenarios) > 1:
        names = ", ".join(scenarios)
        raise InputError(f"{arguments.scenario} holds {len(scenarios)} scenarios; choose by `--name`: {names}")
    name = next(iter(scenarios)) if arguments.name is None else arguments.name
    if name not in scenarios:
        raise InputError(f"{arguments.scenario} holds no scenario {name!r}; there are: {', '.join(scenarios)}")
    return scenarios[name], sets_of(op, scenarios[name], file)


def _regions(arguments: argparse.Namespace, loop: ClosedLoop, progress: Callable[[str], None]) -> tuple[Region, ...]:
    """Take the proven regions from a design's certificate, or prove some if that is asked for."""
    path = Path(arguments.target)
    if path.is_dir() or path.suffix == ".json":
        found = _certified(path / "design.json" if path.is_dir() else path, loop)
        if found:
            return found
    if not arguments.prove:
        return ()
    progress("proving a region of attraction")
    from firmtouch.certificate.attraction.finding import look_around
    from firmtouch.montecarlo.proven import regions_of_finding

    return regions_of_finding(look_around(loop), loop)


def _certified(design: Path, loop: ClosedLoop) -> tuple[Region, ...]:
    """Read the regions of the certificate beside a design, if there is one."""
    from firmtouch.certificate.file import read_certificate
    from firmtouch.montecarlo.proven import regions_of_file

    path = design.parent / "certificate.json"
    if not path.is_file():
        return ()
    file = read_certificate(path.read_bytes(), str(path))
    if not file.sealed():
        raise InputError(f"{path}: its digest does not fit; it was changed, and nothing is believed of it")
    if file.design_sha256 != hashlib.sha256(design.read_bytes()).hexdigest():
        raise InputError(f"{path} belongs to another {design.name} than that beside it; design once more")
    return regions_of_file(file.surroundings, loop)


def _labels(arguments: argparse.Namespace, study: Study) -> list[Label]:
    from firmtouch.montecarlo import Label

    inside = max(LEAST_INSIDE, arguments.runs // 10) if study.regions else 0
    outside = [Label(False, i) for i in range(1, arguments.runs + 1)]
    return outside + [Label(True, i) for i in range(1, inside + 1)]


def _records(
    arguments: argparse.Namespace, study: Study, question: Mapping[str, Any], folder: Path
) -> tuple[list[Record], float]:
    """Run what the folder does not hold yet; gives all records that are asked for, and the seconds that it took."""
    from firmtouch.montecarlo import run_all
    from firmtouch.montecarlo.journal import Journal, read_runs

    known = {} if arguments.fresh else read_runs(folder, question)
    labels = _labels(arguments, study)
    todo = [each for each in labels if each not in known]
    begin = time.monotonic()
    with (
        Journal(folder, question, fresh=arguments.fresh) as journal,
        _bar(len(labels), len(labels) - len(todo)) as step,
    ):
        try:
            for batch in run_all(study, todo, jobs=processes(arguments.jobs)):
                journal.append(batch)
                known |= {each.label: each for each in batch}
                step(len(batch))
        except KeyboardInterrupt:
            sys.stderr.write(f"{len(known)} runs are kept in {folder}; the same command goes on from there\n")
            raise
    return [known[each] for each in labels], time.monotonic() - begin


@contextmanager
def _bar(total: int, done: int) -> Iterator[Callable[[int], None]]:
    """Show progress: a bar on a terminal, elsewhere a line now and then."""
    console = talk_console()
    if console.is_terminal:
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        columns = (TextColumn("simulating"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
        with Progress(*columns, console=console, transient=True) as progress:
            task = progress.add_task("", total=total, completed=done)
            yield lambda count: progress.advance(task, count)
        return
    told, last = done, time.monotonic()

    def step(count: int) -> None:
        nonlocal told, last
        told += count
        if time.monotonic() - last >= SIGN_OF_LIFE:
            last = time.monotonic()
            sys.stderr.write(f"{told} of {total} runs\n")

    yield step


def _again(arguments: argparse.Namespace) -> str:
    """Give the command that runs one of these once more, but for the number."""
    words = ["firmtouch", "montecarlo", arguments.target]
    for name in ("scenario", "name", "out"):
        if getattr(arguments, name) is not None:
            words += [f"--{name}", getattr(arguments, name)]
    if arguments.seed != 1:
        words += ["--seed", str(arguments.seed)]
    return shlex.join([*words, *(["--prove"] if arguments.prove else []), "--run"])


def _print_paths(folder: Path, paths: Sequence[Path]) -> None:
    from firmtouch.cli.console import results_console

    for path in (folder / "runs.jsonl", *paths):
        results_console().print(f"  {path}", markup=False, soft_wrap=True)
