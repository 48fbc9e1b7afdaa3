"""`OperatingPoint` + what is asked for -> `Gains`."""

from firmtouch.synthesis.pole_assignment import PolesMissedError, assign_poles

__all__ = ["PolesMissedError", "assign_poles"]
