"""Contactor and target of a contact: surfaces and bodies, one or several, merged into one surface each."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from abut.contact.coupling import Coupling, CouplingOptions, couple, default_reach
from abut.contact.geometry import CREASE, area_vectors, full_moments, straight
from abut.contact.self_contact import with_kin
from abut.errors import InputError, nearest
from abut.mesh.exterior import exterior
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface

Names = str | Sequence[str]  # of surfaces or bodies
Rows = NDArray[np.int64]  # (n, 2): cell, local facet
Sides = tuple[Surface, Surface]  # contactor, target
SAME_DISTANCE = 1e-9  # of a distance: another one that differs by less is the same
SLIVER = 1e-9  # of a facet's area: less is rounding where edges of both sides coincide
ON_AXIS = 1e-9  # of the largest radius: facets at smaller ones have no area


def listed(side: Names) -> tuple[str, ...]:
    """The names of a side."""
    return (side,) if isinstance(side, str) else tuple(side)


def words(side: Names) -> str:
    """A side in a sentence: "'a'", "'a', 'b' and 'c'"."""
    quoted = [f"'{name}'" for name in listed(side)]
    return " and ".join(filter(None, (", ".join(quoted[:-1]), quoted[-1])))


def label(side: Names) -> str:
    """A side as part of a name: "a", "a+b"."""
    return "+".join(listed(side))


def code(side: Names) -> str:
    """A side as a user types it: '"a"', '["a", "b"]'."""
    quoted = [f'"{name}"' for name in listed(side)]
    return quoted[0] if len(quoted) == 1 else f"[{', '.join(quoted)}]"


def normalised(side: object, where: str) -> str | tuple[str, ...]:
    """A name, or several different ones as a tuple. Raises InputError for anything else."""
    if isinstance(side, str):
        return side
    if not isinstance(side, Sequence) or not side or not all(isinstance(name, str) for name in side):
        raise InputError(f"{where}: expected the name of a surface or body, or a list of names, got {side!r}")
    different = tuple(dict.fromkeys(side))
    return different[0] if len(different) == 1 else different


def check_names(mesh: Mesh, side: Names, where: str) -> None:
    """Raise InputError for names that are neither a surface nor a body."""
    for name in listed(side):
        if name not in mesh.surfaces and name not in mesh.bodies:
            known = [*mesh.surfaces, *(body for body in mesh.bodies if body not in mesh.surfaces)]
            raise InputError(f"{where}: no surface or body named {name!r} in the mesh{nearest(name, known)}")


def bodies_of(mesh: Mesh, side: Names) -> set[str]:
    """The bodies that a side belongs to; names are known."""
    cells = np.concatenate([mesh.surfaces[n][:, 0] if n in mesh.surfaces else mesh.bodies[n][:1] for n in listed(side)])
    return {body for body, of_body in mesh.bodies.items() if np.isin(cells, of_body).any()}


def moving_sides(mesh: Mesh, contactor: Names, target: Names) -> Sides:
    """The surfaces of both sides of bodies that may move anywhere and fold: a body stands for its whole outside."""
    outside = [_outside_asked(mesh, side) for side in (contactor, target)]
    rows, other = (_rows(mesh, side, of_body)[0] for side, of_body in zip((contactor, target), outside))
    all_round = any(of_body is not None for of_body in outside)
    return with_kin(mesh, mesh.facets(rows, label(contactor)), mesh.facets(other, label(target)), all_round)


def find_sides(mesh: Mesh, contactor: Names, target: Names, moved: float = 0.0) -> Sides:
    """The surfaces of both sides, each facet once; names are known, and that of a surface comes before that of a body.

    A body stands for its outside, as far as it can meet the other side: facets of the contactor that see the target along
    their normals with nothing in between (another body, or the thickness of their own), the facets seen, and those around
    them. moved: the largest prescribed displacement, length. Where nothing is seen, the whole outside is left."""
    outside = _outside_asked(mesh, (*listed(contactor), *listed(target)))
    rows, of_body = _rows(mesh, contactor, outside)
    other, of_other = _rows(mesh, target, outside)
    if outside is not None:
        met = _met(mesh, rows, other, outside, moved)
        if met[0].any():
            rows, other = rows[met[0] | ~of_body], other[met[1] | ~of_other]
    return mesh.facets(rows, label(contactor)), mesh.facets(other, label(target))


def _outside_asked(mesh: Mesh, names: Names) -> Rows | None:
    """The exterior facets, where one of the names is a body's."""
    return exterior(mesh) if any(name not in mesh.surfaces for name in listed(names)) else None


