"""Reports of the shipped models, their poles assigned, each designed and rendered once a process and only as far as a test looks."""

import functools
import json
import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from functools import cached_property
from pathlib import Path

import pytest
from ruamel.yaml import YAML

import firmtouch
from firmtouch.report import design_as_json, design_document, render_html, render_pdf
from firmtouch.report.document import Document, Figure

ROOT = Path(__file__).parents[2]


class Report:
    """A design with its renderings, made when they are first asked for."""

    def __init__(self, model: firmtouch.ModelFile, front: tuple[str, str] | None = None) -> None:
        self.model = model
        self.design = firmtouch.design_model(model, front=front)

    @cached_property
    def document(self) -> Document:
        return design_document(self.design)

    @cached_property
    def html(self) -> str:
        return render_html(self.document)

    @cached_property
    def pdf(self) -> bytes:
        return render_pdf(self.document)

    @cached_property
    def json(self) -> dict:
        """What a reader of `design.json` gets: floats and lists, and no number that is not finite."""
        return json.loads(json.dumps(design_as_json(self.design), allow_nan=False))

    @property
    def pictures(self) -> int:
        """How many pictures there must be: mechanism, poles, eigenvalues, and two of a force loop with a path."""
        return 3 if self.model.spec.force_path is None else 5

    @property
    def figures(self) -> list[Figure]:
        return [block for section in self.document.sections for block in section.blocks if isinstance(block, Figure)]


@functools.cache
def shipped(name: str) -> Report:
    return Report(firmtouch.read_model(ROOT / "models" / f"{name}.yaml").with_method("poles"))


@pytest.fixture(scope="session")
def report(model) -> Report:
    return shipped(model.name)


@pytest.fixture(scope="session")
def shipped_report() -> Callable[[str], Report]:
    """Give the report of one shipped model by its name."""
    return shipped


@pytest.fixture(scope="session")
def pendulum_with() -> Callable[..., Report]:
    """Make a report of the pendulum with sections of its file replaced: the model that is designed soonest."""
    text = (ROOT / "models" / "pendulum_rod.yaml").read_text(encoding="utf-8")

    def make(**sections) -> Report:
        data = YAML(typ="safe", pure=True).load(text)
        for key, value in sections.items():
            data[key] = data.get(key, {}) | value if isinstance(value, dict) else value
        return Report(firmtouch.parse_model(json.dumps(data).encode(), name="pendulum"))

    return make


@functools.cache
def _arm_in_region(region: str, normal_blocks: str, front: tuple[str, str] | None) -> Report:
    data = YAML(typ="safe", pure=True).load((ROOT / "models" / "planar_3r_circle.yaml").read_text(encoding="utf-8"))
    data["design"] |= {"method": "region", "region": json.loads(region), "normal_blocks": normal_blocks}
    return Report(firmtouch.parse_model(json.dumps(data).encode(), name="arm"), front)


@pytest.fixture(scope="session")
def arm_in_region() -> Callable[..., Report]:
    """Make a report of the 3R arm on its pipe, designed by a search within a region; each is made once."""

    def make(region: dict, *, normal_blocks: str = "decouple", front: tuple[str, str] | None = None) -> Report:
        return _arm_in_region(json.dumps(region), normal_blocks, front)

    return make


@pytest.fixture(scope="session")
def program() -> Callable[[str], str]:
    """Find a program that the tests look through; where it is missing they are skipped, but never on a CI machine."""

    def find(name: str) -> str:
        path = shutil.which(name)
        if path is None and os.environ.get("CI"):
            pytest.fail(f"{name} is not installed on this CI machine")
        if path is None:
            pytest.skip(f"{name} is not installed (Debian: chromium, poppler-utils)")
        return path

    return find


@pytest.fixture(scope="session")
def run(program) -> Callable[..., str]:
    """Run a program and give what it prints."""

    def call(name: str, *arguments: str | Path) -> str:
        command = [program(name), *map(str, arguments)]
        return subprocess.run(command, check=True, capture_output=True, text=True, encoding="utf-8").stdout

    return call


QUIET = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


@pytest.fixture(scope="session")
def browser() -> Iterator:
    """Chromium, one for all tests of a process: a second one beside it cannot be started."""
    chromium = shutil.which("chromium")
    if chromium is None and os.environ.get("CI"):
        pytest.fail("chromium is not installed on this CI machine")
    if chromium is None:
        pytest.skip("chromium is not installed; the HTML report was not looked at")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=QUIET)
        yield browser
        browser.close()
