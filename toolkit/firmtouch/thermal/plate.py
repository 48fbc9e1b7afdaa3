"""A plate that is touched on a disc only: what its edge draws beyond what one dimension says.

In one dimension an insulated plate draws k g tanh(g L) per area, g = sqrt(s/alpha). From the disc's edge heat goes on
sideways: into a half-space as long as the plate's back is not felt (g L large), through the whole plate as along a
radial fin afterwards. Between both a constriction R_0 under the edge remains, which the ratio L/a alone determines.
"""

from __future__ import annotations

import math

import numpy as np

from firmtouch.thermal.arrays import Complex
from firmtouch.thermal.stack import Material

THIN = math.pi / 2 - 2 * math.log(2) / math.pi
"""Makes k a R_0 = ln 2 / pi^2 of a thin plate: a strip's edge, whose fin begins 2 ln 2 L / pi beyond it."""
THICK = 4 * math.exp(-np.euler_gamma)
"""Makes k a R_0 = 1/4 - (ln(4 L/a) - gamma) a/(2 pi L) of a thick one: the disc's images seen as points."""
FAR = 1e8
"""|g a| beyond which K_0/K_1 is its limit to all digits."""


def constriction(ratio: float) -> float:
    """Give k a R_0 of an isothermal disc on a plate of L/a = `ratio`: its steady resistance beyond the radial fin's.

    1/4 - ln(1 + c l) / (2 pi l) with l = L/a, and c from `THIN` to `THICK`, which are exact. The way between them is
    fitted to the solution of the dual integral equations, within 0.3 % of R_0.
    """
    way = ratio * (ratio + 0.57) / (ratio**2 + 1.33 * ratio + 1.23)
    c = THIN + (THICK - THIN) * way
    return 0.25 - math.log1p(c * ratio) / (2 * math.pi * ratio)


def _bessel_ratio(y: Complex) -> Complex:
    """Give K_0(y)/K_1(y), Re y > 0; neither has zeros there."""
    from scipy.special import kve

    far = np.abs(y) > FAR
    near: Complex = np.where(far, 1, y)
    return np.where(far, 1, kve(0, near) / kve(1, near))


def edge_admittance(material: Material, radius: float, thickness: float, s: Complex) -> Complex:
    """Give what an isothermal disc of radius a (m) draws beyond one dimension (W/K), from a plate of thickness L (m).

    1/Y = R_0 + (1/(4 k a) - R_0) tanh(g L/2) + (g L/sinh(g L)) K_0(g a) / (2 pi k L g a K_1(g a)); 4 k a of a
    half-space (L = inf). The way between short and long times is chosen, `pad.disc_admittance` tells its error. All of
    it is analytic but for within 0.1 rad of the negative real axis, where also the branch cut is: the principal root
    keeps Re g > 0.
    """
    k, a, L = material.conductivity, radius, thickness
    if math.isinf(L):
        return np.full_like(s, 4 * k * a)
    g: Complex = np.sqrt(s / material.alpha)
    rest = g == 0  # a plate without an end draws nothing in the end
    g = np.where(rest, 1 / L, g)
    x, y = g * L, g * a
    decay: Complex = np.exp(-x)
    fin = _bessel_ratio(y) / (2 * math.pi * k * L * y) * 2 * x * decay / -np.expm1(-2 * x)
    R_0 = constriction(L / a) / (k * a)
    behind = (1 / (4 * k * a) - R_0) * (1 - decay) / (1 + decay)
    return np.where(rest, 0, 1 / (R_0 + behind + fin))
