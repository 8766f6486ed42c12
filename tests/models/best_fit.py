"""How near continuous linear functions on a surface come to a field: what no pressure on that mesh can do better."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import CELLS
from abut.contact.geometry import by_kind, facet_measure, pressure_kind
from abut.mesh.quadrature import gauss_rule
from abut.mesh.surface import Surface

Array = NDArray[np.float64]
PARTS = 4  # of each side of a facet, for fields with kinks


def _fine_rule(corners: int) -> tuple[Array, Array]:
    """Points (q, 2) and weights (q,) on the reference square or triangle, in PARTS^2 pieces."""
    x, w = gauss_rule("quad4" if corners == 4 else "tri3", 6)
    i, j = (k.ravel() for k in np.meshgrid(np.arange(PARTS), np.arange(PARTS)))
    if corners == 4:
        pieces = [(x + 1.0) / PARTS - 1.0 + 2.0 / PARTS * np.array(at) for at in zip(i, j)]
    else:
        pieces = [(x + np.array(at)) / PARTS for at in zip(i, j) if sum(at) < PARTS]
        pieces += [(np.array(at) + 1.0 - x) / PARTS for at in zip(i, j) if sum(at) < PARTS - 1]
    return np.concatenate(pieces), np.tile(w / PARTS**2, len(pieces))


def fits(surface: Surface, exact: Callable[[Array], Array]) -> tuple[float, float]:
    """Relative L2 errors on a surface in 3D, first of the averages of ``exact`` (points (n, 3) -> (n,)) over each corner's
    function, int N_i p / int N_i, then of the best of all continuous linear functions."""
    n = len(surface.points)
    mass, load, parts = sp.csr_matrix((n, n)), np.zeros(n), []
    for kind, facets in by_kind(surface):
        x, weights = _fine_rule(CELLS[kind].corners)
        shape, _ = shape_functions(CELLS[pressure_kind(kind, 1)].code, np.ascontiguousarray(x))
        at, _, area = facet_measure(surface, kind, facets, x)
        area, p = area * weights, exact(at.reshape(-1, 3)).reshape(at.shape[:2])
        nodes = surface.nodes[facets, : shape.shape[1]].astype(np.int64)
        np.add.at(load, nodes, (area * p) @ shape)
        blocks = np.einsum("fq,qi,qj->fij", area, shape, shape)
        rows, columns = np.broadcast_arrays(nodes[:, :, None], nodes[:, None])
        mass = mass + sp.csr_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(n, n))
        parts.append((area, p, shape, nodes))
    used = np.flatnonzero(mass.diagonal() > 0.0)
    average, best = np.zeros(n), np.zeros(n)
    average[used] = load[used] / np.asarray(mass.sum(axis=1)).ravel()[used]
    best[used] = spla.spsolve(mass[used][:, used].tocsc(), load[used])
    size = sum(float((area * p**2).sum()) for area, p, _, _ in parts)

    def error(values: Array) -> float:
        miss = (float((area * (values[nodes] @ shape.T - p) ** 2).sum()) for area, p, shape, nodes in parts)
        return float(np.sqrt(sum(miss) / size))

    return error(average), error(best)
