"""Every mistake in a file is told as `file:line:column: what it is, what was expected`, all of them at once."""

import time

import pytest

from firmtouch.errors import ModelFileError
from firmtouch.modelfile import parse_model
from firmtouch.modelfile.diagnostics import MOST_MISTAKES

BASE = """\
schema: firmtouch.model/1
title: An arm
parameters:
  l: 0.5 m
  m: {value: 2 kg, interval: [1 kg, 3 kg], label: a mass}
  I: 0.1 kg*m^2
  g: 9.81 m/s^2
coordinates:
  q1: {unit: rad, label: shoulder}
  q2: rad
definitions:
  elbow: [l*cos(q1), l*sin(q1)]
  tip: elbow + l*[cos(q1 + q2), sin(q1 + q2)]
mechanism:
  gravity: [0, -g]
  bodies:
    upper:
      mass: m
      inertia: I
      centre_of_mass: 0.5*elbow
      orientation: q1
    fore: {mass: m, centre_of_mass: tip}
constraints:
  wall: {expression: 0.6 - x(tip), unit: m}
operating_point:
  guess: {q1: 70 deg, q2: -75 deg}
  lambda_d: {wall: 40 N}
design:
  poles: [-6, -8]
  force_feedback: 0.8
  normal_blocks: decouple
bounds:
  disturbance: 2 N*m
drawing:
  lines:
    arm: [[0, 0], elbow, tip]
  surfaces:
    wall: {through: [[0.6, 0], [0.6, 1]]}
  contacts:
    wall: tip
"""
MARK = "»"


def told(text):
    """Give what is told about a file: lines of `line:column: message`."""
    with pytest.raises(ModelFileError) as caught:
        parse_model(text.encode(), name="arm", file="arm.yaml")
    lines = str(caught.value).splitlines()
    assert all(each.startswith("arm.yaml:") for each in lines)
    return [each.removeprefix("arm.yaml:") for each in lines]


def marked(text):
    """Take the marks out of a text, and give the places where they stood."""
    places = []
    while (at := text.find(MARK)) >= 0:
        places.append(f"{text.count(chr(10), 0, at) + 1}:{at - (text.rfind(chr(10), 0, at) + 1) + 1}")
        text = text[:at] + text[at + 1 :]
    return text, places


def changed(old, new):
    assert BASE.count(old) == 1
    return BASE.replace(old, new)


def test_the_base_of_these_tests_has_no_mistake():
    parse_model(BASE.encode(), name="arm")


