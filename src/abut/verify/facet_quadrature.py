"""Integration on contactor facets alone, without segments: a comparison, which abut's contact does not use.

The products of contactor and target functions have kinks where the target's edges lie within a contactor facet. A rule over
the whole facet misses them by an error that more points reduce slowly and never remove, so that a constant pressure gives
the target other nodal forces than its own consistent ones: the patch test fails.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import CELLS
from abut.interface.coupling import couple, default_reach
from abut.interface.geometry import by_kind, full_moments, nodal_normals
from abut.interface.node_to_segment import feet
from abut.mesh.surface import Surface

CHUNK = 4096  # points whose feet are sought together


def facet_forces(contactor: Surface, target: Surface, points: int) -> NDArray[np.float64]:
    """Target nodal forces of a unit pressure, int N_j by ``points`` Gauss points per direction on each contactor facet.

    Each point acts on the target where the contactor's normal meets it; one that meets nothing is lost. Returns magnitudes,
    (n_target_points,).
    """
    reach = default_reach(contactor, target)
    nodal = nodal_normals(contactor)
    force = np.zeros(len(target.points))
    for kind, facets in by_kind(contactor):
        cell = CELLS[kind]
        xi, weights = _gauss(kind, points)
        shapes, derivatives = shape_functions(cell.code, np.ascontiguousarray(xi))
        x = contactor.points[contactor.nodes[facets, : cell.nodes]]
        tangents = np.einsum("qna,fnd->fqda", derivatives, x)
        metric = np.einsum("fqda,fqdb->fqab", tangents, tangents)
        area = (np.sqrt(np.linalg.det(metric)) * weights).ravel()
        at = np.einsum("qn,fnd->fqd", shapes, x).reshape(-1, contactor.dim)
        normal = np.einsum("qn,fnd->fqd", shapes, nodal[facets, : cell.nodes]).reshape(-1, contactor.dim)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        for first in range(0, len(at), CHUNK):
            part = slice(first, first + CHUNK)
            facet, values, _ = feet(at[part], normal[part], target, reach)
            nodes = np.where((facet >= 0)[:, None], target.nodes[facet], -1)
            used = nodes >= 0
            np.add.at(force, nodes[used], (values * area[part, None])[used])
    return force


def segment_forces(contactor: Surface, target: Surface) -> NDArray[np.float64]:
    """The same forces integrated on segments, as abut's contact does."""
    coupling = couple(contactor, target, 0, componentwise=True)
    own = coupling.target_part[:, -len(target.points) :]
    return np.asarray(own.T @ np.ones(9 * len(contactor)))


def force_error(force: NDArray[np.float64], target: Surface) -> float:
    """Worst difference from the target's own consistent forces int N_j dS, over the largest of these. Contactor and target
    must cover each other and lie in one plane."""
    exact = np.zeros(len(target.points))
    used = target.nodes >= 0
    np.add.at(exact, target.nodes[used], full_moments(target, 2)[used])
    return float(np.abs(force - exact).max() / np.abs(exact).max())


def _gauss(kind: str, n: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """n Gauss points per direction on a reference facet (collapsed on triangles), points (q, dim) and weights (q,)."""
    x, w = np.polynomial.legendre.leggauss(n)
    if CELLS[kind].dim == 1:
        return x[:, None], w
    a, b = (g.ravel() for g in np.meshgrid(x, x, indexing="ij"))
    weights = np.outer(w, w).ravel()
    if CELLS[kind].corners == 4:
        return np.stack([a, b], axis=1), weights
    r, t = 0.5 * (a + 1.0), 0.5 * (b + 1.0)
    return np.stack([r * (1.0 - t), r * t], axis=1), 0.25 * weights * r
