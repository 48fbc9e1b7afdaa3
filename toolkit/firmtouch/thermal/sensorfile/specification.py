"""The structure of a sensor file, and what its sections must be to each other."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from typing import Final, Literal

from pydantic import Field, ValidationInfo, model_validator

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import Text, refuse
from firmtouch.modelfile.words import shown
from firmtouch.thermal.sensorfile.drive import USES, DriveSpec, ElectronicsSpec, PadSpec
from firmtouch.thermal.sensorfile.requirements import WINDOW, RequirementsSpec
from firmtouch.thermal.sensorfile.search import EntryChoice, SearchSpec
from firmtouch.thermal.sensorfile.stack import BackingSpec, StackEntry
from firmtouch.thermal.sensorfile.touch import LIGHT, ContactSpec, ObjectSpec, TemperaturesSpec
from firmtouch.thermal.tables.rows import Known, RowsSpec, known_to

MOST_ENTRIES: Final = 30
MOST_OBJECTS: Final = 100
DRIVEN: Final = ("power", "flux", "loop_gain", "second")
"""What modes may need."""
ALL_DIFFERENT: Final = 1e-3
"""Temperatures closer than this, in K, give no signal."""


class SensorSpec(RowsSpec):
    """A thermal touch sensor: its layers, the touch, the drive, and what it shall do."""

    schema_: Literal["firmtouch.sensor/1"] = Field("firmtouch.sensor/1", alias="schema", description="the format")
    title: Text = Field(description="a line for the reader")
    description: Text | None = None
    stack: tuple[StackEntry, ...] = Field(
        min_length=1, max_length=MOST_ENTRIES, description="from the touched face inward"
    )
    backing: BackingSpec = Field(description="what is behind the stack")
    contact: ContactSpec = Field(description="between the touched face and an object")
    objects: tuple[ObjectSpec, ...] = Field(min_length=1, max_length=MOST_OBJECTS, description="what is touched")
    temperatures: TemperaturesSpec
    drive: DriveSpec = DriveSpec.model_construct(mode="constant_power")
    pad: PadSpec | None = Field(None, description="without it, heat flows in one dimension")
    electronics: ElectronicsSpec | None = Field(None, description="without it, nothing is said of noise")
    requirements: RequirementsSpec = RequirementsSpec.model_construct()
    search: SearchSpec | None = Field(
        None, description="with it, a sensor is designed; without it, this one is analysed"
    )

    @model_validator(mode="after")
    def _belongs_together(self, info: ValidationInfo) -> SensorSpec:
        checks = (
            self._planes(),
            self._names(),
            self._signal(),
            self._what_requirements_need(),
            self._what_a_bridge_needs(known_to(info)),
            self._what_search_names(known_to(info)),
        )
        problems = tuple(chain(*checks))
        if problems:
            refuse(*problems)
        return self

    @property
    def sensed(self) -> int:
        """Which entry of the stack is felt."""
        return next(i for i, each in enumerate(self.stack) if each.sensed)

    @property
    def heated(self) -> int:
        """Which entry of the stack is heated: the one marked, or the sensed one."""
        return next((i for i, each in enumerate(self.stack) if each.heated), self.sensed)

    @property
    def window(self) -> float:
        """The time after the touch, in s, in which the end value is looked for."""
        asked = self.requirements.rise_time
        return WINDOW if asked is None else asked.window

    @property
    def signal(self) -> str:
        """What is read: `power` at constant temperature, otherwise `temperature`."""
        asked = self.requirements.rise_time
        if asked is not None and asked.signal is not None:
            return asked.signal
        return "power" if self.drive.mode == "constant_temperature" else "temperature"

    def entry(self, name: str) -> StackEntry:
        """Give the entry of the stack that has this name."""
        return next(each for each in self.stack if each.name == name)

    def _planes(self) -> Iterator[Problem]:
        """Hold to one plane that is felt, at most one that is heated, and something that heat can enter."""
        for mark in ("sensed", "heated"):
            marked = [i for i, each in enumerate(self.stack) if getattr(each, mark)]
            for i in marked[1:]:
                message = f"a second {mark} plane; the first is entry {marked[0] + 1} of the stack"
                yield Problem(message, path=("stack", i, mark), at_key=True)
            if mark == "sensed" and not marked:
                yield Problem("no plane is sensed; mark an entry with `sensed: true`", path=("stack",), at_key=True)
        if all(each.joint is not None for each in self.stack):
            yield Problem("a stack of joints alone", path=("stack",), at_key=True)

    def _names(self) -> Iterator[Problem]:
        """Hold names to stand for one thing each."""
        objects: set[str] = set()
        for i, each in enumerate(self.objects):
            if each.called in objects:
                message = f"an object {shown(each.called)} stands above; give this one another `name`"
                yield Problem(message, path=("objects", i))
            objects.add(each.called)
        entries: set[str] = set()
        for i, entry in enumerate(self.stack):
            if entry.name in entries:
                yield Problem(f"an entry {shown(str(entry.name))} stands above", path=("stack", i, "name"))
            if entry.name is not None:
                entries.add(entry.name)

    def _signal(self) -> Iterator[Problem]:
        """Give what keeps the touch from changing what is read."""
        T = self.temperatures
        if self.drive.mode != "pulse" and abs(T.object - T.sensor) < ALL_DIFFERENT:
            message = (
                f"object and sensor have one temperature, so that a touch changes nothing with `{self.drive.mode}`"
            )
            yield Problem(message, path=("temperatures", "sensor"))
        if self.drive.second is not None and abs(self.drive.second - T.sensor) < ALL_DIFFERENT:
            yield Problem("both pads have one temperature", path=("drive", "second"))
        if self.drive.power is not None and self.pad is None:
            message = "the `power` of a pad needs a `pad`; without one, give a `flux`"
            yield Problem(message, path=("drive", "power"), at_key=True)
        asked = self.requirements.rise_time
        if asked is not None and asked.signal == "power" and self.signal_is_temperature:
            message = f"with `{self.drive.mode}` the heater's power tells nothing; the signal is `temperature`"
            yield Problem(message, path=("requirements", "rise_time", "signal"))

    @property
    def signal_is_temperature(self) -> bool:
        """Tell whether the drive, or every one that a search may choose, leaves only the temperature to be read."""
        modes: set[str] = {self.drive.mode}
        if self.search is not None and self.search.drive is not None:
            modes |= {*(self.search.drive.mode or ())}
        return "constant_temperature" not in modes

    def _what_requirements_need(self) -> Iterator[Problem]:
        asked = self.requirements
        where: tuple[str | int, ...] = ("requirements",)
        if asked.discrimination is not None:
            names = tuple(each.called for each in self.objects)
            for i, pair in enumerate(asked.discrimination.pairs):
                for j, name in enumerate(pair):
                    if name not in names:
                        place = (*where, "discrimination", "pairs", i, j)
                        yield Problem(f"{shown(name)} is none of the `objects`", path=place, near=(name, names))
        by_d_prime = asked.rise_time is not None and asked.rise_time.metric == "d_prime"
        if by_d_prime and asked.discrimination is None:
            message = "the metric `d_prime` needs `discrimination`, whose pairs must be told apart"
            yield Problem(message, path=(*where, "rise_time", "metric"))
        noisy = {"discrimination": asked.discrimination, "range": asked.range}
        for name, each in noisy.items():
            if each is not None and self.electronics is None:
                yield Problem(f"`{name}` needs the `electronics`", path=(*where, name), at_key=True)
        spread = {"crosstalk": asked.crosstalk, "pitch": asked.pitch}
        for name, value in spread.items():
            if value is not None and (self.pad is None or self.pad.pitch is None):
                yield Problem(f"`{name}` needs a `pad` with its `pitch`", path=(*where, name), at_key=True)
        if asked.power is not None and self.pad is None:
            yield Problem("`power` needs a `pad`", path=(*where, "power"), at_key=True)
        if asked.crosstalk is not None and asked.crosstalk.time is None and asked.rise_time is None:
            message = "say at which `time` after the touch, as in `{at_most: 5 %, time: 10 ms}`"
            yield Problem(message, path=(*where, "crosstalk"))

    def _what_a_bridge_needs(self, known: Known) -> Iterator[Problem]:
        """Hold to a resistance that depends on temperature, where it is read by a bridge."""
        bridge = self.electronics is not None and self.electronics.bridge_voltage is not None
        for name in ("self_heating", "feedback"):
            if getattr(self.requirements, name) is not None and not bridge:
                message = f"`{name}` needs the `bridge_voltage` of the `electronics`"
                yield Problem(message, path=("requirements", name), at_key=True)
        entry = next((each for each in self.stack if each.sensed), None)
        if not bridge or entry is None:
            return
        film = entry.film
        if film is None or (film.element(known.parts.get(film.part or "")) is None and not _unusable(film.part, known)):
            message = "the sensed film has no `resistance` with a `B` or a `coefficient`; else give `temperature_noise`"
            yield Problem(message, path=("electronics", "bridge_voltage"))
            return
        choice = self.search.stack.get(entry.name or "") if self.search is not None else None
        for i, name in enumerate((choice.part if choice is not None else None) or ()):
            if film.element(known.parts.get(name)) is None and not _unusable(name, known):
                message = f"{shown(name)} has no `resistance` with a `B` or a `coefficient` in the tables"
                yield Problem(message, path=("search", "stack", str(entry.name), "part", i))

    def _what_search_names(self, known: Known) -> Iterator[Problem]:
        search = self.search
        if search is None:
            return
        names = tuple(each.name for each in self.stack if each.name is not None)
        for name, choice in search.stack.items():
            where = ("search", "stack", name)
            if name not in names:
                message = f"{shown(name)} is the `name` of no entry of the stack"
                yield Problem(message, path=where, at_key=True, near=(name, names))
                continue
            yield from _of_entry(self.entry(name), choice, where, known)
        for group in ("pad", "electronics"):
            if getattr(search, group) is not None and getattr(self, group) is None:
                message = f"the file has no `{group}` to start from"
                yield Problem(message, path=("search", group), at_key=True)
        yield from self._what_modes_need(search)
        if search.contact is not None:
            by_pressure = self.contact.pressure is not None
            wrong = "nominal" if by_pressure else "pressure"
            if getattr(search.contact, wrong) is not None:
                message = f"the file's `contact` is given by its {'pressure' if by_pressure else 'conductance'}"
                yield Problem(message, path=("search", "contact", wrong), at_key=True)
            pressure, heaviest = search.contact.pressure, LIGHT * self.contact.hardness
            if pressure is not None and pressure[1] >= heaviest:
                message = f"contacts are computed for pressures below a tenth of the hardness, {heaviest:g} Pa"
                yield Problem(message, path=("search", "contact", "pressure", 1))
        if "discrimination" in (search.objective, *search.front) and self.requirements.discrimination is None:
            message = "to make discrimination best, say in `requirements: discrimination` of which pairs"
            yield Problem(message, path=("search", "objective"))

    def _what_modes_need(self, search: SearchSpec) -> Iterator[Problem]:
        """Hold every mode that may be chosen to have what it needs, of the drive or of the search."""
        modes = search.drive.mode if search.drive is not None else None
        if search.drive is not None and search.drive.power is not None and self.pad is None:
            message = "the `power` of a pad needs a `pad`; without one, search a `flux`"
            yield Problem(message, path=("search", "drive", "power"), at_key=True)
        for i, mode in enumerate(modes or ()):
            have = {name for each in (self.drive, search.drive) for name in DRIVEN if getattr(each, name, None)}
            needed = ("flux",) if mode == "pulse" and not have & {"power", "flux"} else USES[mode][0]
            for name in needed:
                if name not in have:
                    message = f"the mode `{mode}` needs a `{name}`, which neither the `drive` nor its search has"
                    yield Problem(message, path=("search", "drive", "mode", i))


def _unusable(part: str | None, known: Known) -> bool:
    """Tell whether a part's row is a mistake already, which is told there."""
    return part is not None and part in known.parts and known.parts[part] is None


def _of_entry(entry: StackEntry, choice: EntryChoice, where: tuple[str, ...], known: Known) -> Iterator[Problem]:
    """Hold what may be chosen of an entry against what the entry is."""
    film = entry.film
    of_material = entry.material is not None or (film is not None and film.material is not None)
    usable = {"thickness": of_material, "material": of_material, "part": film is not None and film.part is not None}
    for name in choice.variables():
        if not usable[name]:
            yield Problem(f"this entry of the stack has no `{name}`", path=(*where, name), at_key=True)
    for i, name in enumerate(choice.part or ()):
        part = known.parts.get(name)
        if part is not None and part.footprint is None and film is not None and film.area is None:
            message = f"{shown(name)} has no footprint in the tables; give the film's `area`"
            yield Problem(message, path=(*where, "part", i))
