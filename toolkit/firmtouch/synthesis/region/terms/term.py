"""What all terms have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Self

from firmtouch.regulation import ClosedLoop
from firmtouch.regulation.lmi_region import LmiRegion
from firmtouch.synthesis.region.variables import Constraints, Variables


@dataclass(frozen=True, kw_only=True)
class Term(ABC):
    """One thing asked: `name` in words with the symbol it bounds, the value asked in SI, its unit, and its sense."""

    name: str
    asked: float
    unit: str
    at_most: bool
    nominal: bool = False
    """Whether the term is about the nominal plant alone."""

    @property
    def exact(self) -> bool:
        """Tell whether the constraints lose nothing: gains that reach the term satisfy them."""
        return True

    @abstractmethod
    def constraints(self, variables: Variables) -> Constraints:
        """Give the convex constraints on the gains that make the term hold at every corner."""

    @abstractmethod
    def reached(self, loop: ClosedLoop) -> float:
        """Compute from finished gains what the term bounds, at one vertex of the polytope."""

    def holds(self, reached: float) -> bool:
        """Tell whether a reached value is good."""
        return reached <= self.asked if self.at_most else reached >= self.asked

    def margin(self, reached: float) -> float:
        """Give how far a reached value lies on the good side."""
        return self.asked - reached if self.at_most else reached - self.asked

    def eased(self, factor: float) -> Self:
        """Give the term that asks for less, by a factor above one."""
        return replace(self, asked=self.asked * factor if self.at_most else self.asked / factor)

    @property
    def can_be_eased(self) -> bool:
        """Tell whether asking for less makes sense: not for what is yes or no."""
        return self.asked > 0


@dataclass(frozen=True, kw_only=True)
class RegionTerm(Term):
    """A term that asks for the poles to lie in a region of the complex plane [T4]."""

    @property
    def exact(self) -> bool:
        """Pm has a special form, so that the inequality is sufficient only."""
        return False

    @abstractmethod
    def region(self) -> LmiRegion:
        """Give the region."""

    @abstractmethod
    def of_pole(self, s: complex) -> float:
        """Give for one pole what the term bounds."""

    def constraints(self, variables: Variables) -> Constraints:
        """Ask for the region at every corner, with one Lyapunov matrix that is affine in the gains."""
        region = self.region().in_time_unit(variables.scaling.omega)
        return [*variables.energy_positive(), *variables.in_region(region)]
