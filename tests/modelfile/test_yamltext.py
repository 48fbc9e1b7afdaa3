"""From bytes to plain data: what YAML allows and a model file does not, and where each piece of it stands."""

import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmtouch.errors import ModelFileError
from firmtouch.modelfile.yamltext import DEEPEST, LARGEST, MOST_ENTRIES, read_yaml


def read(text):
    document = read_yaml(text.encode() if isinstance(text, str) else text, "f")
    assert document.mistakes == ()
    return document.data


def refused(content):
    with pytest.raises(ModelFileError) as caught:
        read_yaml(content.encode() if isinstance(content, str) else content, "f")
    return str(caught.value)


def mistakes(text):
    return [str(each) for each in read_yaml(text.encode(), "f").mistakes]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1", 1),
        ("-0", 0),
        ("+5", 5),
        ("017", 17),
        ("0.50", 0.5),
        (".5", 0.5),
        ("1.", 1.0),
        ("1e3", 1e3),
        ("1e-3", 1e-3),
        ("1.5E+3", 1.5e3),
        ("9007199254740993", 9007199254740993),
        ("123456789012345678901234567890", 1.2345678901234568e29),
        ("true", True),
        ("False", False),
        ("null", None),
        ("~", None),
        ("", None),
        ("yes", "yes"),
        ("no", "no"),
        ("on", "on"),
        ("off", "off"),
        ("y", "y"),
        ("12:30", "12:30"),
        ("2001-01-01", "2001-01-01"),
        ("0x1F", "0x1F"),
        ("0o17", "0o17"),
        ("nan", "nan"),
        ("inf", "inf"),
        ("=", "="),
        ("<<", "<<"),
        ("0.6 m", "0.6 m"),
        ("d - x(tip)", "d - x(tip)"),
        ("'it''s'", "it's"),
        ('"a\\tb \\u00e9"', "a\tb é"),
        ("'1'", "1"),
        ("[1, a, [b, {c: 2}]]", [1, "a", ["b", {"c": 2}]]),
        ("{a: 1, b: }", {"a": 1, "b": None}),
        ("plain over\n  two lines", "plain over two lines"),
        ("|\n  one\n  two\n", "one\ntwo\n"),
        (">-\n  one\n  two\n", "one two"),
    ],
)
def test_values_are_those_of_yaml_1_2(text, value):
    found = read(f"key: {text}")["key"]
    assert found == value
    assert type(found) is type(value)


def test_keys_are_text_whatever_they_look_like():
    found = read("1: a\ntrue: b\n~: c\n.nan: d\n'': e")
    assert found == {"1": "a", "true": "b", "~": "c", ".nan": "d", "": "e"}


def test_merge_keys_are_keys_like_any_other():
    assert read("a: {<<: {b: 1}, c: 2}") == {"a": {"<<": {"b": 1}, "c": 2}}


@pytest.mark.parametrize(
    "bytes_", [b"\xef\xbb\xbftitle: x", b"title: x\r\n", b"title: x\r", b"%YAML 1.2\n---\ntitle: x\n...\n"]
)
def test_byte_order_marks_line_ends_and_document_marks_do_not_matter(bytes_):
    assert read(bytes_) == {"title": "x"}


@pytest.mark.parametrize("content", [b"", b"\n", b" \t \n", b"# only a comment\n", b"\xef\xbb\xbf"])
def test_an_empty_file_is_answered_with_how_to_start(content):
    assert refused(content) == "f:1:1: the file is empty; `firmtouch new NAME` writes one to start from"


