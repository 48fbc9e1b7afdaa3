"""One draw: a scenario's start and world -> those of one run. It depends on the seed and the run's label alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.montecarlo.record import Label
from firmtouch.montecarlo.sets import Sets
from firmtouch.regulation import OperatingPoint
from firmtouch.simulation.scenario import Feedback, Scenario, Start
from firmtouch.simulation.world import Disturbance, World


def generator(seed: int, label: Label) -> np.random.Generator:
    """Give the random numbers of one run: a stream of its own, whatever was run before."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(int(label.proven), label.number)))


def draw(op: OperatingPoint, base: Scenario, sets: Sets, rng: np.random.Generator) -> Scenario:
    """Draw a run around a scenario.

    What the scenario says of its start and world stays: drawn forces, offsets, tilts and rotations are added to it.
    """
    q = base.start.q + sets.position * rng.uniform(-1, 1, op.n)
    qdot = base.start.qdot + sets.velocity * rng.uniform(-1, 1, op.n)
    p, names = np.array(base.world.p), list(op.plant.spec.parameters)
    for name, (low, high) in sets.parameters.items():
        p[names.index(name)] = rng.uniform(low, high)
    d, Delta = in_ellipsoid(sets.disturbance, rng), in_ellipsoid(sets.offset, rng)
    world = replace(
        base.world,
        p=frozen(p),
        Delta=frozen(base.world.Delta + Delta),
        R=frozen(rotation(sets.rotation, op.m, rng) @ base.world.R),
        E=frozen(base.world.E + tilt(sets.tilt * float(np.linalg.norm(op.J, 2)), op.J.shape, rng)),
    )
    return replace(base, start=Start(frozen(q), frozen(qdot)), world=_pushed(world, d), feedback=_noisy(base, rng))


def in_ellipsoid(semi_axes: Array, rng: np.random.Generator) -> Array:
    """Draw uniformly from an ellipsoid; an axis of length zero is no direction of it."""
    axes = semi_axes > 0
    found = np.zeros(len(semi_axes))
    k = int(np.sum(axes))
    if k:
        direction = rng.normal(size=k)
        found[axes] = rng.uniform() ** (1 / k) * direction / np.linalg.norm(direction)
    return np.asarray(semi_axes * found)


def tilt(largest: float, shape: tuple[int, ...], rng: np.random.Generator) -> Array:
    """Draw E with |E| <= largest (2-norm); for m = 1 that is uniform in a ball."""
    if not largest:
        return np.zeros(shape)
    E = rng.normal(size=shape)
    return np.asarray(largest * rng.uniform() ** (1 / E.size) * E / np.linalg.norm(E, 2))


def rotation(largest: float, m: int, rng: np.random.Generator) -> Array:
    """Draw R = exp(Omega), |Omega| <= largest (2-norm); for m = 2 by an angle that is uniform in an interval."""
    if not largest or m < 2:
        return np.eye(m)
    Omega = rng.normal(size=(m, m))
    Omega = Omega - Omega.T
    Omega *= largest * rng.uniform() ** (2 / (m * (m - 1))) / np.linalg.norm(Omega, 2)
    w, V = np.linalg.eigh(1j * Omega)  # Hermitian, so that exp(Omega) = V exp(-j w) V^H
    return np.asarray(((V * np.exp(-1j * w)) @ V.conj().T).real)


def _pushed(world: World, d: Array) -> World:
    return replace(world, disturbances=(*world.disturbances, Disturbance(frozen(d)))) if np.any(d) else world


def _noisy(base: Scenario, rng: np.random.Generator) -> Feedback:
    """Let the sensors' noise differ from run to run."""
    noise = base.feedback.noise
    if noise is None:
        return base.feedback
    return replace(base.feedback, noise=replace(noise, seed=int(rng.integers(2**32))))
