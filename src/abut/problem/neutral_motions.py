"""Motions that contact without friction resists by its facets alone: balls and rollers that spin or run round.

Theory, after (V14): where a surface glides on itself (Gelfand and Guibas 2004)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from abut.bodies.rigid_modes import FREE, RigidModes, free_motions
from abut.contact.geometry import nodal_normals
from abut.dofs import place_of
from abut.errors import InputError
from abut.mesh.surface import Surface
from abut.problem.pair import Pair
from abut.types import Array

SAME = 0.2  # sine, about, of the angle between motions that are one but for noise
MOST = 4  # contacts of a body up to which each may be passed along either side of it


@dataclass(frozen=True)
class Neutral:
    """motions: (n_modes, m) of unit length; noise: (m,) share of the forces that facets may put on each; fields:
    m of (dim + 1, dim), the same at points, [x, 1] times this; group: (m,) numbers of the bodies that move; on: (m,) of
    those whose surface glides on itself, with which the motion goes where they move far."""

    motions: Array
    noise: Array
    fields: Sequence[Array]
    group: NDArray[np.int64]
    on: NDArray[np.int64]

    def only(self, chosen: NDArray[np.bool_]) -> Neutral:
        """Some of them, (m,)."""
        fields = [field for field, one in zip(self.fields, chosen) if one]
        return Neutral(self.motions[:, chosen], self.noise[chosen], fields, self.group[chosen], self.on[chosen])

    def beside(self, others: Array) -> Array:
        """All of them but for ``others`` (n_modes, k), orthonormal: (n_modes, j)."""
        return _but_for(self.motions, others)


def beyond(motions: Array, others: Array) -> Array:
    """What of orthonormal motions (n_modes, k) none of ``others`` (n_modes, m) is, orthonormal: (n_modes, j)."""
    return _but_for(motions, _but_for(others, others[:, :0]))


def _but_for(motions: Array, others: Array) -> Array:
    """The space of motions (n_modes, k) without that of others, orthonormal."""
    axes, size, _ = np.linalg.svd(motions - others @ (others.T @ motions), full_matrices=False)
    return np.asarray(axes[:, size > SAME])


@dataclass(frozen=True)
class _Slopes:
    """Of one side of a contact over some motions, as forms (k, k): the mean square of its normals' share in them, with the
    square of the mean of all n, which noise makes small; of half of what that changes by over a facet; of the motions."""

    along: Array
    turning: Array
    moved: Array


def neutral_motions(rigid: RigidModes, held: Sequence[Array], pairs: Sequence[Pair]) -> Neutral:
    """Motions of single groups of bodies along which each contact glides on one of its sides (Gelfand and Guibas 2004), to
    what its facets leave. held: resistance of supports, and of ties and friction."""
    free = free_motions(held)
    found, noise, fields, of, on = [np.zeros((len(free), 0))], [np.zeros(0)], list[Array](), list[int](), list[int]()
    sliding = [pair for pair in pairs if not (pair.two_way or pair.frictional) and len(pair)]
    if free.shape[1] and sliding:
        moves = _Moves(rigid, sliding[0].contactor.points)
        for group in range(len(rigid.groups)):
            own = _of_group(rigid, free, group)
            sides = list(_sides(moves, sliding, group, own)) if own.shape[1] else []
            if not sides:
                continue
            few = len(sides) <= MOST
            for chosen in product((0, 1), repeat=len(sides)) if few else [(0,) * len(sides), (1,) * len(sides)]:
                slopes = [both.slopes[one] for both, one in zip(sides, chosen)]
                if all(each is not None for each in slopes):
                    glides, share = _glides([each for each in slopes if each is not None])
                    found.append(own @ glides)
                    noise.append(share)
                    fields += list(moves.fields(own @ glides, group))
                    of += [group] * len(share)
                    on += [sides[0].other if chosen[0] else group] * len(share)
    return Neutral(
        np.concatenate(found, axis=1), np.concatenate(noise), fields, np.array(of, np.int64), np.array(on, np.int64)
    )


class _Moves:
    """Rigid motions of each group at any point, which are affine."""

    def __init__(self, rigid: RigidModes, points: Array) -> None:
        self.rigid = rigid
        modes = rigid.modes.reshape(len(points), -1, len(rigid.groups), rigid.per_group)
        self.group = np.full(len(points), -1)
        self.maps = []
        for g in range(len(rigid.groups)):
            nodes = np.flatnonzero(np.abs(modes[:, :, g]).max(axis=(1, 2), initial=0.0) > 0.0)
            self.group[nodes] = g
            x = np.column_stack([points[nodes], np.ones(len(nodes))])
            fit = np.linalg.lstsq(x, modes[nodes, :, g].reshape(len(nodes), -1), rcond=None)[0]
            self.maps.append(fit.reshape(-1, points.shape[1], rigid.per_group))

    def at(self, x: Array, group: int) -> Array:
        """(n, dim, per_group) of a group at points x (n, dim)."""
        return np.einsum("na,adp->ndp", np.column_stack([x, np.ones(len(x))]), self.maps[group])

    def fields(self, motions: Array, group: int) -> Array:
        """Motions (n_modes, m) of a group as in ``Neutral``, (m, dim + 1, dim)."""
        first = self.rigid.per_group * group
        return np.einsum("adp,pm->mad", self.maps[group], motions[first : first + self.rigid.per_group])


def _of_group(rigid: RigidModes, free: Array, group: int) -> Array:
    """The free motions (n_modes, k) of one group alone."""
    inside = np.zeros(len(free), dtype=bool)
    inside[rigid.per_group * group : rigid.per_group * (group + 1)] = True
    _, size, weights = np.linalg.svd(free[~inside], full_matrices=True)
    alone = weights[np.count_nonzero(size > 1e-6) :]
    return np.asarray(free @ alone.T)


@dataclass(frozen=True)
class _Sides:
    """A contact of a group with another: slopes of its own side, and of the other's, None for none; number of the other."""

    slopes: tuple[_Slopes | None, _Slopes | None]
    other: int


