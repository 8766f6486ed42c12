"""How the areas of facets change with their points."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import CELLS
from abut.contact.geometry import by_kind
from abut.dofs import dofs_at, n_dofs
from abut.mesh.quadrature import gauss_rule
from abut.mesh.surface import Surface
from abut.types import Sparse


def area_change(surface: Surface, facets: NDArray[np.int64]) -> Sparse:
    """Derivative of the areas of some facets (2D: lengths; axisymmetric: areas of the full circumference) by all points,
    (len(facets), dim n_points)."""
    dim = surface.dim
    rows, columns, values = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)], [np.zeros(0)]
    for kind, of_kind in by_kind(surface):
        here = np.flatnonzero(np.isin(facets, of_kind))
        nodes = surface.nodes[facets[here], : CELLS[kind].nodes].astype(np.int64)
        column = dofs_at(nodes, dim)
        rows.append(np.broadcast_to(here[:, None, None], column.shape).ravel())
        columns.append(column.ravel())
        values.append(_rates(surface, kind, surface.points[nodes]).ravel())
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return sp.csr_matrix(entries, shape=(len(facets), n_dofs(len(surface.points), dim)))


def _rates(surface: Surface, kind: str, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """By the nodes of facets of one type at x (facets, nodes, dim), of the same shape."""
    xi, weights = gauss_rule(kind, 6)
    shapes, slopes = shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))
    tangents = np.einsum("qka,fkd->afqd", slopes, x)
    if surface.dim == 3:
        normal = np.cross(tangents[0], tangents[1])
        unit = normal / np.linalg.norm(normal, axis=-1, keepdims=True)
        pulls = np.cross(tangents[1], unit), np.cross(unit, tangents[0])
        return np.asarray(sum(np.einsum("q,qk,fqd->fkd", weights, slopes[..., a], pulls[a]) for a in range(2)))
    length = np.linalg.norm(tangents[0], axis=-1)
    around = surface.around(np.einsum("qk,fkd->fqd", shapes, x)) * np.ones_like(length)
    rates = np.einsum("q,qk,fq,fqd->fkd", weights, slopes[..., 0], around / length, tangents[0])
    if surface.axisymmetric:
        rates[..., 0] += 2.0 * np.pi * np.einsum("q,qk,fq->fk", weights, shapes, length)
    return np.asarray(rates)
