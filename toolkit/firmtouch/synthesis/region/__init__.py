"""Gains by convex search: a specification made of terms, one cvxpy problem, a search for eps [T4]."""

from firmtouch.synthesis.region.conflicts import NoGainsError
from firmtouch.synthesis.region.design import RegionDesign, design_region

__all__ = ["NoGainsError", "RegionDesign", "design_region"]
