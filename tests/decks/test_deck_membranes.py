"""Membranes of decks, expanded: elements hinged at their nodes, which carry forces in their plane alone."""

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
from models.decks import load, solve, step

CCX = shutil.which("ccx")
E, NU, THICK = 1000.0, 0.3, 0.1
CODES = ("M3D3", "M3D4", "M3D4R", "M3D6", "M3D8", "M3D8R")
MATERIAL = f"*MATERIAL, NAME=M\n*ELASTIC\n{E}, {NU}\n*MEMBRANE SECTION, ELSET=SHEET, MATERIAL=M\n{THICK}\n"
Grid = dict[tuple[int, int], int]


def sheet(code: str, counts: tuple[int, int], sizes: tuple[float, float], bent: float = 0.0) -> tuple[str, Grid]:
    """Nodes and elements on a rectangle, and the number of the node at each half step (i, j). bent: shifts within the plane,
    of nodes inside."""
    number: Grid = {}
    elements = []

    def of(*steps: tuple[int, int]) -> list[int]:
        return [number.setdefault(at, len(number) + 1) for at in steps]

    for i in range(0, 2 * counts[0], 2):
        for j in range(0, 2 * counts[1], 2):
            corners = [(i, j), (i + 2, j), (i + 2, j + 2), (i, j + 2)]
            cells = [corners] if code[3] in "48" else [corners[:3], [corners[0], *corners[2:]]]
            for cell in cells:
                ends = zip(cell, cell[1:] + cell[:1])
                middles = [((a[0] + b[0]) // 2, (a[1] + b[1]) // 2) for a, b in ends] if code[3] in "68" else []
                elements.append(of(*cell, *middles))
    scale = np.array(sizes) / counts / 2.0
    lines = ["*NODE, NSET=ALL"]
    for (i, j), n in number.items():
        inside = 0 < i < 2 * counts[0] and 0 < j < 2 * counts[1]
        x, y = (scale * (i, j) + (bent * np.sin([i + 2.0 * j, 3.0 * i - j]) if inside else 0.0)).tolist()
        lines.append(f"{n}, {x!r}, {y!r}, 0.")
    lines += [f"*ELEMENT, TYPE={code}, ELSET=SHEET", *(", ".join(map(str, [k, *e])) for k, e in enumerate(elements, 1))]
    return "\n".join(lines) + "\n" + MATERIAL, number


def nodes(name: str, numbers: list[int]) -> str:
    return f"*NSET, NSET={name}\n" + "".join(f"{n},\n" for n in numbers)


def at(folder: Path, solution: abut.Solution, node: int) -> NDArray[np.float64]:
    """The displacement of a node of the deck."""
    solid = expanded(read_deck(folder / "deck.inp"), False)
    used = np.unique(np.concatenate([block.nodes.ravel() for block in solid.blocks]))
    on, weights = zip(*solid.thin[node].shares)
    return np.asarray(np.array(weights) @ solution.displacement[np.searchsorted(used, on)])


@pytest.mark.parametrize("code", CODES)
def test_stretched_sheet(code: str, tmp_path: Path) -> None:
    """The rim stretched evenly, elements of any shape: the strain is even, and the sheet thins by nu / (1 - nu) of it."""
    text, number = sheet(code, (3, 2), (3.0, 2.0), 0.07)
    rim = [n for (i, j), n in number.items() if i in (0, 6) or j in (0, 4)]
    strain = np.array([2e-3, 1e-3])
    rows = [line.split(",") for line in text.partition("*ELEMENT")[0].splitlines()[1:]]
    places = {int(row[0]): np.array(row[1:3], dtype=float) for row in rows}
    lines = [f"{n}, {k + 1}, {k + 1}, {float(strain[k] * places[n][k])!r}" for n in rim for k in (0, 1)]
    held = "*BOUNDARY\nALL, 3, 3\n"
    solution = solve(tmp_path, text + held + step("*BOUNDARY", *lines))
    for n, place in places.items():
        assert at(tmp_path, solution, n)[:2] == pytest.approx(strain * place, abs=1e-11)
    thinning = -NU / (1 - NU) * strain.sum() * THICK / 2
    top = solution.model.mesh.points[:, 2] > THICK / 4
    assert solution.displacement[top, 2] == pytest.approx(thinning, rel=1e-8)


@pytest.mark.parametrize("code", CODES)
def test_strip_pulled_up(code: str, tmp_path: Path) -> None:
    """Two halves hinged to each other and at their ends, under a force across: with the law of Saint Venant and Kirchhoff
    F = E A (w / L)^3, as each half has the Green-Lagrange strain (w / L)^2 / 2."""
    length, width, up = 5.0, 2.0, 0.5
    text, number = sheet(code, (2, 1), (2 * length, width))
    force = E * width * THICK * (up / length) ** 3
    across = {j: number[2, j] for j in (0, 1, 2) if (2, j) in number}
    shares = {0: 1 / 6, 1: 2 / 3, 2: 1 / 6} if len(across) == 3 else {0: 0.5, 2: 0.5}
    ends = [n for (i, _), n in number.items() if i in (0, 4)]
    held = nodes("ENDS", ends) + f"*BOUNDARY\nENDS, 1\nENDS, 3, 3\n{number[0, 0]}, 2\n{number[4, 0]}, 2\n"
    loads = [f"{n}, 3, {shares[j] * force!r}" for j, n in across.items()]
    solution = solve(tmp_path, text + held + step("*CLOAD", *loads).replace("*STEP", "*STEP, NLGEOM"))
    for n in across.values():
        assert at(tmp_path, solution, n)[2] == pytest.approx(up, rel=1e-6)


@pytest.mark.parametrize("code", CODES)
def test_no_moment_from_cell_to_cell(code: str, tmp_path: Path) -> None:
    """One half held, the end of the other one raised: it turns about the hinge, and no stress comes of it."""
    text, number = sheet(code, (2, 1), (2.0, 1.0))
    held = [n for (i, _), n in number.items() if i < 3]
    end = [n for (i, _), n in number.items() if i == 4]
    text += nodes("HELD", held) + nodes("END", end) + "*BOUNDARY\nHELD, 1, 3\n"
    solution = solve(tmp_path, text + step("*BOUNDARY", "END, 3, 3, 1e-3"))
    assert np.abs(solution.displacement).max() == pytest.approx(1e-3, rel=0.1)
    assert np.abs(solution.steps[-1].stress).max() < 1e-8 * E * 1e-3


def test_encastre(tmp_path: Path) -> None:
    """Turns of zero say nothing of what does not turn."""
    text, number = sheet("M3D4", (1, 1), (1.0, 1.0))
    pulled = step("*CLOAD", f"{number[2, 0]}, 1, 1.", f"{number[2, 2]}, 1, 1.")
    ends = [
        solve(tmp_path, f"{text}*BOUNDARY\nALL, 3\n1, 1, {last}\n{number[0, 2]}, 1, {last}\n{pulled}")
        for last in (3, 6)
    ]
    assert np.array_equal(ends[0].displacement, ends[1].displacement)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("*CLOAD\n2, 4, 1.", "node 2 of membranes does not turn; give directions 1 to 3, or take shells"),
        ("*BOUNDARY\n2, 5, 5, 0.1", "node 2 of membranes does not turn"),
    ],
)
def test_turns_are_refused(more: str, words: str, tmp_path: Path) -> None:
    text, _ = sheet("M3D4", (2, 1), (2.0, 1.0))
    with pytest.raises(InputError, match=words):
        load(tmp_path, text + step(more))


