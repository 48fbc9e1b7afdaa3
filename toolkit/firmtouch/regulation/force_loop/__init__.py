"""The loop of the force feedback: the sensor's path [T8], contact that is not rigid [T9]."""

from firmtouch.regulation.force_loop.analysis import AskedMargin, ForceLoop, RealContact, analyse_force_loop
from firmtouch.regulation.force_loop.as_control import as_control_system
from firmtouch.regulation.force_loop.choice import force_feedback_of, with_chosen_force_feedback
from firmtouch.regulation.force_loop.contact import DelayTooLongError
from firmtouch.regulation.force_loop.margins import LoopMargins, admissible_gain, loop_margins, stability_bound
from firmtouch.regulation.force_loop.path import ForcePath, force_path_of
from firmtouch.regulation.force_loop.sweep import (
    ContactPoles,
    Span,
    StiffnessSweep,
    contact_stiffness_sweep,
    critical_feedback,
    poles_in_contact,
)

__all__ = [
    "AskedMargin",
    "ContactPoles",
    "DelayTooLongError",
    "ForceLoop",
    "ForcePath",
    "LoopMargins",
    "RealContact",
    "Span",
    "StiffnessSweep",
    "admissible_gain",
    "analyse_force_loop",
    "as_control_system",
    "contact_stiffness_sweep",
    "critical_feedback",
    "force_feedback_of",
    "force_path_of",
    "loop_margins",
    "poles_in_contact",
    "stability_bound",
    "with_chosen_force_feedback",
]