@pytest.mark.parametrize("text", ["- a\n- b", "just text", "42", "~", "[1, 2]"])
def test_a_file_that_is_no_mapping_is_refused(text):
    assert refused(text).startswith("f:1:1: a model file is a mapping of `title:`")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"title: caf\xe9\n", "f:1:11: no UTF-8 text (byte 0xe9): is this a model file?"),
        (b"a: 1\nb: \xff\n", "f:2:4: no UTF-8 text (byte 0xff)"),
        (b"a: 1\nb: \xed\xa0\x80\n", "f:2:4: no UTF-8 text (byte 0xed)"),
        ("title: x".encode("utf-16"), "f:1:1: no UTF-8 text (byte 0xff)"),
        (bytes(range(256)), "no UTF-8 text (byte 0x80): is this a model file?"),
        (b"\x89PNG\r\n\x1a\n" + bytes(100), "f:1:1: no UTF-8 text (byte 0x89)"),
        (b"\x00" * 100, "f:1:1: a character that YAML does not allow"),
        (b"a: 1\nb: x\x00y", "f:2:5: a character that YAML does not allow"),
        (b"a: \x1b[31m", "f:1:4: a character that YAML does not allow"),
    ],
)
def test_binary_content_is_refused_at_the_first_byte_that_is_no_text(content, message):
    assert message in refused(content)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: !!python/object/apply:os.system [id]", "f:1:4: the tag `tag:yaml.org,2002:python/object/apply:o…`"),
        ("a: !!python/name:os.system ''", "f:1:4: the tag"),
        ("a: !!binary aGk=", "f:1:4: the tag"),
        ("a: !!str 1", "f:1:4: the tag"),
        ("a: !!set {b}", "f:1:4: the tag"),
        ("a: ! x", "f:1:4: the tag `!`; a model file is plain data, without tags"),
        ("%TAG ! tag:foo,2000:\n---\na: !x 1", "f:3:4: the tag `tag:foo,2000:x`"),
        ("!!map\na: 1", "f:1:1: the tag"),
        ("a: &b 1", "f:1:4: anchors and aliases are not read here; write the value out"),
        ("a: *b", "f:1:4: anchors and aliases"),
        ("a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]", "f:1:4: anchors and aliases"),
        ("&x a: 1", "f:1:1: anchors and aliases"),
        ("a: 1\n---\nb: 2", "f:2:1: a second document; a model file holds one"),
        ("a: 1\n...\nb: 2", "f:3:1: a second document"),
        ("%YAML 1.1\n---\na: yes", "f:2:1: another YAML than 1.2"),
        ("%YAML 3.0\n---\na: 1", "f:1:1: no valid YAML: found incompatible YAML document"),
        ("%YAML " + "9" * 5000 + ".1\n---\na: 1", "f:1:1: no valid YAML"),
        ("a:\n\tb: 1", "f:2:1: no valid YAML: while scanning for the next token found character '\\t'"),
        ("a: [1, 2", "f:1:9: no valid YAML: while parsing a flow sequence expected ',' or ']'"),
        ("a: {b: 1", "no valid YAML: while parsing a flow mapping"),
        ("a: 1\n b: 2", "f:2:3: no valid YAML: mapping values are not allowed here"),
        ("a: b: c", "f:1:5: no valid YAML"),
        ("a: @x", "f:1:4: no valid YAML"),
        ('a: "x', "no valid YAML: while scanning a quoted scalar"),
        ('a: "\\q"', "f:1:6: no valid YAML: while scanning a double-quoted scalar found unknown escape character 'q'"),
        ('a: "\\U00110000"', "no valid YAML"),
        ("a: |9x", "no valid YAML"),
        ("a" * 2000 + ": 1", "no valid YAML"),
    ],
)
def test_what_is_no_plain_data_is_refused(text, message):
    assert message in refused(text)


@pytest.mark.parametrize(
    "text",
    [
        "a: " + "[" * 10_000,
        "a: " + "{b: " * 10_000,
        "- " * 10_000,
        "? " * 10_000,
        "\n".join(" " * i + "a:" for i in range(400)),
        "a: " + "[" * (DEEPEST + 1) + "]" * (DEEPEST + 1),
    ],
    ids=["lists", "mappings", "dashes", "question marks", "blocks", "closed lists"],
)
def test_deep_nesting_is_refused_before_it_costs_anything(text):
    start = time.process_time()
    assert f"nested more than {DEEPEST} deep" in refused(text)
    assert time.process_time() - start < 1.0  # some milliseconds


