"""A mesh with its names to a VTU file, which ``Mesh.read`` gives back."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut.cells import BY_CODE
from abut.errors import InputError
from abut.io.vtu import write_vtu
from abut.mesh.mesh import Mesh


def write_mesh(path: Path, mesh: Mesh) -> None:
    """Write bodies and surfaces as cells with the arrays ``region`` and ``region_names`` (``abut.io.vtu.read_vtu``).

    Node sets have no place in that format: raises InputError where the mesh has some, rather than lose them, where a
    body and a surface share a name, and where the file cannot be written.
    """
    if mesh.node_sets:
        raise InputError(
            f"cannot write {path}: VTU files hold no node sets; take {', '.join(mesh.node_sets)} out first"
        )
    both = sorted(set(mesh.bodies) & set(mesh.surfaces))
    if both:
        raise InputError(f"cannot write {path}: a body and a surface are both named '{both[0]}'; rename one")
    parts: list[tuple[str, NDArray[Any]]] = []
    region: list[NDArray[np.int32]] = []
    names = [*mesh.bodies, *mesh.surfaces]
    for name in mesh.bodies:
        parts += [(kind, nodes) for kind, nodes, _ in mesh.cells_of(name)]
        region += [np.full(len(nodes), names.index(name), np.int32) for _, nodes, _ in mesh.cells_of(name)]
    for name in mesh.surfaces:
        surface = mesh.surface(name)
        for code in np.unique(surface.kinds):
            kind = BY_CODE[int(code)]
            own = surface.nodes[surface.kinds == code, : kind.nodes]
            parts.append((kind.name, own))
            region.append(np.full(len(own), names.index(name), np.int32))
    write_vtu(path, mesh.points, parts, {}, {"region": np.concatenate(region)}, {"region_names": names})
