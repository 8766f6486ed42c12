"""Where errors of the pressure in fits of unstructured meshes come from: the gap between the facets, or the cells.

python bench/fits/sources.py; needs gmsh, which a `bench` install brings. At small displacements the pressure goes with the
interference, and so does every error of the cells; what facets stand off the round surface is a length of its own, whose
share falls as the interference grows. Of fits with known pressure (Lame): errors with the given interference and with a
hundred times it; how far the surface that gaps are taken from lies from the round one at most, over the interference; and,
in the plane, pressures by the nodal forces that exact displacements give in the inner ring's cells, without any contact.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import gmsh
import numpy as np
from numpy.typing import NDArray

import abut
from abut._core import shape_functions
from abut.cells import BY_CODE, CELLS
from abut.contact.bulge import at_reference, with_bulge
from abut.mesh.make import join, ring
from abut.mesh.surface import Surface

sys.path.insert(0, str(Path(__file__).parents[1] / "certificate"))
from unseen import lame, meshed, shell

Array = NDArray[np.float64]
BRASS, STEEL = abut.LinearElastic(100e3, 0.34), abut.LinearElastic(210e3, 0.3)
LARGER = 100.0
PLACES = np.array([(i, j) for i in range(11) for j in range(11 - i)]) / 10.0  # on triangles
HEADER = f"{'fit':52s} {'facets off':>11s}  {'mean':>6s} {'most':>7s} {'least':>7s}  interference"


@dataclass(frozen=True)
class Fit:
    """parts: the inner one first; sides: target and contactor as named; give: interference over pressure; radius: of the
    common surface."""

    name: str
    parts: dict[str, abut.Mesh]
    materials: tuple[abut.LinearElastic, abut.LinearElastic]
    held: tuple[str, ...]
    interference: float
    give: float
    radius: float
    plane: str | None = None

    def model(self, interference: float) -> abut.Model:
        inner, outer = self.parts
        return abut.Model(
            join(self.parts), [abut.Solid(part, m) for part, m in zip(self.parts, self.materials)],
            [abut.Support(f"{part}.{side}", normal=0) for part in self.parts for side in self.held],
            contacts=[abut.Contact(contactor=f"{inner}.outer", target=f"{outer}.inner", offset=-interference)],
            plane=self.plane,
        )  # fmt: skip


def balls(size: float) -> Fit:
    """A ball of tet4 in a hollow ball of tet10 whose cells have the given size."""
    r, b = 10.0, 16.0
    hollow = ((1 - 2 * STEEL.poisson) * r**3 + 0.5 * (1 + STEEL.poisson) * b**3) / (b**3 - r**3)
    give = (1 - 2 * BRASS.poisson) / BRASS.young * r + r / STEEL.young * hollow
    parts = {"ball": shell((0.0, r), 1.5, 1), "shell": shell((r, b), size, 2)}
    return Fit(f"ball tet4 in a shell of tet10 of {size:g}", parts, (BRASS, STEEL), ("x0", "y0", "z0"), 0.02, give, r)


def sleeve(inner: float, outer: float, size: float, order: int) -> abut.Mesh:
    """A quarter of a ring of unstructured triangles; surfaces inner, outer, start, end."""

    def build() -> None:
        occ = gmsh.model.occ
        middle = occ.addPoint(0, 0, 0)
        ends = [occ.addPoint(*xy, 0) for xy in ((inner, 0), (outer, 0), (0, outer), (0, inner))]
        lines = [
            occ.addLine(ends[0], ends[1]), occ.addCircleArc(ends[1], middle, ends[2]), occ.addLine(ends[2], ends[3]),
            occ.addCircleArc(ends[3], middle, ends[0]),
        ]  # fmt: skip
        face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
        occ.synchronize()
        gmsh.model.addPhysicalGroup(2, [face], name="body")
        for line, name in zip(lines, ("start", "outer", "end", "inner")):
            gmsh.model.addPhysicalGroup(1, [line], name=name)

    return meshed(build, lambda *_: size, order, 2)


RADII = (0.75, 1.0, 1.75)


def bush(order: int) -> Fit:
    """A brass bush of unstructured triangles in a steel ring of quad4."""
    parts = {"bush": sleeve(*RADII[:2], 0.09, order), "ring": ring(RADII[1:], cells=(8, 12), cell="quad4")}
    give = lame(BRASS, STEEL, RADII, "strain")
    name = f"bush of {'tri3' if order == 1 else 'tri6'} in a ring of quad4"
    return Fit(name, parts, (BRASS, STEEL), ("start", "end"), 0.001, give, RADII[1], "strain")


def off(surface: Surface, radius: float) -> float:
    """How far the surface that gaps are taken from lies from the round one at most."""
    surface = with_bulge(surface)
    kind = BY_CODE[int(surface.kinds[0])].name
    xi = np.linspace(-1.0, 1.0, 21)[:, None] if surface.dim == 2 else PLACES
    shapes, _ = shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))
    x = np.einsum("pn,fnd->fpd", shapes, surface.points[surface.nodes[:, : CELLS[kind].nodes]])
    bulge = np.stack([at_reference(surface, kind, np.full(len(xi), facet), xi) for facet in range(len(surface))])
    # Chords lie inside of the round surface, on a shaft below its facets' outward side, in a bore above it.
    return float(np.abs(np.linalg.norm(x, axis=2) + np.abs(bulge) - radius).max())


def errors(fit: Fit, interference: float) -> tuple[float, float, float]:
    """Mean, largest and least relative error of the reported pressures."""
    contact = abut.solve(fit.model(interference)).contacts[0]
    used = (contact.contactor.nodes >= 0) & contact.covered[:, None]
    _, first = np.unique(contact.contactor.nodes[used], return_index=True)
    error = contact.pressure[used][first] / (interference / fit.give) - 1.0
    return float(error.mean()), float(error.max()), float(error.min())


def by_exact_displacements(fit: Fit) -> tuple[float, float, float]:
    """Of the inner ring's triangles of first order in plane strain: mean, largest and least relative error of its nodal
    forces under Lame's displacements, over the length of chords at a node; nodes on planes of symmetry left out."""
    material, p = fit.materials[0], fit.interference / fit.give
    mesh = fit.parts["bush"]
    a, b = RADII[:2]
    shear, nu = material.young / (2.0 * (1.0 + material.poisson)), material.poisson
    x = mesh.points[:, :2]
    r = np.linalg.norm(x, axis=1)
    u = -p * b**2 / (2.0 * shear * (b**2 - a**2)) * ((1.0 - 2.0 * nu) * r + a**2 / r)
    surface = mesh.surface("outer")
    u = x / r[:, None] * u[:, None]
    lame1 = 2.0 * shear * nu / (1.0 - 2.0 * nu)
    force = np.zeros_like(x)
    for triangle in next(block.nodes for block in mesh.blocks if block.kind == "tri3"):
        edges = np.column_stack([x[triangle[1]] - x[triangle[0]], x[triangle[2]] - x[triangle[0]]])
        slopes = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]]) @ np.linalg.inv(edges)
        gradient = u[triangle].T @ slopes
        strain = 0.5 * (gradient + gradient.T)
        stress = 2.0 * shear * strain + lame1 * np.trace(strain) * np.eye(2)
        force[triangle] += 0.5 * abs(np.linalg.det(edges)) * slopes @ stress
    ends = surface.nodes[:, :2]
    half = 0.5 * np.linalg.norm(surface.points[ends[:, 1]] - surface.points[ends[:, 0]], axis=1)
    length = np.bincount(ends.ravel(), np.repeat(half, 2), len(x))
    inside = np.flatnonzero(np.bincount(ends.ravel(), minlength=len(x)) == 2)
    error = -(force[inside] * x[inside] / r[inside, None]).sum(axis=1) / length[inside] / p - 1.0
    return float(error.mean()), float(error.max()), float(error.min())


def rows(fit: Fit) -> Iterator[str]:
    """Lines of the table."""
    inner, outer = fit.parts
    mesh = join(fit.parts)
    away = max(off(mesh.surface(f"{inner}.outer"), fit.radius), off(mesh.surface(f"{outer}.inner"), fit.radius))
    for times in (1.0, LARGER):
        share = f"{100 * away / (times * fit.interference):9.2f} %"
        mean, most, least = (100.0 * value for value in errors(fit, times * fit.interference))
        interference = f"{times * fit.interference:g}"
        yield f"{fit.name:52s} {share:>11s}  {mean:+6.2f} {most:+7.2f} {least:+7.2f}  {interference}"


def main() -> None:
    """Print a table."""
    print(HEADER)
    for fit in (balls(2.5), balls(1.8), bush(1), bush(2)):
        for row in rows(fit):
            print(row, flush=True)
    mean, most, least = (100.0 * value for value in by_exact_displacements(bush(1)))
    print(f"{'forces of exact displacements in the tri3 bush':52s} {'':11s}  {mean:+6.2f} {most:+7.2f} {least:+7.2f}")


if __name__ == "__main__":
    main()
