"""`surface`: what a good one becomes, in SI, and how each mistake in one is told."""

import json
import math

import jsonschema
import pytest
from ruamel.yaml import YAML
from tests.mechanics.surfaces.given import Root, read

from firmtouch.errors import ModelFileError
from firmtouch.modelfile.fields import values_of
from firmtouch.modelfile.sections import surface as kinds

MARK = "»"
VALIDATOR = jsonschema.Draft202012Validator(Root.model_json_schema())
HEAD = "parameters: {r: 20 cm, alpha: 0.3, m: 2 kg, k: 3 1/m}\ncoordinates: {q1: rad}\n"
FLAT = [[0] * 4] * 4


def with_surface(line):
    return f"{HEAD}surface:\n  {line}\n"


def made(line):
    """Read a surface, which the JSON Schema must accept too."""
    text = with_surface(line)
    VALIDATOR.validate(YAML(typ="safe", pure=True).load(text))
    return read(text)


def told(line):
    """Give the lines in which mistakes are told, as `line:column: words`."""
    with pytest.raises(ModelFileError) as caught:
        read(with_surface(line).replace(MARK, ""))
    return [each.removeprefix("surface.yaml:") for each in str(caught.value).splitlines()]


def field(**entries):
    return "height_field: " + json.dumps({"x": [0, 1], "y": [0, 1], "heights": FLAT} | entries)


KINDS = {
    "plane": ("plane: {point: [0.5 m, 0, 30 cm], normal: [0, 0, 2]}", kinds.Plane),
    "sphere": ("sphere: {centre: [0, 0, 0], radius: 200 mm, side: inside}", kinds.Sphere),
    "cylinder": ("cylinder: {point: [0, 0, 0], axis: [0, 1, 1], radius: r}", kinds.Cylinder),
    "cone": ("cone: {apex: [0, 0, 0], axis: [0, 0, -1], half_angle: 30 deg}", kinds.Cone),
    "torus": ("torus: {centre: [0, 0, 0], axis: [0, 0, 1], ring_radius: 0.5, tube_radius: r}", kinds.Torus),
    "ellipsoid": ("ellipsoid: {centre: [0, 0, 0], semi_axes: [r, 2*r, 0.3 m], orientation: [{z: 30 deg}, {y: alpha}]}", kinds.Ellipsoid),
    "superellipsoid": ("superellipsoid: {centre: [0, 0, 0], semi_axes: [1, 1, 1], exponents: [8, 2.5]}", kinds.Superellipsoid),
    "implicit": ('implicit: {expression: "x**2 + y**2 - z + r", position: [0, 0, r]}', kinds.Implicit),
    "height_field": (field(x=["-10 cm", "r"], heights=[["1 mm", 0.002, 0, 0]] * 5), kinds.HeightField),
}  # fmt: skip


def test_every_kind_is_tested():
    assert list(KINDS) == list(kinds.SurfaceSpec.model_fields)


@pytest.mark.parametrize("kind", KINDS)
def test_a_surface_is_of_one_kind(kind):
    line, section = KINDS[kind]
    spec = made(line)
    assert spec.kind == kind
    assert type(spec.shape) is section


def test_quantities_become_numbers_in_si_and_keep_their_text():
    plane = made(KINDS["plane"][0]).shape
    assert (values_of(plane.point), plane.point.text, plane.point.size) == ((0.5, 0, 0.3), "[0.5 m, 0, 30 cm]", 3)
    assert values_of(plane.normal) == (0, 0, 2)
    assert values_of(made(KINDS["cone"][0]).shape.half_angle) == (math.radians(30),)
    assert values_of(made("sphere: {centre: [-1e-3 m, -.5, +2 km], radius: 2 in}").shape.centre) == (-0.001, -0.5, 2000)
    assert values_of(made("sphere: {centre: [0, 0, 0], radius: 0.1*pi}").shape.radius) == (0.1 * math.pi,)
    ellipsoid = made(KINDS["ellipsoid"][0]).shape
    assert [(axis, values_of(angle)) for axis, angle in ellipsoid.orientation] == [
        ("z", (math.radians(30),)),
        ("y", None),
    ]
    field_ = made(KINDS["height_field"][0]).shape
    assert (len(field_.heights), field_.heights[4]) == (5, (0.001, 0.002, 0, 0))
    assert (field_.x.text, values_of(field_.x)) == ("[-10 cm, r]", None)
    assert made(KINDS["superellipsoid"][0]).shape.exponents == (8, 2.5)


def test_parameters_stay_names():
    sphere = made("sphere: {centre: '[0, r/2, 1 - r]', radius: 2*r}").shape
    assert (sphere.centre.names, sphere.radius.names) == ({"r"}, {"r"})
    assert made(KINDS["implicit"][0]).shape.expression.names == {"x", "y", "z", "r"}


def test_the_usual_side_is_outside():
    assert made("sphere: {centre: [0, 0, 0], radius: 1}").shape.side == "outside"
    assert made(KINDS["sphere"][0]).shape.side == "inside"


