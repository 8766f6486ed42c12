"""Groups of nodes and cells of a code_aster mesh, also those that a command file makes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from typing import Any

import numpy as np
from aster_commands import Command, entries, several
from foreign_mesh import ForeignMesh, NotReadable
from numpy.typing import NDArray

PLACES = ("TOUT", "GROUP_NO", "GROUP_MA", "NOEUD", "MAILLE")


def cells(mesh: ForeignMesh, entry: Mapping[str, Any], groups: tuple[str, ...] = ("GROUP_MA",)) -> list[str]:
    """Names of the cells or facets that an entry names."""
    if entry.get("TOUT"):
        return [name for part in mesh.parts for name in part.names]
    found: list[str] = []
    for key in groups:
        for group in several(entry.get(key)):
            if group not in mesh.cell_groups:
                raise NotReadable(f"no group of cells {group!r}")
            found += mesh.cell_groups[group]
    found += [str(name) for name in several(entry.get("MAILLE"))]
    return list(dict.fromkeys(found))


def nodes(mesh: ForeignMesh, entry: Mapping[str, Any]) -> NDArray[np.int64]:
    """Rows of the points that an entry names, by groups of nodes or cells, or one by one, but for SANS_GROUP_NO."""
    found: list[str] = [str(name) for name in several(entry.get("NOEUD"))]
    for group in several(entry.get("GROUP_NO")):
        if group not in mesh.node_groups:
            raise NotReadable(f"no group of nodes {group!r}")
        found += mesh.node_groups[group]
    rows = mesh.rows(found)
    if any(entry.get(key) for key in ("TOUT", "GROUP_MA", "MAILLE")):
        rows = np.concatenate([rows, mesh.nodes_of_cells(cells(mesh, entry))])
    without = [n for group in several(entry.get("SANS_GROUP_NO")) for n in mesh.node_groups.get(group, ())]
    return np.setdiff1d(rows, mesh.rows(without))


def add_groups(mesh: ForeignMesh, command: Command) -> None:
    """What DEFI_GROUP adds; groups made in other ways than those below are not there, and missed where they are used."""
    for entry in entries(command, "CREA_GROUP_MA"):
        with suppress(NotReadable):
            mesh.cell_groups[entry["NOM"]] = _combined(entry, mesh.cell_groups, lambda e: cells(mesh, e), mesh)
    for entry in entries(command, "CREA_GROUP_NO"):
        if entry.get("TOUT_GROUP_MA"):
            names = list(mesh.cell_groups)
        elif "NOM" not in entry and "OPTION" not in entry:
            names = several(entry.get("GROUP_MA"))
        else:
            with suppress(NotReadable):
                mesh.node_groups[entry["NOM"]] = _combined(entry, mesh.node_groups, lambda e: _near(mesh, e), mesh)
            continue
        for name in names:
            mesh.node_groups.setdefault(name, _names(mesh, mesh.nodes_of_cells(cells(mesh, {"GROUP_MA": name}))))


def _combined(entry: Mapping[str, Any], groups: Mapping[str, list[str]], single: Any, mesh: ForeignMesh) -> list[str]:
    for key in ("UNION", "INTERSEC", "DIFFE"):
        if key in entry:
            parts = [groups[name] for name in several(entry[key]) if name in groups]
            if len(parts) < len(several(entry[key])):
                raise NotReadable(f"DEFI_GROUP: a group of {key} is not there")
            if key == "UNION":
                return list(dict.fromkeys(n for part in parts for n in part))
            rest = [set(part) for part in parts[1:]]
            return [n for n in parts[0] if all((n in other) == (key == "INTERSEC") for other in rest)]
    if "TYPE_MAILLE" in entry:
        raise NotReadable("DEFI_GROUP by type of cell")
    found = single(entry)
    return found if isinstance(found, list) else _names(mesh, found)


def _near(mesh: ForeignMesh, entry: Mapping[str, Any]) -> NDArray[np.int64]:
    option = entry.get("OPTION")
    if option is None:
        return nodes(mesh, entry)
    x, near = mesh.points, float(entry.get("PRECISION", 1e-3))
    if option in ("PLAN", "ENV_SPHERE") and "POINT" in entry:
        away = x - np.array(entry["POINT"], dtype=float)[: x.shape[1]]
        if option == "PLAN":
            normal = np.array(entry["VECT_NORMALE"], dtype=float)[: x.shape[1]]
            return np.flatnonzero(np.abs(away @ normal) <= near * np.linalg.norm(normal))
        return np.flatnonzero(np.abs(np.linalg.norm(away, axis=1) - float(entry["RAYON"])) <= near)
    raise NotReadable(f"DEFI_GROUP, OPTION {option}")


def _names(mesh: ForeignMesh, rows: Iterable[int]) -> list[str]:
    return [mesh.names[int(i)] for i in rows]
