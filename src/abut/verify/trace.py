"""A fine continuous space on a surface: quadratic functions on divided facets, rich enough to see every pressure."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from abut._core import shape_functions
from abut.cells import CELLS, MAX_FACET_NODES
from abut.contact.geometry import by_kind, facet_measure, facet_sizes, function_count, node_coordinates, pressure_kind
from abut.mesh.quadrature import facet_rule
from abut.mesh.surface import Surface
from abut.types import Array, Sparse

SAME = 1e-7  # distance over the smallest facet size below which two nodes are one


@dataclass(frozen=True)
class TraceSpace:
    """mass, full: (n, n) int v w and int v w / length^2 + grad v . grad w along the surface; moments: (n, 9 n_facets)
    int v H_k; pressure_mass: (n_facets, 9, 9) int H_k H_l over whole facets."""

    mass: Sparse
    full: Sparse
    moments: Sparse
    pressure_mass: NDArray[np.float64]


def trace_space(
    surface: Surface,
    degree: int,
    share: NDArray[np.float64],
    divisions: int,
    length: float = 1.0,
    covered: NDArray[np.float64] | None = None,
) -> TraceSpace:
    """The space on all facets with a ``share`` (n_facets,) of their area in contact, divided ``divisions`` times along
    each edge; moments with the pressure functions of ``degree`` on the part in contact.

    covered: (n_facets, 9, 9) int H_k H_l over that part. A function cut off at its rim counts as its projection on the
    facet's pressure functions; without ``covered`` (and in the pressure mass) as the whole function times the share.
    """
    points: list[NDArray[np.float64]] = []
    nodes: list[NDArray[np.int64]] = []
    entries: list[tuple[Array, ...]] = []
    pressure_mass = np.zeros((len(surface), MAX_FACET_NODES, MAX_FACET_NODES))
    first = 0
    for kind, facets in by_kind(surface):
        facets = facets[share[facets] > 0.0]
        parts = _parts(surface, kind, facets, degree, divisions, length)
        whole = np.sum([part.pm for part in parts], axis=0)
        k = whole.shape[1]
        cut = share[facets, None, None] * np.eye(k)
        if covered is not None:
            cut = np.linalg.solve(whole, covered[facets, :k, :k])
        for part in parts:
            pressure_mass[facets[:, None, None], np.arange(part.pm.shape[1])[:, None], np.arange(part.pm.shape[2])] += (
                part.pm * share[facets, None, None]
            )
            count = part.at_nodes.shape[1]
            points.append(part.at_nodes.reshape(-1, surface.dim))
            nodes.append(first + np.arange(len(facets) * count).reshape(-1, count))
            entries.append((facets, part.mass, part.full, part.moments @ cut))
            first += len(facets) * count
    merged, n = _merge(np.concatenate(points), SAME * facet_sizes(surface).min())
    mass: Sparse = sp.csr_matrix((n, n))
    full: Sparse = sp.csr_matrix((n, n))
    moments: Sparse = sp.csr_matrix((n, MAX_FACET_NODES * len(surface)))
    for local, (facets, m, f, c) in zip(nodes, entries):
        here = merged[local]
        rows, columns = np.repeat(here, here.shape[1], axis=1).ravel(), np.tile(here, (1, here.shape[1])).ravel()
        mass = mass + sp.csr_matrix((m.ravel(), (rows, columns)), shape=(n, n))
        full = full + sp.csr_matrix((f.ravel(), (rows, columns)), shape=(n, n))
        functions = MAX_FACET_NODES * facets[:, None] + np.arange(c.shape[2])
        rows = np.repeat(here, c.shape[2], axis=1).ravel()
        columns = np.tile(functions, (1, here.shape[1])).ravel()
        moments = moments + sp.csr_matrix((c.ravel(), (rows, columns)), shape=moments.shape)
    return TraceSpace(mass, full, moments, pressure_mass)


@dataclass(frozen=True)
class _Part:
    at_nodes: NDArray[np.float64]  # (facets, nodes, dim)
    mass: NDArray[np.float64]
    full: NDArray[np.float64]
    moments: NDArray[np.float64]  # (facets, nodes, pressure functions)
    pm: NDArray[np.float64]


def _parts(
    surface: Surface, kind: str, facets: NDArray[np.int64], degree: int, divisions: int, length: float
) -> list[_Part]:
    cell = CELLS[kind]
    fine = "line3" if cell.dim == 1 else "tri6" if cell.corners == 3 else "quad9"
    code, functions = CELLS[fine].code, function_count(kind, degree)
    eta, weights = facet_rule(fine)
    values, slopes = shape_functions(code, np.ascontiguousarray(eta))
    parts = []
    for origin, scale in _division(fine, divisions):
        xi = np.ascontiguousarray(origin + scale * eta)
        _, metric, area = facet_measure(surface, kind, facets, xi)
        measure = area * weights * abs(scale) ** cell.dim
        gradients = slopes / scale
        mass = np.einsum("fq,qn,qm->fnm", measure, values, values)
        stiff = np.einsum("fq,qna,fqab,qmb->fnm", measure, gradients, np.linalg.inv(metric), gradients, optimize=True)
        pressure = np.ones((len(xi), 1))
        if degree:
            pressure, _ = shape_functions(CELLS[pressure_kind(kind, degree)].code, xi)
        at_nodes, _, _ = facet_measure(surface, kind, facets, origin + scale * node_coordinates(fine))
        parts.append(
            _Part(
                at_nodes,
                mass,
                mass / length**2 + stiff,
                np.einsum("fq,qn,qk->fnk", measure, values, pressure[:, :functions]),
                np.einsum("fq,qk,ql->fkl", measure, pressure, pressure),
            )
        )
    return parts


def _merge(points: NDArray[np.float64], distance: float) -> tuple[NDArray[np.int64], int]:
    """Numbers that points closer than ``distance`` share, and how many there are."""
    pairs = cKDTree(points).query_pairs(distance, output_type="ndarray")
    graph = sp.csr_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points),) * 2)
    count, label = connected_components(graph, directed=False)
    return label.astype(np.int64), int(count)


def _division(kind: str, n: int) -> list[tuple[NDArray[np.float64], float]]:
    """Origin and scale of the parts of a reference facet divided n times along each edge."""
    if kind == "tri6":
        upward = [((i / n, j / n), 1.0 / n) for i in range(n) for j in range(n - i)]
        downward = [(((i + 1) / n, (j + 1) / n), -1.0 / n) for i in range(n - 1) for j in range(n - 1 - i)]
        return [(np.array(origin), scale) for origin, scale in upward + downward]
    middles = -1.0 + (2.0 * np.arange(n) + 1.0) / n
    return [(np.array(o), 1.0 / n) for o in itertools.product(middles, repeat=1 if kind == "line3" else 2)]
