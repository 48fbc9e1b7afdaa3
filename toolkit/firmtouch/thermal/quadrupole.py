"""The exact transfer functions of a stack: 1-D multilayer quadrupoles without overflow.

A layer takes (theta, q) of one face to the other by [[cosh x, sinh x / (k g)], [k g sinh x, cosh x]], g = sqrt(s/alpha)
and x = g L (Carslaw and Jaeger, Conduction of Heat in Solids, 3.7). An impedance is carried as a pair (u, v), Z = u/v,
so that a held temperature (0, 1) and an insulated face (1, 0) are numbers like others; a layer, divided by cosh x,
takes it to (u + R v, v + Y u) with R = tanh(x)/(k g) and Y = k g tanh(x), in which only decaying exponentials occur.
Contacts have (R, Y) = (1/h, 0) and films (0, s C'').

All functions take complex s of any shape, off the negative real axis, where the poles are. Those without a half-space
hold at s = 0 too, which is the steady state. Temperatures are deviations from the steady state before.

Where one touch is expected, several may be given: what is found has one more axis then, the first, for them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import mul
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from firmtouch.thermal.arrays import Array, Complex
from firmtouch.thermal.plate import edge_admittance
from firmtouch.thermal.stack import (
    Adiabatic,
    Air,
    Base,
    Contact,
    Disc,
    Element,
    Film,
    Front,
    HalfSpace,
    Layer,
    Slab,
    Stack,
    Touch,
    TouchedObject,
)


@dataclass(frozen=True, slots=True, eq=False)
class Port:
    """An impedance Z = theta/q = u/v (m2K/W) at each s."""

    u: Complex
    v: Complex

    @property
    def impedance(self) -> Complex:
        """Divide; an insulated face at rest has none (`inf`)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.v == 0, np.inf, self.u / self.v)


class _Line(NamedTuple):
    """What an element does to a port, after division by cosh x; `x` is 0 of what has no depth."""

    R: Complex | float
    Y: Complex | float
    x: Complex | float


def _line(element: Element, s: Complex) -> _Line:
    match element:
        case Film(areal_capacity=C):
            return _Line(0.0, s * C, 0.0)
        case Contact(conductance=h):
            return _Line(1 / h, 0.0, 0.0)
        case Layer(material=material, thickness=L):
            # R = (L/k) tanh(x)/x and Y = s rho c L tanh(x)/x
            root: Complex = np.sqrt(s)
            x: Complex = L / math.sqrt(material.alpha) * root
            w: Complex = np.expm1(-x)
            loss: Complex = w * (2 + w)  # e^{-2x} - 1, to full accuracy for thin layers
            rest = x == 0
            ratio: Complex = np.where(rest, 1, -loss / ((2 + loss) * np.where(rest, 1, x)))
            return _Line(L / material.conductivity * ratio, s * (material.volumetric_capacity * L) * ratio, x)


def _attenuation(x: Complex | float) -> Complex | float:
    """Give 1/cosh x, with all digits of what is small."""
    if isinstance(x, float):
        return 1.0
    decay: Complex = np.exp(-x)
    return np.asarray(2 * decay / (1 + decay * decay))


def _through(line: _Line, port: Port) -> Port:
    """See a port through an element."""
    u, v = port.u + line.R * port.v, port.v + line.Y * port.u
    scale = 1 / (np.abs(u) + np.abs(v))  # only u/v matters, and many layers would overflow
    return Port(u * scale, v * scale)


def port_of(end: Front | TouchedObject, s: ArrayLike) -> Port:
    """Look at what ends a stack, at its front or back (thermal quadrupoles' terminations)."""
    s = np.asarray(s, dtype=np.complex128)
    one: Complex = np.ones_like(s)
    zero: Complex = np.zeros_like(s)
    root: Complex = np.sqrt(s)
    match end:
        case Base():
            return Port(zero, one)
        case Adiabatic():
            return Port(one, zero)
        case Air(conductance=h):
            return Port(one, h * one)
        case HalfSpace(material=material):
            return Port(one, material.effusivity * root)
        case Disc(material=material, radius=a, thickness=L):
            inward = material.effusivity * root if math.isinf(L) else _line(Layer(material, L), s).Y
            return Port(one, inward + edge_admittance(material, a, L, s) / (np.pi * a**2))
        case Slab(material=material, thickness=L):
            return _through(_line(Layer(material, L), s), Port(one, zero))
        case Touch(object=touched, conductance=h):
            return _through(_line(Contact(h), s), port_of(touched, s))


@dataclass(frozen=True, slots=True, eq=False)
class _Way:
    """Elements from a plane towards an end; `ports[i]` is what plane i sees of what is behind it."""

    lines: tuple[_Line, ...]
    ports: tuple[Port, ...]

    def passed(self, planes: int) -> Complex | float:
        """Give theta at a plane per theta at the first: the product of u2 / ((u2 + R v2) cosh x)."""

        def ratio(line: _Line, port: Port) -> Complex | float:
            if isinstance(line.R, float) and not line.R:
                return 1.0
            return _attenuation(line.x) * port.u / (port.u + line.R * port.v)

        first: Complex | float = 1.0
        return reduce(mul, map(ratio, self.lines[:planes], self.ports[1 : planes + 1]), first)


