"""docs/thermal.md and README.md: their files are read, their Python runs, and every key and figure of them is right."""

import contextlib
import io
import json
import re
from pathlib import Path

import numpy as np
import pytest

from firmtouch.modelfile.fields import read_quantity
from firmtouch.report.thermal_json import study_as_json
from firmtouch.thermal import (
    Adiabatic,
    Base,
    ContactEvent,
    HalfSpace,
    Layer,
    Roughness,
    Stack,
    Touch,
    contact_conductance,
    object_crosstalk,
    required_conductance,
    rise_time,
)
from firmtouch.thermal.sensorfile import (
    catalogue_schema,
    drive,
    parse_sensor,
    requirements,
    search,
    sensor_schema,
    stack,
    touch,
)
from firmtouch.thermal.sensorfile.specification import SensorSpec
from firmtouch.thermal.study import study_sensor
from firmtouch.thermal.tables import parse_catalogue, read_catalogue, rows

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "thermal.md").read_text(encoding="utf-8")
README = (ROOT / "README.md").read_text(encoding="utf-8")
MODELS = ROOT / "models" / "thermal"


def blocks(text, language, containing):
    """Give the blocks of code of a language that contain something."""
    found = re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)
    return [each for each in found if containing in each]


def table(heading):
    """Give the rows of the table whose first heading this is, each as a mapping from headings to cells."""
    begin = re.search(rf"^\| {re.escape(heading)} \|.*\n\| ---", PAGE, re.MULTILINE).start()
    titles, _, *lines = [
        [cell.strip() for cell in line.split("|")[1:-1]] for line in PAGE[begin:].split("\n\n")[0].splitlines()
    ]
    return [dict(zip(titles, line, strict=True)) for line in lines]


def named(heading):
    """Give what stands in the first column of the table whose first heading this is."""
    return {word for row in table(heading) for word in re.findall(r"`(\w+)`", row[heading])}


def parse_quantity(text):
    """Read `0.25 GPa` or `30 %`, as a file has it."""
    return read_quantity(text if " " in text else float(text), example="").value


def alone(heading, column):
    """Give what a column of a table says of each key, of those that stand alone in their row."""
    rows_of_one = (row for row in table(heading) if column in row and row[heading].count("`") == 2)
    return {row[heading].strip("`"): row[column] for row in rows_of_one}


def keys_of(section):
    return {field.alias or name for name, field in section.model_fields.items()}


TABLES = {
    "section": SensorSpec,
    "entry of `stack`": stack.StackEntry,
    "`film`": stack.FilmSpec,
    "`backing`": stack.BackingSpec,
    "`contact`": touch.ContactSpec,
    "one of `objects`": touch.ObjectSpec,
    "`temperatures`": touch.TemperaturesSpec,
    "`drive`": drive.DriveSpec,
    "`pad`": drive.PadSpec,
    "`electronics`": drive.ElectronicsSpec,
    "`requirements`": requirements.RequirementsSpec,
    "`rise_time`": requirements.RiseTimeSpec,
    "`discrimination`": requirements.DiscriminationSpec,
    "`range`": requirements.RangeSpec,
    "`crosstalk`": requirements.CrosstalkSpec,
    "`power`": requirements.PowerSpec,
    "`search`": search.SearchSpec,
    "every row": rows.RowSpec,
    "`dissipation` and `time_constant`": rows.Held,
}
ROWS = {
    "one of `materials`": rows.MaterialRow,
    "one of `contacts`": rows.ContactRow,
    "one of `parts`": rows.PartRow,
}


@pytest.mark.parametrize("heading", TABLES)
def test_a_table_names_every_key_of_its_section_and_no_other(heading):
    assert named(heading) == keys_of(TABLES[heading])


@pytest.mark.parametrize("heading", ROWS)
def test_a_table_names_every_key_of_its_rows(heading):
    assert named(heading) == keys_of(ROWS[heading]) - keys_of(rows.RowSpec)


@pytest.mark.parametrize("heading", {**TABLES, **ROWS})
def test_units_of_the_tables_are_those_of_the_schema(heading):
    schema = {**TABLES, **ROWS}[heading].model_json_schema()
    own = schema.get("properties") or next(each["properties"] for each in schema["anyOf"] if "properties" in each)
    for name, told in alone(heading, "unit").items():
        units = re.findall(r'"description": "in ([^",]+)', json.dumps(own[name]))
        assert not units or told == units[0], name