def _sides(moves: _Moves, pairs: Sequence[Pair], group: int, own: Array) -> Iterator[_Sides]:
    """Each contact of a group with another."""
    first = moves.rigid.per_group * group
    motions = own[first : first + moves.rigid.per_group]
    for pair in pairs:
        seen = np.zeros(len(pair.contactor.points), dtype=bool)
        seen[place_of(pair.rows.indices, pair.contactor.dim)] = True
        sides = [_by_group(moves, surface, seen) for surface in (pair.contactor, pair.target)]
        for mine, others in (sides, sides[::-1]):
            for other, facets in others[1].items() if group in mine[1] else ():
                if other != group:
                    both = ((mine[0], mine[1][group]), (others[0], facets))
                    one, two = (_slopes(moves, surface, chosen, group, motions) for surface, chosen in both)
                    yield _Sides((one, two), other)


def _by_group(moves: _Moves, surface: Surface, seen: NDArray[np.bool_]) -> tuple[Surface, dict[int, NDArray[np.int64]]]:
    """Facets of each group that take part in a contact."""
    used = surface.nodes >= 0
    whole = np.where(used, seen[surface.nodes], True).all(axis=1)
    group = moves.group[surface.nodes[:, 0]]
    return surface, {int(g): np.flatnonzero(whole & (group == g)) for g in np.unique(group[whole])}


def _slopes(moves: _Moves, surface: Surface, facets: NDArray[np.int64], group: int, motions: Array) -> _Slopes | None:
    try:
        normals = nodal_normals(surface)[facets]
    except InputError:  # a facet without a normal at a node
        return None
    used = surface.nodes[facets] >= 0
    facet, local = np.nonzero(used)
    x = surface.points[surface.nodes[facets][used]]
    moved = moves.at(x, group) @ motions  # (n, dim, k)
    slope = np.einsum("nd,ndk->nk", normals[facet, local], moved)
    mean = normals.sum(axis=1) / used.sum(axis=1, keepdims=True)
    away = np.where(used[..., None], normals - mean[:, None], 0.0)[facet]
    turned = np.einsum("njd,ndk->njk", away, moved) / np.sqrt(used.sum(axis=1))[facet, None, None]
    n, whole = len(x), slope.mean(axis=0)
    return _Slopes(
        slope.T @ slope / n + n * np.multiply.outer(whole, whole),
        np.einsum("njk,njl->kl", turned, turned) / n,
        np.einsum("ndk,ndl->kl", moved, moved) / n,
    )


def _glides(sides: Sequence[_Slopes]) -> tuple[Array, Array]:
    """Motions (k, m) whose slopes are within what the facets of every side turn by, and that, (m,)."""
    along, turning, moved = (sum(getattr(each, name) for each in sides) for name in ("along", "turning", "moved"))
    share, axes = scipy.linalg.eigh(along, along + turning + FREE * moved)
    axes = axes[:, share <= 0.5]
    if not axes.shape[1]:
        return axes, np.zeros(0)
    axes = axes @ scipy.linalg.eigh(axes.T @ turning @ axes, axes.T @ moved @ axes)[1]  # what glides exactly, by itself
    axes /= np.linalg.norm(axes, axis=0)

    def of(form: Array) -> Array:
        return np.asarray(np.einsum("km,kl,lm->m", axes, form, axes))

    within = np.ones(axes.shape[1], dtype=bool)
    for each in sides:
        within &= of(each.along) <= of(each.turning) + FREE * of(each.moved)
    noise = np.sqrt(np.maximum(of(turning), 0.0) / np.maximum(of(moved), 1e-300))
    return axes[:, within], noise[within]
