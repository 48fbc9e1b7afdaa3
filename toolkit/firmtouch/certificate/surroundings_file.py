"""The part of `certificate.json` about the region of attraction [T10]: written, read, and proven again."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Final

import numpy as np
from pydantic import Field

from firmtouch.certificate.attraction import (
    Attraction,
    Chart,
    NotProvenError,
    Search,
    WholeBox,
    prove_attraction,
    prove_whole_box,
)
from firmtouch.certificate.attraction.finding import Finding
from firmtouch.certificate.numbers import Number, Part, Rows, hexadecimal, matrix
from firmtouch.regulation import ClosedLoop

SAFE: Final = 1 - 1e-6
"""Figures are written a little smaller than they were found, so that another machine proves them too."""
MOST_CELLS: Final = 20_000
"""A file that asks for more is not believed to be one of ours."""
Positive = Annotated[Number, Field(gt=0)]


class AttractionPart(Part):
    """A level of V on the surface around q_d, where its proof begins from, and what follows from it."""

    V1: Rows
    V2: Rows
    half_widths: list[Positive]
    most_cells: Annotated[int, Field(gt=0, le=MOST_CELLS)]
    units: list[Positive]
    level: Positive
    distance: Number
    speed: Number
    speed_of_joints: Number
    distance_together: Number
    speed_together: Number


class BoxPart(Part):
    """A box of joint coordinates in which q* is the only equilibrium, and V >= level on its edge."""

    half_width: Positive
    level: Positive
    units: list[Positive]


class SurroundingsPart(Part):
    """What is proven about the surroundings of q_d."""

    attraction: AttractionPart | None
    box: BoxPart | None


def surroundings_as_json(finding: Finding) -> dict[str, Any]:
    """Give what is proven as plain data for JSON; boxes of more than three joints are left out."""
    box = finding.box
    return {
        "attraction": None if finding.attraction is None else _attraction(finding.attraction),
        "box": {
            "half_width": hexadecimal(box.half_width),
            "level": hexadecimal(box.level * SAFE),
            "units": hexadecimal(box.units),
        }
        if isinstance(box, WholeBox)
        else None,
    }


def _attraction(found: Attraction) -> dict[str, Any]:
    return {
        "V1": hexadecimal(found.chart.V1),
        "V2": hexadecimal(found.chart.V2),
        "half_widths": hexadecimal(found.search.half_widths),
        "most_cells": found.search.most_cells,
        "units": hexadecimal(found.units),
        "level": hexadecimal(found.level * SAFE),
        **{name: hexadecimal(value * SAFE) for name, value in _figures(found).items()},
    }


def _figures(found: Attraction) -> dict[str, float]:
    """Name the figures that follow from a level."""
    return {
        "distance": found.distance,
        "speed": found.speeds.norm,
        "speed_of_joints": found.speeds.all_joints,
        "distance_together": found.together.distance,
        "speed_together": found.together.speed,
    }


def disproven(part: SurroundingsPart, loop: ClosedLoop) -> Iterator[str]:
    """Prove the figures again, and say which of them are not."""
    if part.attraction is not None:
        yield from _against_attraction(part.attraction, loop)
    if part.box is not None:
        if len(part.box.units) != loop.operating_point.n:
            yield "the box of joint coordinates does not fit this model"
            return
        try:
            found = prove_whole_box(loop, part.box.half_width, units=part.box.units)
        except NotProvenError as error:
            yield f"the box of joint coordinates: {error}"
        else:
            if found.level < part.box.level:
                yield f"the box of joint coordinates: the level {part.box.level:.6g} J is not proven"


def _against_attraction(told: AttractionPart, loop: ClosedLoop) -> Iterator[str]:
    op = loop.operating_point
    V1, V2 = matrix(told.V1), matrix(told.V2)
    fits = V1.shape == (op.n, op.m) and V2.shape == (op.n, op.n - op.m)
    if not fits or (len(told.half_widths), len(told.units)) != (op.n - op.m, op.n):
        yield "the region of attraction does not fit this model"
        return
    search = Search(tuple(told.half_widths), told.most_cells)
    try:
        found = prove_attraction(loop, Chart(op.q_d, V1, V2), search, told.level, units=told.units)
    except (NotProvenError, ValueError, ZeroDivisionError, np.linalg.LinAlgError) as error:
        yield f"the region of attraction: {error}"
        return
    for name, value in _figures(found).items():
        if not getattr(told, name) <= value:
            yield f"the region of attraction: {name.replace('_', ' ')} {getattr(told, name):.6g} is not proven"
