"""Files of 150 kB that are made to cost time: an answer with exit code 2, within the same five seconds."""

import pytest
from tests.hostile.harness import survive

SIZE = 150_000


def lines(pattern, start=""):
    """Repeat a line with a running number up to the size."""
    count = SIZE // len(pattern.format(9999))
    return start + "".join(pattern.format(i) for i in range(count))


FILES = {
    "a flow list": "poles: [" + "1," * (SIZE // 2) + "1]\n",
    "lists in a flow list": "poles: [" + "[]," * (SIZE // 3) + "1]\n",
    "a flow mapping": "parameters: {" + ",".join(f"a{i}: 1" for i in range(SIZE // 9)) + "}\n",
    "many parameters": lines("  a{0}: 1\n", "parameters:\n"),
    "many undeclared names": lines("  a{0}: b{0}\n", "definitions:\n"),
    "many unknown keys": lines("tilte{0}: 1\n"),
    "one key again and again": "title: 1\n" * (SIZE // 9),
    "many units that are none": lines("  a{0}: 1 xy{0}q\n", "parameters:\n"),
    "many numbers that are none": lines("  a{0}: .nan\n", "parameters:\n"),
    "many bodies": lines("    b{0}: {{mass: 1}}\n", "mechanism:\n  gravity: [0, 0]\n  bodies:\n"),
    "definitions that build on one another": lines("  d{0}: d{0}*d1\n", "definitions:\n"),
    "long expressions": "coordinates: {q: rad}\nparameters: {a: 1}\ndefinitions:\n"
    + "".join(f"  d{i}: " + "a*q+" * 950 + "q\n" for i in range(36)),
    "sums of undeclared names": "parameters:\n"
    + "".join(f"  a{i}: 1\n" for i in range(1500))
    + "definitions:\n"
    + "".join(f"  d{i}: " + "+".join(f"b{j}" for j in range(700)) + "\n" for i in range(35)),
    "one long text": "title: " + "a " * (SIZE // 2),
    "a text over many lines": "title: " + "a\n  " * (SIZE // 4),
    "a folded block": "title: >-\n" + "  aaa\n" * (SIZE // 6),
    "many escapes": 'title: "' + "\\x41 " * (SIZE // 5) + '"\n',
    "many quotes": "title: '" + "'' " * (SIZE // 3) + "'\n",
    "a long key": "a" * SIZE + ": 1\n",
    "a long anchor": "a: &" + "a" * SIZE + " 1\n",
    "a long directive": "%" + "a" * SIZE + "\n---\na: 1\n",
    "open lists": "a: " + "[" * SIZE,
    "open mappings": "a: " + "{a: " * (SIZE // 4),
    "dashes": "- " * (SIZE // 2),
    "question marks": "? " * (SIZE // 2),
    "comments": "#\n" * (SIZE // 2) + "a: 1\n",
    "white space": "a: " + " " * SIZE + "1\n",
    "line breaks": "a: " + "\n" * SIZE + " 1\n",
    "a hundred kilobytes of brackets": "title: x\nconstraints: {a: {expression: " + "(" * 100_000 + ", unit: m}}\n",
}


@pytest.mark.parametrize("name", FILES)
def test_a_large_file_is_answered_soon(name, tmp_path, canary):
    content = FILES[name].encode()
    assert len(content) > 50_000
    assert survive(content, name, tmp_path / "large.yaml", canary) == 2
