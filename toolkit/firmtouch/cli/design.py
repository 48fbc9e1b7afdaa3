"""`firmtouch design MODEL`."""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

from firmtouch.cli import GOOD, NO
from firmtouch.cli.console import results_console, talk_console, working
from firmtouch.errors import InputError

if TYPE_CHECKING:
    from firmtouch.design import Design


def run(arguments: argparse.Namespace) -> int:
    """Design, write the files, and print the verdict."""
    from firmtouch.modelfile import read_model

    with working(f"reading {arguments.model}") as progress:
        model = read_model(arguments.model)
        if arguments.method is not None:
            model = model.with_method(arguments.method)
        progress("loading the design tools")
        from firmtouch.design import design_model, look_around_design, try_out_design
        from firmtouch.report import verdict, write_files

        design = design_model(model, progress, front=_pair(arguments.front))
        if not arguments.no_simulation:
            progress("simulating")
            design = try_out_design(design)
        if not arguments.no_attraction:
            progress("proving a region of attraction")
            design = look_around_design(design)
        contents = _contents(design, progress, pdf=not arguments.no_pdf)
        folder = Path(arguments.out) if arguments.out is not None else Path("reports") / model.name
        progress("writing")
        paths = write_files(folder, contents)
    if arguments.json:
        sys.stdout.write(contents["design.json"].decode())
        return GOOD if design.certificate.certified else NO
    console = results_console()
    console.print(verdict(design), markup=False, soft_wrap=not console.is_terminal)
    for warning in design.warnings:
        talk = talk_console()
        talk.print(f"warning: {warning}", style="yellow", markup=False, soft_wrap=not talk.is_terminal)
    for path in paths:
        console.print(f"  {path}", markup=False, soft_wrap=True)
    return GOOD if design.certificate.certified else NO


def _pair(front: str | None) -> tuple[str, str] | None:
    if front is None:
        return None
    names = [each.strip() for each in front.split(",")]
    if len(names) != 2:
        raise InputError(f"`--front {front}`: two objectives were expected, as in `--front gains,margin`")
    return names[0], names[1]


def _certificate(design: Design, content: bytes) -> bytes:
    """Write the certificate of a design whose design.json has this content."""
    from firmtouch.certificate.file import ModelPart, certificate_as_json

    part = ModelPart(name=design.model.name, sha256=design.model.sha256, method=design.model.spec.design.method)
    data = certificate_as_json(
        design.certificate,
        model=part,
        design_sha256=hashlib.sha256(content).hexdigest(),
        version=version("firmtouch"),
        finding=None if design.surroundings is None else design.surroundings.finding,
    )
    return (json.dumps(data, indent=1, allow_nan=False) + "\n").encode()


def _contents(design: Design, progress: Callable[[str], None], *, pdf: bool) -> dict[str, bytes]:
    from firmtouch.report import design_as_json, design_document, render_html, render_pdf

    progress("drawing the report")
    document = design_document(design)
    contents = {"design.json": (json.dumps(design_as_json(design), indent=1, allow_nan=False) + "\n").encode()}
    contents["certificate.json"] = _certificate(design, contents["design.json"])
    progress("setting report.html")
    contents["report.html"] = render_html(document).encode()
    if pdf:
        progress("setting report.pdf")
        contents["report.pdf"] = render_pdf(document)
    return contents
