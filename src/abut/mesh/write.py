"""A mesh with its names to a VTU file, which ``Mesh.read`` gives back."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from abut.cells import BY_CODE
from abut.errors import InputError
from abut.io.vtu import write_vtu
from abut.mesh.mesh import Mesh
from abut.types import Array


def write_mesh(path: Path, mesh: Mesh) -> None:
    """Write bodies, surfaces and node sets (as vertices) as cells with the arrays ``region`` and ``region_names``
    (``abut.io.vtu.read_vtu``).

    Raises InputError where two of them share a name, which that format cannot hold, and where the file cannot be written.
    """
    names = [*mesh.bodies, *mesh.surfaces, *mesh.node_sets]
    both = [name for name, count in Counter(names).items() if count > 1]
    if both:
        raise InputError(
            f"cannot write {path}: two of a body, a surface and a node set are all named '{both[0]}'; rename one"
        )
    parts: list[tuple[str, Array]] = []
    region: list[NDArray[np.int32]] = []
    for name in mesh.bodies:
        parts += [(kind, nodes) for kind, nodes, _ in mesh.cells_of(name)]
        region += [np.full(len(nodes), names.index(name), np.int32) for _, nodes, _ in mesh.cells_of(name)]
    for name in mesh.surfaces:
        surface = mesh.surface(name)
        for code in np.unique(surface.kinds):
            kind = BY_CODE[int(code)]
            of_kind = surface.nodes[surface.kinds == code, : kind.nodes]
            parts.append((kind.name, of_kind))
            region.append(np.full(len(of_kind), names.index(name), np.int32))
    for name, nodes in mesh.node_sets.items():
        parts.append(("point", nodes[:, None]))
        region.append(np.full(len(nodes), names.index(name), np.int32))
    write_vtu(path, mesh.points, parts, {}, {"region": np.concatenate(region)}, {"region_names": names})
