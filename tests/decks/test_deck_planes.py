"""Plane and axisymmetric elements of several kinds and thicknesses, or beside solids: they become solids."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.decks.expanded import expanded
from abut.errors import InputError
from abut.io.deck import read_deck
from models.decks import load, solve, step

CCX = shutil.which("ccx")
E, NU = 1000.0, 0.3
PULL = 2.0
Places = dict[int, tuple[float, float, float]]
SHAPES = {"3": 3, "4": 4, "4R": 4, "6": 6, "8": 8, "8R": 8}


def patch(prefix: str, shape: str, first: int, left: float, clockwise: bool = False) -> tuple[Places, list[list[int]]]:
    """Nodes and elements of a rectangle of 2 by 1 from (left, 0) on; nodes are ``first`` + 10 i + j, in half steps."""
    cells = []
    for i in (0, 2):
        corners = [(i, 0), (i + 2, 0), (i + 2, 2), (i, 2)]
        for cell in [corners] if SHAPES[shape] in (4, 8) else [corners[:3], [corners[0], *corners[2:]]]:
            cell = cell[::-1] if clockwise else cell
            ends = zip(cell, cell[1:] + cell[:1])
            middles = [((a[0] + b[0]) // 2, (a[1] + b[1]) // 2) for a, b in ends] if SHAPES[shape] > 4 else []
            cells.append([first + 10 * i + j for i, j in (*cell, *middles)])
    used = sorted({n for cell in cells for n in cell})
    return {n: (left + (n - first) // 10 / 2, (n - first) % 10 / 2, 0.0) for n in used}, cells


def written(parts: list[tuple[str, float, Places, list[list[int]]]], more: str = "", nu: float = NU) -> str:
    """A deck of patches, each with the type of its elements and its thickness; element sets P0, P1, ..."""
    lines = ["*NODE, NSET=ALL"]
    lines += [
        f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in {n: x for _, _, p, _ in parts for n, x in p.items()}.items()
    ]
    number = 0
    for k, (code, _, _, cells) in enumerate(parts):
        lines += [f"*ELEMENT, TYPE={code}, ELSET=P{k}"]
        for cell in cells:
            number += 1
            lines.append(", ".join(map(str, [number, *cell])))
    lines += ["*MATERIAL, NAME=M", "*ELASTIC", f"{E}, {nu}"]
    for k, (_, thick, _, _) in enumerate(parts):
        lines += [f"*SOLID SECTION, ELSET=P{k}, MATERIAL=M", repr(thick)]
    return "\n".join(lines) + "\n" + more


def at(folder: Path, solution: abut.Solution, node: int) -> NDArray[np.float64]:
    """The displacement of a node of the deck, in x and y."""
    solid = expanded(read_deck(folder / "deck.inp"), False)
    used = np.unique(np.concatenate([block.nodes.ravel() for block in solid.blocks]))
    thin = solid.thin[node]
    on, weights = zip(*thin.shares)
    mean = np.array(weights) @ solution.displacement[np.searchsorted(used, on)]
    return np.asarray(mean * thin.stretch)[:2]


def held_at(nodes: dict[int, tuple[float, float, float]], x: float) -> str:
    here = [n for n, place in nodes.items() if place[0] == x]
    return "".join(f"{n}, 1\n" for n in here) + f"{here[0]}, 2\n"


def pulled(places: Places, x: float, force: float) -> list[str]:
    """Forces at the nodes of an edge of length 1, as of an even traction."""
    here = sorted((place[1], n) for n, place in places.items() if place[0] == x)
    shares = (0.5, 0.5) if len(here) == 2 else (1 / 6, 2 / 3, 1 / 6)
    return [f"{n}, 1, {force * share!r}" for (_, n), share in zip(here, shares)]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("clockwise", [False, True])
def test_thicknesses_in_a_row(shape: str, clockwise: bool, tmp_path: Path) -> None:
    """A strip that grows thicker, pulled, Poisson's ratio 0: its parts stretch as bars of their sections."""
    thin, thick = 0.2, 0.5
    first, cells = patch("CPS", shape, 100, 0.0, clockwise)
    second, more = patch("CPS", shape, 200, 2.0, clockwise)
    same = {n: m for n, x in second.items() for m, y in first.items() if x == y}
    more = [[same.get(n, n) for n in cell] for cell in more]
    second = {n: x for n, x in second.items() if n not in same}
    whole = first | second
    text = written([(f"CPS{shape}", thin, first, cells), (f"CPS{shape}", thick, second, more)], nu=0.0)
    solution = solve(tmp_path, text + "*BOUNDARY\n" + held_at(whole, 0.0) + step("*CLOAD", *pulled(whole, 4.0, PULL)))
    joint, end = (next(n for n, place in whole.items() if place[0] == x) for x in (2.0, 4.0))
    assert at(tmp_path, solution, joint)[0] == pytest.approx(PULL / E * 2 / thin, rel=1e-6)
    assert at(tmp_path, solution, end)[0] == pytest.approx(PULL / E * (2 / thin + 2 / thick), rel=1e-6)


