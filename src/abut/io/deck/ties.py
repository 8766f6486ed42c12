"""How close surfaces of a *TIE must be: the faces of the slave within its position tolerance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from abut.cells import CELLS
from abut.io.deck.faces import Rows, connectivity, nodes_of_rows
from abut.io.deck.groups import Groups
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Deck, Numbers, Pair

Vector = NDArray[np.float64]

CALCULIX = 0.025  # of the mean distance of its master triangles' centroids from a side (measured with CalculiX 2.20)
ABAQUS = 0.05  # of the mean diagonal of the master's faces (Analysis User's Guide, "Mesh tie constraints")
MOVED = 1e-3  # of a face of the master: slave nodes that are farther from it are said to be
# Faces in triangles through all nodes, the second and third of each on the side whose distance from the centroid counts
TRIANGLES = {
    "tri3": ((0, 1, 2),),
    "quad4": ((0, 1, 3), (1, 2, 3)),
    "tri6": ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    "quad8": ((0, 4, 7), (4, 1, 5), (6, 5, 2), (7, 6, 3), (7, 4, 6), (4, 5, 6)),
}
LINES = {"line2": ((0, 1),), "line3": ((0, 2), (2, 1))}


@dataclass(frozen=True)
class Near:
    """rows: faces of the slave with no node farther than ``tolerance`` from the master; left: how many others; farthest: of
    the nodes of ``rows``; beyond: of all nodes, in each case along the master's normal."""

    rows: Rows
    left: int
    tolerance: float
    farthest: float
    beyond: float


def near(deck: Deck, groups: Groups, pair: Pair) -> Near:
    """The faces of a tie that are near enough. Raises InputError where there is none."""
    rows = groups.rows(pair.slave)
    nodes = nodes_of_rows(deck, rows)
    every = np.unique(nodes[nodes >= 0])
    far = distances(deck, groups.rows(pair.master), every)
    at = np.where(nodes >= 0, far[np.searchsorted(every, np.maximum(nodes, every[0]))], 0.0).max(axis=1)
    limit = pair.tolerance if pair.tolerance else _default(deck, groups, pair)
    inside = at <= limit
    if not inside.any():
        raise DeckError(
            pair.place,
            f"*TIE: no face of '{pair.slave}' is within {limit:.3g}{_whose(pair)} of '{pair.master}', the nearest is "
            f"{at.min():.3g} away; write *TIE, POSITION TOLERANCE={1.01 * at.min():.3g} or more, or take the tie out",
        )
    return Near(rows[inside], int((~inside).sum()), limit, float(at[inside].max()), float(at.max()))


def tie_notes(deck: Deck, groups: Groups, pair: Pair, found: Near) -> list[str]:
    """What is not tied, and what is tied across a gap."""
    notes = []
    if found.left:
        notes.append(
            f"{pair.place}: *TIE '{pair.name}': {found.left} of {found.left + len(found.rows)} faces of '{pair.slave}' are "
            f"farther than {found.tolerance:.3g}{_whose(pair)} from '{pair.master}', up to {found.beyond:.3g}, and are not "
            "tied; POSITION TOLERANCE changes that"
        )
    if found.farthest > MOVED * float(_diagonals(deck, groups.rows(pair.master)).mean()):
        notes.append(
            f"{pair.place}: *TIE '{pair.name}': surfaces up to {found.farthest:.3g} apart are tied as they stand; CalculiX "
            "and Abaqus move the slave's nodes onto the master first"
        )
    return notes


def _whose(pair: Pair) -> str:
    return "" if pair.tolerance else f" ({'Abaqus' if pair.of_abaqus else 'CalculiX'}'s default)"


def _default(deck: Deck, groups: Groups, pair: Pair) -> float:
    """The tolerance where none is given; CalculiX takes the mean over the masters of all ties."""
    if pair.of_abaqus:
        return ABAQUS * float(_diagonals(deck, groups.rows(pair.master)).mean())
    masters = {tie.master for tie in deck.pairs if tie.is_tie}
    return CALCULIX * float(np.concatenate([_heights(deck, groups.rows(name)) for name in masters]).mean())


