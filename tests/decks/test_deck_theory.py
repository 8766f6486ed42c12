"""Small decks with known answers, of the element types that CalculiX's contact decks use."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import abut
from abut.job.load import load_job

EXACT = 1e-10  # the answers lie in the spaces: rounding times the condition of the equations
CONTACT = """*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
1.E7
*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE
SLAVE, MASTER
"""


def solve(folder: Path, *parts: str) -> abut.Solution:
    path = folder / "deck.inp"
    path.write_text("\n".join(parts), encoding="utf-8")
    return abut.solve(load_job(path).model)


def rows(x: list[float], y: list[float], node: int, element: int) -> tuple[str, str, list[int]]:
    """Nodes and elements of a grid of quadrilaterals with 8 nodes between the lines x and y, numbered onward from node
    and element; nodes of the highest line."""
    xs, ys = (np.sort(np.concatenate([lines, 0.5 * (np.array(lines[1:]) + lines[:-1])])) for lines in (x, y))
    number = {}
    for j in range(len(ys)):
        for i in range(len(xs)):
            if i % 2 == 0 or j % 2 == 0:
                number[i, j] = node + len(number)
    nodes = "\n".join(f"{n}, {float(xs[i])!r}, {float(ys[j])!r}" for (i, j), n in number.items())
    places = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    cells = [(i, j) for j in range(0, len(ys) - 1, 2) for i in range(0, len(xs) - 1, 2)]
    elements = "\n".join(
        f"{element + k}, " + ", ".join(str(number[i + a, j + b]) for a, b in places) for k, (i, j) in enumerate(cells)
    )
    return nodes, elements, [n for (_, j), n in number.items() if j == len(ys) - 1]


def listed(numbers: list[int]) -> str:
    return "\n".join(f"{n}," for n in numbers)


def test_rings_pressed_on_each_other(tmp_path: Path) -> None:
    """CAX8R, one element over three: a uniform axial stress, u_z = -p z / E and u_r = nu p r / E in both rings."""
    low, low_elements, _ = rows([1.0, 2.0], [0.0, 1.0], 1, 1)
    high, high_elements, _ = rows([1.0, 1.2, 1.7, 2.0], [1.0, 1.5], 101, 11)
    solution = solve(
        tmp_path, "*NODE", low, high, "*ELEMENT, TYPE=CAX8R, ELSET=E", low_elements, high_elements,
        "*NSET, NSET=FOOT", "1, 2, 3", "*BOUNDARY", "FOOT, 2", "*SURFACE, NAME=SLAVE", "1, S3",
        "*SURFACE, NAME=MASTER", "11, S1", "12, S1", "13, S1", "*MATERIAL, NAME=M", "*ELASTIC", "1000., .3",
        "*SOLID SECTION, ELSET=E, MATERIAL=M", CONTACT, "*STEP", "*STATIC", "*DLOAD", "11, P3, 5.", "12, P3, 5.",
        "13, P3, 5.", "*END STEP",
    )  # fmt: skip
    mesh = solution.model.mesh
    exact = mesh.points * [0.3 * 5.0 / 1000.0, -5.0 / 1000.0]
    assert solution.displacement == pytest.approx(exact, abs=EXACT * 7.5e-3)
    assert [solid.integration for solid in solution.model.solids] == ["reduced", "reduced"]


def test_heat_closes_a_gap(tmp_path: Path) -> None:
    """CPS8R: bars of length 1 and 0.5 between walls, 0.001 apart, warmed by 100 degrees. They would grow by 1.5 alpha T =
    0.0018, and the stress sigma = E (0.0018 - 0.001) / 1.5 takes the rest back; sides are free, u_x = (alpha T + nu sigma
    / E) x."""
    low, low_elements, _ = rows([0.0, 0.5, 1.0], [0.0, 1.0], 1, 1)
    high, high_elements, top = rows([0.0, 1.0], [1.001, 1.501], 101, 11)
    solution = solve(
        tmp_path, "*NODE, NSET=ALL", low, high, "*ELEMENT, TYPE=CPS8R, ELSET=E", low_elements, high_elements,
        "*NSET, NSET=FOOT", "1, 2, 3, 4, 5", "*NSET, NSET=HEAD", listed(top), "*BOUNDARY", "FOOT, 2", "HEAD, 2",
        f"1, 1\n{top[0]}, 1", "*SURFACE, NAME=SLAVE", "1, S3", "2, S3", "*SURFACE, NAME=MASTER", "11, S1",
        "*MATERIAL, NAME=M", "*ELASTIC", "1000., .3", "*EXPANSION", "1.2E-5", "*SOLID SECTION, ELSET=E, MATERIAL=M", "1.",
        CONTACT, "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "ALL, 20.", "*STEP", "*STATIC", "*TEMPERATURE", "ALL, 120.",
        "*END STEP",
    )  # fmt: skip
    stress = 1000.0 * 0.0008 / 1.5
    assert solution.contacts[0].force[1] == pytest.approx(-stress, rel=EXACT)
    x, y = solution.model.mesh.points.T
    along = 1.2e-3 - stress / 1000.0
    upper = y > 1.0005
    exact = np.column_stack([(1.2e-3 + 0.3 * stress / 1000.0) * x, along * np.where(upper, y - 1.501, y)])
    assert solution.displacement == pytest.approx(exact, abs=EXACT * 1e-3)


def test_constraints_that_equations_repeat(tmp_path: Path) -> None:
    """C3D8 and nodes to a surface: both cubes keep level faces by equations, so that four nodal pressures act on one
    displacement. Displacements are unique, u = -F z / (E A); of all pressures the smallest is taken, and it is said."""
    cube = ["0,0", "1,0", "1,1", "0,1"]
    lines = [f"{10 * k + i}, {xy}, {z}" for k, z in enumerate((0, 1, 1, 2)) for i, xy in enumerate(cube, start=1)]
    level = [f"2\n{10 * k + i}, 3, 1., {10 * k + 1}, 3, -1." for k in (1, 2) for i in (2, 3, 4)]
    solution = solve(
        tmp_path, "*NODE, NSET=ALL", *lines, "*ELEMENT, TYPE=C3D8, ELSET=E", "1, 1,2,3,4,11,12,13,14",
        "2, 21,22,23,24,31,32,33,34", "*NSET, NSET=TOP", "31, 32, 33, 34", "*NSET, NSET=TOUCH", "21,", "*BOUNDARY",
        "1, 3\n2, 3\n3, 3\n4, 3", "ALL, 1, 2", "*EQUATION", *level, "*SURFACE, NAME=SLAVE, TYPE=NODE", "TOUCH",
        "*SURFACE, NAME=MASTER", "1, S2", "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.",
        "*SOLID SECTION, ELSET=E, MATERIAL=M", CONTACT.replace("SURFACE TO SURFACE", "NODE TO SURFACE"), "*STEP",
        "*STATIC", "*CLOAD", "TOP, 3, -2.5", "*END STEP",
    )  # fmt: skip
    z = solution.model.mesh.points[:, 2]
    assert solution.displacement[:, 2] == pytest.approx(-0.01 * z, abs=EXACT * 0.02)
    assert np.linalg.norm(solution.contacts[0].force) == pytest.approx(10.0, rel=EXACT)
    assert any("one of many" in note for note in solution.notes)


@pytest.mark.parametrize("code", ["C3D8", "C3D8I"])
def test_a_brick_that_is_warm_on_one_side(code: str, tmp_path: Path) -> None:
    """It counts with its mean, as in CalculiX, to all digits: a free brick grows by alpha T / 2 in all directions, and
    nothing is stressed."""
    x = ["0,0,0", "1,0,0", "1,1,0", "0,1,0", "0,0,1", "1,0,1", "1,1,1", "0,1,1"]
    nodes = [f"{n}, {at}" for n, at in enumerate(x, start=1)]
    solution = solve(
        tmp_path, "*NODE, NSET=ALL", *nodes, f"*ELEMENT, TYPE={code}, ELSET=E", "1, 1,2,3,4,5,6,7,8", "*MATERIAL, NAME=M",
        "*ELASTIC", "1000., .3", "*EXPANSION", "1.E-3", "*SOLID SECTION, ELSET=E, MATERIAL=M", "*BOUNDARY", "1, 1, 3",
        "2, 2, 3", "4, 3", "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "ALL, 0.", "*STEP", "*STATIC", "*TEMPERATURE",
        *(f"{n}, 10." for n in (5, 6, 7, 8)), "*END STEP",
    )  # fmt: skip
    assert solution.displacement == pytest.approx(5e-3 * solution.model.mesh.points, abs=EXACT * 5e-3)