@pytest.mark.parametrize("shape", SHAPES)
def test_stress_beside_strain_and_solids(shape: str, tmp_path: Path) -> None:
    """Three bars pulled alike: E in plane stress and of a solid, E / (1 - nu^2) in plane strain, which thins by
    nu / (1 - nu) of it."""
    stress, cells = patch("CPS", shape, 100, 0.0)
    strain, others = patch("CPE", shape, 200, 0.0)
    strain = {n: (x, y + 5.0, z) for n, (x, y, z) in strain.items()}
    brick = {
        301 + i: x for i, x in enumerate([(x, y, z) for z in (7.0, 8.0) for x, y in ((0, 0), (2, 0), (2, 1), (0, 1))])
    }
    brick = {n: (float(x), float(y), float(z)) for n, (x, y, z) in brick.items()}
    parts = [
        (f"CPS{shape}", 0.5, stress, cells),
        (f"CPE{shape}", 0.5, strain, others),
        ("C3D8", 1.0, brick, [list(brick)]),
    ]
    held = "".join(f"{n}, 1\n" for n, x in brick.items() if x[0] == 0) + "301, 2, 3\n304, 3\n"
    text = written(parts) + "*BOUNDARY\n" + held_at(stress, 0.0) + held_at(strain, 0.0) + held
    loads = pulled(stress, 2.0, PULL) + pulled(strain, 2.0, PULL)
    loads += [f"{n}, 1, {PULL / 4!r}" for n, x in brick.items() if x[0] == 2]
    solution = solve(tmp_path, text + step("*CLOAD", *loads))
    strains = PULL / 0.5 / E
    for places, up, across, share in ((stress, 0.0, NU, 1.0), (strain, 5.0, NU / (1 - NU), 1 - NU**2)):
        corner = next(n for n, x in places.items() if x[:2] == (2.0, up + 1.0))
        low = next(n for n, x in places.items() if x[:2] == (0.0, up))
        moved = at(tmp_path, solution, corner) - at(tmp_path, solution, low)
        assert moved == pytest.approx([2 * strains * share, -across * strains * share], rel=1e-6)
    far = np.linalg.norm(solution.model.mesh.points - (2.0, 1.0, 8.0), axis=1).argmin()
    assert solution.displacement[far, 0] == pytest.approx(2 * PULL / E, rel=1e-6)


@pytest.mark.parametrize("load_of", ["*DLOAD\n1, P4, 10.", "*CLOAD\n102, 1, 50.\n100, 1, 30."])
@pytest.mark.parametrize("shape", ["4", "8", "8R", "6"])
def test_ring_as_a_sector(shape: str, load_of: str, tmp_path: Path) -> None:
    """A ring beside a plate that has nothing to do with it: a sector of 2 degrees, whose section keeps its shape, moves as
    the axisymmetric model does, up to the square of half its angle (1.5e-4)."""
    places, cells = patch("CAX", shape, 100, 3.0)
    load_of = load_of.replace("P4", "P3") if shape == "6" else load_of
    ring = (f"CAX{shape}", 1.0, places, cells)
    held = "*BOUNDARY\n100, 2\n120, 2\n"
    plate, square = patch("CPS", "8", 200, 50.0)
    both = written([ring, ("CPS8", 0.3, plate, square)], held + held_at(plate, 50.0))
    folders = [tmp_path / "alone", tmp_path / "both"]
    for folder in folders:
        folder.mkdir()
    load_of = load_of if shape != "6" else load_of.replace("1, P3", "2, P3")
    alone = solve(folders[0], written([ring], held) + step(*load_of.split("\n")))
    solution = solve(folders[1], both + step(*load_of.split("\n")))
    size = np.abs(alone.displacement).max()
    nodes = sorted(places)
    for node, moved in zip(nodes, alone.displacement):
        assert at(folders[1], solution, node) == pytest.approx(moved, abs=4e-4 * size)


