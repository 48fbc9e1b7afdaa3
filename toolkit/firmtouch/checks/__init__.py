"""Is this model what it says it is? One function a check, each with a figure and the bound that it must keep."""

from firmtouch.checks.model import CHECKS, check_model
from firmtouch.checks.result import CheckReport, CheckResult

__all__ = ["CHECKS", "CheckReport", "CheckResult", "check_model"]