# What stands in the file, what it becomes (with a mark where the mistake is), and words of the message.
SINGLE = {
    "unknown key": ("title:", f"{MARK}titel: x\ntitle:", "unknown key `titel`; there are: schema, title, description"),
    "unknown key, suggestion": ("title:", f"{MARK}titel: x\ntitle:", "; did you mean `title`?"),
    "unknown key below": ("      mass: m\n", f"      mass: m\n      {MARK}masss: m\n", "; did you mean `mass`?"),
    "unknown key in a short form": ("label: a mass", f"{MARK}lable: a mass", "did you mean `label`?"),
    "unknown key in the mechanism": ("  gravity:", f"  {MARK}gravty: 1\n  gravity:", "did you mean `gravity`?"),
    "missing key": ("  wall: {expression: 0.6 - x(tip), unit: m}", f"  {MARK}wall: {{unit: m}}", "`expression` is missing here"),
    "unit of another dimension": ("0.6 - x(tip)", f"{MARK}l*x(tip)", "phi is in m^2, but its `unit` is m"),
    "quantity of another dimension": ("q1: 70 deg", f"q1: {MARK}70 mm", "`70 mm` is in m, but a plain number or an angle was expected"),
    "force of another dimension": ("wall: 40 N", f"wall: {MARK}40 N*m", "`40 N*m` is in J, but N was expected"),
    "unit that is none": ("0.5 m", f"0.5 {MARK}metr", "`metr` is no unit; did you mean `metre`?"),
    "unit that is none, further in": ("0.1 kg*m^2", f"0.1 kg*{MARK}mtr^2", "`mtr` is no unit"),
    "temperature": ("0.5 m", f"0.5 {MARK}degC", "`degC` is no multiple of an SI unit"),
    "unit no multiple of SI": ("q2: rad", f"q2: {MARK}deg", "coordinates and constraints count in SI, and `deg` is"),
    "mass in metres": ("      mass: m", f"      mass: {MARK}l", "this is in m, but kg was expected"),
    "sum of dimensions": ("0.6 - x(tip)", f"x(tip) - {MARK}m", "kg is added to m"),
    "undeclared name": ("0.6 - x(tip)", f"0.6 - x({MARK}tp)", "`tp` is not declared; did you mean `tip`?"),
    "undeclared name in a list": ("[l*cos(q1),", f"[l*cos({MARK}q3),", "`q3` is not declared"),
    "declared further down": ("  elbow: [", f"  early: '2*{MARK}tip'\n  elbow: [", "`tip` cannot be used here: a definition"),
    "defined by itself": ("tip: elbow", f"tip: {MARK}tip + elbow", "`tip` cannot be used here"),
    "mass that moves": ("      mass: m", f"      mass: m*{MARK}q1", "`q1` cannot be used here: this is a constant"),
    "key that stands twice": ("  q2: rad", f"  q2: rad\n  {MARK}q1: rad", "`q1` stands here twice; first in line 9"),
    "name of a function": ("  l: 0.5 m", f"  l: 0.5 m\n  {MARK}sin: 1", "`sin` is the name of a function or a constant"),
    "no name": ("  l: 0.5 m", f"  l: 0.5 m\n  {MARK}2l: 1", "`2l` is no name; names are a letter and up to 31 letters"),
    "wrong length of a vector": ("gravity: [0, -g]", f"gravity: {MARK}[0, -g, 0, 0]", "a vector of 4"),
    "wrong number of poles": ("[-6, -8]", f"{MARK}[-6, -8, -9]", "3 poles; 2 coordinates and 1 constraints leave 2(n - m) = 2"),
    "wrong number of gains": ("feedback: 0.8", f"feedback: {MARK}[1, 2]", "2 force-feedback gains for 1 constraint"),
    "not a number": ("0.5 m", f"{MARK}.nan", "`.nan` is no finite number"),
    "infinite number": ("[-6, -8]", f"[-6, {MARK}-.inf]", "`-.inf` is no finite number"),
    "infinite quantity": ("0.5 m", f"{MARK}1e999 m", "`1e999 m` is no finite number of a usable size"),
    "huge quantity": ("0.5 m", f"{MARK}1e16 m", "no finite number of a usable size (at most 1e+15 in SI)"),
    "infinite constant": ("0.6 - x(tip)", f"x(tip) - {MARK}1e999", "`1e999` is beyond the range of a double"),
    "constant that overflows": ("0.6 - x(tip)", f"x(tip) - {MARK}exp(1000)", "a constant that is no finite number"),
    "division by zero": ("0.6 - x(tip)", f"x(tip)/{MARK}0", "a division by zero"),
    "import": ("0.6 - x(tip)", f"__import__({MARK}'os').system('id')", "has no meaning in an expression"),
    "import without quotes": ("0.6 - x(tip)", f"{MARK}__import__(l)", "there is no function `__import__`"),
    "attribute": ("0.6 - x(tip)", f"tip{MARK}.x", "there are no attributes here, a component is written `x(p)`"),
    "lambda": ("0.6 - x(tip)", f"'lambda l{MARK}: l'", "`:` has no meaning"),
    "power sign": ("0.6 - x(tip)", f"x(tip){MARK}^2", "powers are written `**`"),
    "function without derivatives": ("0.6 - x(tip)", f"{MARK}abs(x(tip))", "`abs` has no second derivative everywhere"),
    "unknown function": ("0.6 - x(tip)", f"0.6 - {MARK}xx(tip)", "there is no function `xx`"),
    "velocity in a constraint": ("0.6 - x(tip)", f"l*{MARK}dot(q1)", "velocities are not allowed here"),
    "hundred kilobytes": ("0.6 - x(tip)", MARK + "l+" * 50_000 + "l", "an expression of 100001 characters; at most 4000"),
    "ten thousand brackets": ("0.6 - x(tip)", MARK + "(" * 10_000 + "l" + ")" * 10_000, "an expression of 20001 characters"),
    "a thousand brackets": ("0.6 - x(tip)", "(" * 40 + MARK + "(" * 960 + "l" + ")" * 1000, "nested more than 40 deep"),
    "empty expression": ("0.6 - x(tip)", f"{MARK}''", "an empty expression"),
    "no expression": ("0.6 - x(tip)", f"{MARK}true", "an expression was expected"),
    "mapping as expression": ("0.6 - x(tip)", f"{MARK}{{a: 1}}", "an expression was expected"),
    "a power that grows": ("0.5 m", f"9{MARK}**9**9 m", "`**9**9 m` is no unit"),
    "exponent too large": ("0.6 - x(tip)", f"l - l**{MARK}99/l**98", "an exponent of 99; at most 32"),
    "no coordinate": ("0.6 - x(tip)", f"{MARK}0.6*l", "a constraint in which no coordinate stands"),
    "interval without the value": ("[1 kg, 3 kg]", f"{MARK}[3 kg, 4 kg]", "the interval from 3 to 4 does not hold the value 2"),
    "interval of one": ("[1 kg, 3 kg]", f"{MARK}[1 kg]", "two quantities were expected, as in `[3.5 kg, 5.0 kg]`"),
    "interval of three": ("[1 kg, 3 kg]", f"{MARK}[1 kg, 2 kg, 3 kg]", "two quantities were expected"),
    "interval of another sort": ("[1 kg, 3 kg]", f"{MARK}1 kg", "two quantities were expected"),
    "interval in another unit": ("[1 kg, 3 kg]", f"[1 kg, {MARK}3 m]", "`3 m` is in m, but kg was expected"),
    "interval that is no number": ("[1 kg, 3 kg]", f"[{MARK}a, 3 kg]", "`a` is no quantity"),
    "unstable pole": ("[-6, -8]", f"[-6, {MARK}8]", "the pole `8` is not stable; its real part must be negative"),
    "pole that is none": ("[-6, -8]", f"[-6, {MARK}fast]", "`fast` is no pole; write `-4` or `-4+3j`, in 1/s"),
    "pole too fast": ("[-6, -8]", f"[-6, {MARK}-1e308+1.7e308j]", "no pole of a usable size (at most 1e+06 1/s)"),
    "pole alone": ("[-6, -8]", f"{MARK}[-6+2j, -6+2j]", "the pole -6+2j has no conjugate; complex poles come in pairs"),
    "no poles": ("[-6, -8]", f"{MARK}-6", "a list of poles was expected"),
    "a choice": ("normal_blocks: decouple", f"normal_blocks: {MARK}decuple", "`decuple` is not possible here; expected `decouple`"),
    "a choice, suggestion": ("normal_blocks: decouple", f"normal_blocks: {MARK}decuple", "; did you mean `decouple`?"),
    "a choice that is no text": ("normal_blocks: decouple", f"{MARK}normal_blocks: [a]", "a list is not possible here; expected `decouple`"),
    "weight": ("normal_blocks: decouple", f"normal_blocks: {MARK}{{policy: blend}}", "`weight` belongs to `policy: blend`"),
    "negative gain": ("feedback: 0.8", f"feedback: {MARK}-1", "a force-feedback gain of -1; it must lie between 0 and"),
    "gain with a unit": ("feedback: 0.8", f"feedback: {MARK}1 N", "force-feedback gains have no unit"),
    "negative bound": ("disturbance: 2 N*m", f"disturbance: {{q1: {MARK}-1 N*m, q2: 1 N*m}}", "a bound must not be negative"),
    "tilt out of range": ("disturbance: 2 N*m", f"tilt: {MARK}90 deg", "`90 deg` is out of range; it must be between 0 and 1"),
    "unknown coordinate": ("q2: -75 deg}", f"q2: 1, {MARK}q3: 1}}", "`q3` is no coordinate; there are: q1, q2"),
    "unknown constraint": ("    wall: tip", f"    {MARK}wal: tip", "`wal` is no constraint; there are: wall; did you mean `wall`?"),
    "empty text": ("title: An arm", f"title: {MARK}''", "a text was expected (not empty, at most 2000 characters)"),
    "text that is a number": ("title: An arm", f"title: {MARK}5", "a text was expected"),
    "text with control characters": ("title: An arm", f'title: {MARK}"a\\e[31m"', "characters that cannot be printed"),
    "point in a drawing": ("arm: [[0, 0], elbow,", f"arm: [[0, 0], {MARK}q1,", "a scalar was given where a vector of 2 or a vec"),
    "one point": ("arm: [[0, 0], elbow, tip]", f"arm: {MARK}[tip]", "a list of at least two points was expected"),
    "surface of no form": ("{through: [[0.6, 0], [0.6, 1]]}", f"{MARK}{{radius: l}}", "a surface is given by `through`, or by"),
    "another format": ("firmtouch.model/1", f"{MARK}firmtouch.model/2", "expected `firmtouch.model/1`; did you mean"),
    "tag": ("0.5 m", f"{MARK}!!python/object:os.system x", "a model file is plain data, without tags"),
    "alias": ("0.5 m", f"{MARK}*other", "anchors and aliases are not read here"),
}  # fmt: skip


