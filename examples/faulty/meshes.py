"""Makes the two meshes with mistakes in them, in Gmsh's format: a target surface too small, some cells inside out."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from abut.mesh.make import join, rectangle
from abut.mesh.mesh import Mesh

HERE = Path(__file__).parent


def main() -> None:
    mesh = join(
        {
            "lower": rectangle(x=(0, 10), y=(0, 4), cells=(8, 3), cell="quad4"),
            "upper": rectangle(x=(2, 8), y=(4, 7), cells=(5, 2), cell="quad4"),
        }
    )
    left_part = {**mesh.surfaces, "lower.top": mesh.surfaces["lower.top"][:3]}
    write_gmsh(HERE / "small-target.msh", mesh, left_part, reverse=())
    write_gmsh(HERE / "inside-out.msh", mesh, dict(mesh.surfaces), reverse=("upper",))


def write_gmsh(path: Path, mesh: Mesh, surfaces: dict[str, np.ndarray], reverse: tuple[str, ...]) -> None:
    """Quadrilaterals and named edges as MSH 2.2; the first 4 cells of the bodies ``reverse`` with their nodes the wrong
    way round."""
    names = [*((1, name) for name in surfaces), *((2, name) for name in mesh.bodies)]
    elements = []
    for tag, (dim, name) in enumerate(names, start=1):
        if dim == 1:
            cells = mesh.facets(surfaces[name]).nodes[:, :2]
        else:
            cells = np.concatenate([nodes for _, nodes, _ in mesh.cells_of(name)])
            cells = np.concatenate([cells[:4, ::-1], cells[4:]]) if name in reverse else cells
        elements += [f"{1 if dim == 1 else 3} 2 {tag} {tag} {' '.join(str(n + 1) for n in cell)}" for cell in cells]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names))]
    lines += [f'{dim} {tag} "{name}"' for tag, (dim, name) in enumerate(names, start=1)]
    lines += ["$EndPhysicalNames", "$Nodes", str(len(mesh.points))]
    lines += [f"{i} {x:.12g} {y:.12g} 0" for i, (x, y) in enumerate(mesh.points, start=1)]
    lines += ["$EndNodes", "$Elements", str(len(elements))]
    lines += [f"{i} {element}" for i, element in enumerate(elements, start=1)]
    path.write_text("\n".join([*lines, "$EndElements", ""]), encoding="utf-8")


if __name__ == "__main__":
    main()
