"""What a sensor does: its signals, what it tells apart, its heat, what it reaches of what is asked, and what binds."""

from firmtouch.thermal.analysis.analyse import Analysis, ScenarioResponse, analyse
from firmtouch.thermal.analysis.binding import Binding, Relief
from firmtouch.thermal.analysis.crosstalk import Crosstalk
from firmtouch.thermal.analysis.felt import Felt, Grid, feel, loop_margin
from firmtouch.thermal.analysis.heat import Heat, Release, heat, hold_power, recovery_times, release
from firmtouch.thermal.analysis.outcomes import Outcome
from firmtouch.thermal.analysis.rational import RationalModel, rational_models
from firmtouch.thermal.analysis.spectra import LoopSpectrum, SignalSpectrum, Spectra, signal_transfer, spectra_of
from firmtouch.thermal.analysis.telling import Grade, Pair, grade, tell_pairs
from firmtouch.thermal.analysis.tolerances import Tolerance, Tolerances

__all__ = [
    "Analysis",
    "Binding",
    "Crosstalk",
    "Felt",
    "Grade",
    "Grid",
    "Heat",
    "LoopSpectrum",
    "Outcome",
    "Pair",
    "RationalModel",
    "Release",
    "Relief",
    "ScenarioResponse",
    "SignalSpectrum",
    "Spectra",
    "Tolerance",
    "Tolerances",
    "analyse",
    "feel",
    "grade",
    "heat",
    "hold_power",
    "loop_margin",
    "rational_models",
    "recovery_times",
    "release",
    "signal_transfer",
    "spectra_of",
    "tell_pairs",
]
