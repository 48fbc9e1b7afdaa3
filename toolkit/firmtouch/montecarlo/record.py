"""What is kept of each run: a line of `runs.jsonl`."""

from __future__ import annotations

import re
from dataclasses import asdict, dataclass, replace
from typing import Any, Final

import numpy as np

from firmtouch.errors import InputError
from firmtouch.mechanics import Array
from firmtouch.regulation import OperatingPoint
from firmtouch.simulation.ending import FAR, contact_signs
from firmtouch.simulation.trajectory import Outcome, Trajectory

OFF: Final = "off_surface"
"""The outcome of a start that cannot be put onto the true surface: no run at all."""
LARGEST: Final = 10**9


@dataclass(frozen=True, slots=True, order=True)
class Label:
    """The number of a run: `17`, or `p17` of one that starts inside what is proven."""

    proven: bool
    number: int

    def __str__(self) -> str:
        """Write it as it is asked for."""
        return f"{'p' if self.proven else ''}{self.number}"


def read_label(text: str) -> Label:
    """Read `17` or `p17`.

    Raises
    ------
    InputError
        If it is neither.
    """
    found = re.fullmatch(r"(p?)([1-9][0-9]{0,8})", text)
    if found is None:
        raise InputError(f"{text!r} is no run: a number was expected, such as 17, or p17 for a start inside the proof")
    return Label(bool(found[1]), int(found[2]))


@dataclass(frozen=True, slots=True)
class Record:
    """How a run ended and how far it went, in SI.

    `outcome` is a member's name of `Outcome`, in small letters, or `off_surface`. `t` is when it ended, `farthest` the
    largest |q_i - q_di| on its way, `distance` the largest |q_i - q*_i| at its end (q* is its own world's equilibrium,
    or q_d where there is none nearby), `force` the largest |lambda_j - lambda_dj| on its way, `torque` the largest part
    of a drive's limit, None without limits. `pulled` tells that a one-sided contact had to pull. Of starts inside a
    proven region, `V` is the energy (J) that they start with, and `level` what is proven.
    """

    label: Label
    outcome: str
    reason: str
    t: float = 0.0
    farthest: float = 0.0
    distance: float = 0.0
    force: float = 0.0
    torque: float | None = None
    pulled: bool = False
    V: float | None = None
    level: float | None = None

    @property
    def converged(self) -> bool:
        """Whether it came to rest at its own world's equilibrium."""
        return self.outcome == Outcome.CONVERGED.name.lower()

    @property
    def counts(self) -> bool:
        """Whether there was a run at all."""
        return self.outcome != OFF

    def with_energy(self, V: float, level: float) -> Record:
        """Add what a start inside a proven region has."""
        return replace(self, V=V, level=level)


def record_of(label: Label, trajectory: Trajectory, op: OperatingPoint, limits: Array | None) -> Record:
    """Give the figures of a run."""
    rest = trajectory.rest
    near = rest is not None and np.max(np.abs(rest.q - op.q_d)) <= FAR
    target = rest.q if rest is not None and near else op.q_d
    share = None if limits is None else float(np.max(np.abs(trajectory.u) / limits))
    return Record(
        label=label,
        outcome=trajectory.outcome.name.lower(),
        reason=trajectory.reason,
        t=float(trajectory.t[-1]),
        farthest=float(np.max(np.abs(trajectory.q - op.q_d))),
        distance=float(np.max(np.abs(trajectory.q[-1] - target))),
        force=float(np.max(np.abs(trajectory.lambda_ - op.lambda_d))),
        torque=share,
        pulled=bool(np.any(contact_signs(op) * trajectory.lambda_ < 0)),
    )


def record_as_json(record: Record) -> dict[str, Any]:
    """Give a record as plain data for JSON; numbers that are not finite are null."""
    data = asdict(record) | {"label": str(record.label)}
    return {
        ("run" if name == "label" else name): None if isinstance(value, float) and not np.isfinite(value) else value
        for name, value in data.items()
    }


def record_from_json(data: dict[str, Any]) -> Record:
    """Read a record back.

    Raises
    ------
    ValueError, KeyError, TypeError, InputError
        If it is none.
    """
    rest = {name: value for name, value in data.items() if name != "run"}
    figures = {name: float("inf") if rest[name] is None else float(rest[name]) for name in _FIGURES}
    return Record(label=read_label(data["run"]), **(rest | figures))


_FIGURES: Final = ("t", "farthest", "distance", "force")
