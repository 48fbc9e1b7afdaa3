"""What a file declares, found in a first and lenient reading, so that every expression can be checked on its own.

Mistakes are not reported here but by the fields themselves; what is wrong is declared as unknown, so that it causes
no second message elsewhere.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Any

from firmtouch.modelfile.expression import ExpressionError, Kind, kind_of, parse
from firmtouch.modelfile.expression.kind import UNKNOWN
from firmtouch.modelfile.expression.problem import Problem
from firmtouch.modelfile.expression.tree import Name, Node, Vector, children
from firmtouch.modelfile.rows import rows_written, sort_of
from firmtouch.modelfile.units import JOULE, SECOND, UnitError, parse_unit, split_quantity

MOST_COORDINATES = 100
LARGEST_EXPANSION = 20_000
DEEPEST_EXPANSION = 60


@dataclass(frozen=True, slots=True)
class Extent:
    """How many nodes a tree has, and how deep it is."""

    nodes: int
    depth: int


@dataclass(frozen=True, slots=True)
class Declarations:
    """Names and their kinds, as a first reading of the file found them.

    `hidden` are names that exist and cannot be used where these declarations are, each with the reason. `optional` are
    constraints whose multiplier need not be given, `contacts` those on surfaces. Of a robot, `joints` are the
    coordinates as its joints make them, `frames` what constraints can name, and `tools` those of them that are tools;
    `attached` reads its file.
    """

    parameters: Mapping[str, Kind] = field(default_factory=dict)
    coordinates: Mapping[str, Kind] = field(default_factory=dict)
    definitions: Mapping[str, Kind] = field(default_factory=dict)
    extents: Mapping[str, Extent] = field(default_factory=dict)
    constraints: Mapping[str, Kind] = field(default_factory=dict)
    hidden: Mapping[str, str] = field(default_factory=dict)
    optional: frozenset[str] = frozenset()
    contacts: tuple[str, ...] = ()
    joints: Mapping[str, Any] | None = None
    frames: tuple[str, ...] | None = None
    tools: tuple[str, ...] = ()
    attached: Callable[[str], Any] | None = None

    @property
    def names(self) -> dict[str, Kind]:
        """All names that stand for a value."""
        return {**self.parameters, **self.coordinates, **self.definitions}

    @property
    def rates(self) -> dict[str, Kind]:
        """The kinds of the coordinates' time derivatives."""
        return {name: Kind(kind.dimension / SECOND, known=kind.known) for name, kind in self.coordinates.items()}

    def above(self, definition: str) -> Declarations:
        """Give what is declared before a definition: definitions use what stands above them."""
        names = list(self.definitions)
        at = names.index(definition)
        before = {name: self.definitions[name] for name in names[:at]}
        below = dict.fromkeys(names[at:], "a definition uses those above it, and this one is not")
        return replace(self, definitions=before, hidden=below)

    def plus(self, definition: str, kind: Kind, extent: Extent) -> Declarations:
        """Add a definition below the others."""
        definitions, extents = {**self.definitions, definition: kind}, {**self.extents, definition: extent}
        return replace(self, definitions=definitions, extents=extents)

    def constant(self) -> Declarations:
        """Give what constants are made of: parameters alone."""
        varying = dict.fromkeys((*self.coordinates, *self.definitions), "this is a constant, made of parameters alone")
        return Declarations(self.parameters, hidden=varying)

    @property
    def joint_forces(self) -> dict[str, Kind]:
        """The kinds of the generalised forces: energy by coordinate."""
        return {name: Kind(JOULE / kind.dimension, known=kind.known) for name, kind in self.coordinates.items()}

    @property
    def stiffnesses(self) -> dict[str, Kind]:
        """The kinds of the diagonal entries of W and K: generalised force by coordinate."""
        return self._force_by(self.coordinates)

    @property
    def dampings(self) -> dict[str, Kind]:
        """The kinds of the diagonal entries of C: generalised force by velocity."""
        return self._force_by(self.rates)

    def _force_by(self, kinds: Mapping[str, Kind]) -> dict[str, Kind]:
        forces = self.joint_forces
        return {name: Kind(forces[name].dimension / kind.dimension, known=kind.known) for name, kind in kinds.items()}

    @property
    def multipliers(self) -> dict[str, Kind]:
        """The kinds of the multipliers: energy by constraint."""
        return {name: Kind(JOULE / kind.dimension, known=kind.known) for name, kind in self.constraints.items()}

    @property
    def contact_stiffnesses(self) -> dict[str, Kind]:
        """The kinds of the contacts' stiffnesses: multiplier by constraint."""
        forces = self.multipliers
        return {
            name: Kind(forces[name].dimension / kind.dimension, known=kind.known)
            for name, kind in self.constraints.items()
        }

    def check(self, tree: Node, *, velocities: bool = False) -> tuple[Kind, Extent]:
        """Find an expression's kind and its extent, and refuse one that grows beyond bounds."""
        kind = kind_of(tree, names=self.names, rates=self.rates if velocities else {}, hidden=self.hidden)
        extent = self.extent(tree)
        if extent.nodes > LARGEST_EXPANSION or extent.depth > DEEPEST_EXPANSION:
            message = (
                f"{extent.nodes} operations, {extent.depth} deep, when its definitions are written out; "
                f"at most {LARGEST_EXPANSION}, {DEEPEST_EXPANSION} deep, are read"
            )
            raise ExpressionError(Problem(message, tree.at))
        return kind, extent

    def extent(self, tree: Node) -> Extent:
        """Measure a tree with its definitions written out."""
        if isinstance(tree, Name):
            return self.extents.get(tree.name, Extent(1, 1))
        below = [self.extent(each) for each in children(tree)]
        return Extent(1 + sum(each.nodes for each in below), 1 + max((each.depth for each in below), default=0))


