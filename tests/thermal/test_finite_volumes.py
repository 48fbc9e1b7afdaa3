"""An independent discretisation: one-dimensional finite volumes and BDF, before and after the contact, against the exact."""

import numpy as np
import pytest
import scipy.sparse
from scipy.integrate import solve_ivp

from firmtouch.thermal import ContactEvent, HalfSpace, Touch

DIFFERENCE, AGREE = 14.0, 1e-3
"""Kelvin: and 1 mK of it, which some hundred cells reach."""
TIMES = np.array([1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0, 2.0])


def cells_of(material, thickness, count, *, towards=None):
    """Cut a layer evenly, or a body from its face inward by cells that grow."""
    if towards is None:
        sizes = np.full(count, thickness / count)
    else:
        edges = thickness * np.expm1(towards * np.linspace(0, 1, count + 1)) / np.expm1(towards)
        sizes = np.diff(edges)
    return sizes, np.full(count, material.conductivity), np.full(count, material.volumetric_capacity)


def finite_volumes(stack, touched, h):
    """Integrate object | contact | layers | base, all of the object at 14 K, all of the finger at 0."""
    depth = 6 * np.sqrt(touched.alpha * TIMES[-1])  # erfc(3) = 2e-5 of what happens at the face
    size, k, c = (each[::-1] for each in cells_of(touched, depth, 160, towards=9.0))
    cover, substrate, foam = stack.elements
    inside = [cells_of(cover.material, cover.thickness, 25), cells_of(substrate.material, substrate.thickness, 50)]
    inside.append(cells_of(foam.material, foam.thickness, 100, towards=4.0))
    n_object, n_sensed = size.size, size.size + 25
    size, k, c = (np.concatenate([a, *b]) for a, b in zip((size, k, c), zip(*inside, strict=True), strict=True))
    half = size / k / 2
    resistance = half[:-1] + half[1:]
    resistance[n_object - 1] += 1 / h
    G = 1 / resistance
    capacity = size * c
    loss = np.concatenate([[0], G]) + np.concatenate([G, [1 / half[-1]]])  # the base is at 0
    A = scipy.sparse.diags_array([G / capacity[1:], -loss / capacity, G / capacity[:-1]], offsets=[-1, 0, 1]).tocsc()
    start = np.where(np.arange(size.size) < n_object, DIFFERENCE, 0.0)
    found = solve_ivp(lambda _, x: A @ x, (0, TIMES[-1]), start, "BDF", TIMES, jac=A, rtol=1e-7, atol=1e-8)
    # The plane between two cells, from the flux through both halves.
    before, after = half[n_sensed - 1], half[n_sensed]
    return (found.y[n_sensed - 1] * after + found.y[n_sensed] * before) / (before + after)


@pytest.mark.parametrize(
    "touched",
    ["copper", *(pytest.param(each, marks=pytest.mark.slow) for each in ("steel", "glass", "pmma", "pine"))],
)
@pytest.mark.parametrize("design", ["D1", pytest.param("D2", marks=pytest.mark.slow)])
def test_against_finite_volumes(m, designs, design, touched):
    stack, thing = getattr(designs, design), getattr(m, touched)
    exact = ContactEvent(stack, Touch(HalfSpace(thing), 1e4), DIFFERENCE).temperature(TIMES)
    assert finite_volumes(stack, thing, 1e4) == pytest.approx(exact, abs=AGREE)