def _rows(mesh: Mesh, side: Names, outside: Rows | None) -> tuple[Rows, NDArray[np.bool_]]:
    """Rows of a side, and which of them come from a body alone. A single surface keeps its order."""
    names = listed(side)
    if outside is None and len(names) == 1:
        return mesh.surfaces[names[0]], np.zeros(len(mesh.surfaces[names[0]]), dtype=bool)
    named = [mesh.surfaces[name] for name in names if name in mesh.surfaces]
    whole = [_outside_of(mesh, name, outside) for name in names if name not in mesh.surfaces and outside is not None]
    every = np.concatenate([*named, *whole])
    _, first = np.unique(_codes(every), return_index=True)
    first.sort()
    return every[first], first >= sum(map(len, named))


def _outside_of(mesh: Mesh, body: str, outside: Rows) -> Rows:
    of_body = outside[np.isin(outside[:, 0], mesh.bodies[body])]
    if not mesh.axisymmetric:
        return of_body
    nodes = mesh.facets(of_body).nodes
    radius = np.where(nodes >= 0, mesh.points[nodes, 0], 0.0).max(axis=1)
    return of_body[radius > ON_AXIS * radius.max(initial=0.0)]


def _met(
    mesh: Mesh, rows: Rows, other: Rows, outside: Rows, moved: float
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which facets of both sides can meet, and those around them. What lies in between hides: the outside of all bodies,
    the contactor's own included, whose far side is as far away as the body is thick."""
    hiding = outside[~np.isin(_codes(outside), _codes(other))]
    plane = replace(mesh, axisymmetric=False)  # areas do not matter, and this is quicker
    contactor, target = straight(plane.facets(rows)), straight(plane.facets(other))
    every = straight(plane.facets(np.concatenate([other, hiding])))
    reach = default_reach(contactor, target) + 2.0 * moved
    seen = couple(contactor, every, 0, CouplingOptions(points=1, reach=reach, keep_points=True, keep_gap_samples=True))
    pairs = _facing_pairs(contactor, seen, len(other)) & _not_through(contactor, seen, len(other))
    met = np.zeros(len(rows), dtype=bool), np.zeros(len(other), dtype=bool)
    for facet, target_facet in pairs:
        met[0][facet] = met[1][target_facet] = True
    return _and_around(contactor, met[0]), _and_around(target, met[1])


def _facing_pairs(contactor: Surface, seen: Coupling, n_target: int) -> set[tuple[int, int]]:
    """Facets of contactor and target (its first ``n_target`` facets) of which more than a sliver sees each other."""
    at = seen.points
    assert at is not None
    large = at.weight > SLIVER * full_moments(contactor, 0)[:, 0][at.facet]
    large &= at.target_facet < n_target
    return set(zip(at.facet[large].tolist(), at.target_facet[large].tolist()))


def _not_through(contactor: Surface, seen: Coupling, n_target: int) -> set[tuple[int, int]]:
    """The same but for those seen through the contactor's body: what lies inside it is seen from where it is nearest to its
    outside. Chords of a bore that cut into a pin do not press on the pin's end."""
    at = seen.gap_samples
    assert at is not None
    x = np.einsum("ik,ikd->id", at.contactor_shapes, contactor.points[np.maximum(contactor.nodes[at.facet], 0)])
    place = x - at.gap[:, None] * at.normal
    around = cKDTree(contactor.points[np.unique(contactor.nodes[contactor.nodes >= 0])])
    near = (at.gap >= 0.0) | (-at.gap <= around.query(place)[0] * (1.0 + SAME_DISTANCE))
    near &= at.target_facet < n_target
    return set(zip(at.facet[near].tolist(), at.target_facet[near].tolist()))


def _and_around(surface: Surface, core: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Facets and those that share a point with them without a crease, so that normals at the rim are the body's."""
    normal = area_vectors(surface).sum(axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    used = (surface.nodes >= 0) & core[:, None]
    facet, local = np.nonzero(used)
    at = np.zeros_like(surface.points)
    np.add.at(at, surface.nodes[facet, local], normal[facet])
    at /= np.maximum(np.linalg.norm(at, axis=1, keepdims=True), 1e-300)
    along = np.einsum("fkd,fd->fk", at[np.maximum(surface.nodes, 0)], normal)
    return np.asarray(core | ((along > CREASE) & (surface.nodes >= 0)).any(axis=1))


def check_own(sides: Sides, contactor: Names, target: Names, where: str) -> None:
    """Raise InputError for surfaces that would press on themselves, where displacements are small."""
    both = [name for name in listed(contactor) if name in listed(target)]
    if both:
        raise InputError(
            f"{where}: contactor and target are the same surface {words(both)}: a body touches itself only where it folds, "
            'which takes kinematics = "finite"; add it, or name the surface opposite'
        )
    codes, other = (_codes(_of(surface)) for surface in sides)
    if np.isin(codes, other).all() or np.isin(other, codes).all():
        raise InputError(
            f"{where}: contactor {words(contactor)} and target {words(target)} are the same facets: a surface does not "
            "press on itself; name the surface opposite"
        )


def check_twice(names: Sequence[str], sides: Sequence[Sides], meet: Callable[[int, int], bool]) -> None:
    """Raise InputError where two contacts (``names``) that act at one time (``meet``) would determine the pressure between
    the same facets twice.

    A facet may belong to any number of contacts: what counts is what it faces there."""
    facets = [tuple(_codes(_of(surface)) for surface in surfaces) for surfaces in sides]
    for first, second in _with_common(facets):
        if not meet(first, second):
            continue
        for turned in (False, True):
            mine, theirs = facets[first], facets[second][::-1] if turned else facets[second]
            common = [np.isin(a, b) for a, b in zip(mine, theirs)]
            if not all(c.any() for c in common):
                continue
            contactor, target = (surface.part(c) for surface, c in zip(sides[first], common))
            reach = default_reach(*sides[first])
            if couple(contactor, target, 0, CouplingOptions(points=1, reach=reach)).segments.any():
                how = ", with its sides swapped" if turned else ""
                raise InputError(
                    f"contacts[{second}]: '{names[second]}' and '{names[first]}' press the same facets together{how}: the "
                    "pressure between them would be determined twice; keep the one whose contactor is softer or has the "
                    "coarser mesh, or leave the common facets out of the other"
                )


def _with_common(facets: Sequence[tuple[Rows, ...]]) -> Iterable[tuple[int, int]]:
    """Pairs of contacts that have a facet in common on each of two sides."""
    if len(facets) < 2:
        return ()
    every = np.concatenate([f for each in facets for f in each])
    owner = np.repeat(np.arange(len(facets)), [sum(map(len, each)) for each in facets])
    _, inverse, count = np.unique(every, return_inverse=True, return_counts=True)
    several = np.unique(owner[count[inverse.ravel()] > 1]).tolist()
    return combinations(several, 2)


def _of(surface: Surface) -> Rows:
    return np.stack([surface.cells, surface.local], axis=1)


def _codes(rows: Rows) -> NDArray[np.int64]:
    """One number for each (cell, local facet): no cell has more than 8 facets."""
    return np.asarray(8 * rows[:, 0] + rows[:, 1], dtype=np.int64)
