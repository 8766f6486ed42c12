"""Compliances of materials at rest, (6, 6), of stresses and strains xx yy zz xy yz zx, shear strains doubled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.bodies.patch_fits import spread
from abut.bodies.solids import Array, Solids
from abut.materials.material import Material, linear
from abut.materials.places import Places, is_local, placed


def compliances(solids: Solids) -> tuple[Array, NDArray[np.int32]]:
    """(k, 6, 6) at rest, and which each cell has, (n_cells,): that of its body, or one in its own middle."""
    which = solids.body_of.copy()
    found = []
    for number, material in enumerate(solids.materials.values()):
        if not is_local(material):
            found.append(_compliance(material)[None])
            which[solids.body_of == number] = sum(map(len, found)) - 1
            continue
        cells = np.flatnonzero(solids.body_of == number)
        centre = spread(solids, solids.points)[cells, 0]
        here = placed(material, Places(centre, np.zeros(len(cells))))
        tangent = here.evaluate(np.zeros((len(cells), 6)), here.initial(len(cells)))[1]
        which[cells] = sum(map(len, found)) + np.arange(len(cells))
        found.append(np.asarray(np.linalg.pinv(tangent, hermitian=True), dtype=float))
    return np.concatenate(found), which


def _compliance(material: Material) -> Array:
    """(6, 6), at rest."""
    rest = linear(material)
    if rest is not None:
        result = np.diag([1.0] * 3 + [2.0] * 3) * (1.0 + rest.poisson)
        result[:3, :3] -= rest.poisson
        return np.asarray(result / rest.young)
    tangent = material.evaluate(np.zeros((1, 6)), material.initial(1))[1][0]
    return np.ascontiguousarray(np.linalg.pinv(tangent, hermitian=True))
