"""Cells that are too stiff for materials which hardly change their volume."""

from __future__ import annotations

from dataclasses import dataclass

from abut.bodies.integration import TETRAHEDRA, bulk_over_shear
from abut.cells import CELLS
from abut.materials.material import linear
from abut.mesh.quadrature import BBAR, CONTINUOUS, PRESSURES, REDUCED
from abut.model.model import Model

STIFF = 24.0  # bulk over shear modulus (Poisson's ratio 0.48) from which first order is some 10 % too stiff
LOCKED = 100.0  # the same (0.495): by 20 to 30 %
SECOND = 50.0  # cells of second order bear this many times as much, and are a few percent too stiff at most


@dataclass(frozen=True)
class Locking:
    """body, kind of its cells, poisson: ratio; stiffness: bulk over shear modulus, of cells of second order over
    ``SECOND``, at
    most ``LOCKED``; cure: a
    sentence."""

    body: str
    kind: str
    poisson: float
    stiffness: float
    cure: str


def locking(model: Model) -> list[Locking]:
    """Bodies of fully integrated cells whose material changes its volume hardly, the worst first; none in plane stress,
    which
    does not lock."""
    found = []
    for solid in model.solids if model.plane != "stress" else ():
        material = linear(solid.material)
        if model.integration(solid) != "full" or material is None:
            continue
        nu = material.poisson
        ratio = bulk_over_shear(nu)
        for kind in {kind for kind, _, _ in model.mesh.cells_of(solid.body)}:
            cell = CELLS[kind]
            simplex = cell.corners == cell.dim + 1
            if simplex and cell.degree == 2 and cell.dim == 2:  # whose linear stresses leave volume enough freedom
                continue
            bears = TETRAHEDRA / STIFF if kind in CONTINUOUS else SECOND
            stiffness = min(ratio / bears, LOCKED) if cell.degree == 2 else ratio
            if stiffness > STIFF:
                found.append(Locking(solid.body, kind, nu, stiffness, _cure(solid.body, kind)))
    return sorted(found, key=lambda one: -one.stiffness)


def _cure(body: str, kind: str) -> str:
    if kind in BBAR:
        return f"integration = \"b-bar\" for body '{body}'"
    if kind in CONTINUOUS:
        return f"integration = \"mixed\" for body '{body}'"
    if kind in REDUCED:
        return f"integration = \"reduced\" for body '{body}'"
    if kind in PRESSURES:
        return f"integration = \"mixed\" for body '{body}'"
    better = {2: "tri6 or quad8", 3: "hex20, hex27 or tet10"}[CELLS[kind].dim]
    return f"mesh body '{body}' with {better} cells, which abut then takes with pressures of their own where they would lock"
