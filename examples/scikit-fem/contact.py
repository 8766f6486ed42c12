"""Contact for another finite element code: scikit-fem solves two elastic bodies, ``abut.contact`` couples them.

    pip install abut scikit-fem
    python contact.py

Everything that abut needs from the other code are the two surfaces: points, facets, and which way is out. What comes back
are matrices: with u the displacements of all points, dim in turn, contactor's points first, and p >= 0 the pressure,

    gap = g + B u        weighted gaps of the multipliers, gap >= 0
    K u - B^T p = f      forces of the pressure on both bodies, p >= 0, p gap = 0

The mesh, the stiffness K, the supports and the linear solutions are scikit-fem's and SciPy's; the segments, the integrals
over them and the pressure space are abut's. ``main`` solves the same with abut alone: both agree to 1e-10.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
import skfem
from scipy.sparse.linalg import spsolve
from skfem.helpers import ddot, eye, sym_grad, trace

import abut
from abut.cells import CELLS, MAX_FACET_NODES
from abut.contact.bulge import with_bulge
from abut.contact.clearance import of_corners
from abut.contact.common_normals import common_normals
from abut.contact.coupling import CouplingOptions, couple, default_reach
from abut.contact.geometry import nodal_normals
from abut.contact.laws import Complementarity, LawState
from abut.contact.pressure_space import pressure_space, resolve
from abut.mesh.make import join
from abut.mesh.mesh import CellBlock
from abut.mesh.surface import Surface

YOUNG, POISSON, PRESSED = 1000.0, 0.3, 0.03


def meshes() -> tuple[skfem.MeshTet, skfem.MeshTet]:
    """A punch with a crowned bottom above a block: tetrahedra that know nothing of each other."""
    punch = skfem.MeshTet.init_tensor(*[np.linspace(0.2, 0.8, 6)] * 2, np.linspace(1.0, 1.5, 4))
    punch = punch.with_boundaries({"bottom": lambda x: x[2] == 1.0, "top": lambda x: x[2] == 1.5})
    x, y, z = punch.p
    crown = 0.1 * ((x - 0.5) ** 2 + (y - 0.45) ** 2) * (1.5 - z) / 0.5
    block = skfem.MeshTet.init_tensor(*[np.linspace(0.0, 1.0, 8)] * 2, np.linspace(0.0, 1.0, 5))
    block = block.with_boundaries({"bottom": lambda x: x[2] == 0.0, "top": lambda x: x[2] == 1.0})
    return replace(punch, doflocs=np.array([x, y, z + crown])), block


def surface(mesh: skfem.MeshTet, name: str) -> Surface:
    """A boundary of a scikit-fem mesh as abut sees it: corners turn so that the normal points out of the body."""
    facets = mesh.boundaries[name]
    corners, points = mesh.facets[:, facets].T, np.ascontiguousarray(mesh.p.T)
    x = points[corners]
    normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    inside = points[mesh.t[:, mesh.f2t[0, facets]].T].mean(axis=1)
    turned = np.einsum("ij,ij->i", normal, x[:, 0] - inside) < 0.0
    corners = np.where(turned[:, None], corners[:, [0, 2, 1]], corners)
    nodes = np.full((len(corners), MAX_FACET_NODES), -1, dtype=np.int32)
    nodes[:, :3] = corners
    unknown = np.full(len(corners), -1)
    return Surface(points, np.full(len(corners), CELLS["tri3"].code, np.uint8), nodes, unknown, unknown, name)


def stiffness(mesh: skfem.MeshTet) -> sp.csr_matrix:
    """scikit-fem's stiffness; its unknowns are the components of each point in turn, as abut's."""
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementTetP1()))
    shear = YOUNG / (2.0 * (1.0 + POISSON))
    lame = YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON))

    @skfem.BilinearForm
    def elasticity(u, v, _):  # type: ignore[no-untyped-def]
        strain = sym_grad(u)
        return ddot(2.0 * shear * strain + lame * eye(trace(strain), 3), sym_grad(v))

    assert (basis.nodal_dofs.T.ravel() == np.arange(basis.N)).all()
    return elasticity.assemble(basis)


def solve() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Displacements (n_points, 3) of punch and block together, the force on the punch, and which multipliers are in contact:
    without a model of abut's."""
    punch, block = meshes()
    # abut's gaps are those of the smooth surfaces that flat facets stand for
    contactor, target = (with_bulge(side) for side in (surface(punch, "bottom"), surface(block, "top")))
    name, degree = resolve("auto", contactor)
    # pressures act along the normals between both sides: half way, as both bodies yield alike
    sides, reach = (nodal_normals(contactor), nodal_normals(target)), default_reach(contactor, target)
    normals = common_normals(contactor, target, *sides, share=0.5, reach=reach, couple=couple)
    options = CouplingOptions(normals=normals, keep_points=True, keep_gap_samples=True)
    coupling = of_corners(contactor, target, couple(contactor, target, degree, options))  # gaps of dual functions
    space = pressure_space(name, contactor, coupling)
    operator = (space.transfer.T @ coupling.operator).tocsr()  # B
    opening = space.transfer.T @ coupling.gap  # g

    matrix = sp.block_diag([stiffness(punch), stiffness(block)]).tocsr()  # K
    top = np.unique(punch.facets[:, punch.boundaries["top"]])
    bottom = punch.nvertices + np.unique(block.facets[:, block.boundaries["bottom"]])
    moved = np.zeros((punch.nvertices + block.nvertices, 3))
    moved[top, 2] = -PRESSED
    held = np.zeros(moved.shape, dtype=bool)
    held[top] = held[bottom] = True
    free, u = np.flatnonzero(~held.ravel()), moved.ravel()

    pressure = np.zeros(len(space))
    active = np.ones(len(space), dtype=bool)
    law = Complementarity(stiffness=YOUNG)  # pressure per length: compares gap and pressure
    for _ in range(30):
        gap = opening + operator @ u
        rows = law.evaluate((gap / space.weight)[:, None], pressure[:, None], LawState(active))
        by_gap, by_pressure = sp.diags(rows.by_jump[:, 0, 0] / space.weight), sp.diags(rows.by_traction[:, 0, 0])
        system = sp.bmat([[matrix[free][:, free], -operator[:, free].T], [by_gap @ operator[:, free], by_pressure]])
        forces = matrix @ u - operator.T @ pressure
        change = spsolve(system.tocsc(), -np.concatenate([forces[free], rows.residual[:, 0]]))
        u[free] += change[: len(free)]
        pressure += change[len(free) :]
        wanted = space.weight * pressure / YOUNG > opening + operator @ u
        if (wanted == active).all():
            break
        active = wanted
    force = (operator.T @ pressure).reshape(-1, 3)[: punch.nvertices].sum(axis=0)
    return u.reshape(-1, 3), force, active


