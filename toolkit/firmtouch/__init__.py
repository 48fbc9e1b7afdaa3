"""firmtouch: position and contact-force regulation of constrained mechanisms.

The walk from a model file to a report, each step a function from value to value:

    read_model -> derive_plant -> find_operating_point -> assign_poles -> steady_state_errors -> design_model
                                                                       -> usual_scenarios -> simulate

and that from a sensor file to what a fingertip feels: read_sensor -> study_sensor.

Names are loaded when they are first used, so that importing the package costs nothing.
"""

from __future__ import annotations

from firmtouch.lazy_names import loader

TYPE_CHECKING = False  # type checkers take it as true; `typing` itself would cost a third of the start

if TYPE_CHECKING:
    from typing import Final

    from firmtouch.certificate.certificate import Certificate, certify
    from firmtouch.certificate.subject import Subject, subject_of
    from firmtouch.checks import CheckReport, check_model
    from firmtouch.design import Design, design_model
    from firmtouch.errors import Diagnostic, FirmtouchError, InputError, ModelFileError, NoDesignError
    from firmtouch.mechanics import Plant, derive_plant
    from firmtouch.modelfile import ModelFile, ModelSpec, parse_model, parse_scenarios, read_model, read_scenarios
    from firmtouch.regulation import (
        ClosedLoop,
        Gains,
        OperatingPoint,
        SteadyState,
        close_loop,
        find_operating_point,
        steady_state_errors,
    )
    from firmtouch.simulation import Scenario, Trajectory, predict, scenarios_of, simulate, try_out, usual_scenarios
    from firmtouch.synthesis import assign_poles
    from firmtouch.synthesis.region import NoGainsError, RegionDesign, design_region
    from firmtouch.thermal.sensorfile import SensorFile, parse_sensor, read_sensor
    from firmtouch.thermal.study import Study, study_sensor

_HOMES: Final = {
    "certificate.certificate": ("Certificate", "certify"),
    "certificate.subject": ("Subject", "subject_of"),
    "checks": ("CheckReport", "check_model"),
    "design": ("Design", "design_model"),
    "errors": ("Diagnostic", "FirmtouchError", "InputError", "ModelFileError", "NoDesignError"),
    "mechanics": ("Plant", "derive_plant"),
    "modelfile": ("ModelFile", "ModelSpec", "parse_model", "parse_scenarios", "read_model", "read_scenarios"),
    "regulation": (
        "ClosedLoop",
        "Gains",
        "OperatingPoint",
        "SteadyState",
        "close_loop",
        "find_operating_point",
        "steady_state_errors",
    ),
    "simulation": (
        "Scenario",
        "Trajectory",
        "predict",
        "scenarios_of",
        "simulate",
        "try_out",
        "usual_scenarios",
    ),
    "synthesis": ("assign_poles",),
    "synthesis.region": ("NoGainsError", "RegionDesign", "design_region"),
    "thermal.sensorfile": ("SensorFile", "parse_sensor", "read_sensor"),
    "thermal.study": ("Study", "study_sensor"),
}
_HOME_OF: Final = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "Certificate",
    "CheckReport",
    "ClosedLoop",
    "Design",
    "Diagnostic",
    "FirmtouchError",
    "Gains",
    "InputError",
    "ModelFile",
    "ModelFileError",
    "ModelSpec",
    "NoDesignError",
    "NoGainsError",
    "OperatingPoint",
    "Plant",
    "RegionDesign",
    "Scenario",
    "SensorFile",
    "SteadyState",
    "Study",
    "Subject",
    "Trajectory",
    "assign_poles",
    "certify",
    "check_model",
    "close_loop",
    "derive_plant",
    "design_model",
    "design_region",
    "find_operating_point",
    "parse_model",
    "parse_scenarios",
    "parse_sensor",
    "predict",
    "read_model",
    "read_scenarios",
    "read_sensor",
    "scenarios_of",
    "simulate",
    "steady_state_errors",
    "study_sensor",
    "subject_of",
    "try_out",
    "usual_scenarios",
]

__getattr__ = loader(__name__, _HOME_OF)


def __dir__() -> list[str]:
    return __all__
