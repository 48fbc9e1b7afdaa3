"""`firmtouch verify CERTIFICATE --model MODEL`."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from firmtouch.cli import GOOD, NO
from firmtouch.cli.console import results_console, working
from firmtouch.errors import InputError


def run(arguments: argparse.Namespace) -> int:
    """Read both files, prove the claims again, and say what differs."""
    from firmtouch.modelfile import read_model

    path = Path(arguments.certificate)
    with working(f"reading {path}") as progress:
        content = _content(path)
        from firmtouch.certificate.file import read_certificate
        from firmtouch.certificate.verify import verify

        file, model = read_certificate(content, str(path)), read_model(arguments.model)
        beside = path.parent / "design.json"
        progress("proving the claims")
        found = verify(file, model, _content(beside) if beside.is_file() else None)
    if arguments.json:
        result = {"certified": found.holds, "proven": list(found.proven), "differences": list(found.differences)}
        sys.stdout.write(json.dumps(result, indent=1) + "\n")
        return GOOD if found.holds else NO
    console = results_console()
    method = {"poles": "assigned poles", "region": "the region"}[file.model.method]
    words = f"{len(found.proven)} claims about gains for {method} are proven once more"
    if found.holds:
        compared = "" if beside.is_file() else "; there is no design.json beside it to compare"
        console.print(f"Certified: {words}, model {model.name}{compared}.", markup=False, soft_wrap=True)
        return GOOD
    console.print(f"Not certified: {words}, and this differs:", markup=False, soft_wrap=True)
    for each in found.differences:
        console.print(f"  {each}", markup=False, soft_wrap=True)
    return NO


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
