"""Plane bodies whose cells run clockwise are turned round on reading, and give the results of those that do not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.cells import CELLS
from abut.cli import main
from abut.errors import InputError
from abut.job import load_job
from abut.mesh.check import check_mesh
from abut.mesh.clockwise import order, turn_bodies
from abut.mesh.make import join, rectangle
from abut.mesh.mesh import CellBlock, Mesh
from abut.mesh.write import write_mesh
from models.volume import volume

PLANE = ("tri3", "tri6", "quad4", "quad8", "quad9")
GMSH = {"tri3": 2, "tri6": 9, "quad4": 3, "quad8": 16, "quad9": 10, "line2": 1, "line3": 8}
NOTE = "body 'b': its cells were numbered clockwise; their numbering was reversed"


def sheared(cell: str) -> Mesh:
    """Two bodies; of the upper one every side and mid node is where no other one is by symmetry."""
    mesh = join({"a": rectangle(x=(0, 3), y=(-1, 0), cells=(3, 1), cell=cell), "b": rectangle(cells=(2, 2), cell=cell)})
    x, y = mesh.points.T
    return replace(mesh, points=np.stack([x + 0.1 * x * y + 0.05 * y**2, y + 0.02 * np.sin(3 * x) * (y + 1)], axis=1))


def reversed_body(mesh: Mesh, cells: slice = slice(None)) -> Mesh:
    """Body b with (some of) its cells clockwise, and its surfaces on the same facets."""
    wrong = np.zeros(mesh.n_cells, dtype=bool)
    wrong[mesh.bodies["b"][cells]] = True
    blocks, surfaces = [], {}
    for block, first in zip(mesh.blocks, mesh.starts):
        nodes = block.nodes.copy()
        own = wrong[first : first + len(nodes)]
        nodes[own] = nodes[own][:, order(block.kind)]
        blocks.append(CellBlock(block.kind, nodes))
    for name, rows in mesh.surfaces.items():
        k = CELLS[mesh.blocks[0].kind].corners
        surfaces[name] = np.where(wrong[rows[:, :1]] & [False, True], [0, k - 1] + rows * [1, -1], rows)
    return replace(mesh, blocks=tuple(blocks), surfaces=surfaces)


def gmsh_file(path: Path, mesh: Mesh) -> None:
    names = [*((1, name) for name in mesh.surfaces), *((2, name) for name in mesh.bodies)]
    elements = []
    for tag, (dim, name) in enumerate(names, start=1):
        if dim == 1:
            surface = mesh.surface(name)
            groups = [("line3" if surface.nodes[0, 2] >= 0 else "line2", surface.nodes)]
        else:
            groups = [(kind, nodes) for kind, nodes, _ in mesh.cells_of(name)]
        for kind, cells in groups:
            for cell in cells[:, : CELLS[kind].nodes]:
                elements.append(f"{GMSH[kind]} 2 {tag} {tag} {' '.join(str(n + 1) for n in cell)}")
    path.write_text(
        "\n".join(
            [
                *("$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names))),
                *(f'{dim} {tag} "{name}"' for tag, (dim, name) in enumerate(names, start=1)),
                *("$EndPhysicalNames", "$Nodes", str(len(mesh.points))),
                *(f"{i} {x!r} {y!r} 0" for i, (x, y) in enumerate(mesh.points.tolist(), start=1)),
                *("$EndNodes", "$Elements", str(len(elements))),
                *(f"{i} {element}" for i, element in enumerate(elements, start=1)),
                *("$EndElements", ""),
            ]
        )
    )


def deck_file(path: Path, mesh: Mesh, *more: str) -> None:
    lines = ["*NODE", *(f"{i}, {x!r}, {y!r}" for i, (x, y) in enumerate(mesh.points.tolist(), start=1))]
    for name in mesh.bodies:
        for kind, nodes, cells in mesh.cells_of(name):
            lines.append(f"*ELEMENT, TYPE=CPE{CELLS[kind].nodes}, ELSET={name}")
            lines += [f"{c + 1}, {', '.join(str(n + 1) for n in own)}" for c, own in zip(cells, nodes)]
    for name, rows in mesh.surfaces.items():
        lines += [f"*SURFACE, NAME={name}", *(f"{c + 1}, S{f + 1}" for c, f in rows)]
    path.write_text("\n".join([*lines, *more, ""]))


WRITE = {".msh": gmsh_file, ".vtu": write_mesh, ".inp": deck_file}


@pytest.mark.parametrize("ending", WRITE)
@pytest.mark.parametrize("cell", PLANE)
def test_a_clockwise_body_is_turned_round(cell: str, ending: str, tmp_path: Path) -> None:
    """Cells become those of the mesh it was made of, node for node; surfaces keep their points and look outward."""
    if (cell, ending) == ("quad9", ".inp"):
        pytest.skip("decks have none")
    made = sheared(cell)
    wrong = reversed_body(made)
    with pytest.raises(InputError, match="inverted"):
        check_mesh(wrong)
    WRITE[ending](tmp_path / f"made{ending}", wrong)
    read = Mesh.read(tmp_path / f"made{ending}")
    assert read.notes == (NOTE,)
    assert volume(read) == pytest.approx(volume(made), rel=1e-14)
    assert np.allclose(read.points, made.points, atol=0.0)
    assert [b.nodes.tolist() for b in read.blocks] == [b.nodes.tolist() for b in made.blocks]
    for name, rows in made.surfaces.items():
        assert sorted(read.surfaces[name].tolist()) == sorted(rows.tolist()), name


@pytest.mark.parametrize("cell", PLANE)
def test_surfaces_follow(cell: str) -> None:
    """Of a mesh that has its facet numbers already."""
    made = sheared(cell)
    turned = turn_bodies(reversed_body(made))
    assert turned.notes == (NOTE,)
    for name, rows in made.surfaces.items():
        assert turned.surfaces[name].tolist() == rows.tolist()
    assert turn_bodies(made) is made


@pytest.mark.parametrize("ending", WRITE)
def test_some_clockwise_cells_are_refused(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"made{ending}"
    WRITE[ending](path, reversed_body(sheared("quad8"), slice(1, 3)))
    with pytest.raises(
        InputError, match=r"2 quad8 cells of 'b' are inverted.* run clockwise, those of other cells do not"
    ):
        Mesh.read(path)


def test_a_solved_deck_tells(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Same pressure with the upper body clockwise; the note is in what is printed."""
    made = replace(sheared("quad8"), points=join(
        {"a": rectangle(x=(0, 3), y=(-1, 0), cells=(3, 1), cell="quad8"), "b": rectangle(cells=(2, 2), cell="quad8")}
    ).points)  # fmt: skip
    found = []
    for name, mesh in (("right", made), ("wrong", reversed_body(made))):
        held = [f"{n + 1}, 1, 2" for n in mesh.nodes_of("a.bottom")]
        push = [f"{c + 1}, P{f + 1}, 5." for c, f in mesh.surfaces["b.top"]]
        sides = [f"{n + 1}, 1, 1" for n in mesh.nodes_of("b.left")]
        cards = [
            *("*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3"),
            *("*SOLID SECTION, ELSET=a, MATERIAL=M", "*SOLID SECTION, ELSET=b, MATERIAL=M"),
            *("*SURFACE INTERACTION, NAME=I", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD"),
            *("*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE", "b.bottom, a.top"),
            *("*BOUNDARY", *held, *sides, "*STEP", "*STATIC", "*DLOAD", *push, "*END STEP"),
        ]
        deck_file(tmp_path / f"{name}.inp", mesh, *cards)
        solution = abut.solve(load_job(tmp_path / f"{name}.inp").model)
        found.append(solution.contacts[0].max_pressure)
    assert found[1] == pytest.approx(found[0], rel=1e-12)
    assert main(["check", str(tmp_path / "wrong.inp")]) == 0
    assert main(["convert", str(tmp_path / "wrong.inp"), str(tmp_path / "wrong.vtu")]) == 0
    assert capsys.readouterr().out.count(NOTE) == 2