@pytest.mark.parametrize("mistake", SINGLE)
def test_a_mistake_is_told_alone_at_its_line_and_column(mistake):
    old, new, words = SINGLE[mistake]
    text, (place,) = marked(changed(old, new))
    start = time.process_time()
    (line,) = told(text)
    assert time.process_time() - start < 2.0  # a tenth of a second; hostile ones must not take longer
    assert line.startswith(f"{place}: ")
    assert words in line


@pytest.mark.parametrize("section", ["title", "coordinates", "mechanism", "constraints", "operating_point", "design"])
def test_a_missing_section_is_told_at_the_beginning(section):
    kept, skipping = [], False
    for line in BASE.splitlines():
        skipping = line.startswith(f"{section}:") or (skipping and line.startswith(" "))
        if not skipping:
            kept.append(line)
    assert f"1:1: `{section}` is missing here" in told("\n".join(kept))


def test_an_empty_section_is_no_mapping():
    assert told(BASE.partition("bounds:")[0] + "bounds:\n") == [
        "32:1: a mapping `name: value` was expected, not nothing"
    ]
    text = (
        BASE.partition("constraints:")[0]
        + "constraints: {}\n"
        + "operating_point:"
        + BASE.partition("operating_point:")[2]
    )
    assert "23:14: no entries where at least 1 is needed" in told(text)


