"""What the thermal tests share: the materials and the worked designs of the references, and an oracle of its own."""

from collections.abc import Callable
from types import SimpleNamespace

import mpmath
import pytest

from firmtouch.thermal import Base, Film, HalfSpace, Layer, Material, Stack

TABLE = {
    "foam": (0.05, 300, 1300),
    "parylene": (0.084, 1289, 712),
    "kapton": (0.12, 1420, 1090),
    "pine": (0.12, 510, 1380),
    "pdms": (0.16, 965, 1460),
    "pmma": (0.19, 1180, 1470),
    "skin": (0.37, 1100, 3400),
    "glass": (1.4, 2500, 750),
    "silicone": (1.5, 2500, 1000),
    "steel": (14.9, 7900, 477),
    "aluminium": (237, 2702, 903),
    "alumina": (30, 3960, 780),
    "copper": (401, 8933, 385),
}


@pytest.fixture(scope="session")
def m() -> SimpleNamespace:
    return SimpleNamespace(**{name: Material(name, *numbers) for name, numbers in TABLE.items()})


@pytest.fixture(scope="session")
def designs(m) -> SimpleNamespace:
    """Worked designs: a cover and a substrate, the sensed plane between them, on a millimetre of foam or a base."""

    def backed(cover, substrate, *rest):
        return Stack((cover, substrate, *rest), sensed=1, backing=Base())

    foam = Layer(m.foam, 1e-3)
    return SimpleNamespace(
        D1=backed(Layer(m.kapton, 12.5e-6), Layer(m.kapton, 25e-6), foam),
        D2=backed(Layer(m.parylene, 5e-6), Layer(m.kapton, 7.5e-6), foam),
        D3=backed(Layer(m.parylene, 2e-6), Layer(m.kapton, 5e-6), foam),
        D4=Stack((Layer(m.parylene, 5e-6),), sensed=1, backing=HalfSpace(m.pdms)),
        D5=backed(Layer(m.silicone, 100e-6), Layer(m.alumina, 250e-6)),
    )


@pytest.fixture(scope="session")
def oracle() -> Callable:
    """Make the step response in mpmath: products of cosh/sinh matrices, and its own Talbot inversion."""

    def transfer(stack, touched, h):
        def H(s):
            def matrix(element):
                if isinstance(element, Film):
                    return mpmath.matrix([[1, 0], [s * element.areal_capacity, 1]])
                if not isinstance(element, Layer):
                    return mpmath.matrix([[1, 1 / mpmath.mpf(element.conductance)], [0, 1]])
                g = mpmath.sqrt(s / element.material.alpha)
                kg, x = element.material.conductivity * g, g * element.thickness
                return mpmath.matrix([[mpmath.cosh(x), mpmath.sinh(x) / kg], [kg * mpmath.sinh(x), mpmath.cosh(x)]])

            def product(elements):
                found = mpmath.eye(2)
                for each in elements:
                    found = found * matrix(each)
                return found

            backing = stack.backing
            held = isinstance(backing, Base)
            end = mpmath.matrix([0, 1] if held else [1, backing.material.effusivity * mpmath.sqrt(s)])
            sensed = product(stack.elements[stack.sensed :]) * end
            face = product(stack.elements[: stack.sensed]) * sensed
            Z_o = 1 / (touched.material.effusivity * mpmath.sqrt(s))
            return sensed[0] / (face[0] + face[1] * (1 / mpmath.mpf(h) + Z_o))

        return H

    def step(stack, touched, h, t):
        H = transfer(stack, touched, h)
        with mpmath.workdps(30):
            return float(mpmath.invertlaplace(lambda s: H(s) / s, t, method="talbot"))

    return step