@pytest.mark.skipif(CCX is None, reason="CalculiX is not installed")
@pytest.mark.parametrize("shape", ["8", "8R", "6"])
def test_as_calculix(shape: str, tmp_path: Path) -> None:
    """Plane stress of two thicknesses that share an edge, plane strain apart, pressures on edges: at every node."""
    first, cells = patch("CPS", shape, 100, 0.0)
    second, more = patch("CPS", shape, 200, 2.0)
    same = {n: m for n, x in second.items() for m, y in first.items() if x == y}
    more = [[same.get(n, n) for n in cell] for cell in more]
    second = {n: x for n, x in second.items() if n not in same}
    third, others = patch("CPE", shape, 300, 8.0)
    text = written(
        [(f"CPS{shape}", 0.2, first, cells), (f"CPS{shape}", 0.5, second, more), (f"CPE{shape}", 0.5, third, others)]
    )
    text += "*BOUNDARY\n" + held_at(first | second, 0.0) + held_at(third, 8.0)
    edges = ["P0, P1, 3.", "P1, P3, 5.", "P2, P3, 4."]  # below, above, above
    if shape == "6":
        edges = ["1, P1, 3.", "3, P1, 3.", "6, P2, 5.", "8, P2, 5.", "10, P2, 4.", "12, P2, 4."]
    text += step("*DLOAD", *edges, "*NODE PRINT, NSET=ALL", "U")
    solution = solve(tmp_path, text)
    subprocess.run(["ccx", "-i", "deck"], cwd=tmp_path, check=True, capture_output=True)
    rows = re.findall(r"^ +(\d+) +(\S+) +(\S+) +\S+$", (tmp_path / "deck.dat").read_text(), re.MULTILINE)
    size = max(abs(float(x)) for row in rows for x in row[1:])
    for node, x, y in rows:
        assert at(tmp_path, solution, int(node)) == pytest.approx([float(x), float(y)], abs=2e-5 * size)


def test_refused(tmp_path: Path) -> None:
    """On the axis, and loads out of the plane."""
    plate, square = patch("CPS", "4", 200, 50.0)
    places, cells = patch("CAX", "4", 100, 0.0)
    text = written([("CAX4", 1.0, places, cells), ("CPS4", 0.3, plate, square)], "*BOUNDARY\n100, 2\n200, 1, 2\n")
    with pytest.raises(InputError, match="need radii > 0; leave a hole along the axis"):
        load(tmp_path, text + step("*CLOAD", "220, 2, 1."))
    places, cells = patch("CAX", "4", 100, 1.0)
    text = written([("CAX4", 1.0, places, cells), ("CPS4", 0.3, plate, square)], "*BOUNDARY\n100, 2\n200, 1, 2\n")
    with pytest.raises(InputError, match="node 220 of plane or axisymmetric elements moves in x and y"):
        load(tmp_path, text + step("*CLOAD", "220, 3, 1."))


def test_notes(tmp_path: Path) -> None:
    plate, square = patch("CPS", "4", 200, 50.0)
    places, cells = patch("CAX", "4", 100, 1.0)
    text = written([("CAX4", 1.0, places, cells), ("CPS4", 0.3, plate, square)], "*BOUNDARY\n100, 2\n200, 1, 2\n")
    notes = load(tmp_path, text + step("*CLOAD", "220, 2, 1.")).notes
    assert any("a sector of 2 degrees; forces in the results are those of the sector" in note for note in notes)


def test_nodes_of_a_surface_that_end_within_a_face(tmp_path: Path) -> None:
    """A set that ends in the middle of an edge has the whole edge."""
    places, cells = patch("CPS", "8", 100, 0.0)
    text = written([("CPS8", 1.0, places, cells)], "*SURFACE, NAME=S, TYPE=NODE\n102,\n112,\n122,\n132,\n")
    (tmp_path / "deck.inp").write_text(text + "*BOUNDARY\n100, 1, 2\n" + step("*CLOAD", "120, 2, 1."))
    assert len(abut.Mesh.read(tmp_path / "deck.inp").surfaces["S"]) == 2
