"""Trusses of decks, expanded: hinged bars that carry forces along themselves alone."""

from __future__ import annotations

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
from models.decks import load, solve, step, write

CCX = shutil.which("ccx")
E, AREA = 1e7, 0.0625
PLACES = {1: (0.0, 0.0, 0.0), 2: (5.0, 0.0, 5.0), 3: (0.0, 0.0, 10.0), 4: (0.0, 4.0, 3.0)}
FORCE = (1.0, 0.5, 0.3)
HINGED = "*BOUNDARY\n1, 1, 3\n3, 1, 3\n4, 1, 3\n"
MATERIAL = f"*MATERIAL, NAME=M\n*ELASTIC\n{E}, 0.3\n*EXPANSION\n1.E-5\n*SOLID SECTION, ELSET=BARS, MATERIAL=M\n{AREA}\n"


def bars(code: str, pairs: tuple[tuple[int, int], ...] = ((1, 2), (2, 3), (4, 2)), more: str = HINGED) -> str:
    """Bars between nodes of ``PLACES``; T3D3 has nodes 11, 12, ... in the middle."""
    nodes = dict(PLACES)
    lines = []
    for i, (a, b) in enumerate(pairs, 1):
        nodes[10 + i] = tuple(np.mean([PLACES[a], PLACES[b]], axis=0).tolist())
        lines.append(f"{i}, {a}, {b}" if code == "T3D2" else f"{i}, {a}, {10 + i}, {b}")
    kept = {n: x for n, x in nodes.items() if n < 10 or code == "T3D3"}
    text = ["*NODE, NSET=ALL", *(f"{n}, {x[0]!r}, {x[1]!r}, {x[2]!r}" for n, x in kept.items())]
    return "\n".join([*text, f"*ELEMENT, TYPE={code}, ELSET=BARS", *lines]) + "\n" + more + MATERIAL


def at(folder: Path, solution: abut.Solution, node: int) -> NDArray[np.float64]:
    """The displacement of a node of the deck."""
    solid = expanded(read_deck(folder / "deck.inp"), False)
    numbers = np.unique(np.concatenate([block.nodes.ravel() for block in solid.blocks]))
    nodes, weights = zip(*solid.thin[node].shares)
    return np.asarray(np.array(weights) @ solution.displacement[np.searchsorted(numbers, nodes)])


def frame() -> NDArray[np.float64]:
    """The displacement of node 2 of an ideal truss."""
    stiffness = np.zeros((3, 3))
    for other in (1, 3, 4):
        along = np.array(PLACES[2]) - PLACES[other]
        length = np.linalg.norm(along)
        stiffness += E * AREA / length**3 * np.outer(along, along)
    return np.linalg.solve(stiffness, FORCE)


PULLED = step("*CLOAD", *(f"2, {k + 1}, {f}" for k, f in enumerate(FORCE)), "*NODE PRINT, NSET=ALL", "U")


@pytest.mark.parametrize("code", ["T3D2", "T3D3"])
def test_three_bars(code: str, tmp_path: Path) -> None:
    """Forces along bars alone: an even stress, which the solids have exactly."""
    solution = solve(tmp_path, bars(code) + PULLED)
    assert at(tmp_path, solution, 2) == pytest.approx(frame(), rel=1e-8)


@pytest.mark.parametrize("code", ["T3D2", "T3D3"])
def test_warm_bar(code: str, tmp_path: Path) -> None:
    """Its end moves by expansion x warming x length, its middle by half."""
    text = bars(code, ((1, 3),), "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 0.\n*BOUNDARY\n1, 1, 3\n3, 1, 2\n")
    solution = solve(tmp_path, text + step("*TEMPERATURE", "ALL, 100."))
    assert at(tmp_path, solution, 3) == pytest.approx([0.0, 0.0, 1e-5 * 100.0 * 10.0], rel=1e-8, abs=1e-12)
    assert np.ptp(solution.displacement[:, 2]) == pytest.approx(1e-2, rel=1e-6)


def test_under_a_brick(tmp_path: Path) -> None:
    """A brick on four bars that share its corners, in series: 1 / (E A) of each over its length."""
    young, area, length, down = 1000.0, 0.01, 2.0, 0.01
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    lines = ["*NODE, NSET=ALL"]
    for i, (x, y) in enumerate(corners, 1):
        lines += [f"{i}, {x}, {y}, 0", f"{i + 4}, {x}, {y}, 1", f"{i + 8}, {x}, {y}, {-length}"]
    lines += ["*ELEMENT, TYPE=C3D8, ELSET=BRICK", "1, 1, 2, 3, 4, 5, 6, 7, 8", "*ELEMENT, TYPE=T3D2, ELSET=BARS"]
    lines += [f"{i + 1}, {i}, {i + 8}" for i in range(1, 5)]
    lines += ["*BOUNDARY", "ALL, 1, 2", *(f"{i}, 3, 3" for i in range(9, 13)), "*MATERIAL, NAME=M", "*ELASTIC"]
    lines += [f"{young}, 0.", "*SOLID SECTION, ELSET=BRICK, MATERIAL=M", "*SOLID SECTION, ELSET=BARS, MATERIAL=M"]
    text = "\n".join([*lines, f"{area}\n"])
    solution = solve(tmp_path, text + step("*BOUNDARY", *(f"{i}, 3, 3, {-down}" for i in range(5, 9))))
    points = solution.model.mesh.points
    low = [np.linalg.norm(points - (x, y, 0.0), axis=1).argmin() for x, y in corners]
    share = length / (4 * area) / (length / (4 * area) + 1.0)
    assert solution.displacement[low, 2] == pytest.approx(-down * share, rel=1e-8)


