"""Surfaces that may touch themselves: which facets see each other through their own body, and which of two is the
contactor; theory (G11), (G12)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from abut.contact.coupling import CouplingOptions, GapSamples, couple
from abut.contact.geometry import facet_sizes, mean_normals, straight
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface

Array = NDArray[np.float64]
DEPTH = 3.0  # thicknesses of the body, up to which a facet's far side lies opposite after large strains
ASLANT = np.array([1.0, 0.764, 0.583])  # to the axes, so that hardly any two facets are level
OPEN = 0.05  # share of what is aslant in the direction of ranks
BENEATH = 2.0  # facets below its middle that a facet is ranked: those opposite each other are that much further apart
APART = 1e3  # in extents: ranks of different bodies do not mix
BODY, RANK, MIDDLE, NORMAL, REACH, THICKNESS, WIDTH = (
    0,
    1,
    slice(2, 5),
    slice(5, 8),
    8,
    9,
    10,
)  # columns of ``Surface.kin``


def with_kin(mesh: Mesh, contactor: Surface, target: Surface, all_round: bool) -> tuple[Surface, Surface]:
    """Both surfaces with what ``Surface.kin`` says, where they have a body in common or go ``all_round`` one; else as they
    are."""
    both = contactor.cells, target.cells
    bodies = _bodies(mesh)
    relatives, other = (bodies[cells] for cells in both)
    if not all_round and not np.isin(relatives, other).any():
        return contactor, target
    codes = [8 * side.cells + side.local for side in (contactor, target)]
    _, first, number = np.unique(np.concatenate(codes), return_index=True, return_inverse=True)
    whole = replace(
        contactor,
        kinds=np.concatenate([contactor.kinds, target.kinds])[first],
        nodes=np.concatenate([contactor.nodes, target.nodes])[first],
        cells=np.concatenate(both)[first],
        local=np.concatenate([contactor.local, target.local])[first],
        parts=None,
        axisymmetric=False,
        bulge=None,
        kin=None,
    )
    kin = _kin(straight(whole), bodies[whole.cells])
    parts = [kin[relatives] for relatives in np.split(number.ravel(), [len(contactor)])]
    parts[0][~np.isin(codes[0], codes[1]), RANK] = -np.inf
    parts[1][~np.isin(codes[1], codes[0]), RANK] = np.inf
    return replace(contactor, kin=parts[0]), replace(target, kin=parts[1])


def lies_deep(contactor: Surface, target: Surface, at: GapSamples | None) -> bool:
    """Whether some of the target lies deeper in the contactor than a facet is long: it may then be seen through the body, as
    the far flank of the tooth beside, which surfaces with ``with_kin`` leave out."""
    if at is None or not (at.gap < 0.0).any():
        return False
    size = np.maximum(facet_sizes(contactor)[at.facet], facet_sizes(target)[at.target_facet])
    return bool((at.gap < -size).any())


def _kin(surface: Surface, body: NDArray[np.int64]) -> Array:
    """(n_facets, WIDTH) of an undeformed surface."""
    dim = surface.dim
    used = surface.nodes >= 0
    middle = np.where(used[:, :, None], surface.points[surface.nodes], 0.0).sum(axis=1) / used.sum(axis=1)[:, None]
    extent = float(np.ptp(surface.points[surface.node_ids], axis=0).max())
    result = np.zeros((len(surface), WIDTH))
    result[:, BODY] = body
    normal, size = mean_normals(surface), facet_sizes(surface)
    sights = _sights(surface, body, extent)
    beneath = middle - BENEATH * np.median(size) * normal
    ranked = beneath @ _direction(beneath, sights) / extent
    result[:, RANK] = APART * np.unique(body, return_inverse=True)[1].ravel() + ranked
    result[:, MIDDLE][:, :dim] = middle
    result[:, NORMAL][:, :dim] = normal
    result[:, THICKNESS] = _thickness(len(surface), sights)
    result[:, REACH] = DEPTH * result[:, THICKNESS] + 2.0 * size
    return result


@dataclass(frozen=True)
class _Sights:
    """Facets of one body that see each other: facet, other (n,); gap (n,) negative through the body; area (n,) seen."""

    facet: NDArray[np.int64]
    other: NDArray[np.int64]
    gap: Array
    area: Array


def _sights(surface: Surface, body: NDArray[np.int64], extent: float) -> _Sights:
    options = CouplingOptions(points=1, reach=2.0 * extent, keep_points=True, hidden=True)
    at = couple(surface, surface, 0, options).points
    assert at is not None
    own = body[at.facet] == body[at.target_facet]
    return _Sights(at.facet[own].astype(np.int64), at.target_facet[own].astype(np.int64), at.gap[own], at.weight[own])


def _thickness(n_facets: int, sights: _Sights) -> Array:
    """Of the body behind each facet (n_facets,), infinite where its far side is not on the surface."""
    behind = sights.gap < 0.0
    result = np.full(n_facets, np.inf)
    np.minimum.at(result, sights.facet[behind], -sights.gap[behind])
    return result


def _direction(place: Array, sights: _Sights) -> Array:
    """Along which facets that see each other across air, at ``place`` (n_facets, dim), are furthest apart, theory (G12);
    without any, and as far as they leave it open, aslant."""
    across = sights.gap > 0.0
    way = place[sights.other[across]] - place[sights.facet[across]]
    length = np.linalg.norm(way, axis=1)
    apart = length > 0.0
    share = sights.area[across][apart] / length[apart]  # what is near touches first
    unit = way[apart] / length[apart][:, None]
    aslant = ASLANT[: place.shape[1]]
    tensor = np.einsum("n,ni,nj->ij", share / max(share.sum(), 1e-300), unit, unit) + OPEN * np.outer(aslant, aslant)
    axis = np.linalg.eigh(tensor)[1][:, -1]
    return np.asarray(axis if axis @ aslant > 0.0 else -axis)


def _bodies(mesh: Mesh) -> NDArray[np.int64]:
    """Number of the body of each cell, (n_cells,): cells that hang together by points."""
    rows, columns = [], []
    for block, first in zip(mesh.blocks, mesh.starts):
        rows.append(first + np.repeat(np.arange(len(block.nodes)), block.nodes.shape[1]))
        columns.append(mesh.n_cells + block.nodes.ravel().astype(np.int64))
    row, column, size = np.concatenate(rows), np.concatenate(columns), mesh.n_cells + len(mesh.points)
    touch = sp.csr_matrix((np.ones(len(row)), (row, column)), shape=(size, size))
    return connected_components(touch, directed=False)[1][: mesh.n_cells].astype(np.int64)
