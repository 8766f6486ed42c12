"""A half whose plane of symmetry is held shows the stresses and pressures of the whole."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.mesh.make import box, join, ring
from abut.mesh.mesh import Mesh
from models.mirrored import whole

Array = NDArray[np.float64]
STEEL = abut.LinearElastic(1000.0, 0.3)
SAME = 1e-9  # of the largest value: rounding of displacements over the size of a cell
FLAT, SOLID = ["tri3", "tri6", "quad4", "quad8", "quad9"], ["tet4", "tet10", "hex8", "hex20", "hex27"]


def tube(radii: tuple[float, float], around: int, cell: str) -> Mesh:
    """A quarter of a ring, or of a tube of height 1: two cells through the wall, so that patches reach a plane."""
    if cell in FLAT:
        return ring(radii, cells=(2, around), cell=cell)
    square = box(radii, (0, 90), (0, 1), cells=(2, around, 3), cell=cell)
    r, turn = square.points[:, 0], np.deg2rad(square.points[:, 1])
    sides = {"inner": "left", "outer": "right", "start": "front", "end": "back", "bottom": "bottom", "top": "top"}
    return replace(
        square,
        points=np.column_stack([r * np.cos(turn), r * np.sin(turn), square.points[:, 2]]),
        surfaces={new: square.surfaces[old] for new, old in sides.items()},
    )


def both(
    parts: Mapping[str, Mesh],
    contacts: list[abut.Contact],
    loads: Callable[[], list[abut.Pressure]],
    fields: Callable[[abut.Solution], list[Array]],
) -> list[tuple[Array, Array]]:
    """Fields at the points of the half, and those of the whole there. The plane of the half is x = 0."""
    found, solid = [], next(iter(parts.values())).dim == 3
    for image in (False, True):
        meshes = {name: whole(mesh, 0) if image else mesh for name, mesh in parts.items()}
        held = [abut.Support(f"{name}.start", y=0.0) for name in parts]
        held += [abut.Support(f"{name}.bottom", z=0.0) for name in parts if solid]
        starts = np.cumsum([0, *(len(mesh.points) for mesh in meshes.values())])
        middles = {  # what keeps the whole in place: where the half is held, so off no contact
            f"{name}.middle": start + part.nodes_of("end") for (name, part), start in zip(parts.items(), starts)
        }
        mesh = join(meshes)
        if image:
            mesh = replace(mesh, node_sets={**mesh.node_sets, **middles})
            held += [abut.Support(name, x=0.0) for name in middles]
        else:
            held += [abut.Support(f"{name}.end", x=0.0) for name in parts]
        solids = [abut.Solid(name, STEEL) for name in parts]
        model = abut.Model(mesh, solids, held, loads(), contacts, plane=None if solid else "strain")
        values = fields(abut.solve(model))
        own = [np.arange(start, start + len(part.points)) for start, part in zip(starts, parts.values())]
        found.append([value[np.concatenate(own)] for value in values])
    return list(zip(*found, strict=True))


def stress(solution: abut.Solution) -> list[Array]:
    return [solution.steps[-1].stress]


def stress_and_pressure(solution: abut.Solution) -> list[Array]:
    contact, mesh = solution.contacts[0], solution.model.mesh
    pressure = np.zeros((2, len(mesh.points)))
    for side, values, row in (
        (contact.contactor, contact.pressure, pressure[0]),
        (contact.target, contact.target_pressure, pressure[1]),
    ):
        used = side.nodes >= 0
        row[side.nodes[used]] = np.nan_to_num(values[used])
    return [solution.steps[-1].stress, *pressure]


@pytest.mark.parametrize("cell", FLAT + SOLID)
def test_stresses(cell: str) -> None:
    """Under a pressure from inside that is not the same all round, symmetric about x = 0; of a body with two planes, three
    in 3D, and with a surface on which the traction is known."""
    pressure = abut.Pressure("tube.inner", lambda x: 1.0 + 0.5 * x[:, 0] ** 2)
    ((half, full),) = both({"tube": tube((1.0, 2.0), 4, cell)}, [], lambda: [pressure], stress)
    assert np.abs(full).max() > 1.0
    assert np.abs(half - full).max() < SAME * np.abs(full).max()


PLAIN = [(cell, SAME) for cell in ("tri3", "quad4", "quad8", "quad9", "tri6")]
CUT = [("tet4", 3e-5), ("tet10", 1e-5), ("hex20", 1e-5)]


@pytest.mark.long
@pytest.mark.parametrize(("cell", "same"), PLAIN + CUT)
@pytest.mark.parametrize("swapped", [False, True])
def test_pressures(cell: str, same: float, swapped: bool) -> None:
    """Of two rings, or tubes with a free end, that do not match. In 3D facets are cut where they end in the plane, which
    leaves 1e-10 of their area, and the multipliers of the last ones apart by 1e-6."""
    parts = {"a": tube((1.0, 2.0), 5, cell), "b": tube((2.0, 3.0), 7, cell)}
    sides = ("a.outer", "b.inner")[:: -1 if swapped else 1]
    contact = abut.Contact(contactor=sides[0], target=sides[1], offset=-0.02)
    for half, full in both(parts, [contact], list, stress_and_pressure):
        assert np.abs(full).max() > 1.0
        assert np.abs(half - full).max() < same * np.abs(full).max()


@pytest.mark.long
@pytest.mark.parametrize(("cell", "same"), [("hex8", SAME), ("tet4", 1e-6)])
def test_displacements_of_tubes(cell: str, same: float) -> None:
    """Of linear cells, whose gaps hang on the surface's curvature, also at its free end. The whole is held across its middle
    plane, at which it does not end."""
    parts = {"a": tube((1.0, 2.0), 5, cell), "b": tube((2.0, 3.0), 7, cell)}
    contact = abut.Contact(contactor="b.inner", target="a.outer", offset=-0.02)
    ((half, full),) = both(parts, [contact], list, lambda s: [s.displacement])
    assert np.abs(half - full).max() < same * np.abs(full).max()
