"""Choice of the contactor of a contact: stiffness and mesh size of its sides."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.contact.geometry import facet_sizes, nodal_normals
from abut.contact.sides import words
from abut.diagnosis.finding import Finding
from abut.mesh.facets import bodies_at
from abut.mesh.surface import Surface
from abut.model import Model
from abut.problem.contact_pairs import Pair

ALIKE = 1.1  # ratio of Young's moduli up to which neither side is the softer one
FINER = 2.0  # ratio of facet sizes that is worth a word
PLANE = np.cos(np.deg2rad(1.0))


def sides(model: Model, pair: Pair) -> list[Finding]:
    """Advice to swap the sides, or to refine one of them, where the pressure would gain by it."""
    where = f"contact '{pair.contact.name}'"
    facing = pair.coupling.segments > 0
    young = [_young(model, surface) for surface in (pair.contactor, pair.target)]
    size = [
        float(np.median(facet_sizes(pair.contactor)[facing])),
        float(np.median(facet_sizes(pair.target)[_seen(pair)])),
    ]
    summary = f"Young's moduli {young[0]:.3g} (contactor) and {young[1]:.3g}, facets {size[0]:.3g} and {size[1]:.3g}"
    if young[0] > ALIKE * young[1]:
        return [
            Finding(
                "advice",
                where,
                f"contactor {words(pair.contact.contactor)} is the stiffer side ({summary})",
                "swap contactor and target: the softer side should carry the pressure",
            )
        ]
    if FINER * size[0] < size[1] and not _is_plane(pair.target):
        return [
            Finding(
                "advice",
                where,
                f"contactor {words(pair.contact.contactor)} is {size[1] / size[0]:.2g} times finer than its "
                f"curved target, whose faceting its pressure will show ({summary})",
                "refine the target, or swap the sides",
            )
        ]
    if size[0] > FINER * size[1] and not ALIKE * young[0] < young[1]:
        return [
            Finding(
                "advice",
                where,
                f"contactor {words(pair.contact.contactor)} is {size[0] / size[1]:.2g} times coarser than "
                f"its target ({summary})",
                "swap the sides for a finer pressure, or refine the contactor",
            )
        ]
    return [Finding("info", where, summary)]


def _young(model: Model, surface: Surface) -> float:
    """The softest body of a side; a body without a material is rigid."""
    young = {solid.body: solid.material.young for solid in model.solids}
    return min(young.get(body, np.inf) for body in bodies_at(model.mesh, surface.cells))


def _seen(pair: Pair) -> NDArray[np.bool_]:
    """Facets of the target all nodes of which the contactor has found."""
    found = np.zeros(len(pair.target.points), dtype=bool)
    columns = np.unique(pair.coupling.target_part.tocoo().col)
    found[columns if pair.tied else columns // pair.target.dim] = True
    nodes = pair.target.nodes
    seen = np.asarray((found[nodes] | (nodes < 0)).all(axis=1), dtype=bool)
    return seen if seen.any() else np.ones(len(seen), dtype=bool)


def _is_plane(surface: Surface) -> bool:
    normals = nodal_normals(surface)[surface.nodes >= 0]
    return bool((normals @ normals[0]).min() > PLANE)
