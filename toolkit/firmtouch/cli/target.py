"""MODEL_OR_DESIGN: a model file, whose gains are found first, or a finished design."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from firmtouch.errors import InputError

if TYPE_CHECKING:
    from firmtouch.modelfile import ModelFile
    from firmtouch.regulation import ClosedLoop

DESIGN = "design.json"


def load_target(text: str, progress: Callable[[str], None]) -> tuple[ModelFile, ClosedLoop]:
    """Load a design.json, or a folder that holds one; anything else is a model file, for which gains are found.

    Raises
    ------
    InputError
        If it is neither.
    NoDesignError
        If a model has no gains.
    """
    path = Path(text)
    if path.is_dir():
        path /= DESIGN
        if not path.is_file():
            raise InputError(f"{text}: this folder holds no {DESIGN}; `firmtouch design MODEL --out {text}` writes one")
    if path.suffix == ".json":
        progress(f"reading {path}")
        from firmtouch.report.saved import read_design

        return read_design(path)
    progress(f"reading {path}")
    from firmtouch.modelfile import read_model

    model = read_model(path)
    progress("loading the design tools")
    from firmtouch.design import find_gains

    return model, find_gains(model, progress).loop
