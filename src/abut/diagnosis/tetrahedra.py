"""Tetrahedra of first order under a contactor: what their pressures are worth."""

from __future__ import annotations

import numpy as np

from abut.contact.sides import words
from abut.diagnosis.finding import Finding
from abut.mesh.facets import bodies_at
from abut.model import Model
from abut.problem.pair import Pair


def tetrahedra(model: Model, pair: Pair) -> list[Finding]:
    """Of a contactor on tet4 of a body that deforms: a node's displacement is as stiff as the cells around it are many, so a
    node with few cells takes more than its share of the force (docs/verification/pressure.md has numbers)."""
    mesh, cells = model.mesh, np.unique(pair.contactor.cells)
    bounds = zip(mesh.blocks, mesh.starts, mesh.starts[1:])
    some = np.concatenate([cells[:0], *(cells[(cells >= a) & (cells < b)] for k, a, b in bounds if k.kind == "tet4")])
    names = [name for name in bodies_at(mesh, some) if name in model.deformable.materials] if len(some) else []
    if not names or pair.tied:
        return []
    return [
        Finding(
            "advice",
            f"contact '{pair.contact.name}'",
            f"{words(pair.contact.contactor)} is of tet4: pressures at single nodes are off by 5 to 25 % on irregular "
            "meshes, since a node with fewer cells around it takes more force (means are right to a few per cent)",
            f"take tet10 for {', '.join(repr(name) for name in names)} (within 3 % with as many facets), or average over a "
            "few facets",
        )
    ]
