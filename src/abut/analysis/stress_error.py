"""How far the stresses of the elements are off, by the recovered ones: theory (Z6), (Z7), (Z8)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from abut.bodies.recovery import energies
from abut.bodies.solids import Solids
from abut.bodies.stress import PointStress
from abut.contact.geometry import facet_sizes
from abut.mesh.surface import Surface
from abut.solution import ContactResult
from abut.solution.stress_error import AIM, ContactStressError, StressError

PRESSED = 0.05  # pressure over the largest from which on a facet is near the middle of contact
ROUNDED = 1e-13  # of displacements: a few hundred times what doubles hold
TRIFLE = 1e-6  # energy of a body over that of all from which down its stresses matter to nobody

Array = NDArray[np.float64]


def stress_error(
    solids: Solids, displacement: Array, stress: PointStress, values: Array, contacts: Sequence[ContactResult]
) -> StressError | None:
    """The estimate of Zienkiewicz and Zhu; None where stresses are the rounding of displacements. displacement: (n_points,
    dim); stress: at the integration points; values: (n_values, 6) recovered."""
    points = np.ascontiguousarray(solids.points + displacement) if solids.kinematics == "finite" else solids.points
    table = energies(solids, points, stress, values)
    error, energy, volume = table.T
    total = float(energy.sum())
    if total <= _rounding(solids, volume, displacement):
        return None
    relative = np.zeros(len(error))
    for cells in solids.mesh.bodies.values():
        own = float(energy[cells].sum())
        if own > TRIFLE * total:
            density = own / max(float(volume[cells].sum()), 1e-300)
            relative[cells] = np.sqrt(error[cells] / np.maximum(volume[cells], 1e-300) / density)
    whole = float(np.sqrt(error.sum() / total)) if total > 0.0 else 0.0
    near = [e for contact in contacts for e in _near(solids, contact, error, energy)]
    return StressError(relative, whole, total, near)


def _rounding(solids: Solids, volume: Array, displacement: Array) -> float:
    """Energy of stresses that rounding of the displacements makes."""
    used = np.flatnonzero((volume > 0.0) & (solids.body_of >= 0))
    size = volume[used] ** (1.0 / displacement.shape[1])
    modulus = np.array([material.modulus for material in solids.materials.values()])[solids.body_of[used]]
    strain = ROUNDED * np.abs(displacement).max(initial=0.0) / size
    return float((volume[used] * modulus * strain**2).sum())


def _near(solids: Solids, contact: ContactResult, error: Array, energy: Array) -> Iterator[ContactStressError]:
    """Of the bodies on both sides of a contact."""
    for side, pressure in ((contact.contactor, contact.pressure), (contact.target, contact.target_pressure)):
        at = np.nan_to_num(pressure).max(axis=1)
        pressed = at > PRESSED * at.max(initial=0.0)
        for number, body in enumerate(solids.materials):
            facets = pressed & (solids.body_of[side.cells] == number)
            if facets.any():
                cells = _around(solids, side, facets, number)
                size, off = float(np.median(facet_sizes(side)[facets])), _ratio(error[cells], energy[cells])
                yield ContactStressError(contact.name, body, off, size, size * AIM / max(off, AIM))


def _around(solids: Solids, side: Surface, facets: NDArray[np.bool_], body: int) -> NDArray[np.int64]:
    """Cells of a body that have a node of these facets."""
    of = solids.patches
    nodes = side.nodes[facets]
    marked = np.zeros(len(solids.points), dtype=bool)
    marked[nodes[nodes >= 0]] = True
    patches = marked[of.point[of.corner]] & (of.body[of.corner] == body)
    return np.unique(of.around[np.flatnonzero(patches)].indices).astype(np.int64)


def _ratio(error: Array, energy: Array) -> float:
    return float(np.sqrt(error.sum() / max(float(energy.sum()), 1e-300)))
