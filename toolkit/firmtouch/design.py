"""The walk from a model file to a finished design: each step one public function, the result one value."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from firmtouch.certificate.certificate import Certificate, certify
from firmtouch.certificate.subject import subject_of
from firmtouch.certificate.witness import Multipliers, Witness
from firmtouch.checks import CheckReport, check_model
from firmtouch.errors import InputError, NoDesignError
from firmtouch.mechanics import Scene, derive_plant, draw_scene
from firmtouch.mechanics.symbolic import SymbolicPlant
from firmtouch.modelfile import ModelFile
from firmtouch.regulation import ClosedLoop, OperatingPoint, SteadyState, find_operating_point, steady_state_errors
from firmtouch.regulation.closed_loop import match_poles, pole_distance
from firmtouch.regulation.force_loop import ForceLoop, analyse_force_loop, with_chosen_force_feedback
from firmtouch.regulation.force_loop.warnings import force_warnings
from firmtouch.regulation.projection import OffSurfaceError, project
from firmtouch.regulation.uncertainty import IndefiniteInertiaError
from firmtouch.simulation.trial import Trial, try_out
from firmtouch.synthesis import assign_poles
from firmtouch.synthesis.pole_assignment import requested_poles

if TYPE_CHECKING:
    from firmtouch.certificate.attraction.comparison import Comparison
    from firmtouch.certificate.attraction.finding import Finding
    from firmtouch.synthesis.region import RegionDesign

FAR: Final = 0.3
"""A projection that moves the guess further than this (rad or m) deserves a word."""
ILL_CONDITIONED: Final = 1e4
GHOST: Final = 0.22
"""How far along a free direction the ghosts of the picture stand, in rad or m."""
MOST_GHOST_DIRECTIONS: Final = 2
MOST_DRAWN: Final = 2
"""Free directions up to which the region of attraction is drawn, and simulated for comparison."""


@dataclass(frozen=True, slots=True)
class Design:
    """A checked design: all that the reports and `design.json` tell.

    `surroundings` is None until they are looked at, and `trial` until the loop is tried out in simulation.
    `requested` is empty, and `residual` zero, for a region design, which asks for no particular poles; `region` holds
    what it does ask for, and is None for a pole assignment. `model` holds numbers where the file left G_f to be chosen.
    """

    model: ModelFile
    loop: ClosedLoop
    requested: tuple[complex, ...]
    achieved: tuple[complex, ...]
    residual: float
    steady_state: SteadyState
    checks: CheckReport
    symbolic: SymbolicPlant | None
    scene: Scene | None
    region: RegionDesign | None
    force_loop: ForceLoop
    certificate: Certificate
    surroundings: Surroundings | None
    trial: Trial | None
    warnings: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Surroundings:
    """How far and how fast the mechanism may start [T10], and, for n - m <= 2, what simulation finds beside it."""

    finding: Finding
    comparison: Comparison | None


class ChecksFailedError(NoDesignError):
    """The model is not what it says it is, so no promise about its gains would hold."""

    def __init__(self, report: CheckReport) -> None:
        self.report = report
        reasons = "; ".join(
            f"{each.name} ({each.figure:.3g}, must be {each.relation} {each.bound:g}): {each.detail}"
            for each in report.failed
        )
        super().__init__(f"the model fails its checks: {reasons}; `firmtouch check` tells more")


@dataclass(frozen=True, slots=True)
class FoundGains:
    """Gains as a method found them, in their loop; see `Design` for the other fields."""

    model: ModelFile
    loop: ClosedLoop
    requested: tuple[complex, ...]
    achieved: tuple[complex, ...]
    region: RegionDesign | None


def find_gains(
    model: ModelFile,
    progress: Callable[[str], None] = lambda _: None,
    *,
    front: tuple[str, str] | None = None,
) -> FoundGains:
    """Find the gains alone, by the method that the file names, without proofs or checks of the model.

    Raises
    ------
    NoDesignError
        If there are none.
    InputError
        If the file's intervals or objectives make no sense for the mechanism.
    """
    model = replace(model, spec=with_chosen_force_feedback(model.spec))
    progress("deriving the mechanics")
    op = find_operating_point(derive_plant(model.spec))
    if model.spec.design.method == "region":
        region = _design_region(op, model, front, progress)
        return FoundGains(model, region.loop, (), region.loop.poles.pencil, region)
    if front is not None:
        raise InputError("a front weighs objectives of region designs; this one assigns poles (`--method region`)")
    progress("assigning the poles")
    loop = assign_poles(op, model.spec.design)
    requested = requested_poles(model.spec.design)
    return FoundGains(model, loop, requested, match_poles(loop.poles.pencil, requested), None)


def design_model(
    model: ModelFile,
    progress: Callable[[str], None] = lambda _: None,
    *,
    front: tuple[str, str] | None = None,
) -> Design:
    """Design, analyse and check; `progress` is told what is being done, `front` names two objectives to weigh.

    Raises
    ------
    NoDesignError
        If there is no such design, or the model fails its checks.
    InputError
        If the file's intervals or objectives make no sense for the mechanism.
    """
    found = find_gains(model, progress, front=front)
    model, loop, region = found.model, found.loop, found.region
    spec = model.spec
    op = loop.operating_point
    progress("checking the model")
    checks, symbolic = check_model(model, at=op)
    if not checks.holds:
        raise ChecksFailedError(checks)
    progress("looking at the force loop")
    force_loop = analyse_force_loop(loop, spec)
    progress("proving the claims")
    certificate = certify(subject_of(op, loop.gains, _witness(region)))
    return Design(
        model=model,
        loop=loop,
        requested=found.requested,
        achieved=found.achieved,
        residual=pole_distance(found.achieved, found.requested) if found.requested else 0.0,
        steady_state=steady_state_errors(loop, spec.bounds),
        checks=checks,
        symbolic=symbolic,
        scene=_scene(loop),
        region=region,
        force_loop=force_loop,
        certificate=certificate,
        surroundings=None,
        trial=None,
        warnings=(
            *_warnings(loop),
            *force_warnings(force_loop),
            *(_search_warnings(region) if region is not None else ()),
            *(f"Not proven: {each.words} ({each.verdict.value})." for each in certificate.open),
        ),
    )


def look_around_design(design: Design) -> Design:
    """Add the region of attraction to a design."""
    from firmtouch.certificate.attraction.comparison import compare_attraction
    from firmtouch.certificate.attraction.finding import look_around

    finding = look_around(design.loop)
    drawn = finding.attraction is not None and finding.attraction.chart.free <= MOST_DRAWN
    comparison = compare_attraction(design.loop, finding.attraction) if drawn and finding.attraction else None
    return replace(design, surroundings=Surroundings(finding, comparison))


def try_out_design(design: Design) -> Design:
    """Add simulations of the nonlinear closed loop to a design, and warn of those that went wrong."""
    trial = try_out(design.loop, design.steady_state)
    bad = [each.trajectory for each in trial.runs if not each.trajectory.outcome.good]
    warnings = tuple(f"Simulated, “{each.scenario.title}” {each.reason}." for each in bad)
    return replace(design, trial=trial, warnings=(*design.warnings, *warnings))


def _design_region(
    op: OperatingPoint, model: ModelFile, front: tuple[str, str] | None, progress: Callable[[str], None]
) -> RegionDesign:
    """Search for gains; cvxpy takes a second to load, so it is loaded for those who need it."""
    from firmtouch.synthesis.region import design_region
    from firmtouch.synthesis.region.front import pareto_front

    progress("searching for gains")
    try:
        found = design_region(op, model.spec, progress)
    except IndefiniteInertiaError as error:
        raise model.mistake(str(error), *(("parameters", name, "interval") for name in error.parameters)) from error
    if front is None:
        return found
    progress("drawing the front")
    return replace(found, front=pareto_front(found.problem, model.spec, *front))


def _witness(region: RegionDesign | None) -> Witness:
    """Hand over what the search found beside the gains, for a proof to begin from."""
    evidence = region.evidence if region is not None else None
    if region is None or evidence is None:
        return Witness()
    scaling = region.problem.scaling
    multipliers = {
        name: Multipliers(each.F, each.P, scaling.T, scaling.omega) for name, each in evidence.multipliers.items()
    }
    return Witness(evidence.epsilon, multipliers)


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


def _search_warnings(region: RegionDesign) -> tuple[str, ...]:
    """Say where the search did not end as one would wish."""
    from firmtouch.synthesis.region.programme import Status

    stages = {
        "fewer edges": "gains found for one edge of the region less keep it all the same",
        "poles": "assigning one pair of poles to all free directions reached the region all the same",
        "alternation": "turns between the gains and general Lyapunov matrices found these gains all the same; they are "
        "some that do, and not the best ones",
        "descent": "a local search on the poles, and proofs for what it found, gave these gains all the same; they are "
        "some that do, and not the best ones",
    }
    warnings = []
    if region.search.stage in stages:
        found = stages[region.search.stage]
        warnings.append(f"The convex search [T4], sufficient and not necessary, found no gains; {found}.")
    elif region.search.status is Status.ALMOST:
        warnings.append("The solver came close to its tolerances only; the gains passed every check from their values.")
    return tuple(warnings)
