"""What materials remember, for results: at nodes, the largest of it, and integrals over bodies."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from abut.bodies.evaluation import History
from abut.bodies.patch_fits import carried
from abut.bodies.solids import Array, Group, Solids
from abut.bodies.volumes import point_volumes
from abut.materials.material import history_fields
from abut.mesh.reference import reference_nodes


def at_cells(solids: Solids, history: History, name: str) -> Iterator[tuple[Group, Array]]:
    """Groups of bodies whose material remembers ``name``, with it at the integration points, (cells, q, k)."""
    for group in solids.groups():
        if group.body not in history:
            continue
        columns = history_fields(solids.materials[group.body]).get(name)
        if columns is not None:
            q = len(group.rule[1])
            rows = history[group.body][group.first : group.first + len(group.cells) * q, columns]
            yield group, rows.reshape(len(group.cells), q, -1)


def names(solids: Solids) -> tuple[str, ...]:
    """Of all that materials remember."""
    return tuple(dict.fromkeys(name for material in solids.materials.values() for name in history_fields(material)))


def nodal(solids: Solids, history: History, name: str) -> Array:
    """At the points, (n_points,) or (n_points, k), as in ``averaged`` within each cell's own."""
    result = averaged(solids, at_cells(solids, history, name), within=True)
    return np.asarray(result[:, 0] if result.shape[1] == 1 else result)


def averaged(solids: Solids, values: Iterable[tuple[Group, Array]], within: bool = False) -> Array:
    """At the points, (n_points, k): values at integration points, (cells, q, k) of groups, carried linearly to the nodes of
    a cell, and averaged over the cells of a point; zero elsewhere. within: no farther than a cell's largest and smallest."""
    n = len(solids.points)
    total, count = np.zeros((n, 0)), np.zeros(n)
    for group, inside in values:
        there = carried(group.kind, group.rule, reference_nodes(group.kind)) @ inside
        if within:
            there = np.clip(there, inside.min(axis=1, keepdims=True), inside.max(axis=1, keepdims=True))
        if not total.size:
            total = np.zeros((n, inside.shape[2]))
        nodes = group.nodes.ravel()
        count += np.bincount(nodes, minlength=n)
        for k in range(inside.shape[2]):
            total[:, k] += np.bincount(nodes, there[..., k].ravel(), n)
    return np.asarray(total / np.maximum(count, 1.0)[:, None])


def largest(solids: Solids, history: History, name: str) -> tuple[float, int]:
    """The largest of a scalar at integration points, and its cell; (0, -1) where nothing has it."""
    found = (0.0, -1)
    for group, values in at_cells(solids, history, name):
        row = int(values[..., 0].max(axis=1).argmax())
        found = max(found, (float(values[row].max()), int(group.cells[row])))
    return found


def integral(solids: Solids, history: History, name: str) -> float:
    """Of a scalar over the undeformed volume (per unit thickness in 2D, all round if axisymmetric)."""
    total = 0.0
    for group, values in at_cells(solids, history, name):
        total += float((point_volumes(solids, group, group.rule) * values[..., 0]).sum())
    return total
