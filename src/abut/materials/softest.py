"""How stiff the side of a contact is: the modulus of its most compliant body.

Each of two bodies pressed together yields by (1 - nu^2) / E times the pressure (Hertz; a half space under any pressure).
This number, and not E alone, tells which one is softer. Where a side has several bodies the most compliant one counts: it
yields most, and what is estimated from it errs to the safe side.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from abut.materials.material import Material, linear
from abut.mesh.facets import bodies_at
from abut.mesh.mesh import Mesh

TYPICAL = 0.3  # Poisson's ratio of metals


def contact_modulus(material: Material | None) -> float:
    """E / (1 - nu^2), force per area, of other materials than linear elastic ones about that; infinite for a rigid body,
    which has no material."""
    if material is None:
        return np.inf
    rest = linear(material)
    poisson = TYPICAL if rest is None else rest.poisson
    return material.modulus / (1.0 - poisson**2)


def softest(mesh: Mesh, materials: Mapping[str, Material], cells: NDArray[np.int64]) -> Material | None:
    """The material of the most compliant of the bodies that have some of the cells; None where all of them are rigid.

    materials: by body; a body without one is rigid. cells: (n,) cell numbers of a surface's facets."""
    known = [materials[body] for body in bodies_at(mesh, cells) if body in materials]
    return min(known, key=contact_modulus, default=None)
