"""What the thermal side computes with, and the refusals that its values share."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from firmtouch.errors import InputError

Array = NDArray[np.floating[Any]]
Complex = NDArray[np.complexfloating[Any, Any]]

Transfer = Callable[[Complex], Complex]
"""A function of the Laplace variable s (1/s), of arrays of any shape."""

Response = Callable[[Array], Array]
"""A function of time (s), of arrays of any shape."""


class ThermalValueError(InputError):
    """A size that no thing has; `name` and `value` tell which."""

    def __init__(self, name: str, value: float, expected: str) -> None:
        self.name, self.value = name, value
        super().__init__(f"{name} is {value:g}, but must be {expected}")


def require_positive(**sizes: float) -> None:
    """Refuse what is not a positive finite number.

    Raises
    ------
    ThermalValueError
        Of the first such size.
    """
    for name, value in sizes.items():
        if not (math.isfinite(value) and value > 0):
            raise ThermalValueError(name.replace("_", " "), value, "a positive number")


def require_conductance(value: float, name: str = "contact conductance") -> None:
    """Refuse a conductance that is not positive; an infinite one is a perfect contact.

    Raises
    ------
    ThermalValueError
        If it is not positive.
    """
    if math.isnan(value) or value <= 0:
        raise ThermalValueError(name, value, "positive (`inf` is a perfect contact)")


def require_thickness(value: float) -> None:
    """Refuse a plate's thickness that is not positive; an infinite one is a half-space.

    Raises
    ------
    ThermalValueError
        If it is not positive.
    """
    if math.isnan(value) or value <= 0:
        raise ThermalValueError("thickness", value, "positive (`inf` is a half-space)")


def require_times(t: ArrayLike) -> Array:
    """Give times as an array.

    Raises
    ------
    ThermalValueError
        Of the least, if it is not positive.
    """
    times = np.asarray(t, dtype=np.float64)
    if times.size and not (np.isfinite(times).all() and times.min() > 0):
        raise ThermalValueError("time", float(times.min()), "positive and finite")
    return times