def test_a_section_of_another_sort_is_told_as_what_it_is():
    for sort, words in (("[1, 2]", "a list"), ("5", "`5`"), ("", "nothing"), ("some text", "`some text`")):
        text = (
            BASE.partition("mechanism:")[0]
            + f"mechanism: {sort}\n"
            + "constraints:"
            + BASE.partition("constraints:")[2]
        )
        (line,) = [each for each in told(text) if "mapping" in each]
        assert line.endswith(f"a mapping `name: value` was expected, not {words}")
        assert line.startswith("14:")


def test_more_than_a_hundred_coordinates_are_too_many():
    text = changed("  q2: rad", "  q2: rad\n" + "\n".join(f"  p{i}: rad" for i in range(100)))
    assert any("102 entries where at most 100 are read" in line for line in told(text))


def test_as_many_constraints_as_coordinates_leave_nothing_to_move():
    text = changed("unit: m}\noperating", "unit: m}\n  floor: {expression: y(tip), unit: m}\noperating")
    lines = told(text.replace("{wall: 40 N}", "{wall: 40 N, floor: 1 N}").replace("[-6, -8]", "[]"))
    assert any("a list of poles was expected" in line for line in lines)


def test_two_forms_of_one_thing_are_one_too_many():
    assert told(changed("  guess: {", "  q_d: {q1: 1, q2: 1}\n  guess: {")) == [
        "26:3: give either `q_d` or `guess`, not both"
    ]
    assert told(changed("  lambda_d: {wall: 40 N}\n", "")) == ["26:3: give either `lambda_d` or `f_d`"]


