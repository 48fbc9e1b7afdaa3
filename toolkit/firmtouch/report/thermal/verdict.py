"""The verdict of a thermal study in one sentence, for reports and for the terminal."""

from __future__ import annotations

from typing import Final

from firmtouch.report.thermal.words import enumerated, outcome_words, place_words, quantity, requirement_words
from firmtouch.thermal.analysis import Analysis, Outcome
from firmtouch.thermal.study import Study

TOLD: Final = 3
"""Requirements that are told of where all are missed."""


def study_verdict(study: Study) -> str:
    """Say what was found, in one sentence."""
    analysis, search = study.analysis, study.search
    if not analysis.outcomes:
        return f"Nothing is asked of this sensor: {_fastest(analysis)}."
    missed = [each for each in analysis.outcomes if not each.met]
    count = len(analysis.outcomes)
    if not missed:
        which = "the only requirement is met" if count == 1 else f"all {count} requirements are met"
        of = ""
        if search is not None and search.found:
            of = f"{search.met} of {search.tried} designs that were tried meet everything, and in the best of them "
        text = f"{of}{which}: {_least_spare(analysis)}"
        return f"{text[0].upper()}{text[1:]}."
    told = enumerated(_told(each, analysis) for each in missed[:TOLD])
    more = f", and {len(missed) - TOLD} more" if len(missed) > TOLD else ""
    which = f"{len(missed)} of {count} requirements {'is' if len(missed) == 1 else 'are'} missed"
    if count == 1:
        which = "the only requirement is missed"
    if search is not None and not search.found:
        start = f"None of the {search.tried} designs that were tried meets everything; in the nearest {which}"
    else:
        start = f"Not met: {which}"
    return f"{start}: {told}{more}{_binds(analysis)}."


def _fastest(analysis: Analysis) -> str:
    own = [each for each in analysis.responses if each.drive == analysis.sensor.drive.mode]
    worst = max(own, key=lambda each: each.rise_10_90)
    return f"its slowest 10–90 % rise time is {quantity(worst.rise_10_90, 's')} ({place_words(worst.scenario.words)})"


def _least_spare(analysis: Analysis) -> str:
    """Tell the rise time, where it is asked for, or else the first requirement."""
    first = next((each for each in analysis.outcomes if each.name == "rise_time"), analysis.outcomes[0])
    return _told(first, analysis)


def _told(outcome: Outcome, analysis: Analysis) -> str:
    words = requirement_words(outcome, analysis.spec)
    at = f" ({place_words(outcome.where)})" if outcome.where else ""
    bound = f"{'at most' if outcome.at_most else 'at least'} {outcome_words(outcome, outcome.asked)}"
    asked = f", {bound} being asked" if outcome.met else f" instead of {bound}"
    return f"the {words} is {outcome_words(outcome, outcome.reached)}{at}{asked}"


def _binds(analysis: Analysis) -> str:
    binding = analysis.binding
    if binding is None:
        return ""
    together = not binding.alone and len(binding.together) > 1
    terms = [each.term for each in (binding.together if together else binding.alone)]
    if together:
        return f"; {enumerated(terms)} bind together"
    return f"; what binds is {terms[0] if terms else 'what is touched'}"
