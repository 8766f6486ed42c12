"""Which side of a contact is the contactor, where the user leaves it to abut: decided once, as the model is built."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.contact.common_normals import edges_press
from abut.contact.contactor_choice import LEANS, NEAR, Side, choose, side, where_contact_begins
from abut.contact.coupling import CouplingOptions, IntegrationPoints, couple, default_reach
from abut.contact.geometry import facet_sizes, full_moments, straight, without_normal
from abut.contact.sides import Sides, words
from abut.errors import InputError
from abut.materials.material import Material
from abut.materials.softest import contact_modulus, softest
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface
from abut.model.conditions import COMPONENTS, Support
from abut.model.contact import METHODS, Contact

SAME = "a surface on itself"
OF_FRICTION = "named first: its friction varies with position, and goes with its points"


def decided(contact: Contact, measures: tuple[Side, Side], finite: bool) -> Contact:
    """The contact with contactor and target; ``measures``: of the sides in the order in which they are named.

    finite: whether displacements may be large. Raises InputError where a coefficient of friction that varies with position
    would have to go with the points of a rigid side."""
    if finite and callable(contact.friction):
        if np.isinf(measures[0].modulus):
            raise InputError(
                f"contact '{contact.name}': friction varies with position and goes with the points of "
                f"{words(contact.first)}, named first, which is rigid: name the other one first"
            )
        return contact.with_choice(0, OF_FRICTION)
    choice = choose(*measures)
    return contact.with_choice(choice.contactor, choice.why(*measures))


def square_at_edges(contact: Contact, finite: bool) -> bool:
    """Whether sharp edges of the contactor push square to the face that they press on, theory (R2). finite: whether
    displacements may be large."""
    return not finite and contact.kind != "tied" and contact.method == METHODS[0]


def measured(
    mesh: Mesh, materials: Mapping[str, Material], held: NDArray[np.bool_], surfaces: Sides, edges: bool
) -> tuple[Side, Side]:
    """Two sides as the choice sees them: facets within reach of each other, or, where none are so near, of the contact's own
    reach. materials: by body, those without one are rigid; held: (n_points,) as from ``held_points``;
    edges: whether sharp ones count."""
    flat = [straight(replace(surface, axisymmetric=False)) for surface in surfaces]
    sizes = [facet_sizes(surface) for surface in flat]
    options = CouplingOptions(points=1, reach=default_reach(*flat), keep_points=True)
    at = couple(flat[0], flat[1], 0, options).points
    if at is None or not len(at.gap):
        facing, opposite = [np.arange(len(surface)) for surface in flat], np.inf
        first, sharp = facing, (False, False)
    else:
        both = sizes[0][at.facet] + sizes[1][at.target_facet]
        near = np.abs(at.gap) <= NEAR * both
        near |= not near.any()
        facing = [np.unique(of[near]) for of in (at.facet, at.target_facet)]
        opposite = float(at.weight[near].sum())
        begins = np.flatnonzero(near)[where_contact_begins(at.gap[near], both[near])]
        first = [np.unique(of[begins]) for of in (at.facet, at.target_facet)]
        sharp = _edges(flat[0], flat[1], at, near) if edges else (False, False)
    moduli = [_modulus(mesh, materials, held, surface, facets) for surface, facets in zip(surfaces, facing)]
    one, other = (
        replace(
            side(size[f], full_moments(flat_side, 0)[around, 0], opposite, modulus, not without_normal(surface).any()),
            tetrahedra=_tetrahedra(mesh, surface, around),
            edge=edge,
        )
        for surface, flat_side, size, f, around, modulus, edge in zip(
            surfaces, flat, sizes, first, facing, moduli, sharp
        )
    )
    return one, other


def _edges(one: Surface, other: Surface, at: IntegrationPoints, near: NDArray[np.bool_]) -> tuple[bool, bool]:
    """Of each side, whether an edge of it presses on the other one's face where these are nearest."""
    nearest = int(np.argmin(np.where(near, at.gap, np.inf)))
    try:
        mine, theirs = (bool(flags[nearest]) for flags in edges_press(one, other, at, LEANS))
    except InputError:  # a facet without a normal
        return False, False
    return mine and not theirs, theirs and not mine


def _tetrahedra(mesh: Mesh, surface: Surface, facets: NDArray[np.int64]) -> bool:
    """Whether most of these facets are of tetrahedra of first order."""
    own = np.zeros(mesh.starts[-1], dtype=bool)
    for block, start, end in zip(mesh.blocks, mesh.starts, mesh.starts[1:]):
        own[start:end] = block.kind == "tet4"
    return bool(own[surface.cells[facets]].mean() > 0.5)


def choices(contacts: Sequence[Contact]) -> tuple[str, ...]:
    """A line for each contact whose contactor abut has chosen: which, and why."""
    return tuple(
        f"contact '{c.name}': contactor {words(c.contactor)} ({c.chosen}), target {words(c.target)}"
        for c in contacts
        if c.first and c.contactor != c.target
    )


def held_points(mesh: Mesh, supports: Sequence[Support]) -> NDArray[np.bool_]:
    """Points (n_points,) all of whose displacements supports prescribe."""
    held = np.zeros((len(mesh.points), mesh.dim), dtype=bool)
    for support in supports:
        given = [getattr(support, name) is not None for name in COMPONENTS[: mesh.dim]]
        if any(given):
            held[np.ix_(np.unique(mesh.nodes_of(support.on)), np.flatnonzero(given))] = True
    return np.asarray(held.all(axis=1))


def _modulus(
    mesh: Mesh,
    materials: Mapping[str, Material],
    held: NDArray[np.bool_],
    surface: Surface,
    facets: NDArray[np.int64],
) -> float:
    """Infinite where the points that may touch cannot move."""
    nodes = surface.nodes[facets]
    if held[nodes[nodes >= 0]].all():
        return np.inf
    return contact_modulus(softest(mesh, materials, surface.cells))