def _heights(deck: Deck, rows: Rows) -> Vector:
    """Distances of triangles' centroids from a side, of faces of one unit of thickness in a plane: squares."""
    result: list[Vector] = []
    for kind, nodes in connectivity(deck, rows).items():
        if kind in LINES:
            for a, b in LINES[kind]:
                length = np.linalg.norm(_at(deck, nodes[:, b]) - _at(deck, nodes[:, a]), axis=1)
                result.append(0.5 * length * (1.0 + np.sqrt(0.5)) / 3.0)
            continue
        for i, j, k in TRIANGLES[kind]:
            p, q, r = (_at(deck, nodes[:, n]) for n in (i, j, k))
            twice = np.linalg.norm(np.cross(q - p, r - p), axis=1)
            result.append(twice / np.maximum(np.linalg.norm(r - q, axis=1), 1e-300) / 3.0)
    return np.concatenate(result)


def _diagonals(deck: Deck, rows: Rows) -> Vector:
    """The longest distance between corners of each face."""
    result = []
    for kind, nodes in connectivity(deck, rows).items():
        corners = [_at(deck, nodes[:, i]) for i in range(CELLS[kind].corners)]
        apart = [np.linalg.norm(a - b, axis=1) for i, a in enumerate(corners) for b in corners[:i]]
        result.append(np.max(apart, axis=0))
    return np.concatenate(result)


def _at(deck: Deck, nodes: Numbers) -> Vector:
    return np.asarray(deck.points[np.searchsorted(deck.nodes, nodes)])


def distances(deck: Deck, rows: Rows, nodes: Numbers) -> Vector:
    """Of nodes from the faces in ``rows`` that are nearest, along the normals of these: none beside a plane face."""
    return np.abs(heights(deck, rows, nodes))


def heights(deck: Deck, rows: Rows, nodes: Numbers) -> Vector:
    """As ``distances``, with their sign: below zero inside the body that the faces belong to."""
    parts = []
    for kind, own in connectivity(deck, rows).items():
        for pick in (*TRIANGLES.get(kind, ()), *LINES.get(kind, ())):
            corners = _at(deck, own[:, pick].ravel()).reshape(len(own), -1, 3)
            parts.append(corners if corners.shape[1] == 3 else np.concatenate([corners, corners[:, 1:]], axis=1))
    triangles = np.concatenate(parts)
    centres = triangles.mean(axis=1)
    radius = float(np.linalg.norm(triangles - centres[:, None], axis=2).max())
    tree, points = cKDTree(centres), _at(deck, nodes)
    reach = tree.query(points)[0] + 2.0 * radius * (1.0 + 1e-9)
    flat = deck.blocks[0].type.plane is not None
    return np.array([_height(x, triangles[tree.query_ball_point(x, r)], flat) for x, r in zip(points, reach)])


def _height(x: Vector, triangles: Vector, flat: bool) -> float:
    """Of a point above the nearest of triangles (n, 3, 3), along its normal; ``flat``: lines, their last point repeated."""
    a, b, c = triangles.transpose(1, 0, 2)
    normal = np.cross(b - a, [0.0, 0.0, 1.0]) if flat else np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    height = ((x - a) * normal).sum(axis=1)
    apart = np.full(len(triangles), np.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        along = ((x - p) * (q - p)).sum(axis=1) / np.maximum(((q - p) ** 2).sum(axis=1), 1e-300)
        foot = p + np.clip(along, 0.0, 1.0)[:, None] * (q - p)
        apart = np.minimum(apart, np.linalg.norm(x - foot, axis=1))
    if not flat:
        foot = x - height[:, None] * normal
        sides = [(np.cross(q - p, foot - p) * normal).sum(axis=1) for p, q in ((a, b), (b, c), (c, a))]
        apart = np.where(np.min(sides, axis=0) >= 0.0, np.abs(height), apart)
    nearest = apart <= apart.min() * (1.0 + 1e-9)
    return float(height[nearest][np.abs(height[nearest]).argmin()])
