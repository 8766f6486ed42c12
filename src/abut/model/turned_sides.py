"""Where a model is one of alike sectors: its equations tell."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from abut.contact.bulge import Held, with_bulge
from abut.contact.sides import Sides
from abut.mesh.record import MeshRecord
from abut.mesh.surface import Surface
from abut.model.conditions import COMPONENTS, Equation
from abut.model.contact import GEOMETRIES, Contact
from abut.sectors import NEAR, Turned
from abut.types import Array

SAME = 1e-6  # of matrices: rounding of coefficients that were written with few digits


def turned_sides(mesh: MeshRecord, equations: Sequence[Equation]) -> tuple[Turned, ...]:
    """The points that equations let move as others do, turned about an axis, where they lie so, too: by turn and axis. Two
    of them or more, since one lies so for some axis."""
    found: list[tuple[Array, list[tuple[int, int]]]] = []
    for pair, rows in _between_two(mesh, equations).items():
        turn = _turn(rows, mesh.dim)
        if turn is None:
            continue
        for known, members in found:
            if np.abs(known - turn).max() < SAME:
                members.append(pair)
                break
            if np.abs(known - turn.T).max() < SAME and np.abs(known - known.T).max() > SAME:
                members.append(pair[::-1])
                break
        else:
            found.append((turn, [pair]))
    return tuple(side for turn, members in found for side in _about_axes(mesh, turn, np.array(members)))


def smooth_sides(
    contacts: Sequence[Contact], plain: Mapping[str, Sides], of: Sequence[Turned], held: Held | None
) -> dict[str, Sides]:
    """Both sides of contacts, by name, as surfaces that go on beyond the sides of sectors, with their bulge, which ties do
    not have; held: planes of symmetry."""
    made = dict(plain)
    for contact in contacts:
        sides = made[contact.name]
        if of:
            sides = _beyond(sides[0], of), _beyond(sides[1], of)
        if contact.kind != "tied" and contact.geometry == GEOMETRIES[0]:
            sides = with_bulge(sides[0], held), with_bulge(sides[1], held)
        made[contact.name] = sides
    return made


def _beyond(surface: Surface, sides: Sequence[Turned]) -> Surface:
    """A surface that goes on beyond those sides of a sector which most of its points are on."""
    points = surface.node_ids
    count = [int((np.isin(side.nodes, points) & np.isin(side.partners, points)).sum()) for side in sides]
    return replace(surface, turned=sides[int(np.argmax(count))]) if max(count) else surface


def _between_two(mesh: MeshRecord, equations: Sequence[Equation]) -> dict[tuple[int, int], list[Array]]:
    """Homogeneous equations between two points: coefficients (2, dim) by the pair, that in the first term first."""
    rows: dict[tuple[int, int], list[Array]] = {}
    for equation in equations:
        named = [mesh.node_sets.get(t.on, ()) for t in equation.terms if isinstance(t.on, str)]
        if equation.value != 0.0 or any(len(nodes) != 1 for nodes in named):
            continue
        nodes = [int(mesh.node_sets[t.on][0]) if isinstance(t.on, str) else int(t.on) for t in equation.terms]
        both = tuple(dict.fromkeys(nodes))
        if len(both) != 2:
            continue
        pair = both if both in rows or both[::-1] not in rows else both[::-1]
        row = np.zeros((2, mesh.dim))
        for node, term in zip(nodes, equation.terms):
            row[pair.index(node), COMPONENTS.index(term.component)] += term.coefficient
        rows.setdefault((pair[0], pair[1]), []).append(row)
    return rows


def _turn(rows: Sequence[Array], dim: int) -> Array | None:
    """The turn (dim, dim) from the second point's displacement to the first's; None where the equations are none of one."""
    if not rows or len(rows) not in (dim, 2):
        return None
    own, other = np.stack(rows, axis=1)
    if len(rows) < dim:  # supports hold both points along the axis
        axis = np.cross(*own)[None]
        own, other = np.concatenate([own, axis]), np.concatenate([other, -axis])
    if abs(np.linalg.det(own)) < SAME * np.abs(own).max() ** dim:
        return None
    turn = -np.linalg.solve(own, other)
    alike = np.abs(turn @ turn.T - np.eye(dim)).max() < SAME and np.linalg.det(turn) > 0.0
    if not alike or np.abs(turn - np.eye(dim)).max() < SAME:
        return None
    left, _, right = np.linalg.svd(turn)
    return np.asarray(left @ right)


def _about_axes(mesh: MeshRecord, turn: Array, members: Array) -> list[Turned]:
    """Pairs (n, 2) of points that one turn takes to each other, by the axis."""
    result = []
    shifts = mesh.points[members[:, 0]] - mesh.points[members[:, 1]] @ turn.T
    while len(members) > 1:
        size = float(np.ptp(mesh.points[members.ravel()], axis=0).max())
        here = np.abs(shifts - shifts[0]).max(axis=1) <= NEAR * size
        if here.sum() > 1:
            result.append(Turned(members[here, 0], members[here, 1], turn, shifts[here].mean(axis=0)))
        members, shifts = members[~here], shifts[~here]
    return result
