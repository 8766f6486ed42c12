"""A surface of straight facets with the mirror images of those next to planes of symmetry."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.contact.geometry import by_kind
from abut.mesh.surface import Surface

SAME = 1e-6  # directions that differ by less are one; places in a plane, of the surface's size
RINGS = 2  # of facets around a point that its normal may depend on
Array = NDArray[np.float64]


def with_images(plain: Surface, points: NDArray[np.int64], directions: Array) -> Surface:
    """The surface and, after its own, images of the facets within two rings of points (n,) on planes of symmetry with unit
    normals (n, dim); what lies on a plane is common. Planes that meet mirror the images, too."""
    used = plain.points[plain.node_ids]
    size = float(np.ptp(used, axis=0).max())
    largest = directions[np.arange(len(points)), np.abs(directions).argmax(axis=1)]
    directions = directions * np.sign(largest)[:, None]
    level = np.einsum("na,na->n", plain.points[points], directions)
    key = np.round(np.column_stack([directions, level / size]) / SAME)
    _, first, plane = np.unique(key, axis=0, return_index=True, return_inverse=True)
    result, on = plain, np.zeros((len(first), len(plain.points)), dtype=bool)
    on[plane.ravel(), points] = True
    for k, (normal, at) in enumerate(zip(directions[first], level[first])):
        result, source = _mirrored(result, on[k], normal, at)
        off = (result.points[on.shape[1] :] @ directions[first].T - level[first]).T
        image = on[:, source] & (np.abs(off) < SAME * size)
        on = np.hstack([on, image])
    return result


def _mirrored(plain: Surface, on: NDArray[np.bool_], normal: Array, at: float) -> tuple[Surface, NDArray[np.int64]]:
    """With images beyond one plane, and of which points (m,) the further points are those. on: (n_points,) in the plane."""
    there = plain.nodes >= 0
    near: NDArray[np.bool_] = on
    facets = np.zeros(len(plain), dtype=bool)
    for _ in range(RINGS):
        facets = np.asarray((near[np.maximum(plain.nodes, 0)] & there).any(axis=1))
        near = np.zeros_like(on)
        near[plain.nodes[facets][there[facets]]] = True
    source = np.flatnonzero(near & ~on)
    image = np.arange(len(on))
    image[source] = len(on) + np.arange(len(source))
    nodes = plain.nodes.copy()
    for kind, own in by_kind(plain):
        n = CELLS[kind].corners
        nodes[own, :n] = image[plain.nodes[own, :n]][:, ::-1]
    x = plain.points[source]
    points = np.vstack([plain.points, x - 2.0 * (x @ normal - at)[:, None] * normal])
    cells, local, kinds = (np.concatenate([own, own[facets]]) for own in (plain.cells, plain.local, plain.kinds))
    more = np.vstack([plain.nodes, nodes[facets]])
    return Surface(points, kinds, more, cells, local, plain.name, plain.axisymmetric), source
