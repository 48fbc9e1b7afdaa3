"""Many runs of one scenario with drawn starts, parameters and disturbances, held against what is proven."""

from firmtouch.montecarlo.draw import draw
from firmtouch.montecarlo.record import Label, Record
from firmtouch.montecarlo.sets import Sets, sets_of
from firmtouch.montecarlo.study import Study, build_study, run_labelled
from firmtouch.montecarlo.summary import Summary, clopper_pearson, summarise
from firmtouch.montecarlo.workers import run_all

__all__ = [
    "Label",
    "Record",
    "Sets",
    "Study",
    "Summary",
    "build_study",
    "clopper_pearson",
    "draw",
    "run_all",
    "run_labelled",
    "sets_of",
    "summarise",
]
