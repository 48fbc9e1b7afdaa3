"""Seeded damage to model files: bytes, and the tree of a YAML file. The same seed always gives the same file."""

from __future__ import annotations

import copy
import json
import random
import re
from dataclasses import dataclass
from functools import cache
from typing import Any

from ruamel.yaml import YAML

MOST_STEPS = 3

TOKENS = (
    b"{", b"}", b"[", b"]", b":", b": ", b"- ", b"? ", b"| \n", b">-\n", b"#", b"&a ", b"*a", b"!!python/object:os.system ",
    b"!", b"%YAML 1.1\n", b"---\n", b"...\n", b"\t", b"\r", b"\r\n", b"\x00", b"\xff", b"\xef\xbb\xbf", b"\xc3", b"\xe2\x80\xa8",
    b"\xc2\x85", b"'", b'"', b'"\\x00"', b"<<: ", b"null", b"~", b"yes", b".nan", b".inf", b"-.inf", b"1e999", b"1e308",
    b"-1", b"0", b"0x1F", b"0o17", b"1_000", b"9" * 400, b"(" * 60, b"__import__('os').system('id')", b"q1**q1", b"1/0",
    b"exp(exp(exp(100)))", b"9**9**9", b"lambda: 0", b"^2", b"a.b", b"dot(q1)", b",", b"@", b"`", b"\n", b"\n\n  ", b" ",
)  # fmt: skip
"""Pieces of text that mean something to YAML, to the grammar of expressions, or to neither."""


class Raw(str):
    """A scalar that goes into the file as it is."""

    __slots__ = ()


class Pairs(list):  # type: ignore[type-arg]  # the entries are [key, value] lists
    """A mapping that may hold a key twice."""

    __slots__ = ()


EXPRESSIONS = (
    "1/0", "0**-1", "sqrt(-1)", "log(0)", "0*log(0)", "1/(l1-l1)", "q1**q1", "q2**0.5", "9**9**9", "exp(exp(exp(100)))",
    "exp(exp(exp(10*q1)))", "q1/q1", "sqrt(q1-q1)", "sqrt(0*q1)", "atan2(0, 0)", "atan2(q1-q1, 0*q1)", "asin(2)",
    "asin(2 + 0*q1)", "acos(q1 + 5)", "tan(pi/2)", "log(q1-q1)", "1e308*1e308*q1", "1e-308*q1*1e-308", "1e300*cos(q1)",
    "(q1+q2)**32", "q1**-32", "sin(1e300*q1)", "cosh(100*q1)", "sinh(800 + q1)", "norm([q1-q1, 0])", "[q1, q2]",
    "[q1, q2, q1]", "x([q1, q2])", "z([1, 2])", "inner([q1, 1], [1, q2])", "cross([q1, 1], [1, q2])", "dot(q1)", "dot(m1)",
    "dot(q1)**2", "0.5*dot(q1)**3", "0*q1", "q1", "m1", "tip", "elbow", "x(tip)", "x(tip) - x(tip)", "pi", "e", "lambda",
    "abs(q1)", "min(q1, q2)", "foo(q1)", "__import__('os').system('id')", "().__class__", "q1 if q1 else q2", "q1^2",
    "q1;q2", "exec('1')", "((((((((((q1))))))))))", "-" * 30 + "q1", "+".join(["sin(q1)*cos(q2)"] * 120),
    "*".join(["(sin(q1) + cos(q2))"] * 30), "sin(" * 12 + "q1" + ")" * 12, "tan(tan(tan(tan(tan(q1)))))",
    "(1 + q1)**(1 + q2)", "exp(" * 6 + "q1" + ")" * 6, "sqrt(1 - q1**2 - q2**2)", "1/(1 + q1**2)", "q1**(1/3)",
)  # fmt: skip

VALUES = (
    *EXPRESSIONS, *map(Raw, (
        ".nan", "-.inf", ".inf", "1e999", "-1e999", "1e308", "-1e308", "1e-320", "0x1F", "0o17", "1_000", "1e3", "+5", "-0.0",
        "yes", "no", "on", "~", "!!python/object/apply:os.system [id]", "!!binary aGk=", "&a 1", "*a", "[", "{a: 1}", "[[[[]]]]",
        "[[[[[[[[[[[[[[[[[[[[1]]]]]]]]]]]]]]]]]]]]", "{}", "[]", "''", '"\\0"', "|\n        a\n        b", ">-\n      q1 +\n      q2",
        "2001-01-01", "1:30", "=", "<<",
    )),
    None, True, False, -1, 0, 1, 2, 3, 0.5, 1e15, 1e16, 1e-15, 1e-300, 10**30, -1e6, "", " ", "x" * 3000, "9" * 500,
    "0 kg", "-1 kg", "1e300 kg", "-5 m", "0 m", "1e-200 m", "1e14 m", "5 degC", "9**9**9 m", "5 parsec", "1 deg", "3 N/m", "m", "rad", "kg*m^2",
    "1", "decouple", "reject", "blend", "tangent", "plant", "-4+3j", "-4-3j", "1j", "nan", "inf", "-1e308+1.7e308j",
    [], [[]], [None], [0, 0], [0, 0, 0], [1, 2, 3, 4], ["q1", "q2"], [["q1", 0], [0, "q2"]], [-1, -1], [-4, -5, -6, -7],
    ["-4+3j", "-4-3j"], [[-4, -5]], [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 0, 0], [0, 0, 0], [0, 0, 0]], [1, 0, 0], [True, False],
    [Raw("{x: q1}")], [Raw("{z: q1}"), Raw("{y: q1}")], ["a"] * 50, [list(range(9)), "b", [Raw(".nan")]],
)  # fmt: skip
"""What a value is replaced by: honest, odd and hostile ones."""

