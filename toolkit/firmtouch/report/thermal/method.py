"""How the numbers are computed: the equations, and where they are from."""

from __future__ import annotations

from collections.abc import Iterator

from firmtouch.report.document import Block, Equation, Math, Paragraph, Section
from firmtouch.thermal.analysis import Analysis


def section(analysis: Analysis) -> Section:
    """Write the method."""
    return Section("How it is computed", tuple(_blocks(analysis)))


def _blocks(analysis: Analysis) -> Iterator[Block]:
    yield from _layers()
    yield from _touch(analysis)
    yield Paragraph(
        (
            "Times are found by inverting these transforms numerically (Abate and Whitt's Euler method for loops, "
            "Talbot's contour for all others). A 10–90 % rise time is ",
            Math("t_90 - t_10"),
            " of the extremum in the window.",
        )
    )
    if analysis.discrimination or analysis.range:
        yield Paragraph(
            (
                "With the difference ",
                Math("D"),
                " of two signals at the samples, white noise ",
                Math("sigma"),
                ", and the columns of ",
                Math("G"),
                " for what a standard deviation of each unknown does to them:",
            )
        )
        yield Equation("d'^2 = D^T (sigma^2 I + G G^T)^(-1) D")


def _layers() -> Iterator[Block]:
    yield Paragraph(
        (
            "Heat flows in one dimension through the layers. Each takes temperature and flux from one face to the "
            "other exactly; films only store heat, joints only resist. All temperatures are deviations from the state "
            "before the touch.",
        )
    )
    yield Equation(
        'mat(delim: "[", theta_1; q_1) = mat(delim: "[", cosh x, sinh x slash (k g); k g sinh x, cosh x) '
        'mat(delim: "[", theta_2; q_2), quad g = sqrt(s slash alpha), quad x = g L',
        "Carslaw and Jaeger, 3.7",
    )
    yield Paragraph(
        (
            "So the impedance behind the touched face follows from the backing outward, layer by layer, with ",
            Math("tanh"),
            " alone, which does not overflow:",
        )
    )
    yield Equation('Z <- (Z + tanh(x) slash (k g)) / (1 + Z k g tanh(x)), quad Z_"object" = 1 / (e sqrt(s))')


def _touch(analysis: Analysis) -> Iterator[Block]:
    if analysis.sensor.pad is not None:
        yield Paragraph(
            (
                "A pad is a disc of radius ",
                Math("a"),
                " and area ",
                Math("A"),
                ", into which heat also flows from the sides:",
            )
        )
        yield Equation('1 slash Z_"object" = e sqrt(s) + 4 k slash (pi a)')
    yield Paragraph(
        (
            "The touch is a step of the temperature at the contact, which is a conductance ",
            Math("h"),
            " between both faces:",
        )
    )
    yield Equation('theta_"face" = Z / (Z + 1 slash h + Z_"object") (T_o - T_s) / s')
    if analysis.spectra.loops:
        yield Paragraph(
            (
                "A loop of the gain ",
                Math("K(s)"),
                " holds the sensed temperature by a heater, and needs the power ",
                Math("p"),
                ":",
            )
        )
        yield Equation(
            "p = - (K F T_c) / (1 + L) (T_o - T_s) / s, quad L = K Z_p F, quad F = e^(-s T_d) / (tau_s s + 1)"
        )