def test_a_name_that_is_declared_twice_is_told_at_both_places():
    assert told(changed("definitions:\n", "definitions:\n  l: 2*g\n")) == [
        "4:3: `l` is declared twice, as a parameter and as a definition",
        "12:3: `l` is declared twice, as a parameter and as a definition",
    ]
    first, _ = told(changed("  g: 9", "  q2: 1\n  g: 9"))
    assert first == "7:3: `q2` is declared twice, as a parameter and as a coordinate"


def test_a_missing_entry_is_named():
    assert told(changed("q1: 70 deg, ", "")) == ["26:10: no entry for the coordinate `q1`"]
    assert told(changed("{q1: 70 deg, q2: -75 deg}", "{}")) == ["26:10: no entry for the coordinate `q1`, `q2`"]


def test_a_centre_of_mass_in_the_plane_does_not_go_with_gravity_in_space():
    assert told(changed("gravity: [0, -g]", "gravity: [0, 0, -g]")) == [
        "20:23: a vector of 2, where gravity has 3",
        "22:37: a vector of 2, where gravity has 3",
    ]


def test_a_wrong_declaration_causes_no_second_message():
    assert told(changed("0.5 m", "0.5 metr")) == ["4:10: `metr` is no unit; did you mean `metre`?"]
    assert told(changed("elbow: [l*cos(q1), l*sin(q1)]", "elbow: 'l*cos(q1'")) == [
        "12:18: the expression ends where `)` was expected"
    ]
    assert told(changed("q2: rad", "q2: radd")) == ["10:7: `radd` is no unit; did you mean `rad`?"]
    assert told(changed("expression: 0.6 - x(tip), unit: m}", "expression: 0.6 - x(tip), unit: meh}")) == [
        "24:42: `meh` is no unit"
    ]
    assert told(changed("0.5 m", ".nan")) == ["4:6: `.nan` is no finite number"]
    assert told(changed("[-6, -8]", "[.nan, -8]")) == ["29:11: `.nan` is no finite number"]


SEVERAL = f"""\
schema: firmtouch.model/1
{MARK}titel: An arm
title: An arm
parameters:
  l: 0.5 {MARK}metr
  m: {MARK}.nan
  {MARK}pi: 3
  g: {{value: 9.81 m/s^2, interval: {MARK}[1 m/s^2, 2 m/s^2]}}
coordinates:
  q1: {{unit: {MARK}deg}}
  q2: rad
  {MARK}q2: rad
definitions:
  elbow: [l*cos(q1), l*sin({MARK}q3)]
  tip: elbow + l*[cos(q1 + q2), {MARK}cosh(q1, q2)]
mechanism:
  gravity: [0, -g]
  bodies:
    upper:
      mass: {MARK}g
      centre_of_mass: {MARK}__import__(1)
      {MARK}orientaton: q1
constraints:
  wall: {{expression: 0.6 - x(tip){MARK}.real, unit: m}}
operating_point:
  guess: {{q1: {MARK}70 mm, q2: -75 deg}}
  lambda_d: {{wall: 40 N, {MARK}wal: 3}}
design:
  poles: [-6, {MARK}+8]
  force_feedback: {MARK}strong
  normal_blocks: {MARK}decuple
bounds:
  tilt: {MARK}180 deg
drawing:
  lines:
    arm: [{MARK}5, elbow]
"""


def test_mistakes_of_every_kind_are_told_together_in_the_order_of_the_file():
    text, places = marked(SEVERAL)
    lines = told(text)
    assert [line.split(": ")[0] for line in lines] == places
    words = [
        "unknown key `titel`",
        "`metr` is no unit",
        "`.nan` is no finite number",
        "`pi` is the name of a function or a constant",
        "does not hold the value 9.81",
        "`deg` is a multiple",
        "`q2` stands here twice",
        "`q3` is not declared",
        "`cosh` takes 1 argument, not 2",
        "this is in m/s^2, but kg was expected",
        "there is no function `__import__`",
        "unknown key `orientaton`",
        "there are no attributes here",
        "`70 mm` is in m, but a plain number or an angle was expected",
        "`wal` is no constraint",
        "the pole `8` is not stable",
        "a plain number was expected",
        "`decuple` is not possible here",
        "`180 deg` is out of range",
        "a scalar was given where a vector of 2",
    ]
    assert len(words) == len(lines)
    for expected, line in zip(words, lines, strict=True):
        assert expected in line


