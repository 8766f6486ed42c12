"""A clevis under tension: how many linear solutions, and how long, on meshes of twenty sizes under loads over two decades.

An eye between the cheeks of a fork, with a pin through both; a quarter of it, cut by the planes y = 0 and z = 0. The fork is
held at its end; a force pulls at the eye. Pin and eye are held by contact alone, and nothing touches before they move.

python bench/clevis.py [--sizes 3.8 1.4] [--count 20] [--forces 100 1000 10000] [--law constraint-function] [--linear amg]
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np

import abut

HOLE, CLEARANCE, OUTER, LENGTH = 6.0, 0.05, 12.0, 30.0  # mm
EYE, CHEEK = 5.0, (5.5, 11.5)  # half thickness of the eye; a cheek between two heights
STEEL = abut.LinearElastic(210e3, 0.3)


def mesh(size: float) -> abut.Mesh:
    """Tetrahedra tet10 of a size, by Gmsh."""
    import gmsh

    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        bodies = {
            "eye": _lug(gmsh.model.occ, (0.0, EYE), 1.0),
            "fork": _lug(gmsh.model.occ, CHEEK, -1.0),
            "pin": _upper(gmsh.model.occ, gmsh.model.occ.addCylinder(0, 0, 0, 0, 0, CHEEK[1] + 0.5, HOLE - CLEARANCE)),
        }
        gmsh.model.occ.synchronize()
        for name, tag in bodies.items():
            gmsh.model.addPhysicalGroup(3, [tag], name=name)
            for side, tags in _sides(gmsh.model, tag).items():
                gmsh.model.addPhysicalGroup(2, tags, name=f"{name}.{side}")
        for option, value in {"MeshSizeMax": size, "MeshSizeMin": size, "RandomSeed": 1}.items():
            gmsh.option.setNumber(f"Mesh.{option}", value)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        gmsh.model.mesh.optimize("HighOrderElastic")
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "clevis.msh"
            gmsh.write(str(path))
            return abut.Mesh.read(path)
    finally:
        gmsh.finalize()


def _upper(occ: object, tag: int) -> int:
    """The half of a solid with y >= 0."""
    half = occ.addBox(-100, 0, -100, 200, 100, 200)
    return occ.intersect([(3, tag)], [(3, half)])[0][0][1]


def _lug(occ: object, heights: tuple[float, float], way: float) -> int:
    """The upper half of a plate with a round end and a hole, that goes the way of x."""
    low, high = heights
    head = occ.addCylinder(0, 0, low, 0, 0, high - low, OUTER)
    shank = occ.addBox(min(0.0, way * LENGTH), -OUTER, low, LENGTH, 2 * OUTER, high - low)
    hole = occ.addCylinder(0, 0, low, 0, 0, high - low, HOLE)
    whole = occ.cut(occ.fuse([(3, head)], [(3, shank)])[0], [(3, hole)])[0][0][1]
    return _upper(occ, whole)


def _sides(model: object, tag: int) -> dict[str, list[int]]:
    """Surfaces of a solid by where they lie: round (hole or pin), y (plane y = 0), z (plane z = 0), end."""
    found: dict[str, list[int]] = {}
    for _, side in model.getBoundary([(3, tag)], oriented=False):
        low, high = np.reshape(model.getBoundingBox(2, side), (2, 3))
        kind = model.getType(2, side)
        if kind == "Cylinder" and high[1] < HOLE + 1.0:
            found.setdefault("round", []).append(side)
        elif kind == "Plane":
            for name, axis, at in (("y", 1, 0.0), ("z", 2, 0.0), ("end", 0, LENGTH), ("end", 0, -LENGTH)):
                if max(abs(low[axis] - at), abs(high[axis] - at)) < 1e-3:
                    found.setdefault(name, []).append(side)
    return found


def clevis(where: abut.Mesh, force: float, law: str = "complementarity", **solve: object) -> abut.Model:
    """``force``: on the whole clevis, N; a quarter of it on the quarter."""
    return abut.Model(
        where,
        [abut.Solid(body, STEEL) for body in ("eye", "fork", "pin")],
        [
            *(abut.Support(f"{body}.y", y=0.0) for body in ("eye", "fork", "pin")),
            *(abut.Support(f"{body}.z", z=0.0) for body in ("eye", "pin")),
            abut.Support("fork.end", x=0.0, y=0.0, z=0.0),
        ],
        [abut.Force("eye.end", (0.25 * force, 0.0, 0.0))],
        [abut.Contact(contactor=f"{body}.round", target="pin.round", name=body, law=law) for body in ("eye", "fork")],
        solve=abut.SolveOptions(**solve),
    )


def runs(sizes: list[float], forces: list[float], law: str, linear: str) -> Iterator[str]:
    """A row of the table for each."""
    for size in sizes:
        where = mesh(size)
        for force in forces:
            clock = time.perf_counter()
            solution = abut.solve(clevis(where, force, law, linear=linear))
            seconds = time.perf_counter() - clock
            krylov = [note.split()[0] for note in solution.notes if "linear iterations in all" in note]
            cells = (
                f"{size:.2f}",
                solution.dofs,
                f"{force:g}",
                "yes" if solution.converged else "NO",
                len(solution.steps[0].iterations),
                *(krylov or ["-"]),
                sum(contact.active for contact in solution.contacts),
                ", ".join(f"{contact.max_pressure:.4g}" for contact in solution.contacts),
                f"{seconds:.1f}",
                solution.solver,
            )
            yield "| " + " | ".join(map(str, cells)) + " |"


HEAD = "size, mm", "unknowns", "force, N", "converged", "solutions", "Krylov", "active", "largest, MPa", "s", "solver"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=float, nargs=2, default=[3.8, 1.4])
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--forces", type=float, nargs="+", default=[100.0, 1000.0, 10000.0])
    parser.add_argument("--law", default="complementarity")
    parser.add_argument("--linear", default="auto")
    options = parser.parse_args()
    print("| " + " | ".join(HEAD) + " |")
    print("|" + "---|" * len(HEAD))
    for row in runs(list(np.geomspace(*options.sizes, options.count)), options.forces, options.law, options.linear):
        print(row, flush=True)


if __name__ == "__main__":
    main()