KEYS = (
    "q1", "q2", "l1", "m1", "pi", "sin", "dot", "x", "schema", "title", "parameters", "mechanism", "bodies", "guess", "q_d", "f_d",
    "lambda_d", "policy", "weight", "kinetic_energy", "potential_energy", "level", "through", "centre", "radius", "interval",
    "value", "unit", "label", "mass", "inertia", "orientation", "gravity", "", "__class__", "a b", "1", "yes", "~", "[key]", "<<",
    "copy", "é", "a" * 40,
)  # fmt: skip


NUMBERS = (
    "0",
    "-1",
    "1",
    "1e-300",
    "1e14",
    "-1e14",
    "1e-9",
    "1e9",
    "3.14159",
    "0.001",
    "100",
    "-0.5",
    "45",
    "90",
    "180",
    "1e5",
)
"""What the number of a quantity is replaced by; its unit stays."""

FORMS = (
    "sqrt({})", "log({})", "1/({})", "({})**2", "({})**-3", "1e9*({})", "0*({})", "-({})", "({})/({})", "x({})", "{} + {}",
    "exp({})", "1e-200*({})", "1e200*({})", "({})*sin(q1)", "({})*sqrt(q1)", "({})/q1", "({})*atan2(q1, q1)", "({}) - ({})",
    "({})*q1**q2", "({})*(1 + q1)**0.5", "[x({}), y({})]", "({})*tan(1e9*q1)", "({})*exp(100*q1)", "({})*(q1/q1)**(1/3)",
)  # fmt: skip
PIECES = (
    "0", "1", "-", "*", "/", "+", "**", "-1", "1e8", "1e-300", "1e300", "sin(q1)", "q1", "l1", "tip", "(q1)**3", "q1/q1", "q1*q2", "pi",
)  # fmt: skip

Names = dict[str, list[str]]


@dataclass(frozen=True, slots=True)
class Mutation:
    """A damaged file, and the steps that led to it."""

    seed: str
    steps: tuple[str, ...]
    content: bytes


def mutate(source: bytes, seed: str) -> Mutation:
    """Damage a file in one to three steps, either in its bytes or in its tree."""
    rng = random.Random(seed)
    steps = rng.choice((1, 1, 1, 2, MOST_STEPS))
    if rng.random() < 0.3:
        return _mutate_bytes(source, seed, rng, steps)
    return _mutate_tree(source, seed, rng, steps)


def _mutate_bytes(source: bytes, seed: str, rng: random.Random, count: int) -> Mutation:
    content, done = source, []
    for _ in range(count):
        sort = rng.choice(("flip", "insert", "delete", "duplicate", "truncate", "splice", "splice", "splice"))
        at = rng.randrange(len(content) + 1)
        span = rng.choice((1, 1, 2, 5, 40, 400))
        match sort:
            case "flip" if at < len(content):
                content = content[:at] + bytes([content[at] ^ (1 << rng.randrange(8))]) + content[at + 1 :]
            case "insert":
                content = content[:at] + rng.randbytes(min(span, 5)) + content[at:]
            case "delete":
                content = content[:at] + content[at + span :]
            case "duplicate":
                content = content[:at] + content[at : at + span] * rng.choice((2, 2, 3, 50)) + content[at + span :]
            case "truncate":
                content = content[:at]
            case "splice":
                content = content[:at] + rng.choice(TOKENS) + content[at + rng.choice((0, 0, 1, 4)) :]
        done.append(f"{sort} at byte {at}")
    return Mutation(seed, tuple(done), content)


def _mutate_tree(source: bytes, seed: str, rng: random.Random, count: int) -> Mutation:
    data = _loaded(source)
    sections = {"q": "coordinates", "p": "parameters", "d": "definitions"}
    names = {short: [*data.get(section, ())] or ["q1"] for short, section in sections.items()}
    tree = _with_pairs(data)
    done = [_one_step(tree, rng, names) for _ in range(count)]
    return Mutation(seed, tuple(done), (_block(tree, 0) + "\n").encode())


@cache
def _loaded(source: bytes) -> dict[str, Any]:
    return YAML(typ="safe", pure=True).load(source.decode())