@pytest.mark.parametrize(
    "text",
    [
        "a: [" + "1," * 74_000 + "]",
        "a: [" + "[]," * 49_000 + "]",
        "a: {" + ",".join(f"k{i}: 1" for i in range(15_000)) + "}",
        "".join(f"k{i}: 1\n" for i in range(15_000)),
        "a: [1, #\n" + "2, #\n" * 29_000 + "]",
    ],
    ids=["flow list", "lists in a list", "flow mapping", "block mapping", "comments between"],
)
def test_a_file_of_many_small_values_is_refused_after_some_thousand(text):
    start = time.process_time()
    assert f"more than {MOST_ENTRIES} keys and values" in refused(text)
    assert time.process_time() - start < 4.0  # half a second; without the bound it would be ten


def test_a_file_that_is_too_large_is_refused_unread():
    assert refused(b"a: " + b"x" * LARGEST) == f"f:1:1: a file of {LARGEST + 3} bytes; at most {LARGEST} are read"


def test_a_key_that_stands_twice_is_a_mistake_that_hides_no_other():
    assert mistakes("a: 1\nb: {c: .nan, c: 2}\na: 3\n? [x]\n: 1") == [
        "f:2:8: `.nan` is no finite number",
        "f:2:14: `c` stands here twice; first in line 2",
        "f:3:1: `a` stands here twice; first in line 1",
        "f:4:3: a key that is no text",
    ]


@pytest.mark.parametrize("text", [".nan", ".NaN", ".inf", "-.inf", "+.Inf", "1e999", "-1e999", "9" * 400])
def test_a_number_that_is_not_finite_is_a_mistake(text):
    shown = text if len(text) <= 40 else text[:39] + "…"
    assert mistakes(f"a: 1\nb: {text}") == [f"f:2:4: `{shown}` is no finite number"]


PLACED = """\
plain: one + two
several: [3, four + five]
quoted: "six + \\"seven\\""
single: 'it''s + eight'
folded: >-
  - nine +
  ten
literal: | # with + a comment
  eleven +
    twelve
multi: thirteen
  + fourteen
  + fifteen
nested:
  empty:
"""


@pytest.mark.parametrize(
    ("path", "word", "place"),
    [
        (("plain",), "one", (1, 8)),
        (("plain",), "two", (1, 14)),
        (("several", 1), "five", (2, 21)),
        (("quoted",), "seven", (3, 18)),
        (("single",), "eight", (4, 18)),
        (("folded",), "-", (6, 3)),
        (("folded",), "nine", (6, 5)),
        (("folded",), "ten", (7, 3)),
        (("literal",), "eleven", (9, 3)),
        (("literal",), "+", (9, 10)),
        (("literal",), "twelve", (10, 5)),
        (("multi",), "fourteen", (12, 5)),
        (("multi",), "fifteen", (13, 5)),
    ],
)
@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
def test_a_character_of_a_value_is_found_in_the_file(path, word, place, line_end):
    document = read_yaml(PLACED.replace("\n", line_end).encode(), "f")
    value = document.data
    for each in path:
        value = value[each]
    assert document.place(path, offset=value.index(word)) == place


def test_a_path_that_leads_beyond_the_file_gives_the_deepest_part_that_is_there():
    document = read_yaml(PLACED.encode(), "f")
    assert document.place(("nested",), key=True) == (14, 1)
    assert document.place(("nested", "empty"), key=True) == (15, 3)
    assert document.place(("nested", "empty")) == (15, 3)
    assert document.place(("nested", "missing")) == (14, 1)
    assert document.place(("nothing", "at", "all")) == (1, 1)
    assert document.place(("several", 7)) == (2, 1)
    assert document.place(("plain", "policy"), offset=6) == (1, 14)
    assert document.place((), key=True) == (1, 1)


@given(st.binary(max_size=80) | st.text(max_size=80).map(str.encode))
def test_any_bytes_are_read_or_refused_and_nothing_else(content):
    try:
        read_yaml(content, "f")
    except ModelFileError as error:
        assert all(each.line >= 1 and each.column >= 1 for each in error.diagnostics)