@pytest.mark.parametrize("heading", {**TABLES, **ROWS})
def test_defaults_of_the_tables_are_those_of_the_file(heading):
    fields = {**TABLES, **ROWS}[heading].model_fields
    told = alone(heading, "default")
    for name, cell in told.items():
        default = fields[name].default
        if isinstance(default, bool):
            assert cell == f"`{str(default).lower()}`"
        elif isinstance(default, (int, float)):
            assert parse_quantity(cell) == default, name


def test_modes_of_the_drive_need_and_may_have_what_the_table_says():
    cells = [[set(re.findall(r"`(\w+)`", cell)) for cell in row.values()] for row in table("mode")]
    told = {mode: needs | may for (mode,), _, needs, may in cells}
    assert told == {mode: {*needed, *usable} for mode, (needed, usable) in drive.USES.items()}


def properties(schema):
    """Walk a JSON Schema -> the names of all properties."""
    if isinstance(schema, list):
        return set().union(*map(properties, schema))
    if not isinstance(schema, dict):
        return set()
    own = schema.get("properties", {})
    return {*own}.union(
        *map(properties, own.values()), *(properties(v) for k, v in schema.items() if k != "properties")
    )


@pytest.mark.parametrize("schema", [sensor_schema(), catalogue_schema()], ids=["sensor", "catalogue"])
def test_the_page_names_every_property_of_the_schemas(schema):
    names = properties(schema)
    assert {"loop_gain", "steinhart_hart", "k", "B_between", "evaluations"} & names  # the walk goes deep
    assert {name for name in names if f"`{name}`" not in PAGE} == set()


def keys(value):
    """Give all keys of JSON, at any depth."""
    if isinstance(value, list):
        return set().union(*map(keys, value))
    return {*value}.union(*map(keys, value.values())) if isinstance(value, dict) else set()


def few(text, count=10):
    """Let a file's search try few designs."""
    return re.sub(r"(?m)^  (objective: .*)$", rf"  \1\n  evaluations: {count}", text)


@pytest.fixture(scope="module")
def film():
    """Analyse the film sensor as it is."""
    text = (MODELS / "fingertip_film.yaml").read_text(encoding="utf-8").split("\nsearch:")[0]
    return study_sensor(parse_sensor(text.encode(), name="film"))


@pytest.fixture(scope="module")
def scopes():
    """Run the page's Python as a reader would, from the repository's root; give what it defined and printed."""
    printed = io.StringIO()
    with contextlib.chdir(ROOT), contextlib.redirect_stdout(printed):
        found = [{}, {}]
        for text, scope in zip(blocks(PAGE, "python", "firmtouch"), found, strict=True):
            exec(text, scope)  # the page's own
    return *found, printed.getvalue()


@pytest.fixture(scope="module")
def written(film, scopes):
    """Give thermal.json of studies that have everything between them: a front, what binds, a range, each drive."""
    text = (MODELS / "fingertip_chip.yaml").read_text(encoding="utf-8")
    quick = text.replace("at_most: 10 ms", "at_most: 0.5 s").replace(
        "objects: [softwood, pmma, glass, steel_304, copper]", "objects: [copper]"
    )
    sought = few(quick) + "  front: [rise_time, thickness]\n"
    core = (MODELS / "biotac_like.yaml").read_text(encoding="utf-8")
    drives = (
        "pulse, flux: 10 kW/m^2",
        "two_temperature, second: 30 degC",
        "constant_temperature, loop_gain: 1e3 W/m^2/K",
    )
    texts = [sought, *(f"{core}drive: {{mode: {each}}}\n" for each in drives)]
    studies = [film, *(study_sensor(parse_sensor(each.encode(), name="core")) for each in texts)]
    return [scopes[0]["written"], *map(study_as_json, studies)]


def test_the_page_names_every_key_of_thermal_json(written):
    assert [each["verdict"] for each in written[:3]] == ["infeasible", "met", "met"]
    assert written[2]["search"]["front"]["designs"]
    names = set().union(*map(keys, written))
    assert {"figures", "johnson", "runaway_power", "needed", "spread", "duration", "second", "dead_time"} <= names
    assert {name for name in names if f"`{name}`" not in PAGE} == set()


@pytest.mark.parametrize("heading", ["key", "`sensor`", "one of `responses`", "in `search`"])
def test_a_table_of_thermal_json_names_no_key_that_is_not_there(written, heading):
    assert named(heading) <= set().union(*map(keys, written))


def test_the_sensor_file_of_the_page_is_read_as_it_stands():
    (text,) = blocks(PAGE, "yaml", "firmtouch.sensor/1")
    spec = parse_sensor(text.encode(), name="page").spec
    assert spec.contact.conductances == (5e3, 1e4, 2e4)
    assert spec.temperatures.prior == 0.5
    assert (spec.search.front, spec.search.evaluations) == (("rise_time", "power"), 500)
    assert spec.electronics.noise_density == pytest.approx(5e-9)


