"""How long the step response of a three-layer fingertip takes at 400 times, and how far it is from mpmath's.

mpmath is called as its users call it: `invertlaplace` at each time, on the same formula of cosh/sinh matrices. Its
time for all is that of 20 of them, evenly chosen, times 20; both take turns in one run.
"""

from __future__ import annotations

import math

import mpmath
import numpy as np
from tests.benchmarks.measure import Figure, seconds

from firmtouch.thermal import Base, ContactEvent, HalfSpace, Layer, Material, Stack, Touch

TIMES = np.logspace(-5, 0, 400)
EVERY, ROUNDS, WARM = 20, 3, 30
MILLISECONDS, FASTER, AGREE = 10, 100, 1e-9
KAPTON = Material("Kapton", 0.12, 1420, 1090)
FOAM = Material("foam", 0.05, 300, 1300)
COPPER = Material("copper", 401, 8933, 385)
LAYERS = (Layer(KAPTON, 12.5e-6), Layer(KAPTON, 25e-6), Layer(FOAM, 1e-3))
H = 1e4


def ours() -> np.ndarray:
    stack = Stack(LAYERS, sensed=1, backing=Base())
    return ContactEvent(stack, Touch(HalfSpace(COPPER), H), 1.0).temperature(TIMES)


def transform(s: mpmath.mpc) -> mpmath.mpc:
    """Give theta/s: products of the layers' matrices on a base."""

    def matrix(layer: Layer) -> mpmath.matrix:
        g = mpmath.sqrt(s / layer.material.alpha)
        kg, x = layer.material.conductivity * g, g * layer.thickness
        return mpmath.matrix([[mpmath.cosh(x), mpmath.sinh(x) / kg], [kg * mpmath.sinh(x), mpmath.cosh(x)]])

    sensed = matrix(LAYERS[1]) * matrix(LAYERS[2]) * mpmath.matrix([0, 1])
    face = matrix(LAYERS[0]) * sensed
    return sensed[0] / (face[0] + face[1] * (1 / mpmath.mpf(H) + 1 / (COPPER.effusivity * mpmath.sqrt(s)))) / s


def theirs() -> np.ndarray:
    return np.array([float(mpmath.invertlaplace(transform, float(t), method="talbot")) for t in TIMES[::EVERY]])


def figures() -> list[Figure]:
    error = float(np.abs(ours()[::EVERY] - theirs()).max())
    mine, others = math.inf, math.inf
    for _ in range(ROUNDS):
        mine = min(mine, *(seconds(ours) for _ in range(WARM)))
        others = min(others, seconds(theirs) * EVERY)
    detail = f"{1e3 * mine:.2f} ms against {others:.2f} s"
    return [
        Figure("thermal step, 3 layers, 400 times", 1e3 * mine, "<=", MILLISECONDS, "ms", ""),
        Figure("thermal step: mpmath / ours", others / mine, ">=", FASTER, "", detail),
        Figure("thermal step: difference from mpmath", error, "<=", AGREE, "", f"at {TIMES[::EVERY].size} times"),
    ]
