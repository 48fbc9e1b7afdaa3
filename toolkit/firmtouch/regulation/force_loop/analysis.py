"""All that is told of a design's force loop, as one value."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import Final

import numpy as np

from firmtouch.mechanics.arrays import frozen
from firmtouch.modelfile import ModelSpec
from firmtouch.modelfile.sections.force_path import USUAL_MARGINS, ForceMargins
from firmtouch.regulation.closed_loop import ClosedLoop
from firmtouch.regulation.force_loop.contact import DelayTooLongError
from firmtouch.regulation.force_loop.margins import LoopMargins, admissible_gain, loop_margins
from firmtouch.regulation.force_loop.path import ForcePath, force_path_of
from firmtouch.regulation.force_loop.sweep import (
    ContactPoles,
    StiffnessSweep,
    contact_stiffness_sweep,
    critical_feedback,
    poles_in_contact,
)

MARGINS: Final = ("gain", "delay", "modulus")
KEPT: Final = 1e-9
"""A margin that is missed by less, relatively, is kept: a gain that was chosen for it stands right on it."""


@dataclass(frozen=True, slots=True)
class RealContact:
    """What the file's contact stiffness does: the poles there, and the least g of G_f = g I that is unstable there.

    The poles are None where the delay is too long for them to be computed; the gain is infinite if none was found.
    """

    poles: ContactPoles | None
    critical_gain: float


@dataclass(frozen=True, slots=True)
class AskedMargin:
    """A margin by name (`gain`, `delay`, `modulus`): what is asked, and the least one that there is."""

    name: str
    asked: float
    least: float

    @property
    def kept(self) -> bool:
        """Tell whether it is as large as asked."""
        return self.least >= self.asked * (1 - KEPT)


@dataclass(frozen=True, slots=True)
class ForceLoop:
    """The loops of the force feedback [T8], and the poles over the contact's stiffness [T9].

    `loops` has one entry for each eigenvalue of G_f, ascending. `given` says whether the file has a force path;
    without one, `path` is ideal. `asked` are the margins that the file asks for, if it does; `admissible` is the
    largest g of G_f = g I that keeps them, or the usual ones (gain 2, modulus 0.5).
    """

    path: ForcePath
    given: bool
    loops: tuple[LoopMargins, ...]
    asked: ForceMargins | None
    admissible: float
    sweep: StiffnessSweep
    contact: RealContact | None

    @property
    def stable(self) -> bool:
        """Tell whether every loop is stable [T8]."""
        return all(each.stable for each in self.loops)

    @property
    def verdicts(self) -> tuple[AskedMargin, ...]:
        """Compare every margin that the file asks for with the least one among the loops."""
        names = [name for name in MARGINS if self.asked is not None and getattr(self.asked, name) is not None]
        return tuple(
            AskedMargin(name, getattr(self.asked, name), min(getattr(each, f"{name}_margin") for each in self.loops))
            for name in names
        )


def analyse_force_loop(loop: ClosedLoop, spec: ModelSpec) -> ForceLoop:
    """Analyse the force feedback of a finished design with the force path of its file; without one, L = 1."""
    path, given = force_path_of(spec), spec.force_path
    ideal = path or ForcePath()
    asked = given.margins if given is not None else None
    gains = np.linalg.eigvalsh(loop.gains.G_f)
    return ForceLoop(
        path=ideal,
        given=path is not None,
        loops=tuple(loop_margins(ideal, max(float(g), 0.0)) for g in gains),
        asked=asked,
        admissible=admissible_gain(ideal, asked or USUAL_MARGINS),
        sweep=contact_stiffness_sweep(loop, ideal, spec.design),
        contact=_real_contact(loop, spec, ideal),
    )


def _real_contact(loop: ClosedLoop, spec: ModelSpec, path: ForcePath) -> RealContact | None:
    given = spec.force_path and spec.force_path.contact_stiffness
    if not given:
        return None
    stiffness = frozen([given[name] for name in spec.constraints])
    poles, critical = None, np.inf
    with suppress(DelayTooLongError):
        poles = poles_in_contact(loop, path, stiffness, spec.design)
        critical = critical_feedback(loop, path, stiffness)
    return RealContact(poles, critical)