STYLES = {
    "plain": f"wall: {{expression: 0.6 - x({MARK}tp), unit: m}}",
    "double-quoted": f'wall: {{expression: "0.6 - x({MARK}tp)", unit: m}}',
    "single-quoted": f"wall: {{expression: '0.6 - x({MARK}tp)', unit: m}}",
    "folded": f"wall:\n    unit: m\n    expression: >-\n      0.6\n      - x({MARK}tp)",
    "folded, sign first": f"wall:\n    unit: m\n    expression: >-  # - x(tp)\n      -x({MARK}tp)",
    "folded, first character": f"wall:\n    unit: m\n    expression: >-\n      {MARK}tp",
    "literal": f"wall:\n    unit: m\n    expression: |\n      0.6\n        - x({MARK}tp)\n",
    "plain over lines": f"wall:\n    unit: m\n    expression: 0.6\n      - x({MARK}tp)",
    "quoted over lines": f'wall:\n    unit: m\n    expression: "0.6\n\n      - x(\\\n      {MARK}tp)"',
    "flow over lines": f"wall: {{unit: m,\n    expression: 0.6\n      - x({MARK}tp)}}",
    "key far away": f"'wall'  :\n    ? expression\n    : 0.6 - x({MARK}tp)\n    ? unit\n    : m",
}


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
def test_places_are_right_in_every_style_of_yaml(style, line_end):
    text, (place,) = marked(changed("wall: {expression: 0.6 - x(tip), unit: m}", STYLES[style]))
    assert told(text.replace("\n", line_end)) == [f"{place}: `tp` is not declared; did you mean `tip`?"]


def test_a_hundred_mistakes_are_told_and_the_others_counted():
    text = changed("definitions:\n", "definitions:\n" + "".join(f"  a{i}: u{i}\n" for i in range(150)))
    lines = told(text)
    assert len(lines) == MOST_MISTAKES + 1
    assert lines[0] == "12:7: `u0` is not declared"
    assert lines[-1] == f"{12 + MOST_MISTAKES}:{4 + len(str(MOST_MISTAKES)) + 2}: and 50 more mistakes from here on"


def test_a_definition_that_grows_without_bound_is_refused_once():
    doubling = "".join(f"  d{i}: d{i - 1}*d{i - 1}\n" for i in range(1, 60))
    first, *others = told(changed("definitions:\n", "definitions:\n  d0: q1\n" + doubling))
    assert first.startswith("26:8: 32767 operations, 15 deep, when its definitions are written out; at most 20000, 60 ")
    # What builds on a refused definition begins to count anew.
    assert len(others) == 3


def test_a_control_character_never_reaches_the_terminal():
    hostile = '"tip\\e[31m\\u202e\\ud800"'
    for old, new in (
        ("q2: rad", f"q2: {hostile}"),
        ("    wall: tip", f"    {hostile}: tip"),
        ("[-6, -8]", f"[{hostile}]"),
        ("  tip: elbow", f"  {hostile}: elbow"),  # declared, and then the nearest name to `tip`
        ("  wall: {expression", f"  {hostile}: {{expression"),
        ("q2: rad", 'q2: "k\n\n  m"'),
    ):
        for line in told(changed(old, new)):
            assert line.isprintable()


def test_a_file_of_undeclared_names_only_is_answered_soon():
    names = "".join(f"  a{i}: 1\n" for i in range(1500))
    sums = "".join(f"  d{i}: " + "+".join(f"b{j}" for j in range(700)) + "\n" for i in range(30))
    start = time.process_time()
    lines = told(f"title: x\nparameters:\n{names}definitions:\n{sums}")
    # Under two seconds on a quiet machine, of which YAML takes the half; comparing every name with every other would
    # take minutes.
    assert time.process_time() - start < 5.0
    assert len(lines) == MOST_MISTAKES + 1
