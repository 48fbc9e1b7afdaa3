"""Resistances that tell a temperature: oxides that fall with it (NTC), and metals that rise (RTD).

Each gives R(T) in ohm, its inverse, and the temperature coefficient alpha_R = (dR/dT)/R in 1/K. Temperatures are in K,
and all of these take arrays of any shape.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from firmtouch.thermal.arrays import Array, ThermalValueError, require_positive

ROOM = 298.15
"""K: where a resistance is told, if nothing else is said."""

Point = tuple[float, float]
"""A temperature (K) and the resistance (ohm) measured there."""


def _refuse_first(name: str, values: Array, fine: NDArray[np.bool_], expected: str) -> None:
    if not fine.all():
        raise ThermalValueError(name, float(values[~fine][0]), expected)


def _positive(name: str, given: ArrayLike) -> Array:
    values = np.asarray(given, dtype=np.float64)
    _refuse_first(name, values, np.isfinite(values) & (values > 0), "a positive number")
    return values


def _exp_at(log_R: Array, T: Array) -> Array:
    """Give exp(ln R), and refuse temperatures so near to zero that it is no number."""
    with np.errstate(over="ignore", under="ignore"):
        R: Array = np.exp(log_R)
    _refuse_first("temperature", T, np.isfinite(R) & (R > 0), "one at which the resistance is a positive number")
    return R


@dataclass(frozen=True, slots=True)
class NTC:
    """An oxide with one constant B (K): R = R25 exp(B (1/T - 1/T25)); R25 (ohm) is its resistance `at` T25 (K)."""

    R25: float
    B: float
    at: float = ROOM

    def __post_init__(self) -> None:
        require_positive(R25=self.R25, B=self.B, reference_temperature=self.at)

    def resistance(self, T: ArrayLike) -> Array:
        """Give R (ohm).

        Raises
        ------
        ThermalValueError
            If a temperature is not positive, or so low that R is no number.
        """
        T = _positive("temperature", T)
        return _exp_at(np.asarray(math.log(self.R25) + self.B * (1 / T - 1 / self.at)), T)

    def temperature(self, R: ArrayLike) -> Array:
        """Give T (K) from 1/T = 1/T25 + ln(R/R25)/B.

        Raises
        ------
        ThermalValueError
            If a resistance is not positive, or not above R25 exp(-B/T25), which it has at infinite temperature.
        """
        R = _positive("resistance", R)
        inverse = np.asarray(1 / self.at + (np.log(R) - math.log(self.R25)) / self.B)
        _refuse_first("resistance", R, inverse > 0, "above R25 exp(-B/T25), what it has at infinite temperature")
        return np.asarray(1 / inverse)

    def coefficient(self, T: ArrayLike) -> Array:
        """Give alpha_R = -B/T^2 (1/K).

        Raises
        ------
        ThermalValueError
            If a temperature is not positive.
        """
        return np.asarray(-self.B / _positive("temperature", T) ** 2)


@dataclass(frozen=True, slots=True)
class SteinhartHart:
    """An oxide by 1/T = a + b ln R + c ln^3 R, with R in ohm (Steinhart and Hart, Deep-Sea Res. 15 (1968) 497).

    b is positive: with another b no part of the curve, or two parts of it, would fall. A negative c makes the curve
    fall only where |ln R| < sqrt(b / (3 |c|)); what is outside of there is refused.
    """

    a: float
    b: float
    c: float

    def __post_init__(self) -> None:
        require_positive(b=self.b)
        for name, value in (("a", self.a), ("c", self.c)):
            if not math.isfinite(value):
                raise ThermalValueError(name, value, "a finite number")

    @classmethod
    def through(cls, points: tuple[Point, Point, Point]) -> SteinhartHart:
        """Give the curve through three points (T, R), by divided differences of 1/T over ln R.

        Raises
        ------
        ThermalValueError
            If a size is not positive, two points have the same resistance, the three ln R sum to zero (then c has no
            influence on the differences), or the curve does not fall at all three.
        """
        for T, R in points:
            require_positive(temperature=T, resistance=R)
        (y1, x1), (y2, x2), (y3, x3) = ((1 / T, math.log(R)) for T, R in points)
        for first, second, R in ((x1, x2, points[1][1]), (x1, x3, points[2][1]), (x2, x3, points[2][1])):
            if first == second:
                raise ThermalValueError("resistance", R, "another at each of the three points")
        if x1 + x2 + x3 == 0:
            raise ThermalValueError("sum of ln R", 0.0, "other than zero: give the resistances in ohm")
        slope2, slope3 = (y2 - y1) / (x2 - x1), (y3 - y1) / (x3 - x1)
        c = (slope3 - slope2) / ((x3 - x2) * (x1 + x2 + x3))
        b = slope2 - c * (x1**2 + x1 * x2 + x2**2)
        found = cls(y1 - (b + c * x1**2) * x1, b, c)
        found.temperature([R for _, R in points])  # refuses where it does not fall
        return found

    def _log(self, T: Array) -> Array:
        """Give x = ln R, the root of c x^3 + b x = 1/T - a on the part that falls, by Cardano's formula.

        With w = sqrt(3 |c|/b) and d = 3 w (1/T - a)/(2 b) it is x = (2/w) sinh(arsinh(d)/3), as sinh 3u = 3 sinh u +
        4 sinh^3 u; for c < 0 the same with sin. So written nothing cancels, and a small c leaves (1/T - a)/b.
        """
        rest = np.asarray((1 / T - self.a) / self.b)
        w = math.sqrt(3 * abs(self.c) / self.b)
        if w == 0:
            return rest
        d = 1.5 * w * rest
        if self.c > 0:
            return np.asarray(2 / w * np.sinh(np.arcsinh(d) / 3))
        _refuse_first("temperature", T, np.abs(d) < 1, "one at which R(T) falls, which this curve does not everywhere")
        return np.asarray(2 / w * np.sin(np.arcsin(d) / 3))

    def resistance(self, T: ArrayLike) -> Array:
        """Give R (ohm), exactly.

        Raises
        ------
        ThermalValueError
            If a temperature is not positive, the curve does not fall there, or R is no number.
        """
        T = _positive("temperature", T)
        return _exp_at(self._log(T), T)

    def temperature(self, R: ArrayLike) -> Array:
        """Give T (K).

        Raises
        ------
        ThermalValueError
            If a resistance is not positive, or one at which the curve has no temperature or does not fall.
        """
        R = _positive("resistance", R)
        x = np.log(R)
        inverse = np.asarray(self.a + (self.b + self.c * x**2) * x)
        fine = (inverse > 0) & (self.b + 3 * self.c * x**2 > 0)
        _refuse_first("resistance", R, fine, "one at which the curve has a positive temperature and falls")
        return np.asarray(1 / inverse)

    def coefficient(self, T: ArrayLike) -> Array:
        """Give alpha_R = -1/(T^2 (b + 3 c ln^2 R)) (1/K).

        Raises
        ------
        ThermalValueError
            If a temperature is not positive, or the curve does not fall there.
        """
        T = _positive("temperature", T)
        return np.asarray(-1 / (T**2 * (self.b + 3 * self.c * self._log(T) ** 2)))


@dataclass(frozen=True, slots=True)
class RTD:
    """A metal: R = R0 (1 + alpha (T - at)); R0 (ohm) and alpha (1/K) are those `at` a temperature (K).

    A Pt100 is told at 273.15 K; at 25 degrees its coefficient is 0.351 %/K, and no longer 0.385.
    """

    R0: float
    alpha: float
    at: float = ROOM

    def __post_init__(self) -> None:
        require_positive(R0=self.R0, alpha=self.alpha, reference_temperature=self.at)

    def _ratio(self, T: ArrayLike) -> Array:
        T = _positive("temperature", T)
        ratio = np.asarray(1 + self.alpha * (T - self.at))
        _refuse_first("temperature", T, ratio > 0, f"above {self.at - 1 / self.alpha:g} K, where this line has no R")
        return ratio

    def resistance(self, T: ArrayLike) -> Array:
        """Give R (ohm).

        Raises
        ------
        ThermalValueError
            If a temperature is not positive, or R would not be.
        """
        return np.asarray(self.R0 * self._ratio(T))

    def temperature(self, R: ArrayLike) -> Array:
        """Give T (K).

        Raises
        ------
        ThermalValueError
            If a resistance, or its temperature, is not positive.
        """
        R = _positive("resistance", R)
        T = np.asarray(self.at + (R / self.R0 - 1) / self.alpha)
        _refuse_first("resistance", R, T > 0, "one that it has above 0 K")
        return T

    def coefficient(self, T: ArrayLike) -> Array:
        """Give alpha_R = alpha/(1 + alpha (T - at)) (1/K).

        Raises
        ------
        ThermalValueError
            If a temperature is not positive, or R would not be.
        """
        return np.asarray(self.alpha / self._ratio(T))


Thermometer = NTC | SteinhartHart | RTD
"""What a temperature is read with."""
