"""Random assemblies with friction: those without it, rubbed, and pushed or pulled in directions of their own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

import abut
from models.assemblies import PLANE
from models.assemblies_solid import SOLID
from models.assembly_parts import Rng

LEAST, MOST = 0.05, 0.5  # coefficients of friction
LOOSE = 0.5  # chance that a support along x is taken away, so that friction alone holds
SIDEWAYS = (0.02, 1.0)  # of further forces over the loads


def rubbed(build: Callable[[Rng], abut.Model], seed: int) -> abut.Model:
    """What ``build`` makes, with friction in every contact and a force in any direction wherever there is a load."""
    rng = np.random.default_rng(seed)
    model = build(rng)
    contacts = [
        own if own.kind == "tied" else replace(own, friction=float(rng.uniform(LEAST, MOST))) for own in model.contacts
    ]
    loads = list(model.loads)
    for load in model.loads:
        if isinstance(load, abut.BodyForce) or rng.random() < 0.3:
            continue
        value = np.linalg.norm(load.value) * np.exp(rng.uniform(*np.log(SIDEWAYS)))
        loads.append(abut.Force(load.on, tuple(float(v) for v in value * _direction(model, rng))))
    supports = list(model.supports)
    sets = [i for i, s in enumerate(supports) if s.on in model.mesh.node_sets and s.x is not None]
    if sets and not model.equations and rng.random() < LOOSE:
        del supports[sets[int(rng.integers(len(sets)))]]
    steps = int(rng.integers(1, 4))
    return replace(model, contacts=contacts, loads=loads, supports=supports, solve=replace(model.solve, steps=steps))


def _direction(model: abut.Model, rng: Rng) -> np.ndarray:
    if model.plane == "axisymmetric":
        return np.array([0.0, 1.0]) * rng.choice([-1.0, 1.0])
    way = rng.normal(size=model.mesh.dim)
    return np.asarray(way / np.linalg.norm(way))


def plane(seed: int) -> abut.Model:
    return rubbed(list(PLANE.values())[seed % len(PLANE)], seed)


def solid(seed: int) -> abut.Model:
    return rubbed(list(SOLID.values())[seed % len(SOLID)], seed)
