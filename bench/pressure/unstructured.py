"""A quarter of a ball on a block of Gmsh's tetrahedra: python bench/pressure/unstructured.py CELL FACETS [contactor].

CELL: tet4 or tet10; FACETS: over two thirds of the radius of contact; errors of the reported pressure inside 0.9 a over
Hertz's peak, and what ``abut check`` says beforehand. Needs gmsh, which a `bench` install brings.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import gmsh
import numpy as np

import abut

RADIUS, CONTACT, SIZE, NU = 8.0, 0.6, 4.0, 0.3
MODULUS = 0.5 * 1000.0 / (1.0 - NU**2)  # of both
DOWN = CONTACT**2 / RADIUS


def mesh(facets: float, order: int, block: float = 1.25) -> abut.Mesh:
    """Of size CONTACT / facets at the contact on the ball, ``block`` times that on the block."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    occ = gmsh.model.occ
    ball = occ.addSphere(0, 0, RADIUS, RADIUS)
    part = occ.addBox(0, 0, 0, SIZE, SIZE, SIZE)
    occ.intersect([(3, ball)], [(3, part)])
    lower = occ.addBox(0, 0, -SIZE, SIZE, SIZE, SIZE)
    occ.synchronize()
    volumes = [tag for _, tag in gmsh.model.getEntities(3)]
    upper = next(tag for tag in volumes if tag != lower)
    for name, tag in (("ball", upper), ("block", lower)):
        gmsh.model.addPhysicalGroup(3, [tag], name=name)
        groups: dict[str, list[int]] = {}
        for _, face in gmsh.model.getBoundary([(3, tag)], oriented=False):
            low, high = np.array(gmsh.model.getBoundingBox(2, face)).reshape(2, 3)
            groups.setdefault(_side(name, low, high), []).append(face)
        for side, faces in groups.items():
            gmsh.model.addPhysicalGroup(2, faces, name=f"{name}.{side}")
    size = CONTACT / facets
    gmsh.model.mesh.setSizeCallback(
        lambda dim, tag, x, y, z, lc: (
            size * (block if z < -1e-9 else 1.0) * max(1.0, (np.linalg.norm([x, y, z]) / CONTACT - 0.6) * 1.5)
        )
    )
    for option in ("MeshSizeFromPoints", "MeshSizeExtendFromBoundary", "MeshSizeFromCurvature"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(order)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "ball.msh"
        gmsh.write(str(path))
        gmsh.finalize()
        return abut.Mesh.read(path)


def _side(body: str, low: np.ndarray, high: np.ndarray) -> str:
    for axis, name in ((0, "x0"), (1, "y0")):
        if high[axis] < 1e-3:
            return name
    if body == "ball":
        return "far" if low[2] > SIZE - 1e-3 else "round" if low[2] < 1e-3 and high[2] < SIZE - 1e-3 else "side"
    return "top" if low[2] > -1e-3 else "far" if high[2] < 1e-3 - SIZE else "side"


def model(cell: str, facets: float, contactor: str = "ball", **contact: object) -> abut.Model:
    steel = abut.LinearElastic(1000.0, NU)
    sides = ("ball.round", "block.top") if contactor == "ball" else ("block.top", "ball.round")
    return abut.Model(
        mesh(facets, 1 if cell == "tet4" else 2),
        [abut.Solid(body, steel) for body in ("ball", "block")],
        [
            *(abut.Support(f"{body}.{side}", **{side[0]: 0.0}) for body in ("ball", "block") for side in ("x0", "y0")),
            abut.Support("block.far", z=0.0),
            abut.Support("ball.far", z=-2.0 * DOWN),
        ],
        contacts=[abut.Contact(contactor=sides[0], target=sides[1], **contact)],
    )


def errors(solution: abut.Solution) -> tuple[float, float, float]:
    """Radius of contact by the force, mean and largest error over the peak."""
    contact = solution.contacts[0]
    force = 4.0 * abs(float(contact.force[2]))
    radius = (0.75 * force * RADIUS / MODULUS) ** (1.0 / 3.0)
    peak = 1.5 * force / (np.pi * radius**2)
    used = contact.contactor.nodes >= 0
    nodes, first = np.unique(contact.contactor.nodes[used], return_index=True)
    r = np.linalg.norm(contact.contactor.points[nodes, :2], axis=1) / radius
    error = np.abs(contact.pressure[used][first] / peak - np.sqrt(np.maximum(0.0, 1.0 - r**2)))[r < 0.9]
    return radius, float(error.mean()), float(error.max())


def main() -> None:
    cell, facets, *contactor = sys.argv[1:]
    made = model(cell, float(facets), *contactor)
    solution = abut.solve(made)
    radius, mean, most = errors(solution)
    check = next(c for c in solution.certificate if c.name == "pressure error")
    print(
        f"{cell}, a = {radius:.3f}, {radius / CONTACT * float(facets):.1f} facets over it: "
        f"mean {100 * mean:.1f} %, largest {100 * most:.1f} %, estimate {100 * check.value:.1f} % ({check.verdict})"
    )
    for finding in abut.check(made).findings:
        if "tet4" in finding.what:
            print(f"check: {finding.what}; {finding.cure}")


if __name__ == "__main__":
    main()