def mesh_of_abut(mesh: skfem.MeshTet, name: str) -> abut.Mesh:
    """The same cells and boundaries as abut's own mesh; abut wants positive volumes."""
    points, cells = np.ascontiguousarray(mesh.p.T), mesh.t.T.astype(np.int32)
    x = points[cells]
    turned = np.linalg.det(x[:, 1:] - x[:, :1]) < 0.0
    cells[turned] = cells[turned][:, [1, 0, 2, 3]]
    surfaces = {}
    for boundary, facets in mesh.boundaries.items():
        own, wanted = mesh.f2t[0, facets], np.sort(mesh.facets[:, facets].T, axis=1)
        rows = np.stack([np.sort(cells[own][:, nodes], axis=1) for _, nodes in CELLS["tet4"].facets], axis=1)
        local = (rows == wanted[:, None]).all(axis=2).argmax(axis=1)
        surfaces[boundary] = np.stack([own, local], axis=1).astype(np.int64)
    return abut.Mesh(points, (CellBlock("tet4", cells),), {name: np.arange(len(cells))}, surfaces)


def solve_with_abut() -> tuple[np.ndarray, np.ndarray]:
    """The same by abut alone."""
    bodies = {name: mesh_of_abut(mesh, name) for name, mesh in zip(("punch", "block"), meshes())}
    mesh = join(bodies)
    material = abut.LinearElastic(YOUNG, POISSON)
    model = abut.Model(
        mesh,
        solids=[abut.Solid(name, material) for name in bodies],
        supports=[abut.Support("block.bottom", x=0, y=0, z=0), abut.Support("punch.top", x=0, y=0, z=-PRESSED)],
        contacts=[abut.Contact(contactor="punch.bottom", target="block.top")],
    )
    solution = abut.solve(model)
    return solution.displacement, solution.contacts[0].force


def main() -> float:
    """Solve twice, print, and return the largest difference of displacement and force, relative to the largest."""
    (u, force, active), (own, own_force) = solve(), solve_with_abut()
    difference = max(np.abs(u - own).max() / PRESSED, np.abs(force - own_force).max() / np.abs(force).max())
    print(f"{active.sum()} of {len(active)} multipliers in contact")
    print(f"force on the punch: scikit-fem with abut.contact {force[2]:.10g}, abut alone {own_force[2]:.10g}")
    print(f"largest relative difference of displacements and forces: {difference:.1e}")
    return float(difference)


if __name__ == "__main__":
    main()
