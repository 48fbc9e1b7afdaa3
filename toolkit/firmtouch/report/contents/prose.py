"""Plain sentences -> lines in which the paper's symbols are set as such."""

from __future__ import annotations

import re
from typing import Final

from firmtouch.report.document import Code, Line, Math, Span

_SYMBOLS: Final = {
    "q_d": "q_d",
    "lambda_d": "lambda_d",
    "f_d": "f_d",
    "G_f": "G_f",
    "M22 s^2 + N0_22": "M_22 s^2 + N_(0,22)",
    "Phi_j''": "Phi''_j",
    "P_qq": "P_(q q)",
    "P_q": "P_q",
    "J^T": "J^T",
    "s^2/2 q'^T M q'": "s^2 slash 2 dot(q)^T M dot(q)",
    "K(q, s q')": "K(q, s dot(q))",
    "LDL^T": "L D L^T",
    "I + G_f > 0": "I + G_f > 0",
    "g - J^T lambda_d": "g - J^T lambda_d",
    "ker J": "ker J",
    "K > mu I": "K > mu I",
    "K > mu D": "K > mu D",
    "C > 0": "C > 0",
    "W > 0": "W > 0",
    "K > 0": "K > 0",
    "M > 0": "M > 0",
    "Re s < -alpha": '"Re" s < -alpha',
    "-Re s / |s| > zeta": '-"Re" s slash |s| > zeta',
    "|s| < w": "|s| < w",
    "R^T R = I": "R^T R = I",
    "det R = 1": "det R = 1",
}
_NAME: Final = r"`(?P<name>[^`]+)`"
_PATTERN: Final = re.compile("|".join([_NAME, *map(re.escape, sorted(_SYMBOLS, key=len, reverse=True))]))


def prose(text: str) -> Line:
    """Set the symbols of a sentence, and what stands between backticks as names of a file."""
    spans: list[Span] = []
    at = 0
    for match in _PATTERN.finditer(text):
        name = match["name"]
        spans += [text[at : match.start()], Code(name) if name else Math(_SYMBOLS[match.group()])]
        at = match.end()
    spans.append(text[at:])
    return tuple(each for each in spans if each != "")
