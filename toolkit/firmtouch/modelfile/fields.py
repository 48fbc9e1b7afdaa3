"""The kinds of entry that a model file has, as pydantic types: names, quantities, expressions, poles.

Each validator reports all its mistakes in one `PydanticCustomError` whose context holds `Problem`s; `read` turns them
into `file:line:column`. `Declarations` come in as pydantic's validation context.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Annotated, Any, Final, NoReturn, TypeVar

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from firmtouch.modelfile.declarations import Declarations, Extent, parse_entry
from firmtouch.modelfile.expression import CONSTANTS, FUNCTIONS, ExpressionError, Kind, Node, Problem, names_in
from firmtouch.modelfile.units import DIMENSIONLESS, Dimension, UnitError, parse_unit, split_quantity
from firmtouch.modelfile.words import shown

NAME: Final = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,31}")
RESERVED: Final = frozenset({*FUNCTIONS, *CONSTANTS, "dot"} - {"x", "y", "z"})
K = TypeVar("K", bound=str | int)
T = TypeVar("T")
LARGEST: Final = 1e15
FASTEST: Final = 1e6


def refuse(*problems: Problem) -> NoReturn:
    """Report problems as pydantic wants it."""
    raise PydanticCustomError("problems", "{first}", {"first": problems[0].message, "problems": problems})


@contextmanager
def under(*path: str | int) -> Iterator[None]:
    """Report problems from inside as standing further down the file."""
    try:
        yield
    except PydanticCustomError as error:
        refuse(*(each.below(*path) for each in problems_of(error.context)))


def problems_of(context: Mapping[str, Any] | None) -> tuple[Problem, ...]:
    """Get the problems out of a pydantic error's context; none for an error of pydantic's own."""
    return tuple((context or {}).get("problems", ()))


def read_all(entries: Iterable[tuple[K, Any]], read: Callable[[K, Any], T]) -> dict[K, T]:
    """Read entries one by one, and report the problems of all of them together."""
    values: dict[K, T] = {}
    problems: list[Problem] = []
    for key, raw in entries:
        try:
            values[key] = read(key, raw)
        except PydanticCustomError as error:
            problems += (problem.below(key) for problem in problems_of(error.context))
    if problems:
        refuse(*problems)
    return values


def declared(info: ValidationInfo) -> Declarations:
    """Give the file's declarations; without a file there are none."""
    return info.context if isinstance(info.context, Declarations) else Declarations()


@dataclass(frozen=True, slots=True, eq=False)
class Checked:
    """A pydantic type made of one function from the raw entry to the value, and of its JSON Schema."""

    read: Callable[[Any, ValidationInfo], Any]
    schema: dict[str, Any]

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Validate with `read` alone."""
        return core_schema.with_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Describe what may be written."""
        return self.schema


def _label(raw: object) -> str:
    if not isinstance(raw, str) or not NAME.fullmatch(raw):
        message = f"{shown(str(raw))} is no name; names are a letter and up to 31 letters, digits or `_`"
        refuse(Problem(message, at_key=True))
    return raw


Label = Annotated[str, Checked(lambda raw, _: _label(raw), {"type": "string", "pattern": f"^{NAME.pattern}$"})]
"""The name of a constraint, a body, a line: not a value that an expression could use."""


def new_name(raw: object, known: Declarations) -> str:
    """Check a name that the file declares."""
    name = _label(raw)
    if name in RESERVED:
        refuse(Problem(f"`{name}` is the name of a function or a constant; choose another", at_key=True))
    spaces = {"parameter": known.parameters, "coordinate": known.coordinates, "definition": known.definitions}
    homes = [kind for kind, names in spaces.items() if name in names]
    if len(homes) > 1:
        refuse(Problem(f"`{name}` is declared twice, as a {' and as a '.join(homes)}", at_key=True))
    return name


NewName = Annotated[
    str, Checked(lambda raw, info: new_name(raw, declared(info)), {"type": "string", "pattern": f"^{NAME.pattern}$"})
]
"""A name that the file declares here."""


def _text(raw: object, info: ValidationInfo) -> str:  # noqa: ARG001  # the signature is pydantic's
    if not isinstance(raw, str) or not raw.strip() or len(raw) > 2000:
        refuse(Problem("a text was expected (not empty, at most 2000 characters)"))
    if not all(each.isprintable() or each.isspace() for each in raw):
        refuse(Problem("a text with characters that cannot be printed"))
    return " ".join(raw.split())