def declarations(data: Mapping[str, Any], beside: Declarations | None = None) -> Declarations:
    """Read what a file declares; a name that is declared twice is of unknown kind.

    `beside` says what is known besides: how to read a robot's file, and the coordinates that its joints are.
    """
    beside = beside or Declarations()
    sections = [_section(data, name) for name in ("parameters", "coordinates", "definitions")]
    twice = {name for name, count in Counter(chain(*sections)).items() if count > 1}
    parameters = {name: UNKNOWN if name in twice else _parameter(value) for name, value in sections[0].items()}
    coordinates = {name: UNKNOWN if name in twice else _with_unit(value) for name, value in sections[1].items()}
    constraints: dict[str, Kind] = {}
    optional: set[str] = set()
    for entry, value in _section(data, "constraints").items():
        rows = rows_written(value)
        constraints |= {each.name(entry): _of_unit(each.unit) for each in rows} or {entry: _with_unit(value)}
        optional |= {each.name(entry) for each in rows if each.optional}
    known = replace(
        beside,
        parameters=parameters,
        coordinates=coordinates | dict(beside.coordinates),
        constraints=constraints,
        optional=frozenset(optional),
        contacts=tuple(name for name, value in _section(data, "constraints").items() if sort_of(value) == "surface"),
    )
    for name, value in sections[2].items():
        kind, extent = UNKNOWN, Extent(1, 1)
        if name not in twice:
            kind, extent = _definition(value, known)
        known = known.plus(name, kind, extent)
    return known


def _definition(raw: object, known: Declarations) -> tuple[Kind, Extent]:
    try:
        return known.check(parse_entry(raw))
    except ExpressionError:
        return UNKNOWN, Extent(1, 1)


def parse_entry(raw: object) -> Node:
    """Parse an expression as it stands in a file: text, a number, or a list that makes a vector."""
    if isinstance(raw, str):
        return parse(raw)
    if isinstance(raw, bool) or raw is None:
        raise ExpressionError(Problem("an expression was expected, such as `l1*cos(q1)`"))
    if isinstance(raw, int | float):
        return parse(repr(raw))
    if isinstance(raw, list) and raw:
        return Vector(_entries(raw), 0)
    raise ExpressionError(Problem("an expression was expected, such as `l1*cos(q1)`, or a list of them"))


def _entries(raw: list[Any]) -> tuple[Node, ...]:
    entries: list[Node] = []
    problems: list[Problem] = []
    for i, each in enumerate(raw):
        try:
            entries.append(parse_entry(each))
        except ExpressionError as error:
            problems.extend(problem.below(i) for problem in error.problems)
    if problems:
        raise ExpressionError(*problems)
    return tuple(entries)


def _section(data: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    section = data.get(name)
    return section if isinstance(section, dict) else {}


def _parameter(value: object) -> Kind:
    if isinstance(value, dict):
        value = value.get("value")
    if isinstance(value, int | float) and not isinstance(value, bool):
        return Kind()
    split = split_quantity(value) if isinstance(value, str) else None
    return UNKNOWN if split is None else _of_unit(split[1])


def _with_unit(value: object) -> Kind:
    return _of_unit(value.get("unit") if isinstance(value, dict) else value)


def _of_unit(text: object) -> Kind:
    try:
        return Kind(parse_unit(text).dimension) if isinstance(text, str) else UNKNOWN
    except UnitError:
        return UNKNOWN
