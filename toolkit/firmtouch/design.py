"""The walk from a model file to a finished design: each step one public function, the result one value."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from firmtouch.checks import CheckReport, check_model
from firmtouch.errors import NoDesignError
from firmtouch.mechanics import Scene, derive_plant, draw_scene
from firmtouch.mechanics.symbolic import SymbolicPlant
from firmtouch.modelfile import ModelFile
from firmtouch.regulation import ClosedLoop, SteadyState, find_operating_point, steady_state_errors
from firmtouch.regulation.closed_loop import match_poles, pole_distance
from firmtouch.regulation.operating_point import OffSurfaceError, project
from firmtouch.synthesis import assign_poles
from firmtouch.synthesis.pole_assignment import requested_poles

FAR: Final = 0.3
"""A projection that moves the guess further than this (rad or m) deserves a word."""
ILL_CONDITIONED: Final = 1e4
GHOST: Final = 0.22
"""How far along a free direction the ghosts of the picture stand, in rad or m."""
MOST_GHOST_DIRECTIONS: Final = 2


@dataclass(frozen=True, slots=True)
class Design:
    """A checked design: all that the reports and `design.json` tell."""

    model: ModelFile
    loop: ClosedLoop
    requested: tuple[complex, ...]
    achieved: tuple[complex, ...]
    residual: float
    steady_state: SteadyState
    checks: CheckReport
    symbolic: SymbolicPlant | None
    scene: Scene | None
    warnings: tuple[str, ...]


class ChecksFailedError(NoDesignError):
    """The model is not what it says it is, so no promise about its gains would hold."""

    def __init__(self, report: CheckReport) -> None:
        self.report = report
        reasons = "; ".join(
            f"{each.name} ({each.figure:.3g}, must be {each.relation} {each.bound:g})" for each in report.failed
        )
        super().__init__(f"the model fails its checks: {reasons}; `firmtouch check` tells more")


def design_model(model: ModelFile, progress: Callable[[str], None] = lambda _: None) -> Design:
    """Design, analyse and check; `progress` is told what is being done.

    Raises
    ------
    NoDesignError
        If there is no such design, or the model fails its checks.
    """
    spec = model.spec
    progress("deriving the mechanics")
    op = find_operating_point(derive_plant(spec))
    progress("assigning the poles")
    loop = assign_poles(op, spec.design)
    requested = requested_poles(spec.design)
    achieved = match_poles(loop.poles.pencil, requested)
    progress("checking the model")
    checks, symbolic = check_model(model)
    if not checks.holds:
        raise ChecksFailedError(checks)
    return Design(
        model=model,
        loop=loop,
        requested=requested,
        achieved=achieved,
        residual=pole_distance(achieved, requested),
        steady_state=steady_state_errors(loop, spec.bounds),
        checks=checks,
        symbolic=symbolic,
        scene=_scene(loop),
        warnings=_warnings(loop),
    )


def _scene(loop: ClosedLoop) -> Scene | None:
    """Draw the mechanism at q_d, and behind it where the constraints let it go."""
    op = loop.operating_point
    ghosts = []
    for direction in loop.split.V2.T[:MOST_GHOST_DIRECTIONS]:
        for sign in (-1, 1):
            try:
                ghosts.append(project(op.plant, op.q_d + sign * GHOST * direction).q)
            except OffSurfaceError:
                continue  # the surface ends here, and so does the picture
    return draw_scene(op.plant, op.q_d, op.lambda_d, ghosts)


def _warnings(loop: ClosedLoop) -> tuple[str, ...]:
    op, warnings = loop.operating_point, []
    if op.moved > FAR:
        warnings.append(f"The projection moved the guess by {op.moved:.2g} (rad or m); is q_d where you want it?")
    condition = float(loop.split.S[0] / loop.split.S[-1])
    if condition > ILL_CONDITIONED:
        warnings.append(f"J(q_d) has condition number {condition:.2g}: multipliers are hard to tell apart near here.")
    strongest = float(np.max(np.linalg.eigvalsh(loop.gains.G_f)))
    if strongest >= 1:
        warnings.append(
            f"The largest force-feedback gain is {strongest:.3g}. An undelayed force signal allows any, but one that "
            "comes one sample late is stable only below 1."
        )
    units = {each.unit for each in op.plant.spec.coordinates.values()}
    if len(units) > 1:
        warnings.append(
            "Coordinates are in rad and in m: eigenvalues of W, C and K mix units and depend on the choice of SI."
        )
    if not loop.full.holds:
        warnings.append(
            "The conditions hold on the tangent level alone: on the directions that the constraints leave free. "
            "That is enough near q_d while the contact lasts, but it is less than the paper's conditions."
        )
    return tuple(warnings)
