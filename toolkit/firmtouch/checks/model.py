"""All checks of one model, in the order in which a reader would ask for them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

import numpy as np

from firmtouch.checks import contact, curvature, derivatives, inertia, limits, motion
from firmtouch.checks.result import CheckReport, CheckResult
from firmtouch.checks.subject import Subject, make_subject, subject_at
from firmtouch.modelfile import ModelFile
from firmtouch.regulation import OperatingPoint

if TYPE_CHECKING:
    from firmtouch.mechanics.symbolic import SymbolicPlant

CHECKS: Final[tuple[Callable[[Subject], CheckResult], ...]] = (
    contact.on_surface,
    contact.full_rank,
    contact.force_in_range,
    limits.within_limits,
    limits.drives_hold,
    inertia.inertia_symmetric,
    inertia.inertia_positive,
    inertia.kinetic_energy_homogeneous,
    inertia.passive,
    inertia.orientations_orthonormal,
    derivatives.hessians_symmetric,
    derivatives.hessians_by_differences,
    motion.energy_kept,
    curvature.curvature_matters,
)
"""The checks that need numbers alone; the comparison with SymPy comes last."""


def check_model(model: ModelFile, *, at: OperatingPoint | None = None) -> tuple[CheckReport, SymbolicPlant | None]:
    """Run every check on a model, at its operating point if that was found; a check that fails stops no other.

    The SymPy derivation that was made for the comparison is given too (`None` if the model is too large for it).
    """
    from firmtouch.mechanics.symbolic import derive_symbolically

    # Overflow and 0/0 are no news to the user's terminal: the checks report what is not finite.
    with np.errstate(all="ignore"):
        subject = make_subject(model.spec) if at is None else subject_at(at)
        results = [check(subject) for check in CHECKS]
        symbolic = derive_symbolically(model.spec) if derivatives.worth_comparing(subject) else None
        results.append(derivatives.derivations_agree(subject, symbolic))
    return CheckReport(model.name, tuple(results)), symbolic