def test_the_rows_of_the_page_are_read_and_their_bead_has_a_capacity():
    (text,) = blocks(PAGE, "yaml", "firmtouch.catalogue/1")
    found = parse_catalogue(text.encode(), read_catalogue(), file="page.yaml")
    assert found.materials["our_gel"].effusivity == pytest.approx((0.21 * 1030 * 1900) ** 0.5)
    bead = found.parts["our_bead"].capacity
    assert (bead.basis, bead.value) == ("delta tau", pytest.approx(0.14e-3 * 0.5))
    assert bead.ways["mass"] == pytest.approx(0.07e-6 * 750)
    assert not bead.warning


def test_the_python_of_the_page_runs_and_gives_what_its_comments_say(scopes):
    of_file, of_layers, printed = scopes
    assert of_file["study"].verdict == "infeasible"
    assert json.loads(json.dumps(of_file["written"]))["schema"] == "firmtouch.thermal/1"
    assert of_file["table"].startswith("t [s],softwood low [K]")
    assert printed.startswith("infeasible film capacity ['film capacity', 'backing', 'depth diffusion']")
    assert f"{1e3 * of_layers['slow'].seconds:.2f} ms" in PAGE
    assert f"# {1e3 * of_layers['quick'].seconds:.2f} ms" in PAGE
    assert of_layers["held"].seconds < of_layers["slow"].seconds / 10
    assert of_layers["reduced"].relative_error < 1e-4


@pytest.fixture(scope="module")
def of():
    return read_catalogue().materials


def test_figures_of_the_page_that_the_notebook_does_not_have(of):
    crosstalk = object_crosstalk(of["copper"], 0.5e-3, 2e-3, np.array([0.01, 0.1, 1.0]))
    assert "{:.1f} % after 10 ms, {:.1f} % after 0.1 s and {:.0f} % after 1 s".format(*(100 * crosstalk)) in PAGE
    found = contact_conductance(
        50e3, Roughness(1e-6, 0.15, 0.25e9), of["kapton"].conductivity, of["aluminium"].conductivity
    )
    assert f"{found.spots:.0f} + {found.gas:.0f} W/m^2/K" in PAGE
    C = 25e-6 * of["kapton"].volumetric_capacity
    assert (round(C, 1), round(required_conductance(C, 10e-3), -2)) == (38.7, 8500)


def rise(stack, h=float("inf"), window=1e3):
    return rise_time(ContactEvent(stack, Touch(Base(), h), 1.0).temperature, window).seconds


@pytest.mark.parametrize(("name", "deep", "thick"), [("kapton", 5.0, 29.3), ("pdms", 6.0, 35.5)])
def test_ten_milliseconds_allow_the_thicknesses_that_the_page_tells(of, name, deep, thick):
    material = of[name]
    half_space = Stack((Layer(material, deep * 1e-6),), sensed=1, backing=HalfSpace(material))
    insulated = Stack((Layer(material, thick * 1e-6),), sensed=1, backing=Adiabatic())
    # Rise times go with the square of a thickness, and these have two or three digits.
    assert rise(half_space) == pytest.approx(10e-3, rel=0.02)
    assert rise(insulated, window=10.0) == pytest.approx(10e-3, rel=0.005)


def test_a_layer_needs_three_times_the_contact_of_its_lump(of):
    layer = Stack((Layer(of["kapton"], 25e-6),), sensed=1, backing=Adiabatic())
    assert rise(layer, 27e3, window=10.0) == pytest.approx(10e-3, rel=1e-3)  # 27 083 is told as 27 000


def test_the_readme_s_sensor_meets_what_it_asks_and_all_four_sensors_are_listed():
    (text,) = blocks(README, "yaml", "firmtouch.sensor/1")
    study = study_sensor(parse_sensor(text.encode(), name="readme"))
    assert study.verdict == "met"
    names = {each.stem for each in MODELS.glob("*.yaml")}
    assert len(names) == 4
    for page in (README, PAGE):
        assert {name for name in names if f"`{name}`" not in page} == set()


def test_the_loop_of_the_film_is_as_fast_as_the_page_says(film):
    found = film.analysis.responses
    modes = "constant_power", "constant_temperature"
    slow, quick = ([1e3 * each.rise_10_90 for each in found if each.drive == mode] for mode in modes)
    told = " ".join(PAGE.split())
    assert f"takes {min(slow):.0f} to {max(slow):.0f} ms, fastest on copper, slowest on foam" in told
    assert f"the power of the loop {min(quick):.2f} to {max(quick):.2f} ms" in told
