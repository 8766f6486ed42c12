"""Integration on contactor facets alone, without segments: a comparison, which abut's contact does not use.

The products of contactor and target functions have kinks where the target's edges lie within a contactor facet. A rule over
the whole facet misses them by an error that more points reduce slowly and never remove, so that a constant pressure gives
the target other nodal forces than its own consistent ones: the patch test fails.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.cells import CELLS, MAX_FACET_NODES
from abut.contact.coupling import CouplingOptions, couple, default_reach
from abut.contact.geometry import by_kind, facet_measure, full_moments, nodal_normals
from abut.contact.node_to_segment import feet
from abut.mesh.quadrature import gauss_rule
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
        xi, weights = gauss_rule(kind, points)
        shapes, _ = shape_functions(cell.code, np.ascontiguousarray(xi))
        at, _, area = facet_measure(contactor, kind, facets, xi)
        at, area = at.reshape(-1, contactor.dim), (area * weights).ravel()
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
    coupling = couple(contactor, target, 0, CouplingOptions(componentwise=True))
    on_target = coupling.target_part[:, -len(target.points) :]
    return np.asarray(on_target.T @ np.ones(MAX_FACET_NODES * len(contactor)))


def force_error(force: NDArray[np.float64], target: Surface) -> float:
    """Worst difference from the target's own consistent forces int N_j dS, over the largest of these. Contactor and target
    must cover each other and lie in one plane."""
    exact = np.zeros(len(target.points))
    used = target.nodes >= 0
    np.add.at(exact, target.nodes[used], full_moments(target, 2)[used])
    return float(np.abs(force - exact).max() / np.abs(exact).max())