SPHERE = "sphere: {{centre: [0, 0, 0], radius: {}}}"
BALL = "sphere: {{centre: {}, radius: 1}}"
MISTAKES = {
    "unknown kind": (f"{MARK}spere: {{centre: [0, 0, 0], radius: 1}}", "unknown key `spere`; there are: plane, sphere, cylinder"),
    "did you mean": (f"{MARK}elipsoid: {{}}", "did you mean `ellipsoid`?"),
    "two kinds": (f"{{plane: {{point: [0, 0, 0], normal: [0, 0, 1]}}, {MARK}sphere: {{centre: [0, 0, 0], radius: 1}}}}", "`plane` and `sphere` at once"),
    "missing": (f"{MARK}sphere: {{centre: [0, 0, 0]}}", "`radius` is missing here"),
    "unknown key": (f"sphere: {{centre: [0, 0, 0], {MARK}diameter: 1, radius: 1}}", "unknown key `diameter`; there are: centre, radius, side"),
    "unit": (SPHERE.format(f"{MARK}1 kg"), "`1 kg` is in kg, but m was expected"),
    "unit of a parameter": (SPHERE.format(f"{MARK}2*m"), "this is in kg, but m was expected"),
    "no unit": (SPHERE.format(f"1 {MARK}metro"), "`metro` is no unit; did you mean `metre`?"),
    "negative": (SPHERE.format(f"{MARK}-2 m"), "`-2 m` is out of range; it must be positive"),
    "zero": (SPHERE.format(f"{MARK}0"), "it must be positive"),
    "zero by calculation": (SPHERE.format(f"{MARK}1 - 1"), "it must be positive"),
    "no number": (SPHERE.format(f"{MARK}log(0)"), "a constant that is no finite number"),
    "too large": (SPHERE.format(f"{MARK}1e300 km"), "no finite number of a usable size"),
    "moving": (SPHERE.format(f"{MARK}q1"), "`q1` cannot be used here: this is a constant, made of parameters alone"),
    "undeclared": (SPHERE.format(f"1 + {MARK}s"), "`s` is not declared"),
    "a quantity in a sum": (SPHERE.format(f"0.1 m {MARK}+ r"), "a quantity with a unit stands alone here"),
    "a list": (SPHERE.format(f"{MARK}[1, 2]"), "a vector of 2 was given where a scalar was expected"),
    "nothing": (SPHERE.format(f"{MARK}true"), "an expression was expected"),
    "two numbers": (BALL.format(f"{MARK}[0, 1]"), "2 entries where a list of three was expected"),
    "one number": (BALL.format(f"{MARK}1"), "no list where a list of three was expected"),
    "one bad entry": (BALL.format(f"[0, {MARK}1 s, 0]"), "`1 s` is in s, but m was expected"),
    "a short text": (BALL.format(f"{MARK}'[0, 1]'"), "a vector of 2 was given where a vector of 3 was expected"),
    "side": (f"sphere: {{centre: [0, 0, 0], radius: 1, side: {MARK}insid}}", "did you mean `inside`?"),
    "zero normal": (f"plane: {{point: [0, 0, 0], normal: {MARK}[0, 0, 0]}}", "a direction of length zero"),
    "normal in metres": (f"plane: {{point: [0, 0, 0], normal: [0, 0, {MARK}1 m]}}", "`1 m` is in m, but a plain number"),
    "flat cone": (f"cone: {{apex: [0, 0, 0], axis: [0, 0, 1], half_angle: {MARK}90 deg}}", "it must be above 0 and below 1.5708"),
    "sharp cone": (f"cone: {{apex: [0, 0, 0], axis: [0, 0, 1], half_angle: {MARK}0}}", "it must be above 0"),
    "torus": (f"torus: {{centre: [0, 0, 0], axis: [0, 0, 1], ring_radius: 10 cm, tube_radius: {MARK}0.1}}", "a tube of 0.1 m around a ring of 0.1 m cuts itself"),
    "semi-axis": (f"ellipsoid: {{centre: [0, 0, 0], semi_axes: [1, {MARK}-1, 1]}}", "`-1` is out of range; it must be positive"),
    "rotation": (f"ellipsoid: {{centre: [0, 0, 0], semi_axes: [1, 1, 1], orientation: [{MARK}{{w: 1}}]}}", "one axis out of x, y, z"),
    "angle": (f"ellipsoid: {{centre: [0, 0, 0], semi_axes: [1, 1, 1], orientation: [{{z: {MARK}1 m}}]}}", "a plain number or an angle"),
    "no rotations": (f"ellipsoid: {{centre: [0, 0, 0], semi_axes: [1, 1, 1], orientation: {MARK}30 deg}}", "a list of rotations was expected"),
    "low exponent": (f"superellipsoid: {{centre: [0, 0, 0], semi_axes: [1, 1, 1], exponents: [2, {MARK}1.5]}}", "it must be at least 2 and at most 32"),
    "high exponent": (f"superellipsoid: {{centre: [0, 0, 0], semi_axes: [1, 1, 1], exponents: [{MARK}33, 2]}}", "at most 32"),
    "exponent of a parameter": (f"superellipsoid: {{centre: [0, 0, 0], semi_axes: [1, 1, 1], exponents: {MARK}[4, 8*alpha]}}", "parameters cannot stand here"),
    "no coordinate": (f"implicit: {{expression: {MARK}r - 1}}", "a surface in which none of x, y, z stands"),
    "a joint": (f"implicit: {{expression: x - {MARK}q1}}", "`q1` cannot be used here"),
    "a kink": (f"implicit: {{expression: x - {MARK}abs(y)}}", "`abs` has no second derivative everywhere"),
    "a vector": (f'implicit: {{expression: {MARK}"[x, y]"}}', "a vector of 2 was given where a scalar was expected"),
    "ragged": (f"height_field: {{x: [0, 1], y: [0, 1], heights: [[0, 0, 0, 0], {MARK}[0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]}}", "3 heights, and 4 in the first row"),
    "few rows": (f"height_field: {{x: [0, 1], y: [0, 1], heights: {MARK}{FLAT[:3]}}}", "3 rows; 4 to 40 are read"),
    "few columns": (f"height_field: {{x: [0, 1], y: [0, 1], heights: [{MARK}[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]}}", "3 heights in a row; 4 to 40"),
    "many rows": (f"height_field: {{x: [0, 1], y: [0, 1], heights: {MARK}{[[0] * 4] * 41}}}", "41 rows; 4 to 40 are read"),
    "no rows": (f"height_field: {{x: [0, 1], y: [0, 1], heights: {MARK}[1, 2, 3, 4]}}", "a list of lists was expected"),
    "height": (f"height_field: {{x: [0, 1], y: [0, 1], heights: [[0, 0, {MARK}1 s, 0], {FLAT[0]}, {FLAT[0]}, {FLAT[0]}]}}", "`1 s` is in s, but m was expected"),
    "backwards": (f"height_field: {{x: {MARK}[1, 0 m], y: [0, 1], heights: {FLAT}}}", "it starts at 1 m and stops at 0 m"),
    "a span": (f"height_field: {{x: {MARK}[0, 0.5, 1], y: [0, 1], heights: {FLAT}}}", "3 entries where a list of two was expected"),
}  # fmt: skip


