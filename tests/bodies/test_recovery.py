"""Recovered stresses: what they reproduce, what they keep apart, where samples are few."""

from __future__ import annotations

import numpy as np
import pytest

from abut._core import shape_functions
from abut.bodies.recovery import at_points, energies, recovered
from abut.bodies.solids import Array, Solids
from abut.cells import CELLS
from abut.materials.elastic import LinearElastic
from abut.mesh.make import box, join, rectangle
from abut.mesh.mesh import Mesh
from abut.mesh.patches import corner_weights

EVERY = [kind for kind, cell in CELLS.items() if cell.dim > 1]
MATERIAL = LinearElastic(2.0, 0.3)


def mesh(kind: str, cells: tuple[int, ...]) -> Mesh:
    make = rectangle if CELLS[kind].dim == 2 else box
    return make(cells=cells, cell=kind)


def sampled(solids: Solids, field: Array, level: Array) -> list[Array]:
    """A linear stress at the integration points."""
    stress = []
    for group in solids.groups():
        shapes, _ = shape_functions(CELLS[group.kind].code, np.ascontiguousarray(group.rule[0]))
        stress.append((shapes @ solids.points[group.nodes]) @ field + level)
    return stress


@pytest.mark.parametrize("integration", ["full", "reduced"])
@pytest.mark.parametrize("kind", EVERY)
def test_linear_stresses_are_reproduced(kind: str, integration: str) -> None:
    """To rounding, on moved nodes, where two layers of cells tell slopes: polynomials hold them, samples lie on them. The
    estimated error is then that of elements that cannot show them, none for types that can."""
    if integration == "reduced" and kind not in ("tri6", "quad8", "tet10", "hex20", "wedge15"):
        pytest.skip("is not for this type")
    dim, random = CELLS[kind].dim, np.random.default_rng(2)
    whole = mesh(kind, (4, 3) if dim == 2 else (3, 3, 3))
    points = whole.points + 0.05 * np.sin(3.0 * whole.points[:, ::-1])
    for block in whole.blocks:  # edges stay straight: curved ones carry linear stresses from point to point almost
        points[block.nodes] = corner_weights(kind) @ points[block.nodes[:, : CELLS[kind].corners]]
    whole = Mesh(points, whole.blocks, whole.bodies, whole.surfaces, whole.node_sets)
    solids = Solids(whole, dict.fromkeys(whole.bodies, MATERIAL), "strain" if dim == 2 else None,
                    dict.fromkeys(whole.bodies, integration))  # fmt: skip
    field, level = random.normal(size=(dim, 6)), random.normal(size=6)
    if dim == 2:
        field[:, 4:], level[4:] = 0.0, 0.0
    stress = sampled(solids, field, level)
    values = recovered(solids, solids.points, stress)
    exact = solids.points[solids.patches.point] @ field + level
    assert np.abs(values - exact).max() < (1e-10 if dim == 3 else 1e-11)
    if CELLS[kind].degree == 2 or kind in ("quad4", "hex8", "wedge6"):
        error, energy, _ = energies(solids, solids.points, stress, values).sum(axis=0)
        assert error < 1e-20 * energy


@pytest.mark.parametrize("kind", EVERY)
def test_a_single_cell_shows_what_it_holds(kind: str) -> None:
    """Few samples: constant stresses to rounding, and never more than what there is by much."""
    whole = mesh(kind, (1,) * CELLS[kind].dim)
    solids = Solids(whole, dict.fromkeys(whole.bodies, MATERIAL), "strain" if CELLS[kind].dim == 2 else None)
    (group,) = solids.groups()
    level = np.array([3.0, -1.0, 2.0, 0.5, 0.0, 0.0])
    stress = np.tile(level, (len(group.cells), len(group.rule[1]), 1))
    assert np.abs(recovered(solids, solids.points, [stress]) - level).max() < 1e-13
    random = np.random.default_rng(4).uniform(-1.0, 1.0, (*stress.shape[:2], 4))
    stress[..., :4] = random
    assert np.abs(recovered(solids, solids.points, [stress])).max() < 12.0


def test_bodies_that_share_points_do_not_mix() -> None:
    """Two layers of different stress: each body shows its own up to the border, the point their mean."""
    glued = rectangle((0.0, 2.0), (0.0, 2.0), (4, 4), "quad4")
    middle = glued.points[glued.blocks[0].nodes].mean(axis=1)[:, 1]
    bodies = {"low": np.flatnonzero(middle < 1.0), "high": np.flatnonzero(middle > 1.0)}
    glued = Mesh(glued.points, glued.blocks, bodies, glued.surfaces, {})
    solids = Solids(glued, dict.fromkeys(bodies, MATERIAL), "strain")
    level = np.where(middle < 1.0, 1.0, 5.0)[:, None, None]
    stress = [level[group.cells] * np.ones((1, len(group.rule[1]), 6)) for group in solids.groups()]
    values, of = recovered(solids, solids.points, stress), solids.patches
    assert of.shared
    assert values[of.body == 0, 0] == pytest.approx(1.0)
    assert values[of.body == 1, 0] == pytest.approx(5.0)
    border = np.abs(glued.points[:, 1] - 1.0) < 1e-9
    assert at_points(of, values, len(glued.points))[border, 0] == pytest.approx(3.0)


def test_bodies_beside_each_other_are_apart() -> None:
    mesh = join({"a": rectangle(cells=(3, 3)), "b": rectangle((1.0, 2.0), cells=(3, 3))})
    solids = Solids(mesh, dict.fromkeys(mesh.bodies, MATERIAL), "strain")
    assert not solids.patches.shared
    assert len(solids.patches.point) == len(mesh.points)