def _way(elements: Sequence[Element], end: Port, s: Complex) -> _Way:
    lines = tuple(_line(each, s) for each in elements)
    ports = [end]
    for line in reversed(lines):
        ports.append(_through(line, ports[-1]))
    return _Way(lines, tuple(reversed(ports)))


def input_impedance(stack: Stack, s: ArrayLike) -> Complex:
    """Give Z_s (m2K/W) that an object sees at the touched face."""
    s = np.asarray(s, dtype=np.complex128)
    return _way(stack.elements, port_of(stack.backing, s), s).ports[0].impedance


def object_impedance(touched: TouchedObject, s: ArrayLike) -> Complex:
    """Give Z_o (m2K/W) that a fingertip sees: 1/(e sqrt(s)) of a half-space, coth(g L)/(k g) of a slab."""
    return port_of(touched, s).impedance


@dataclass(frozen=True, slots=True, eq=False)
class ContactTransfer:
    """What a unit step T_o - T_s = 1 K between two faces that meet makes of each (times 1/s: the step's transform).

    `sensed`: temperature at the plane asked for; `face`, `object_face`: those of the two faces, each a deviation from
    what it had; `flux`: q'' (W/m2K) from the object into the fingertip.
    """

    sensed: Complex
    face: Complex
    object_face: Complex
    flux: Complex


def _side_by_side(ends: Front | TouchedObject | Sequence[Front | TouchedObject], s: Complex) -> Port:
    """Look at one end, or at several along a first axis; an object that is touched in several ways only once."""
    if not isinstance(ends, Sequence):
        return port_of(ends, s)
    bodies = dict.fromkeys(each.object if isinstance(each, Touch) else each for each in ends)
    seen = {each: port_of(each, s) for each in bodies}
    ports = [
        _through(_line(Contact(each.conductance), s), seen[each.object]) if isinstance(each, Touch) else seen[each]
        for each in ends
    ]
    return Port(np.stack([each.u for each in ports]), np.stack([each.v for each in ports]))


def of_touch(touch: Touch | Sequence[Touch], s: Complex, number: Callable[[Touch], float]) -> Array | float:
    """Give a number of a touch, or those of several along a first axis before the axes of s."""
    if isinstance(touch, Sequence):
        return np.array([number(each) for each in touch]).reshape(-1, *[1] * s.ndim)
    return number(touch)


def contact_transfer(
    stack: Stack, touch: Touch | Sequence[Touch], s: ArrayLike, *, plane: int | None = None
) -> ContactTransfer:
    """Give theta/dV and q''/dV: Z_s / (Z_s + 1/h + Z_o) times the plane transfers, and 1 / (Z_s + 1/h + Z_o).

    What the air took before the touch is a source of -`air` dV at the face, which sees Z_s beside 1/h + Z_o.

    Raises
    ------
    ThermalValueError
        If there is no such plane.
    """
    s = np.asarray(s, dtype=np.complex128)
    plane = stack.sensed if plane is None else plane
    stack.check_plane(plane)
    way = _way(stack.elements, port_of(stack.backing, s), s)
    back = way.ports[0]
    touched = _side_by_side([each.object for each in touch] if isinstance(touch, Sequence) else touch.object, s)
    before = touched.u + touched.v * of_touch(touch, s, lambda each: 1 / each.conductance)
    air = of_touch(touch, s, lambda each: each.air)
    whole = back.u * touched.v + back.v * before
    face = back.u * (touched.v - air * before) / whole
    driven = (back.v + air * back.u) / whole
    return ContactTransfer(
        sensed=face * way.passed(plane),
        face=face,
        object_face=-driven * touched.u,
        flux=driven * touched.v,
    )


def heater_transfer(
    stack: Stack, front: Front | Sequence[Front], s: ArrayLike, *, heater: int | None = None, plane: int | None = None
) -> Complex:
    """Give theta/P'' (m2K/W) at a plane for the power P'' (W/m2) at the heater's: (Z_front || Z_back), carried on.

    Both are the sensed plane unless told otherwise.

    Raises
    ------
    ThermalValueError
        If there is no such plane.
    """
    s = np.asarray(s, dtype=np.complex128)
    heater = stack.sensed if heater is None else heater
    plane = stack.sensed if plane is None else plane
    stack.check_plane(heater, "heater's plane")
    stack.check_plane(plane)
    behind = _way(stack.elements[heater:], port_of(stack.backing, s), s)
    before = _way(stack.elements[:heater][::-1], _side_by_side(front, s), s)
    f, b = before.ports[0], behind.ports[0]
    both = f.u * b.u / (f.u * b.v + f.v * b.u)
    if plane >= heater:
        return np.asarray(both * behind.passed(plane - heater))
    return np.asarray(both * before.passed(heater - plane))


def frequency_response(transfer: Complex) -> tuple[Array, Array]:
    """Give magnitude and unwrapped phase (rad) of a transfer function that was evaluated along s = j omega."""
    return np.abs(transfer), np.unwrap(np.angle(transfer))