def _with_pairs(data: object) -> object:
    match data:
        case dict():
            return Pairs([str(key), _with_pairs(value)] for key, value in data.items())
        case list():
            return [_with_pairs(each) for each in data]
        case _:
            return data


def _containers(tree: object) -> list[list]:  # type: ignore[type-arg]  # of anything
    found = [tree] if isinstance(tree, list) and tree else []
    for each in tree if isinstance(tree, list) else ():
        found += _containers(each[1] if isinstance(tree, Pairs) else each)
    return found


def _one_step(tree: object, rng: random.Random, names: Names) -> str:
    spots = [(box, i) for box in _containers(tree) for i in range(len(box))]
    if not spots:
        return "nothing left"
    box, i = rng.choice(spots)
    slot, index = (box[i], 1) if isinstance(box, Pairs) else (box, i)
    where = f"`{box[i][0]}`" if isinstance(box, Pairs) else f"entry {i}"
    sorts = ["delete", "replace", "replace", "swap", "exchange", "repeat", "wrap", *["bend"] * 6]
    sort = rng.choice([*sorts, "rename", "copy"] if isinstance(box, Pairs) else sorts)
    match sort:
        case "delete":
            del box[i]
        case "replace":
            slot[index] = _adapted(copy.deepcopy(rng.choice(VALUES)), rng, names)
        case "swap":
            j = rng.randrange(len(box))
            box[i], box[j] = box[j], box[i]
        case "exchange":
            other, j = rng.choice(spots)
            slot2, index2 = (other[j], 1) if isinstance(other, Pairs) else (other, j)
            first, second = copy.deepcopy(slot[index]), copy.deepcopy(slot2[index2])
            slot[index], slot2[index2] = second, first
        case "repeat":
            box.insert(i, copy.deepcopy(box[i]))
        case "wrap":
            slot[index] = [slot[index]] if rng.random() < 0.5 else Pairs([[rng.choice(KEYS), slot[index]]])
        case "bend":
            slot[index] = _bent(slot[index], rng, names)
        case "rename":
            slot[0] = rng.choice([*KEYS, slot[0][:-1], slot[0] + "x"])
        case "copy":
            box.append([rng.choice(["copy", "twin", *KEYS]), copy.deepcopy(box[i][1])])
    return f"{sort} {where}"


def _adapted(value: object, rng: random.Random, names: Names) -> object:
    """Let an expression speak of what this model has: q1, q2 for its coordinates, l1, m1 for its parameters."""
    if not isinstance(value, str):
        return value
    for pattern, choices in ((r"\bq[12]\b", names["q"]), (r"\b[lm]1\b", names["p"]), (r"\b(tip|elbow)\b", names["d"])):
        value = re.sub(pattern, lambda _, these=choices: rng.choice(these), value) if choices else value
    return value


def _bent(value: object, rng: random.Random, names: Names) -> object:
    """Change a value a little: another number, another operator, another name. Most results are still read."""
    match value:
        case bool() | None:
            return not value
        case int() | float():
            return rng.choice((0, -value, value * 1e6, value * 1e-12, value + 1, 1e15, Raw(".nan")))
        case Raw() | list():
            return copy.deepcopy(rng.choice(VALUES))
        case str() if (quantity := re.fullmatch(r"([-+0-9.e]+)(\s.*)?", value)) is not None:
            return rng.choice(NUMBERS) + (quantity[2] or "")
        case str():
            return _bent_text(value, rng, names)
    return value


def _bent_text(text: str, rng: random.Random, names: Names) -> str:
    words = list(re.finditer(r"[A-Za-z_][A-Za-z0-9_]*|[0-9.]+|[-+*/]", text))
    if not words or rng.random() < 0.2:
        return rng.choice(FORMS).replace("{}", text)
    word = rng.choice(words)
    others = [each.group() for each in words]
    for alike in (*names.values(), list("+-*/"), ["sin", "cos", "tan", "tanh", "exp", "log", "sqrt", "asin"]):
        others = alike if word.group() in alike else others
    other = rng.choice(others) if rng.random() < 0.7 else rng.choice(PIECES)
    return text[: word.start()] + _adapted(other, rng, names) + text[word.end() :]


def _block(tree: object, indent: int) -> str:
    """Write a tree as YAML: mappings as blocks, lists in brackets."""
    if not isinstance(tree, Pairs) or not tree:
        return _flow(tree)
    lines = []
    for key, value in tree:
        nested = isinstance(value, Pairs) and value
        text = _block(value, indent + 1)
        lines.append(f"{'  ' * indent}{_key(key)}:" + (f"\n{text}" if nested else f" {text}"))
    return "\n".join(lines)


def _flow(tree: object) -> str:
    match tree:
        case Raw():
            return str(tree)
        case Pairs():
            return "{" + ", ".join(f"{_key(key)}: {_flow(value)}" for key, value in tree) + "}"
        case list():
            return "[" + ", ".join(map(_flow, tree)) + "]"
        case None:
            return "null"
        case bool() | str():
            return json.dumps(tree)
        case _:
            return repr(tree)


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", key) else json.dumps(key)