@pytest.mark.parametrize("which", MISTAKES)
def test_a_mistake_is_told_at_its_place(which):
    line, words = MISTAKES[which]
    text = with_surface(line)
    at = text.index(MARK)
    place = f"{text.count(chr(10), 0, at) + 1}:{at - text.rfind(chr(10), 0, at)}"
    (only,) = told(line)
    assert only.startswith(f"{place}: "), f"{only} where {place} was expected"
    assert words in only


@pytest.mark.parametrize(
    "text", ["surface:\n", "surface: {}\n", "surface: plane\n", "surface: {plane: }\n", "surface: [1]\n"]
)
def test_no_kind_is_told(text):
    with pytest.raises(
        ModelFileError, match=r"surface.yaml:1:\d+: a (surface of one kind|mapping `name: value`) was expected"
    ):
        read(text)


def test_all_mistakes_are_told_at_once():
    lines = told("torus: {centre: [0, 1], axis: [0, 0, 0], ring_radius: -1, tube_radius: 1 kg}")
    assert len(lines) == 4


def test_a_parameter_must_not_be_called_as_a_coordinate_of_the_surface():
    with pytest.raises(ModelFileError, match="`x` would be a coordinate of the surface here"):
        read("parameters: {x: 1 m}\nsurface: {implicit: {expression: x - y}}\n")
    assert read("parameters: {x: 1 m}\nsurface: {sphere: {centre: [0, 0, 0], radius: x}}\n").kind == "sphere"


@pytest.mark.parametrize(
    "data",
    [
        {},
        {"sphere": {"centre": [0, 0, 0], "radius": 1}, "plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}},
        {"sphere": {"centre": [0, 0], "radius": 1}},
        {"sphere": {"centre": [0, 0, 0], "radius": 1, "side": "left"}},
        {"sphere": {"centre": [0, 0, 0], "diameter": 1}},
        {"height_field": {"x": [0, 1], "y": [0, 1], "heights": [[0] * 3] * 4}},
        {"superellipsoid": {"centre": [0, 0, 0], "semi_axes": [1, 1, 1], "exponents": [2]}},
    ],
)
def test_the_schema_refuses_mistakes_of_structure(data):
    jsonschema.Draft202012Validator.check_schema(VALIDATOR.schema)
    assert not VALIDATOR.is_valid({"surface": data})


def test_the_largest_grid_can_be_read():
    heights = [[round(0.01 * math.sin(i + j * j), 4) for j in range(40)] for i in range(40)]
    spec = read(f"surface: {field(heights=heights)}\n".replace("surface: height_field:", "surface:\n  height_field:"))
    assert len(spec.shape.heights) == 40
