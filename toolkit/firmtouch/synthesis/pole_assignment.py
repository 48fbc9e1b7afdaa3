"""Steps 1-6 of the paper: W and C that put the poles of the linearised loop where they are asked."""

from __future__ import annotations

from typing import Final

import numpy as np
import scipy.linalg

from firmtouch.errors import NoDesignError
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen, symmetric
from firmtouch.modelfile.sections.design import DesignSpec
from firmtouch.regulation import ClosedLoop, Gains, OperatingPoint, close_loop, split_directions
from firmtouch.regulation.closed_loop import match_poles, pole_distance
from firmtouch.regulation.force_loop.choice import force_feedback_of
from firmtouch.synthesis.mode_shapes import choose_mode_shapes
from firmtouch.synthesis.normal_blocks import damping_blocks, stiffness_blocks
from firmtouch.synthesis.pairing import Mode

POLE_TOLERANCE: Final = 1e-4
"""Largest distance of a pole as it is computed again, relative to itself: double poles move by the square root of
rounding (1e-7), and slow ones beside others that are 1e6 times faster by 2e-5."""


class PolesMissedError(NoDesignError):
    """The finished gains do not give the poles; both lists and the distance are kept."""

    def __init__(self, requested: tuple[complex, ...], achieved: tuple[complex, ...], residual: float) -> None:
        self.requested, self.achieved, self.residual = requested, achieved, residual
        asked = ", ".join(f"{each:.6g}" for each in requested)
        got = ", ".join(f"{each:.6g}" for each in achieved)
        super().__init__(
            f"the poles miss: asked for {asked}; the finished gains give {got} (relative distance {residual:.2g}, "
            f"allowed {POLE_TOLERANCE:g}); the problem is badly scaled or the inertia nearly singular"
        )


class NotPositiveError(NoDesignError):
    """C, K or W is not positive definite on the level that was asked for."""

    def __init__(self, loop: ClosedLoop, level: str) -> None:
        self.loop, self.level = loop, level
        positivity = loop.full if level == "full" else loop.tangent
        least = {"K": positivity.K[0], "C": positivity.C[0], "W": positivity.W[0]}
        figures = ", ".join(f"{name}_min = {value:.4g}" for name, value in least.items())
        remedy = (
            "; the poles ask for no more stiffness than the plant brings by itself "
            "(W22 = K22 - N0_22 is not clearly positive): take faster poles, or `level: tangent`, which needs no W > 0"
            if loop.tangent.holds and loop.full.W[0] <= 0
            else ""
        )
        super().__init__(f"not positive definite on the {level} level: {figures}{remedy}")


def assign_poles(op: OperatingPoint, design: DesignSpec) -> ClosedLoop:
    """Choose W and C by pole assignment, and analyse the closed loop from the finished gains.

    Raises
    ------
    PolesMissedError
        If the poles of the finished gains are not those asked for.
    NotPositiveError
        If the conditions fail on the level that is asked for.
    """
    gains = pole_assignment_gains(op, design)
    loop = close_loop(op, gains)
    requested = requested_poles(design)
    residual = max(pole_distance(poles, requested) for poles in (loop.poles.pencil, loop.poles.reduced))
    if not residual <= POLE_TOLERANCE:
        raise PolesMissedError(requested, match_poles(loop.poles.pencil, requested), residual)
    if not (loop.full if design.level == "full" else loop.tangent).holds:
        raise NotPositiveError(loop, design.level)
    return loop


def requested_poles(design: DesignSpec) -> tuple[complex, ...]:
    """List the poles that the file asks for, in its order."""
    assert design.poles is not None
    return tuple(pole for group in design.poles for pole in group)


def pole_assignment_gains(op: OperatingPoint, design: DesignSpec) -> Gains:
    """Build the gains of Steps 1-6 with the chosen mode shapes and normal blocks."""
    split = split_directions(op.J)
    M, N0 = split.blocks(op.M), split.blocks(op.N0)
    L = np.linalg.cholesky(M.X22)  # Step 3: M22 = S^T S with S = L^T
    natural = scipy.linalg.eigh(symmetric(_normalised(N0.X22, L)))

    def stiffness(modes: tuple[Mode, ...], Q: Array) -> Array:
        K22 = symmetric(L @ Q @ np.diag([each.k for each in modes]) @ Q.T @ L.T)  # Step 4
        return split.assemble(stiffness_blocks(K22, M, N0, design.normal_blocks))

    def size(modes: tuple[Mode, ...], Q: Array) -> float:
        W = stiffness(modes, Q) - op.N0
        allowed = design.level == "tangent" or np.linalg.eigvalsh(W)[0] > 0
        return float(np.linalg.norm(W)) if allowed else np.inf

    modes, Q = choose_mode_shapes(design, natural, size)
    C22 = symmetric(L @ Q @ np.diag([each.c for each in modes]) @ Q.T @ L.T)
    return Gains(
        W=symmetric(stiffness(modes, Q) - op.N0),  # Step 6
        C=split.assemble(damping_blocks(C22, M, design.normal_blocks)),  # Step 5
        G_f=force_feedback_of(design),
        bias=frozen(op.g - op.f_d),
    )


def _normalised(X22: Array, L: Array) -> Array:
    half = scipy.linalg.solve_triangular(L, X22, lower=True)
    return frozen(scipy.linalg.solve_triangular(L, half.T, lower=True))
