"""Stretches of a run as they come from an integrator."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from firmtouch.mechanics import Array
from firmtouch.simulation.dae import Dae


@dataclass(frozen=True, slots=True)
class Samples:
    """k instants: t (k), the state x (states x k), and lambda (m x k), u (n x k), Phi (m x k) there."""

    t: Array
    x: Array
    lambda_: Array
    u: Array
    Phi: Array

    def upto(self, end: int) -> Samples:
        """Give the first instants alone."""
        return self._slice(slice(end))

    def since(self, begin: int) -> Samples:
        """Give the instants from one on."""
        return self._slice(slice(begin, None))

    def _slice(self, part: slice) -> Samples:
        return Samples(self.t[part], self.x[:, part], self.lambda_[:, part], self.u[:, part], self.Phi[:, part])


def joined(parts: Sequence[Samples]) -> Samples:
    """Put stretches one after the other."""
    return Samples(
        np.concatenate([each.t for each in parts]),
        *(np.concatenate([getattr(each, name) for each in parts], axis=1) for name in ("x", "lambda_", "u", "Phi")),
    )


def observed(dae: Dae, t: Array, x: Array, parameters: Array) -> Samples:
    """Compute lambda, u and Phi at instants of one stretch."""
    lambda_, u, Phi = (each.full() for each in dae.outputs(ca.DM(t).T, ca.DM(x), ca.DM(parameters)))
    return Samples(t, x, lambda_, u, Phi)
