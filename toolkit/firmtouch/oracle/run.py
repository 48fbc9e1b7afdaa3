"""The closed loop in MuJoCo: the same controller, fed with MuJoCo's positions, speeds and contact forces."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from firmtouch.errors import NoDesignError
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.oracle.agreement import Agreement, check_export, check_export_at_rest
from firmtouch.oracle.export import MujocoExport, export_mechanism
from firmtouch.oracle.library import NotExpressibleError
from firmtouch.oracle.machine import Machine
from firmtouch.oracle.stiffness import DEFAULT, ContactStiffness
from firmtouch.oracle.surfaces import find_touches
from firmtouch.regulation import ClosedLoop
from firmtouch.regulation.projection import project

AT_REST: Final = 1e-10
"""Speeds (rad/s or m/s) below it count as rest: with poles of a few 1/s what is left to go is as small, in rad or m."""
TIME_CONSTANTS: Final = 40.0
"""How many time constants of the slowest pole a run may take: exp(-40) is below rounding."""
RAMP: Final = 2.0
"""A disturbance grows smoothly over so many seconds. MuJoCo's contact leaves J' q' out, so that an arm that moves fast
over a curved surface lifts off a stiff contact, and a touch-down with delayed force feedback may begin to bounce."""
OFFSET: Final = 1e-3
"""Where a run starts beside q_d along each free direction, in rad or m, for the same reason not farther."""
TOUCHING: Final = 1e-12
"""A run starts this far inside each surface, in the unit of phi: rounding must not decide whether there is contact."""
LOOK: Final = 100
"""Steps between two looks whether it has come to rest."""
EXPLODED: Final = 1e3
"""A coordinate or speed this far from rest at q_d, in rad and s (or m), is on its way to infinity. MuJoCo would notice
it much later, and leave a log file in the working directory."""


@dataclass(frozen=True, slots=True)
class OracleRest:
    """Where MuJoCo's arm came to rest: q (n), lambda (m), and how it got there.

    `penetration` (m entries, in the unit of phi) is -phi(q) > 0: how far the contact gave way; `compliance` (m) is how
    far MuJoCo's regularisation lets it, for a multiplier of one. `speed` is the largest |q'| left, `time` the simulated
    time in seconds, `contacts` how many constraints carry force, `agreement` how well the mechanism
    agrees with ours.
    """

    q: Array
    lambda_: Array
    penetration: Array
    compliance: Array
    speed: float
    time: float
    contacts: int
    agreement: Agreement


@dataclass(frozen=True, slots=True)
class OracleMotion:
    """A motion in MuJoCo: times (k, seconds), q and qdot (k x n), lambda_ (k x m)."""

    t: Array
    q: Array
    qdot: Array
    lambda_: Array


class NotSettledError(NoDesignError):
    """MuJoCo's arm did not come to rest; `speed` is the largest |q'| left after `time` seconds."""

    def __init__(self, speed: float, time: float, remedy: str) -> None:
        self.speed, self.time = speed, time
        super().__init__(f"MuJoCo's arm still moves by {speed:.3g} rad/s (or m/s) after {time:.3g} s; {remedy}")


def settle_in_mujoco(
    loop: ClosedLoop,
    *,
    stiffness: ContactStiffness = DEFAULT,
    timestep: float = 5e-4,
    duration: float | None = None,
    offset: ArrayLike | None = None,
    d: ArrayLike = 0.0,
    ramp: float = RAMP,
) -> OracleRest:
    """Let controller (17) bring MuJoCo's arm to rest.

    The arm starts at rest at `offset` (n, rad or m) from q_d, projected onto the surface; by default `OFFSET` along
    each free direction. `d` (n) is the disturbance of Eq. (21), which grows to its constant value over `ramp` seconds.
    The run takes at most `duration` seconds, by default that and 40 time constants of the slowest pole.

    Raises
    ------
    NotExpressibleError
        If MuJoCo cannot express the mechanism or its surfaces, or G_f has an eigenvalue of 1 or more: the force that
        the controller feeds back is that of the step before, and with one step of delay only G_f < 1 is stable [T8].
    NotSettledError
        If it does not come to rest.
    MissingOracleError
        If MuJoCo is not installed.
    """
    export = _export(loop, stiffness, timestep)
    agreement, machine = check_export_at_rest(export), Machine(export)
    offset = OFFSET * loop.split.V2.sum(axis=1) if offset is None else offset
    if duration is None:
        duration = ramp + TIME_CONSTANTS / abs(max(each.real for each in loop.poles.reduced))
    speed = np.inf
    for k, (t, q, qdot, lambda_) in enumerate(_steps(machine, loop, offset, (d, ramp))):
        if k % LOOK == 0 and k:
            speed = float(np.abs(qdot).max())
            if speed < AT_REST and (t > ramp or not np.any(d)):
                return OracleRest(
                    q=frozen(q),
                    lambda_=frozen(lambda_),
                    penetration=frozen(-loop.operating_point.plant.Phi(q)),
                    compliance=machine.compliance(),
                    speed=speed,
                    time=t,
                    contacts=int(np.count_nonzero(lambda_)),
                    agreement=agreement,
                )
        if t > duration:
            break
    raise NotSettledError(
        speed, duration, "give a longer `duration` or, if it bounces, a longer `ramp` or softer contact"
    )


def move_in_mujoco(
    loop: ClosedLoop,
    *,
    duration: float,
    offset: ArrayLike,
    stiffness: ContactStiffness = DEFAULT,
    timestep: float = 5e-4,
    d: ArrayLike = 0.0,
    ramp: float = RAMP,
) -> OracleMotion:
    """Record the motion of MuJoCo's arm under controller (17), step by step; arguments and errors as above.

    Geared rotors are refused here: MuJoCo leaves a part of their inertia out, which at rest does not matter.
    """
    export = _export(loop, stiffness, timestep)
    check_export(export)
    machine, states = Machine(export), []
    for state in _steps(machine, loop, offset, (d, ramp)):
        states.append(state)
        if state[0] >= duration:
            break
    return OracleMotion(*(frozen(each) for each in zip(*states, strict=True)))


def _export(loop: ClosedLoop, stiffness: ContactStiffness, timestep: float) -> MujocoExport:
    op = loop.operating_point
    strongest = float(np.linalg.eigvalsh(loop.gains.G_f)[-1])
    if strongest >= 1:
        raise NotExpressibleError(
            f"G_f has the eigenvalue {strongest:.4g}; in MuJoCo the controller feeds back the contact force of "
            "the step before, and with one step of delay only eigenvalues below 1 are stable"
        )
    touches = find_touches(op)
    return export_mechanism(op.plant, op.q_d, touches=touches, stiffness=stiffness, timestep=timestep)


def _steps(
    machine: Machine, loop: ClosedLoop, offset: ArrayLike, disturbance: tuple[ArrayLike, float]
) -> Iterator[tuple[float, Array, Array, Array]]:
    """Simulate for ever: (t, q, q', lambda) of each step, lambda the contact's answer to this step's u."""
    op, gains, (d, ramp) = loop.operating_point, loop.gains, disturbance
    start = op.q_d + np.broadcast_to(np.asarray(offset, dtype=float), op.n)
    on_surface = project(op.plant, start).q
    machine.place(on_surface - TOUCHING * np.linalg.pinv(op.plant.J(on_surface)).sum(axis=1), np.zeros(op.n))
    feedback, force = op.J.T @ gains.G_f, np.broadcast_to(np.asarray(d, dtype=float), op.n)
    lambda_, timestep, k = np.array(op.lambda_d), machine.export.timestep, 0
    while True:
        machine.observe()
        q, qdot = machine.q, machine.qdot
        dq = q - op.q_d
        if not max(np.abs(dq).max(), np.abs(qdot).max()) < EXPLODED:
            raise NotSettledError(np.inf, k * timestep, "it explodes: give a smaller `timestep`")
        u = gains.bias - gains.W @ dq - gains.C @ qdot + feedback @ (lambda_ - op.lambda_d)  # Eq. (17)
        machine.advance(u + _ramp(k * timestep, ramp) * force)  # Eq. (21)
        lambda_ = machine.lambda_()
        yield k * timestep, q, qdot, lambda_
        k += 1


def _ramp(t: float, duration: float) -> float:
    """Go from 0 to 1 without a step in value or slope."""
    if t >= duration:
        return 1.0
    x = t / duration
    return x * x * (3 - 2 * x)
