"""Which faces of different solids touch, by a coarse mesh."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from abut.detection.opposing_facets import facing, outside
from abut.mesh.mesh import Mesh

SHARE = 0.02  # of the smaller of two faces that must lie opposite the other; less is an edge that comes near


@dataclass(frozen=True)
class Touching:
    """Two bodies that touch: their names, the faces of each (numbers), and the smallest and largest gap between [length]."""

    bodies: tuple[str, str]
    faces: tuple[tuple[int, ...], tuple[int, ...]]
    gap: tuple[float, float]


def touching(mesh: Mesh, bodies: Mapping[int, str], reach: float) -> tuple[Touching, ...]:
    """Pairs of bodies whose faces lie opposite each other within ``reach`` [length].

    mesh: with bodies "v1" and surfaces "v1 f2" for each face of each solid; bodies: their names by number."""
    every = outside(mesh, list(mesh.bodies))
    face = np.full((mesh.n_cells, 8), -1, dtype=np.int64)  # of each cell's facets
    for name, rows in mesh.surfaces.items():
        face[rows[:, 0], rows[:, 1]] = int(name.partition(" f")[2])
    tag = face[every.rows[:, 0], every.rows[:, 1]]
    found = facing(every, reach)
    found = found.where((tag[found.one] >= 0) & (tag[found.other] >= 0))
    whole = {int(t): float(every.area[tag == t].sum()) for t in np.unique(tag)}
    pairs = np.column_stack([every.body[found.one], every.body[found.other], tag[found.one], tag[found.other]])
    sides: dict[tuple[int, int], tuple[set[int], set[int]]] = {}
    gaps: dict[tuple[int, int], list[float]] = {}
    for a, b, one, other in np.unique(pairs, axis=0).tolist():
        here = (pairs == (a, b, one, other)).all(axis=1)
        if found.area[here].sum() < SHARE * min(whole[one], whole[other]):
            continue
        both, faces = ((a, b), (one, other)) if a < b else ((b, a), (other, one))
        for side, number in zip(sides.setdefault(both, (set(), set())), faces):
            side.add(number)
        gaps.setdefault(both, []).extend(found.gap[here].tolist())
    names = [bodies[int(name[1:])] for name in mesh.bodies]
    return tuple(
        Touching((names[a], names[b]), (tuple(sorted(left)), tuple(sorted(right))), (min(gaps[a, b]), max(gaps[a, b])))
        for (a, b), (left, right) in sides.items()
    )
