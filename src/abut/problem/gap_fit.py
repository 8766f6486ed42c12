"""What a fit of second order adds to the weighted gaps of dual functions at large sliding, theory (G15)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import couple_surfaces
from abut.cells import CELLS, MAX_FACET_NODES
from abut.contact.bulge import bulge_at, bulging
from abut.contact.corner_fit import fit_functions, fitted
from abut.contact.coupling import CouplingOptions, cutting_arguments
from abut.contact.geometry import Smoothing, by_kind, nodal_normals
from abut.mesh.surface import Surface

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Places:
    """Points (n of them) of a contactor's facets, each with the target's point opposite. facet, target_facet: (n,); own,
    other: (n, 9) values of the shape functions of the contactor's and the target's facet."""

    facet: NDArray[np.int32]
    target_facet: NDArray[np.int32]
    own: Array
    other: Array


@dataclass(frozen=True)
class Sight:
    """What a contactor sees of its target: integration points with their areas (n,), and the corners and middles of all
    segments."""

    points: Places
    weight: Array
    samples: Places

    @classmethod
    def of(cls, contactor: Surface, target: Surface, options: CouplingOptions, across: Smoothing) -> Sight:
        """As ``abut.contact.coupling.couple`` cuts them."""
        raw = couple_surfaces(
            **cutting_arguments(contactor, target, np.arange(len(contactor)), options, across),
            degree=1, vectorial=True, keep_points=True, gap_samples=True,
        )  # fmt: skip
        points, samples = (
            Places(*(raw[f"{of}_{name}"] for name in ("contactor_facet", "target_facet", "contactor", "target")))
            for of in ("point", "gap_sample")
        )
        return cls(points, raw["point_weight"], samples)

    def covered(self, n_facets: int) -> Array:
        """Area of each facet, (n_facets,)."""
        return np.bincount(self.points.facet, self.weight, n_facets).astype(float)


@dataclass(frozen=True)
class MovedSides:
    """Contactor and target at the outset and where they are now."""

    contactor: Surface
    target: Surface
    contactor_now: Surface
    target_now: Surface


def fit_change(sides: MovedSides, sight: Sight, across: Smoothing, share: Array) -> Array:
    """What int N_k g of the corners' functions N_k becomes by the fit, less what it was, (9 n_facets,), g being the gap of
    the undeformed shapes as they lie now. Zero on linear facets that do not bulge and face none that do.

    across: the contactor's creases; share: (n_facets,) of it that counts."""
    contactor, points = sides.contactor, sight.points
    result = np.zeros((len(contactor), MAX_FACET_NODES))
    if not len(points.facet):
        return result.ravel()
    gap, samples = _rigid_gaps(sides, sight, nodal_normals(contactor, across))
    low, high = np.full(len(contactor), np.inf), np.full(len(contactor), -np.inf)
    np.minimum.at(low, sight.samples.facet, samples)
    np.maximum.at(high, sight.samples.facet, samples)
    number = np.full(len(contactor), -1)
    curved = bulging(contactor, sides.target, points.facet, points.target_facet)
    for kind, _ in by_kind(contactor):
        fits = (contactor.kinds == CELLS[kind].code) & (curved | (CELLS[kind].degree == 2)) & (share > 0.0)
        facets = np.flatnonzero(fits)
        number[facets] = np.arange(len(facets))
        at = np.flatnonzero((contactor.kinds[points.facet] == CELLS[kind].code) & (number[points.facet] >= 0))
        functions, corners = fit_functions(kind, points.own[at])
        sound, fit, mass, moment = fitted(
            functions, corners, sight.weight[at], gap[at], number[points.facet[at]], len(facets)
        )
        chosen = facets[sound]
        kept = np.clip(fit, low[chosen, None], high[chosen, None])
        change = (mass @ kept[..., None])[..., 0] - moment
        result[chosen, : corners.shape[1]] = share[chosen, None] * change
    return result.ravel()


def _rigid_gaps(sides: MovedSides, sight: Sight, normals: Array) -> tuple[Array, Array]:
    """The gaps at both kinds of places between undeformed shapes, each placed as the patches that face each other have
    moved: a contactor's facet, and the target's facets that it sees. normals: (n_facets, 9, dim) at the outset."""
    contactor, target, f, n = sides.contactor, sides.target, sight.points.facet, len(sides.contactor)
    own, other = (np.maximum(surface.nodes, 0) for surface in (contactor, target))
    mine = _Patches.of(
        contactor.points[own], sides.contactor_now.points[own], (contactor.nodes >= 0).astype(float), np.arange(n), n
    )
    pieces, piece = np.unique(np.stack([f, sight.points.target_facet]), axis=1, return_inverse=True)
    seen = np.bincount(piece.ravel(), sight.weight, pieces.shape[1])
    weight, nodes = seen[:, None] * (target.nodes[pieces[1]] >= 0), other[pieces[1]]
    theirs = _Patches.of(target.points[nodes], sides.target_now.points[nodes], weight, pieces[0], n)
    # the point of the undeformed target that would now lie at the middle of the contactor's facet
    start = theirs.start + np.einsum("fba,fb->fa", theirs.turn, mine.now - theirs.now)
    turn = np.einsum("fba,fbc->fac", theirs.turn, mine.turn)

    def gaps(at: Places) -> Array:
        x = np.einsum("qk,qkd->qd", at.own, contactor.points[own[at.facet]] - mine.start[at.facet, None])
        y = np.einsum("qk,qkd->qd", at.other, target.points[other[at.target_facet]] - start[at.facet, None])
        normal = -np.einsum("qk,qkd->qd", at.own, normals[at.facet])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        apart = (x * normal).sum(axis=1) - np.einsum("qa,qab,qb->q", y, turn[at.facet], normal)
        over = bulge_at(contactor, at.facet, at.own) + bulge_at(target, at.target_facet, at.other)
        return np.asarray(apart - over)

    return gaps(sight.points), gaps(sight.samples)


@dataclass(frozen=True)
class _Patches:
    """How patches of a surface have moved: rotation (n, dim, dim), middle at the outset and now, (n, dim)."""

    turn: Array
    start: Array
    now: Array

    @classmethod
    def of(cls, start: Array, now: Array, weight: Array, patch: NDArray[np.int64], n: int) -> _Patches:
        """Of points (m, k, dim) with weights (m, k), those of each row belonging to one of n patches; the rotation that
        takes them nearest to where they are. Of patches without points: none."""
        rows = sp.csr_matrix((np.ones(len(patch)), (patch, np.arange(len(patch)))), shape=(n, len(patch)))
        whole = np.maximum(rows @ weight.sum(axis=1), 1e-300)[:, None]
        middles = [(rows @ np.einsum("mk,mkd->md", weight, x)) / whole for x in (start, now)]
        before, after = (x - middle[patch, None] for x, middle in zip((start, now), middles))
        dim = start.shape[2]
        spread = rows @ np.einsum("mk,mka,mkb->mab", weight, after, before).reshape(-1, dim * dim)
        left, _, right = np.linalg.svd(spread.reshape(n, dim, dim))
        left[..., -1] *= np.sign(np.linalg.det(left @ right))[:, None]
        return cls(left @ right, *middles)