def test_without_a_section(tmp_path: Path) -> None:
    text, _ = sheet("M3D4", (2, 1), (2.0, 1.0))
    with pytest.raises(InputError, match=r"element 1 without \*MEMBRANE SECTION"):
        load(tmp_path, text.partition("*MATERIAL")[0] + step("*BOUNDARY", "1, 1, 3"))


@pytest.mark.skipif(CCX is None, reason="CalculiX is not installed")
def test_as_calculix(tmp_path: Path) -> None:
    """A square clamped all round, pushed across: at every node, to a ten-thousandth of the largest displacement."""
    text, number = sheet("M3D4", (2, 2), (2.0, 2.0))
    rim = [n for (i, j), n in number.items() if i in (0, 4) or j in (0, 4)]
    text += nodes("RIM", rim) + "*BOUNDARY\nRIM, 1, 3\n"
    text += step("*CLOAD", f"{number[2, 2]}, 3, 0.5", "*NODE PRINT, NSET=ALL", "U").replace("*STEP", "*STEP, NLGEOM")
    solution = solve(tmp_path, text)
    subprocess.run(["ccx", "-i", "deck"], cwd=tmp_path, check=True, capture_output=True)
    rows = [
        r for line in (tmp_path / "deck.dat").read_text().splitlines() if len(r := line.split()) == 4 and r[0].isdigit()
    ]
    last = {int(r[0]): np.array(r[1:], dtype=float) for r in rows}
    size = max(np.abs(u).max() for u in last.values())
    for n, u in last.items():
        assert at(tmp_path, solution, n) == pytest.approx(u, abs=1e-4 * size)
