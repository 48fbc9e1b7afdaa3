"""One column of parameters, and what stands where in it."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen


@dataclass(frozen=True, slots=True)
class Layout:
    """Names and sizes of the parameters, in order."""

    sizes: tuple[tuple[str, int], ...]

    def symbols(self) -> tuple[ca.SX, dict[str, ca.SX]]:
        """Make one column of symbols, and its parts by name."""
        parts = {name: ca.SX.sym(name, size) for name, size in self.sizes}
        return ca.vertcat(*parts.values()), parts

    def pack(self, values: dict[str, Array | float]) -> Array:
        """Put values in their places; matrices go column by column, as CasADi reads them."""
        columns = [np.atleast_1d(np.asarray(values[name], dtype=float)).ravel(order="F") for name, _ in self.sizes]
        assert all(each.size == size for each, (_, size) in zip(columns, self.sizes, strict=True))
        return frozen(np.concatenate(columns))

    @property
    def size(self) -> int:
        """The number of parameters."""
        return sum(size for _, size in self.sizes)

    def part(self, column: ca.MX, name: str) -> ca.MX:
        """Take one part out of a column of parameters."""
        return self._parts(column)[name]

    def with_part(self, column: ca.MX, name: str, value: ca.MX) -> ca.MX:
        """Put another value in one place of a column of parameters."""
        return ca.vertcat(*(self._parts(column) | {name: value}).values())

    def _parts(self, column: ca.MX) -> dict[str, ca.MX]:
        ends = [int(each) for each in np.cumsum([0, *(size for _, size in self.sizes)])]
        return dict(zip((name for name, _ in self.sizes), ca.vertsplit(column, ends), strict=True))