Text = Annotated[str, Checked(_text, {"type": "string", "minLength": 1, "maxLength": 2000})]


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number with a unit, converted to SI; `text` is what was written."""

    text: str
    value: float
    dimension: Dimension
    bare: bool

    def in_(self, dimension: Dimension) -> bool:
        """Tell whether it can be read as a quantity of this dimension: bare numbers are SI."""
        return self.bare or self.dimension == dimension


def read_quantity(raw: object, *, example: str = "0.6 m") -> Quantity:
    """Read `0.6 m` or a bare number."""
    if isinstance(raw, bool) or not isinstance(raw, str | int | float):
        refuse(Problem(f"a quantity was expected, such as `{example}`"))
    if isinstance(raw, int | float):
        return _bounded(Quantity(f"{raw:g}", float(raw), DIMENSIONLESS, bare=True), raw)
    split = split_quantity(raw)
    if split is None:
        refuse(Problem(f"{shown(raw)} is no quantity; write a number and a unit, such as `{example}`"))
    number, unit_text, offset = split
    try:
        unit = parse_unit(unit_text)
    except UnitError as error:
        refuse(Problem(str(error), offset + error.offset))
    bare = not unit_text.strip()
    return _bounded(Quantity(" ".join(raw.split()), number * unit.factor, unit.dimension, bare=bare), raw)


def _bounded(quantity: Quantity, raw: object) -> Quantity:
    if not math.isfinite(quantity.value) or abs(quantity.value) > LARGEST:
        refuse(Problem(f"{shown(str(raw))} is no finite number of a usable size (at most {LARGEST:g} in SI)"))
    return quantity


def _any_quantity(raw: object, info: ValidationInfo) -> Quantity:  # noqa: ARG001  # the signature is pydantic's
    return read_quantity(raw)


QUANTITY_SCHEMA: Final[dict[str, Any]] = {
    "anyOf": [{"type": "number"}, {"type": "string", "pattern": r"^\s*[-+]?[0-9.].*$"}]
}
AnyQuantity = Annotated[Quantity, Checked(_any_quantity, {**QUANTITY_SCHEMA, "description": "such as `0.6 m`"})]


def quantity_in(unit: str, *, least: float = -math.inf, most: float = math.inf) -> Checked:
    """Make the type of a quantity of one dimension between two bounds, in SI."""

    def read(raw: object, info: ValidationInfo) -> float:  # noqa: ARG001  # the signature is pydantic's
        quantity = read_quantity(raw, example=f"5 {unit}" if unit != "1" else "5")
        expect_dimension(quantity, parse_unit(unit).dimension)
        if not least <= quantity.value <= most:
            span = f"at least {least:g}" if most == math.inf else f"between {least:g} and {most:g}"
            refuse(Problem(f"{shown(str(raw))} is out of range; it must be {span}"))
        return quantity.value

    return Checked(read, {**QUANTITY_SCHEMA, "description": f"in {unit}"})


def expect_dimension(quantity: Quantity, dimension: Dimension) -> float:
    """Give the value in SI of a quantity that must have this dimension."""
    if not quantity.in_(dimension):
        refuse(Problem(f"`{quantity.text}` is in {quantity.dimension}, but {dimension} was expected"))
    return quantity.value


def _unit(raw: object, info: ValidationInfo) -> str:  # noqa: ARG001  # the signature is pydantic's
    if not isinstance(raw, str):
        refuse(Problem("a unit was expected, such as `m` or `rad`"))
    try:
        return parse_unit(raw).text
    except UnitError as error:
        refuse(Problem(str(error), error.offset))


UnitText = Annotated[str, Checked(_unit, {"type": "string", "examples": ["m", "rad", "1"]})]


@dataclass(frozen=True, slots=True)
class Expression:
    """A checked expression: what was written, its tree, its dimension and size.

    `extent` is that of the tree with its definitions written out.
    """

    text: str
    tree: Node
    kind: Kind
    extent: Extent

    @property
    def size(self) -> int:
        """How many entries it has; 0 is a scalar."""
        return self.kind.size

    @property
    def names(self) -> frozenset[str]:
        """The names that it uses directly."""
        return names_in(self.tree)


EXPRESSION_SCHEMA: Final[dict[str, Any]] = {"anyOf": [{"type": "string"}, {"type": "number"}]}


def expression_in(
    unit: str | None, *, sizes: tuple[int, ...] = (0,), velocities: bool = False, constant: bool = False
) -> Checked:
    """Make the type of an expression with a unit (`None`: any) and a size out of `sizes` (0: a scalar).

    A `constant` one may use parameters alone.
    """

    def read(raw: object, info: ValidationInfo) -> Expression:
        known = declared(info).constant() if constant else declared(info)
        return read_expression(raw, known, unit=unit, sizes=sizes, velocities=velocities)

    vectors = {"type": "array", "items": EXPRESSION_SCHEMA, "minItems": 2, "maxItems": 3}
    choices = [*EXPRESSION_SCHEMA["anyOf"], vectors] if max(sizes) else EXPRESSION_SCHEMA["anyOf"]
    return Checked(read, {"anyOf": choices, "description": f"an expression{f' in {unit}' if unit else ''}"})


def read_expression(
    raw: object,
    known: Declarations,
    *,
    unit: str | None = None,
    sizes: tuple[int, ...] = (0,),
    velocities: bool = False,
) -> Expression:
    """Read an expression, and hold its unit and its size against what is wanted."""
    if isinstance(raw, list):
        read_all(enumerate(raw), lambda _, each: read_expression(each, known, velocities=velocities))
    try:
        tree = parse_entry(raw)
        kind, extent = known.check(tree, velocities=velocities)
    except ExpressionError as error:
        refuse(*error.problems)
    if kind.known and kind.size not in sizes:
        refuse(Problem(f"{_sized(kind.size)} was given where {' or '.join(map(_sized, sizes))} was expected"))
    if unit is not None and not kind.fits(parse_unit(unit).dimension):
        wanted = "a plain number or an angle" if unit == "1" else parse_unit(unit).dimension
        refuse(Problem(f"this is in {kind.dimension}, but {wanted} was expected"))
    text = raw if isinstance(raw, str) else str(raw).replace("'", "")
    return Expression(" ".join(text.split()), tree, kind, extent)


def listed(words: Iterable[str], most: int = 12) -> str:
    """Join words with commas, and count those that are too many to name."""
    words = list(words)
    more = f" and {len(words) - most} more" if len(words) > most else ""
    return ", ".join(words[:most]) + more


def _sized(size: int) -> str:
    return f"a vector of {size}" if size else "a scalar"


def check_keys(given: Iterable[str], choices: Iterable[str], what: str, *, complete: bool) -> None:
    """Refuse keys that are not among the choices, and, if it shall be complete, choices that are missing."""
    given, choices = tuple(given), tuple(choices)
    problems = [
        Problem(
            f"{shown(each)} is no {what}; there are: {listed(choices)}", path=(each,), at_key=True, near=(each, choices)
        )
        for each in given
        if each not in choices
    ]
    missing = [each for each in choices if each not in given] if complete else []
    if missing:
        problems.append(Problem(f"no entry for the {what} {listed(f'`{each}`' for each in missing)}"))
    if problems:
        refuse(*problems)


def read_quantities(raw: object, kinds: Mapping[str, Kind], what: str) -> dict[str, float]:
    """Read a mapping that has one quantity, of its own dimension, for each name; the values are in SI."""
    if not isinstance(raw, dict):
        refuse(Problem(f"an entry for each {what} was expected, as in `{{{next(iter(kinds), 'name')}: ...}}`"))
    check_keys(raw, kinds, what, complete=True)

    def read(name: str, each: object) -> float:
        quantity = read_quantity(each)
        return expect_dimension(quantity, kinds[name].dimension) if kinds[name].known else quantity.value

    return read_all(raw.items(), read)


_COMPLEX: Final = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")


def read_pole(raw: object) -> complex:
    """Read a pole: `-4`, or `-4 + 3j`."""
    if isinstance(raw, int | float) and not isinstance(raw, bool):
        value = complex(raw)
    else:
        compact = raw.replace(" ", "").replace("i", "j") if isinstance(raw, str) and len(raw) < 80 else ""
        try:
            value = complex(compact) if _COMPLEX.match(compact) else complex("?")
        except ValueError:
            refuse(Problem(f"{shown(str(raw))} is no pole; write `-4` or `-4+3j`, in 1/s"))
    if not math.hypot(value.real, value.imag) <= FASTEST:
        refuse(Problem(f"{shown(str(raw))} is no pole of a usable size (at most {FASTEST:g} 1/s)"))
    if value.real >= 0:
        refuse(Problem(f"the pole {shown(str(raw))} is not stable; its real part must be negative"))
    return value