def test_ends_in_axes_of_their_own(tmp_path: Path) -> None:
    """Held at both ends, in different axes: nothing but the nodes is held."""
    turned = "*NSET, NSET=TOP\n3,\n*TRANSFORM, NSET=TOP\n1., 1., 0., -1., 1., 0.\n"
    both = "*NSET, NSET=ENDS\n1, 3\n*BOUNDARY\nENDS, 1, 1\n1, 2, 3\n3, 3, 3\n"
    solution = solve(tmp_path, bars("T3D2", ((1, 3),), turned + both) + step("*BOUNDARY", "3, 2, 2, 0.02"))
    moved = 0.02 / np.sqrt(2.0) * np.array([-1.0, 1.0, 0.0])
    assert at(tmp_path, solution, 3) == pytest.approx(moved, rel=1e-8)
    middle = np.abs(solution.model.mesh.points[:, 2] - 5.0) < 1e-9
    assert solution.displacement[middle].mean(axis=0) == pytest.approx(moved / 2.0, rel=1e-8, abs=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (bars("T3D2") + step("*CLOAD", "2, 4, 1."), "node 2 of trusses does not turn; give directions 1 to 3"),
        (bars("T3D2", more="*BOUNDARY\n1, 1, 6\n") + PULLED, "node 1 of trusses does not turn"),
        (bars("T3D2", ((1, 1),)) + PULLED, "truss 1 has no length"),
        (bars("T3D2").partition("*MATERIAL")[0] + PULLED, r"truss 1 without \*SOLID SECTION"),
    ],
)
def test_refused(text: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        load(tmp_path, text)


@pytest.mark.skipif(CCX is None, reason="CalculiX is not installed")
@pytest.mark.parametrize("card", ["*STEP", "*STEP, NLGEOM"])
def test_as_calculix(card: str, tmp_path: Path) -> None:
    """To the digits that CalculiX prints."""
    text = bars("T3D2") + PULLED.replace("*STEP", card)
    path = write(tmp_path, text)
    solution = solve(tmp_path, text)
    subprocess.run(["ccx", "-i", path.stem], cwd=tmp_path, check=True, capture_output=True)
    row = next(r for line in path.with_suffix(".dat").read_text().splitlines() if (r := line.split()) and r[0] == "2")
    assert at(tmp_path, solution, 2) == pytest.approx(np.array(row[1:4], dtype=float), rel=1e-5)


def test_in_the_plane(tmp_path: Path) -> None:
    """T2D2: two bars at right angles and one of 45 degrees; an ideal truss in the plane, without supports across it."""
    places = {1: (0.0, 0.0), 2: (3.0, 3.0), 3: (0.0, 3.0), 4: (3.0, 0.0)}
    nodes = "".join(f"{n}, {x}, {y}\n" for n, (x, y) in places.items())
    text = "*NODE\n" + nodes + "*ELEMENT, TYPE=T2D2, ELSET=BARS\n1, 1, 2\n2, 3, 2\n3, 4, 2\n*NSET, NSET=FEET\n1, 3, 4\n"
    text += "*NSET, NSET=TOP\n2\n*BOUNDARY\nFEET, 1, 2\n" + MATERIAL
    text += step("*CLOAD", "2, 1, 1.", "2, 2, 3.", "*NODE PRINT, NSET=TOP", "U")
    solution = solve(tmp_path, text)
    stiffness = np.zeros((2, 2))
    for other in (1, 3, 4):
        along = np.array(places[2]) - places[other]
        stiffness += E * AREA / np.linalg.norm(along) ** 3 * np.outer(along, along)
    moved = at(tmp_path, solution, 2)
    assert moved[:2] == pytest.approx(np.linalg.solve(stiffness, (1.0, 3.0)), rel=1e-6)
    assert moved[2] == pytest.approx(0.0, abs=1e-9 * np.abs(moved).max())
    if CCX is None:
        return
    subprocess.run(["ccx", "-i", "deck"], cwd=tmp_path, check=True, capture_output=True)
    row = (tmp_path / "deck.dat").read_text().split()[-4:]
    assert row[0] == "2"
    assert moved[:2] == pytest.approx([float(x) for x in row[1:3]], rel=1e-5)
