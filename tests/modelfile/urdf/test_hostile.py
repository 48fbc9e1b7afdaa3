"""Files that are made to harm, or are no URDF at all: refused with a place, quickly, and without opening anything."""

import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmtouch.errors import ModelFileError
from firmtouch.modelfile.urdf import parse_urdf
from firmtouch.modelfile.urdf.xmltext import DEEPEST, LARGEST, MOST_ELEMENTS

LAUGHS = '<!DOCTYPE r [<!ENTITY a0 "ha">' + "".join(f'<!ENTITY a{i + 1} "{f"&a{i};" * 10}">' for i in range(9)) + "]>"
FILES = {
    "billion laughs": (f'<?xml version="1.0"?>\n{LAUGHS}<robot name="&a9;"/>'.encode(), ":2:1: a document type"),
    "external entity": (b'<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/passwd">]><robot name="&x;"/>', ":1:1: a document type"),
    "external subset": (b'<!DOCTYPE robot SYSTEM "http://127.0.0.1:9/x.dtd"><robot/>', ":1:1: a document type"),
    "parameter entity": (b'<!DOCTYPE r [<!ENTITY % x SYSTEM "file:///dev/zero">%x;]><robot/>', ":1:1: a document type"),
    "undefined entity": (b'<robot>\n<link name="&x;"/></robot>', ":2:"),
    "deep": (b"<robot>" * 100_000, f":1:{7 * DEEPEST + 1}: elements nested"),
    "wide": (b"<robot>" + b"<a/>" * (MOST_ELEMENTS + 9), f"more than {MOST_ELEMENTS} elements"),
    "large": (b"<robot/>" + b" " * LARGEST, f":1:1: a file of more than {LARGEST} bytes"),
    "latin 1": (b'<?xml version="1.0" encoding="ISO-8859-1"?><robot/>', ":1:1: the encoding `ISO-8859-1`"),
    "latin 1 bytes": ('<robot name="\xe9"/>'.encode("latin-1"), ":1:14: no UTF-8 text (byte 0xe9)"),
    "utf 16": ("<robot/>".encode("utf-16"), ":1:1: no UTF-8 text"),
    "utf 16 without mark": ("<robot/>".encode("utf-16-le"), ":1:2: a null byte"),
    "wrong utf 16": (b'<?xml version="1.0" encoding="UTF-16"?><robot/>', "the encoding `UTF-16`"),
    "empty": (b" \n", ":1:1: the file is empty"),
    "only a mark": (b"\xef\xbb\xbf", ":1:1: the file is empty"),
    "cut off": (b'<robot>\n<link name="a"/>\n', ":3:1: no valid XML"),
    "cut off in a tag": (b'<robot>\n<link name="a', ":2:1: no valid XML"),
    "two roots": (b"<robot/><robot/>", ":1:9: no valid XML: junk after document element"),
    "twice the same attribute": (b'<robot name="a" name="b"/>', "no valid XML: duplicate attribute"),
    "null byte": (b'<robot name="\x00"/>', ":1:14: a null byte"),
    "control sequence": (b'<robot>\n<joint type="&#27;[2J"/></robot>', "no valid XML"),
    "yaml": (b"schema: firmtouch.model/1\n", ":1:1: no valid XML"),
}  # fmt: skip


@pytest.mark.parametrize("name", FILES)
def test_it_is_refused_at_its_place(name):
    content, wanted = FILES[name]
    start = time.process_time()
    with pytest.raises(ModelFileError) as caught:
        parse_urdf(content, file="x.urdf")
    assert wanted in str(caught.value)
    assert time.process_time() - start < 1  # s of this process; the largest file takes 0.05 s


def test_a_huge_word_is_shown_short_and_clean():
    with pytest.raises(ModelFileError) as caught:
        parse_urdf(
            f'<robot><link name="a"/><joint name="\u202e{"x" * 1_000_000}" type="y"/></robot>'.encode(), file="x.urdf"
        )
    assert len(str(caught.value)) < 2000
    assert "\u202e" not in str(caught.value)


def test_very_many_mistakes_end_the_reading():
    joints = "".join(
        f'<joint name="j{i}" type="fixed"><parent link="x{i}"/><child link="y{i}"/></joint>' for i in range(5000)
    )
    start = time.process_time()
    with pytest.raises(ModelFileError) as caught:
        parse_urdf(f'<robot><link name="a"/>{joints}</robot>'.encode(), file="x.urdf")
    assert 50 < len(caught.value.diagnostics) <= 100
    assert time.process_time() - start < 2


def test_a_very_long_chain_is_walked_without_recursion():
    links = "".join(f'<link name="l{i}"/>' for i in range(5000))
    joints = "".join(
        f'<joint name="j{i}" type="fixed"><parent link="l{i}"/><child link="l{i + 1}"/></joint>' for i in range(4999)
    )
    assert len(parse_urdf(f"<robot>{links}{joints}</robot>".encode(), file="x.urdf").joints) == 4999


PIECES = st.sampled_from(
    ["<robot>", "</robot>", "<link", ' name="a"', "/>", ">", "<joint", ' type="revolute"', "<!DOCTYPE", "<![CDATA[", "]]>", "<!--", "-->",
     "&lt;", "&#x0;", "<inertial>", "</inertial>", '<mass value="1"/>', '<parent link="a"/>', "\n", "é", "<?x?>", ' xmlns:p="q"']
)  # fmt: skip


@given(st.one_of(st.binary(max_size=200), st.lists(PIECES, max_size=30).map(lambda each: "".join(each).encode())))
def test_anything_is_read_or_refused_as_a_file(content):
    try:
        parse_urdf(content, file="x.urdf")
    except ModelFileError as error:
        assert error.diagnostics
        assert all(each.line >= 1 and each.column >= 1 for each in error.diagnostics)
