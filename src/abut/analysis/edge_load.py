"""Whether edges of the contactor press on the face of the target: the certificate's line "contactor's edges"."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.contact.geometry import nodal_normals, split_at_creases
from abut.contact.pressing_edges import ACROSS, TURNED, leaning, outward
from abut.contact.rim import rim
from abut.errors import InputError
from abut.mesh.surface import Surface
from abut.problem.pair import Pair

Array = NDArray[np.float64]


def edge_load(pair: Pair, values: Array, nodal: Array) -> float:
    """Sine of the angle between the contactor's normal and the target's, on average over the force; zero but where an edge
    of the contactor presses and none of the target: there the pressure acts along the normal of the contactor's face and
    should along the target's: theory (L13). NaN where the target has points without a normal.

    values: (9 n_facets,) facet-wise coefficients of the pressure; nodal: (n_facets, 9) reported at the facets' nodes."""
    at = pair.coupling.gap_samples
    if at is None or not len(at.gap):
        return 0.0
    pressure = np.maximum((at.contactor_shapes * np.nan_to_num(nodal)[at.facet]).sum(axis=1), 0.0)
    of_facet = np.bincount(at.facet, pressure, len(pair.contactor))
    force = np.abs(pair.coupling.weight * values).reshape(len(pair.contactor), -1).sum(axis=1)
    force[of_facet <= 0.0] = 0.0
    if not force.any():
        return 0.0
    share = force[at.facet] / force.sum() * pressure / np.maximum(of_facet[at.facet], 1e-300)
    own = normals_at(nodal_normals(pair.contactor), at.facet, at.contactor_shapes)
    try:
        other = normals_at(nodal_normals(pair.target), at.target_facet, at.target_shapes)
        theirs = _edge_presses(pair.target, at.target_facet, other, own)
    except InputError:
        return float("nan")
    edge = _edge_presses(pair.contactor, at.facet, own, other) & ~theirs
    sine = np.linalg.norm(leaning(-at.normal, other), axis=1)
    return float((share * sine)[edge].sum())


def normals_at(normals: Array, facets: NDArray[np.int32], shapes: Array) -> Array:
    """Unit normals (n, dim), of those at facets' nodes (n_facets, 9, dim), at points given by shape functions (n, 9)."""
    normal = np.einsum("sk,ska->sa", shapes, normals[facets])
    return np.asarray(normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300))


def _edge_presses(surface: Surface, facets: NDArray[np.int32], own: Array, other: Array) -> NDArray[np.bool_]:
    """Where (n,) the other side, opposite facets (n,) of a surface, leans out over a crease or an end of these."""
    ends = rim(split_at_creases(surface)[0])
    out = outward(ends)
    order = np.argsort(ends.facet, kind="stable")
    first = np.searchsorted(ends.facet[order], facets)
    count = np.searchsorted(ends.facet[order], facets, side="right") - first
    lean = leaning(own, other)
    size = np.linalg.norm(lean, axis=1)
    presses = np.zeros(len(facets), dtype=bool)
    for k in range(int(count.max(initial=0))):
        has = k < count
        towards = (lean[has] * out[order[first[has] + k]]).sum(axis=1)
        presses[has] |= towards > ACROSS * size[has]
    return presses & (size > TURNED)
