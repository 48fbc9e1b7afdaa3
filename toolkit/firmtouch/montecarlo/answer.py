"""`montecarlo.json`, schema `firmtouch.montecarlo/1`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from firmtouch.montecarlo.draw import draw, generator
from firmtouch.montecarlo.proven import start_inside
from firmtouch.montecarlo.question import plain
from firmtouch.montecarlo.record import Label, Record, record_as_json
from firmtouch.montecarlo.study import Study
from firmtouch.montecarlo.summary import CONFIDENCE, Summary
from firmtouch.simulation.scenario import Scenario

SCHEMA: Final = "firmtouch.montecarlo/1"


def answer_as_json(
    study: Study, question: Mapping[str, Any], summary: Summary, *, at_least: float | None
) -> dict[str, Any]:
    """Give the summary as plain data for JSON; the worst runs with what was drawn for them."""
    return {
        "schema": SCHEMA,
        "question": dict(question),
        "runs": summary.runs,
        "off_surface": summary.off_surface,
        "converged": summary.converged,
        "fraction": summary.fraction,
        "interval": list(summary.interval),
        "confidence": CONFIDENCE,
        "at_least": at_least,
        "outcomes": summary.counts,
        "worst": {each.figure: [_with_draw(study, record) for record in each.records] for each in summary.worst},
        "inside": {
            "runs": summary.inside,
            "contradictions": [_with_draw(study, each) for each in summary.contradictions],
            "pulled": summary.pulled,
        },
    }


def drawn_scenario(study: Study, label: Label) -> Scenario:
    """Draw a run again, without running it."""
    rng, op = generator(study.seed, label), study.loop.operating_point
    return draw(op, study.base, study.sets, rng)


def drawn_as_json(study: Study, label: Label) -> dict[str, Any]:
    """Tell what is drawn for a run: its start before it is put onto the surface, and its world, in SI."""
    if label.proven:
        region = study.regions[(label.number - 1) % len(study.regions)]
        start, _ = start_inside(study.loop, region, generator(study.seed, label))
        return {"start": plain(start)}
    scenario = drawn_scenario(study, label)
    names = list(study.loop.operating_point.plant.spec.parameters)
    p = scenario.world.p
    return {
        "start": plain(scenario.start),
        "parameters": {name: float(p[names.index(name)]) for name in study.sets.parameters},
        "d": plain(scenario.world.disturbances[-1].d)
        if len(scenario.world.disturbances) > len(study.base.world.disturbances)
        else None,
        "Delta": plain(scenario.world.Delta),
        "R": plain(scenario.world.R),
        "E": plain(scenario.world.E),
    }


def _with_draw(study: Study, record: Record) -> dict[str, Any]:
    return record_as_json(record) | {"drawn": drawn_as_json(study, record.label)}
