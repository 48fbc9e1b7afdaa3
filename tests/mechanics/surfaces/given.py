"""Surfaces from a file's text, and what is measured at them in numbers."""

from functools import cache, cached_property
from types import SimpleNamespace

import casadi as ca
import numpy as np
from pydantic import Field

from firmtouch.mechanics.surfaces import Bend, bend, normal, signed_distance
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile.declarations import declarations
from firmtouch.modelfile.diagnostics import validated
from firmtouch.modelfile.sections.section import Section
from firmtouch.modelfile.sections.surface import SurfaceSpec
from firmtouch.modelfile.yamltext import read_yaml


class Root(Section):
    """As much of a model file as a surface needs."""

    parameters: dict[str, object] = Field(default_factory=dict)
    coordinates: dict[str, object] = Field(default_factory=dict)
    surface: SurfaceSpec


def read(text):
    document = read_yaml(text.encode(), "surface.yaml")
    return validated(document, Root, declarations(document.data)).surface


def surface(text):
    """Read one line, such as `sphere: {centre: [0, 0, 0], radius: r}`; it may use the parameters r and d."""
    return read(f"parameters: {{r: 1 m, d: 1 m}}\nsurface: {{{text}}}\n")


SYMBOLS = Symbols(SimpleNamespace(n=0, parameters={"r": None, "d": None}, coordinates={}, definitions={}))
P = (0.2, 0.1)
"""The values of r and d, in m."""


class Measured:
    """A surface as functions of numbers: s, its gradient, its Hessian, and the normal."""

    def __init__(self, text, p=P):
        self.spec = surface(text)
        x = ca.SX.sym("x", 3)
        at_x = bend(self.spec, x, SYMBOLS)
        assert isinstance(at_x, Bend)
        plain = signed_distance(self.spec, x, SYMBOLS)
        outputs = {"s": plain, "bent": at_x.value, "gradient": at_x.gradient, "hessian": at_x.hessian}
        outputs["normal"] = normal(self.spec, x, SYMBOLS)
        self.symbolic = {name: ca.Function(name, [x, SYMBOLS.p], [ca.densify(each)]) for name, each in outputs.items()}
        self.p = p

    @cached_property
    def by_casadi(self):
        """Give the gradient and the Hessian that CasADi makes of s."""
        x = ca.SX.sym("x", 3)
        hessian, gradient = ca.hessian(signed_distance(self.spec, x, SYMBOLS), x)
        return ca.Function("d", [x, SYMBOLS.p], [ca.densify(gradient), ca.densify(hessian)])

    def __call__(self, x, what="s"):
        value = self.symbolic[what](x, self.p).full()
        return value.item() if value.size == 1 else value.ravel() if value.shape[1] == 1 else value

    def many(self, points):
        """Evaluate s at points (k x 3)."""
        return np.array([self(x) for x in points])

    def curvatures(self, x):
        """Give the two principal curvatures at a point of the surface, ascending; positive where it bends away."""
        n = self(x, "gradient")
        tangents = np.linalg.svd(n[None])[2][1:]
        return np.linalg.eigvalsh(tangents @ self(x, "hessian") @ tangents.T)

    def onto(self, x):
        """Give a point of the surface near x, by Newton's method along the gradient."""
        x = np.array(x, dtype=float)
        for _ in range(60):
            s, g = self(x), self(x, "gradient")
            if abs(s) < 1e-15:
                break
            x = x - s * g / (g @ g)
        return x


def rotation(*turns):
    """Give R of rotations about the moving axes, as `("z", 0.3)`."""
    total = np.eye(3)
    for axis, angle in turns:
        i = "xyz".index(axis)
        j, k = (i + 1) % 3, (i + 2) % 3
        R = np.eye(3)
        R[j, j] = R[k, k] = np.cos(angle)
        R[k, j], R[j, k] = np.sin(angle), -np.sin(angle)
        total = total @ R
    return total


RNG = np.random.default_rng(1993)
HEIGHTS = np.round(0.05 * RNG.normal(size=(7, 5)), 4)
SURFACES = {
    "plane": "plane: {point: [0.1, 0, d], normal: [1, -2, 2]}",
    "sphere": "sphere: {centre: [0.1, 0, d], radius: r}",
    "cylinder": "cylinder: {point: [0.1, 0, d], axis: [1, 1, 3], radius: r}",
    "cone": "cone: {apex: [0.1, 0, d], axis: [1, 0, -2], half_angle: 30 deg}",
    "torus": "torus: {centre: [0.1, 0, d], axis: [1, 0, 2], ring_radius: 2*r, tube_radius: 0.15 m}",
    "ellipsoid": "ellipsoid: {centre: [0.1, 0, d], semi_axes: [r, 0.3, 0.5], orientation: [{z: 30 deg}, {y: 10 deg}]}",
    "superellipsoid": "superellipsoid: {centre: [0.1, 0, d], semi_axes: [r, 0.3, 0.5], exponents: [6, 4], "
    "orientation: [{z: 30 deg}, {x: 0.2}]}",
    "odd superellipsoid": "superellipsoid: {centre: [0.1, 0, d], semi_axes: [r, 0.3, 0.5], exponents: [3, 2.5]}",
    "implicit": 'implicit: {expression: "z - x**2 + sin(y)/2 - d", position: [0.1, 0, 0], orientation: [{y: 20 deg}]}',
    "height field": f"height_field: {{x: [-1, 0.8], y: [-d, 9*d], heights: {HEIGHTS.tolist()}, "
    "position: [0, 0, r], orientation: [{z: 40 deg}, {x: 0.1}]}",
}


@cache
def measured(name):
    """Give one of these surfaces in numbers."""
    return Measured(SURFACES[name])


@cache
def points_of(name):
    """Give some points of it, at a distance from where a distance has no curvature, such as a cone's apex."""
    rng, one = np.random.default_rng(1993), measured(name)
    found = [one.onto([0.1, 0.2, 0.1] + 0.3 * rng.normal(size=3)) for _ in range(8)]
    there = [x for x in found if abs(one(x)) < 1e-13 and np.linalg.norm(x) < 2]
    return tuple(x for x in there if np.abs(one(x, "hessian")).max() < 200)
