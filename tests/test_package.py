"""The package from outside: its public names, their words, and what an import costs."""

import importlib
import inspect
import json
import subprocess
import sys
from pathlib import Path

import pytest

import firmtouch

ROOT = Path(__file__).parents[1]
PARTS = (
    "mechanics",
    "regulation",
    "regulation.force_loop",
    "synthesis",
    "checks",
    "modelfile",
    "oracle",
    "report",
    "simulation",
    "thermal",
    "thermal.analysis",
    "thermal.search",
    "thermal.sensorfile",
    "thermal.tables",
)
HEAVY = (
    "casadi",
    "sympy",
    "cvxpy",
    "control",
    "scipy",
    "matplotlib",
    "pydantic",
    "numpy",
    "typst",
    "pint",
    "rich",
    "mujoco",
)


def imported_by(code: str) -> set[str]:
    """Run a piece of code alone, and list the top-level modules that are then imported."""
    told = "\nimport json, sys\nsys.stderr.write(json.dumps(sorted({name.partition('.')[0] for name in sys.modules})))"
    run = subprocess.run([sys.executable, "-c", code + told], check=True, capture_output=True, text=True, cwd=ROOT)
    return set(json.loads(run.stderr))


@pytest.mark.parametrize("name", firmtouch.__all__)
def test_every_public_name_can_be_imported_and_is_documented(name):
    value = getattr(firmtouch, name)
    assert value.__name__ == name
    assert value.__module__.startswith("firmtouch.")
    assert (inspect.getdoc(value) or "").strip()


def test_public_names_are_sorted_listed_once_and_shown_by_dir():
    assert list(firmtouch.__all__) == sorted(set(firmtouch.__all__))
    assert set(dir(firmtouch)) >= set(firmtouch.__all__)


def test_a_name_that_does_not_exist_is_an_attribute_error():
    with pytest.raises(AttributeError, match="has no attribute 'desing_model'"):
        _ = firmtouch.desing_model


@pytest.mark.parametrize("part", PARTS)
def test_every_public_name_of_a_part_exists_and_is_documented(part):
    module = importlib.import_module(f"firmtouch.{part}")
    assert (module.__doc__ or "").strip()
    assert list(module.__all__) == sorted(set(module.__all__))
    for name in module.__all__:
        value = getattr(module, name)
        if inspect.isclass(value) or inspect.isfunction(value):
            assert (value.__doc__ or "").strip(), f"firmtouch.{part}.{name}"


@pytest.mark.parametrize("part", PARTS)
def test_methods_and_properties_of_public_classes_are_documented(part):
    module = importlib.import_module(f"firmtouch.{part}")
    classes = [value for name in module.__all__ if inspect.isclass(value := getattr(module, name))]
    silent = [
        f"{each.__name__}.{name}"
        for each in classes
        for name, member in vars(each).items()
        if not name.startswith("_")
        and isinstance(member, property | classmethod | staticmethod | type(imported_by))
        and each.__module__.startswith("firmtouch")
        and not (inspect.getdoc(member) or "").strip()
    ]
    assert silent == []


@pytest.mark.parametrize("path", sorted((ROOT / "toolkit").rglob("*.py")), ids=lambda path: path.stem)
def test_every_module_says_what_it_holds_and_is_not_too_long(path):
    text = path.read_text(encoding="utf-8")
    assert text.lstrip().startswith('"""')
    assert len(text.splitlines()) <= 400


def test_importing_the_package_loads_nothing_heavy():
    assert imported_by("import firmtouch").isdisjoint(HEAVY)


@pytest.mark.parametrize("arguments", [["--help"], ["design", "--help"], ["--version"]], ids=" ".join)
def test_asking_for_help_loads_nothing_heavy(arguments):
    code = f"""
import contextlib, io
from firmtouch.cli import main
with contextlib.suppress(SystemExit), contextlib.redirect_stdout(io.StringIO()):
    main({arguments!r})
"""
    assert imported_by(code).isdisjoint(HEAVY)


def test_a_file_with_mistakes_is_told_without_loading_the_numeric_libraries(tmp_path):
    path = tmp_path / "bad.yaml"
    path.write_text("schema: firmtouch.model/1\nbogus: 1\n", encoding="utf-8")
    code = f"""
import contextlib, io
from firmtouch.cli import main
with contextlib.redirect_stderr(io.StringIO()):
    assert main(["design", {str(path)!r}]) == 2
"""
    assert imported_by(code).isdisjoint({"casadi", "sympy", "cvxpy", "control", "scipy", "matplotlib", "typst"})


def test_the_way_to_the_gains_waits_for_no_symbolic_or_convex_library():
    code = """
import firmtouch
model = firmtouch.read_model("models/planar_2r_wall.yaml")
op = firmtouch.find_operating_point(firmtouch.derive_plant(model.spec))
assert firmtouch.assign_poles(op, model.spec.design).full.holds
"""
    loaded = imported_by(code)
    assert {"casadi", "numpy", "scipy"} <= loaded
    assert loaded.isdisjoint({"sympy", "cvxpy", "control", "matplotlib", "typst", "jinja2", "pandas"})


def test_a_whole_design_needs_neither_control_nor_cvxpy_nor_pyplot():
    code = """
import sys
import firmtouch
from firmtouch.report import design_document, render_html, render_pdf
document = design_document(firmtouch.design_model(firmtouch.read_model("models/pendulum_rod.yaml")))
assert render_html(document) and render_pdf(document)
assert "matplotlib.pyplot" not in sys.modules
"""
    assert imported_by(code).isdisjoint({"control", "cvxpy", "tkinter", "IPython"})


def test_the_version_is_told_and_is_that_of_the_package():
    from importlib.metadata import version

    told = subprocess.run([sys.executable, "-m", "firmtouch", "--version"], check=True, capture_output=True, text=True)
    assert told.stdout == f"firmtouch {version('firmtouch')}\n"


def test_the_package_tells_type_checkers_that_it_is_typed():
    assert (Path(firmtouch.__file__).parent / "py.typed").exists()
