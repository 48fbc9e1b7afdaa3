"""`force_feedback: auto`: the largest G_f = g I with the margins of the file's force path."""

from __future__ import annotations

import numpy as np

from firmtouch.errors import InputError
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.modelfile import ModelSpec
from firmtouch.modelfile.sections.design import DesignSpec
from firmtouch.modelfile.sections.force_path import USUAL_MARGINS
from firmtouch.regulation.force_loop.margins import admissible_gain
from firmtouch.regulation.force_loop.path import force_path_of


def with_chosen_force_feedback(spec: ModelSpec) -> ModelSpec:
    """Put numbers where the file leaves them to the force path; any other specification is given back as it is.

    - `force_feedback: auto` becomes the largest g I with the margins asked for (without any: a gain margin of 2 and a
      modulus margin of 0.5, which are then asked). Where the region has a `force_feedback_limit`, g keeps to it.
    - a `region` without `force_feedback_limit` gets that same g as its limit, if there is one.

    All sensors are alike, and so are the loops: one g for all constraints.
    """
    path, given, design = force_path_of(spec), spec.force_path, spec.design
    if path is None or given is None:
        return spec
    admissible, limit = admissible_gain(path, given.margins or USUAL_MARGINS), None
    region = design.region
    if region is not None:
        limit = region.force_feedback_limit
        if limit is None and np.isfinite(admissible):
            limit = (admissible,) * spec.m
            region = region.model_copy(update={"force_feedback_limit": limit})
    if design.force_feedback == "auto":
        g = min((admissible, *(limit or ())))
        matrix = tuple(tuple(float(each) for each in row) for row in g * np.eye(spec.m))
        design = design.model_copy(update={"force_feedback": matrix})
        given = given.model_copy(update={"margins": given.margins or USUAL_MARGINS})
    return spec.model_copy(update={"design": design.model_copy(update={"region": region}), "force_path": given})


def force_feedback_of(design: DesignSpec) -> Array:
    """Give G_f (m x m) of a design.

    Raises
    ------
    InputError
        If it is still to be chosen.
    """
    if design.force_feedback == "auto":
        raise InputError(
            "`force_feedback: auto` is not chosen yet: use `with_chosen_force_feedback(spec)` of "
            "firmtouch.regulation.force_loop, and design from what it gives"
        )
    return frozen(design.force_feedback)
