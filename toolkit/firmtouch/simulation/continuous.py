"""A run under a controller that acts at every instant: CVODES, in stretches between the disturbances' changes."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import casadi as ca
import numpy as np

from firmtouch.mechanics import Array
from firmtouch.simulation.dae import Dae, parameters_of
from firmtouch.simulation.many import with_fast_rate
from firmtouch.simulation.samples import Samples, joined, observed
from firmtouch.simulation.world import World

POINTS: Final = 250
"""Instants that are kept of each stretch."""
PER_PERIOD: Final = 16
"""Instants that are kept, at least, of each period of the fastest pole or disturbance: no dip is stepped over."""
CLOSE: Final = 1e-5
"""How close (s) the kept instants become where a run ends before its time."""
SHORTEST: Final = 1e-3
"""A stretch that cannot be integrated is halved down to this part of it, to find out when it fails."""
MOST_STEPS: Final = 10_000
"""Steps of CVODES after which a stretch is halved: where nothing can be followed, it would go on for ever."""


@dataclass(frozen=True, slots=True)
class Integrator:
    """CVODES over a stretch, from its beginning to `points` of it (parts of the stretch, ascending, up to 1)."""

    points: Array
    function: ca.Function

    def __call__(self, x: Array, t: float, length: float, parameters: Array) -> Array | None:
        """Give the states at the points (states x points), or None where it fails."""
        try:
            found = self.function(x0=x, p=np.concatenate([parameters, [t, length]]))["xf"].full()
        except RuntimeError:
            return None
        return found if np.all(np.isfinite(found)) else None


def build_integrator(dae: Dae, tolerance: float, points: Array, *, runs: int = 1) -> Integrator:
    """Set up CVODES: Adams-Moulton of order 1 to 12, its equations solved by Newton's method with exact Jacobians.

    Arms swing more than they are stiff: at one cost, these keep the energy better than backward differences do. Time
    counts in parts of a stretch. `tolerance` is the relative and the absolute one (in rad, m, and these per second).
    For many `runs` to come, the equations are compiled, if that can be done.
    """
    s, x = ca.SX.sym("s"), ca.SX.sym("x", dae.states)
    column, span = ca.SX.sym("parameters", dae.layout.size), ca.SX.sym("span", 2)
    rate = span[1] * dae.rate(span[0] + span[1] * s, x, column)
    equations = with_fast_rate({"t": s, "x": x, "p": ca.vertcat(column, span), "ode": rate}, runs)
    options: dict[str, Any] = {
        "abstol": tolerance,
        "reltol": tolerance,
        "linear_multistep_method": "adams",
        "nonlinear_solver_iteration": "newton",
        "max_num_steps": MOST_STEPS,
        "disable_internal_warnings": True,
        "show_eval_warnings": False,
    }
    return Integrator(points, ca.integrator("run", "cvodes", equations, 0.0, list(points), options))


def even_points() -> Array:
    """Give the parts of a stretch whose states are kept."""
    return np.linspace(0, 1, POINTS + 1)[1:]


@dataclass(frozen=True, slots=True)
class ContinuousRun:
    """A loop to be followed; `ended` tells the first of some samples after which the run is over, if there is one.

    At least `per_period` instants are kept of each period of the fastest pole or disturbance.
    """

    dae: Dae
    integrator: Integrator
    ended: Callable[[Samples], int | None]
    per_period: float = PER_PERIOD

    def follow(self, world: World, x: Array, duration: float) -> tuple[Samples, float | None]:
        """Integrate from x at t = 0; gives the samples, and when the integrator failed, if it did.

        Where it seems to be over before its time, the instants become as dense as CLOSE says, and the first of them
        at which it is over is the last one.
        """
        borders = self._borders(world, duration)
        parts: list[Samples] = []
        for t, until in itertools.pairwise(borders):
            parameters = parameters_of(self.dae, world, t=t)
            stretch, failed = self._stretch(x, t, until - t, parameters, shortest=SHORTEST * (until - t))
            ending = self._ending(stretch, parameters)
            if ending is not None:
                return joined([*parts, ending]), None
            parts.append(stretch)
            if failed is not None:
                return joined(parts), failed
            x = stretch.x[:, -1]
        return joined(parts), None

    def _borders(self, world: World, duration: float) -> list[float]:
        """Give the times between which the run is one stretch."""
        fastest = max(abs(each) for each in (*self.dae.loop.poles.reduced, *(one.omega for one in world.sinusoids)))
        longest = POINTS * 2 * np.pi / (self.per_period * fastest) if fastest else duration
        changes = [0.0, *(each for each in world.changes if each < duration), duration]
        borders = [changes[0]]
        for begin, end in itertools.pairwise(changes):
            borders += list(np.linspace(begin, end, math.ceil((end - begin) / longest) + 1)[1:])
        return borders

    def _stretch(
        self, x: Array, t: float, length: float, parameters: Array, *, shortest: float
    ) -> tuple[Samples, float | None]:
        """Integrate one stretch, in halves where it fails as a whole."""
        found = self.integrator(x, t, length, parameters)
        if found is not None:
            times = np.concatenate([[t], t + length * self.integrator.points])
            return observed(self.dae, times, np.column_stack([x, found]), parameters), None
        if length < shortest:
            return observed(self.dae, np.array([t]), x[:, None], parameters), t
        left, failed = self._stretch(x, t, length / 2, parameters, shortest=shortest)
        if failed is not None or self.ended(left.since(-1)) is not None:
            return left, failed  # what has run away may take ever shorter steps
        right, failed = self._stretch(left.x[:, -1], t + length / 2, length / 2, parameters, shortest=shortest)
        return joined([left, right]), failed

    def _ending(self, stretch: Samples, parameters: Array) -> Samples | None:
        """Give the stretch up to where the run is over, or None where a closer look finds that it is not."""
        looked = 0
        while (found := self.ended(stretch.since(looked))) is not None:
            stop = looked + found
            begin, until = max(0, stop - 1), min(stop + 1, stretch.t.size - 1)
            t, length = float(stretch.t[begin]), float(stretch.t[until] - stretch.t[begin])
            if stop == 0 or length < CLOSE:
                if self.ended(stretch.since(stop).upto(1)) is not None:
                    return stretch.upto(stop + 1)
                looked = max(stop, looked + 1)
                continue
            closely, _ = self._stretch(stretch.x[:, begin], t, length, parameters, shortest=length)
            ending = self._ending(closely, parameters)
            if ending is not None:
                return joined([stretch.upto(begin), ending])
            looked = max(stop, looked + 1)
        return None
