"""The equations of a loop as machine code, for those who run it many times.

Nothing changes but time: the results are the same to the last bit. Without a compiler, or for an arm whose Jacobian is
too long for one, CasADi's virtual machine goes on.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import casadi as ca

from firmtouch.mechanics.compiled import MOST_INSTRUCTIONS, When, compiled
from firmtouch.simulation.dae import Dae

MANY_RUNS: Final = 500
"""From so many runs on, compiling takes less time than it saves.

Measured, on an idle machine: 1 s to compile the equations of a planar 3R arm, whose run then takes 4.6 ms instead of
8.7."""
SOME_RUNS: Final = 20
"""From so many runs on, looking for what has been compiled takes less time than it saves: some 10 ms for that arm."""
WITH_JACOBIAN: Final = 5
"""A rate and its Jacobian have at least this many times the instructions of the rate."""


def with_fast_outputs(dae: Dae, runs: int) -> Dae:
    """Compute what is looked at after each stretch by machine code, if that pays."""
    if runs < SOME_RUNS:
        return dae
    return replace(dae, outputs=compiled({"outputs": dae.outputs}, when=_when(runs))["outputs"])


def with_fast_rate(equations: dict[str, ca.SX], runs: int) -> dict[str, ca.SX] | dict[str, ca.MX]:
    """Give an integrator's equations with x' and its Jacobian in x, for Newton's method, as machine code."""
    if runs < SOME_RUNS:
        return equations
    inputs, only_x = [equations[each] for each in "txp"], {"is_diff_in": [False, True, False]}
    ode = ca.Function("ode", inputs, [equations["ode"]], only_x)
    if WITH_JACOBIAN * ode.n_instructions() > MOST_INSTRUCTIONS:
        return equations  # without deriving a Jacobian in vain
    fast = compiled({"ode": ode, "jac_ode": ode.jacobian()}, when=_when(runs))["ode"]
    if fast is ode:
        return equations
    t, x, p = (ca.MX.sym(each, ode.size1_in(i)) for i, each in enumerate("txp"))
    return {"t": t, "x": x, "p": p, "ode": fast(t, x, p)}


def _when(runs: int) -> When:
    return When.NOW if runs >= MANY_RUNS else When.CACHED
