"""What a certificate is about: gains at a regulation point, and everything in the closed loop as balls."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import flint
import numpy as np

from firmtouch.certificate.asked import Asked, asked_of
from firmtouch.certificate.decision import PRECISIONS
from firmtouch.certificate.matrices import BallMatrix, exact, identity, middle, symmetrised
from firmtouch.certificate.plants import PlantBalls, Plants, each_once
from firmtouch.certificate.surface import Surface, SurfacePoint
from firmtouch.certificate.witness import Witness
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation import Gains, OperatingPoint, split_directions
from firmtouch.regulation.tangent import Tangent


@dataclass(frozen=True)
class Balls:
    """The closed loop at the exact point of the surface, enclosed at one precision.

    `X` (n x (n-m)) is a basis of ker J, nearly mass-normalised; `J_plus` = J^T (J J^T)^-1.
    """

    point: SurfacePoint
    J: BallMatrix
    X: BallMatrix
    J_plus: BallMatrix
    W: BallMatrix
    C: BallMatrix
    G_f: BallMatrix
    lambda_d: BallMatrix
    nominal: PlantBalls
    vertices: tuple[PlantBalls, ...]

    @property
    def plants(self) -> tuple[PlantBalls, ...]:
        """List the nominal plant and all vertices, each once."""
        return each_once(self.nominal, self.vertices)

    def K(self, plant: PlantBalls) -> BallMatrix:
        """Give K = W + N0 (14)."""
        return self.W + plant.N0

    def tangent(self, X: BallMatrix) -> BallMatrix:
        """Give the block of a symmetric matrix on ker J."""
        return symmetrised(self.X.transpose() * X * self.X)

    @cached_property
    def C22(self) -> BallMatrix:
        """The damping on ker J."""
        return self.tangent(self.C)

    @cached_property
    def Lambda(self) -> BallMatrix:
        """(I + G_f)^-1."""
        return (identity(self.G_f.nrows()) + self.G_f).inv()


@dataclass(frozen=True, slots=True)
class Floats:
    """The same plants in floats, for estimates: M and K of each, and V2 of the nominal J."""

    M: tuple[Array, ...]
    K: tuple[Array, ...]
    V2: Array


@dataclass(frozen=True)
class Subject:
    """Gains at a regulation point of a model, and what is asked of them."""

    op: OperatingPoint
    gains: Gains
    asked: Asked
    witness: Witness = field(default_factory=Witness)
    _known: dict[int, Balls] = field(default_factory=dict, init=False, repr=False, compare=False)

    @cached_property
    def surface(self) -> Surface:
        """Phi and its derivative as tapes."""
        return Surface(self.op.plant, self.op.q_d)

    @cached_property
    def plants(self) -> Plants:
        """The plants as tapes."""
        return Plants(self.op, self.asked.intervals, self.asked.forces)

    @cached_property
    def basis(self) -> Array:
        """T (n x (n-m)) with T^T M T = I and J T = 0, nearly."""
        V2 = split_directions(self.op.J).V2
        L = np.linalg.cholesky(V2.T @ self.op.M @ V2)
        return np.asarray(np.linalg.solve(L, V2.T).T)

    @cached_property
    def floats(self) -> Floats:
        """Take the middle of everything."""
        with flint.ctx.workprec(PRECISIONS[1]):
            nominal, vertices = self.plants.at(self.surface.q_d.entries())
        plants = each_once(nominal, vertices)
        M = tuple(frozen(middle(each.M)) for each in plants)
        K = tuple(frozen(self.gains.W + middle(each.N0)) for each in plants)
        return Floats(M, K, split_directions(self.op.J).V2)

    @cached_property
    def unit(self) -> float:
        """About the size of the poles, in 1/s: a power of two, so that counting time in it rounds nothing."""
        T = self.basis
        size = float(np.linalg.norm(T.T @ (self.gains.W + self.op.N0) @ T, 2)) ** 0.5
        return float(2.0 ** np.round(np.log2(size))) if size > 0 else 1.0

    @cached_property
    def tangents(self) -> tuple[Tangent, ...]:
        """Take all closed loops on ker J, in the coordinates of `basis`, time counted in 1/unit."""
        T, unit, floats = self.basis, self.unit, self.floats
        C = T.T @ self.gains.C @ T / unit
        pairs = zip(floats.M, floats.K, strict=True)
        return tuple(Tangent(T.T @ M @ T, C, T.T @ K @ T / unit**2) for M, K in pairs)

    def balls(self) -> Balls:
        """Enclose the loop at the precision of the moment.

        Raises
        ------
        NoRootError
            If no point of the surface is proven.
        """
        bits: int = flint.ctx.prec
        if bits not in self._known:
            self._known[bits] = self._enclosed()
        return self._known[bits]

    def _enclosed(self) -> Balls:
        point = self.surface.root()
        J, T = self.surface.J(point.q), exact(self.basis)
        J_plus = J.transpose() * (J * J.transpose()).inv()
        nominal, vertices = self.plants.at(point.q)
        return Balls(
            point=point,
            J=J,
            X=T - J_plus * (J * T),
            J_plus=J_plus,
            W=exact(self.gains.W),
            C=exact(self.gains.C),
            G_f=exact(self.gains.G_f),
            lambda_d=exact(self.op.lambda_d),
            nominal=nominal,
            vertices=vertices,
        )


def subject_of(op: OperatingPoint, gains: Gains, witness: Witness | None = None) -> Subject:
    """Put together what is certified for the design that the model file asks for."""
    return Subject(op, gains, asked_of(op.plant.spec), Witness() if witness is None else witness)
