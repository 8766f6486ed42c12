"""Surface and line meshes with nodes in the middle of their edges, and which of a mesh's groups lie on them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.errors import InputError, nearest
from abut.io.raw import RawMesh
from abut.mesh.facets import row_codes
from abut.mesh.thin.edges import with_middles
from abut.thin.records import Shell, Thin

Numbers = NDArray[np.int64]
KINDS = {"shell": ("tri6", "quad8"), "beam": ("line3",)}


@dataclass(frozen=True)
class Sorted:
    """points: (n, 3), with those in the middle of edges. bodies: of each shell and beam its cells, kind -> (n, k) rows of
    points; on: of groups that lie on them the same, single points too; others: all other groups of the mesh; ends:
    (m, 2) of the edges in whose middle the last m points are."""

    points: NDArray[np.float64]
    bodies: Mapping[str, Mapping[str, Numbers]]
    on: Mapping[str, Mapping[str, Numbers]]
    others: Mapping[str, Mapping[str, Numbers]]
    ends: Numbers


def sort(raw: RawMesh, thin: Mapping[str, Thin], where: str) -> Sorted:
    """The groups of a mesh. Raises InputError for shells that are no group of triangles and quadrilaterals in space, and
    beams that are none of lines."""
    for name, section in thin.items():
        if name not in raw.groups or not name:
            raise InputError(f"{where}: no group named {name!r} in the mesh{nearest(name, raw.groups)}")
        what, dim = ("surfaces", 2) if isinstance(section, Shell) else ("lines", 1)
        dims = {CELLS[kind].dim for kind in raw.groups[name] if kind != "point"}
        if dims != {dim}:
            kinds = ", ".join(raw.groups[name])
            raise InputError(
                f"{where}: group '{name}' has cells {kinds}; a section is for {what}: name a group of these alone"
            )
    used = {name: {k: v for k, v in raw.groups[name].items() if k != "point"} for name in thin}
    nodes = np.unique(np.concatenate([v.ravel() for parts in used.values() for v in parts.values()]))
    shells = _corners(used, 2)
    on = {
        name: parts
        for name, parts in raw.groups.items()
        if name and name not in thin and _lies(parts, nodes, shells) and np.isin(_nodes(parts), nodes).any()
    }
    others = {name: parts for name, parts in raw.groups.items() if name not in thin and name not in on}
    flat = [
        (name, *_plain(kind, cells)) for name, parts in (*used.items(), *on.items()) for kind, cells in parts.items()
    ]
    points, cells, ends = with_middles(raw.points, [(kind, rows) for _, kind, rows in flat if kind != "point"])
    made, result = iter(cells), dict[str, dict[str, Numbers]]()
    for name, kind, rows in flat:
        known, numbers = ("point", rows) if kind == "point" else next(made)
        mine = result.setdefault(name, {})
        mine[known] = np.concatenate([mine[known], numbers]) if known in mine else numbers
    return Sorted(points, {name: result[name] for name in thin}, {name: result[name] for name in on}, others, ends)


def _plain(kind: str, cells: Numbers) -> tuple[str, Numbers]:
    """Without nodes in the middle of faces."""
    return ("quad8", cells[:, :8]) if kind == "quad9" else (kind, cells)


def _nodes(parts: Mapping[str, Numbers]) -> Numbers:
    return np.concatenate([cells.ravel() for cells in parts.values()])


def _corners(groups: Mapping[str, Mapping[str, Numbers]], dim: int) -> Numbers:
    """Sorted corners (n, 4) of cells, -1 where there are three."""
    found = [np.empty((0, 4), np.int64)]
    for parts in groups.values():
        for kind, cells in parts.items():
            if kind != "point" and CELLS[kind].dim == dim:
                corners = np.sort(cells[:, : CELLS[kind].corners], axis=1)
                found.append(np.pad(corners, ((0, 0), (0, 4 - corners.shape[1])), constant_values=-1))
    return np.concatenate(found)


def _lies(parts: Mapping[str, Numbers], nodes: Numbers, shells: Numbers) -> bool:
    """Whether a group has no solid cells, and faces only that are cells of shells."""
    dims = {0 if kind == "point" else CELLS[kind].dim for kind in parts}
    if 3 in dims:
        return False
    if 2 not in dims:
        return True
    own = _corners({"": parts}, 2)
    codes = row_codes(np.concatenate([shells, own]))
    return bool(np.isin(codes[len(shells) :], codes[: len(shells)]).all())
