"""*MPC: nodes that stay on a line or in a plane, the mean rotation of nodes. Small displacements; CalculiX's own examples
with these cards agree within 0.001 % at small loads (``docs/verification/decks.md``)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from models.decks import load, step

# A block of 2 x 2 x 2 bricks, node 1 + i + 10 j + 100 k at (i, j, k), held at z = 0
NODES = "".join(f"{1 + i + 10 * j + 100 * k}, {i}, {j}, {k}\n" for k in range(3) for j in range(3) for i in range(3))
CORNERS = (0, 1, 11, 10, 100, 101, 111, 110)
CELLS = [1 + i + 10 * j + 100 * k for k in range(2) for j in range(2) for i in range(2)]
ELEMENTS = "".join(f"{e}, {', '.join(str(n + c) for c in CORNERS)}\n" for e, n in enumerate(CELLS, start=1))
BLOCK = f"""*NODE, NSET=ALL
{NODES}*ELEMENT, TYPE=C3D8, ELSET=E
{ELEMENTS}*NSET, NSET=BOTTOM
1,2,3,11,12,13,21,22,23
*NSET, NSET=TOP
201,202,203,211,212,213,221,222,223
*MATERIAL, NAME=EL
*ELASTIC
1000., .3
*SOLID SECTION, ELSET=E, MATERIAL=EL
*BOUNDARY
BOTTOM, 1, 3
"""
PUSH = step("*CLOAD", "212, 3, -1.", "223, 1, 2.")


def moved(folder: Path, text: str) -> tuple[np.ndarray, np.ndarray, abut.Solution]:
    """Places and displacements by (k, j, i), and the solution."""
    solution = abut.solve(load(folder, text).model)
    points, u = solution.model.mesh.points, solution.displacement
    place = np.zeros((3, 3, 3, 3))
    result = np.zeros((3, 3, 3, 3))
    for x, each in zip(points, u):
        i, j, k = np.rint(x).astype(int)
        place[k, j, i], result[k, j, i] = x, each
    return place, result, solution


def balanced(solution: abut.Solution) -> None:
    """What binds the nodes does no work on turns and shifts of all of them, so that supports alone carry the loads."""
    total = sum(solution.steps[-1].reactions.values())
    assert total == pytest.approx([-2.0, 0.0, 1.0], abs=1e-9)


def test_nodes_stay_in_their_plane(tmp_path: Path) -> None:
    _, free, _ = moved(tmp_path, BLOCK + PUSH)
    x, u, solution = moved(tmp_path, BLOCK + "*MPC\nPLANE, TOP\n" + PUSH)
    columns = np.column_stack([np.ones(9), x[2, ..., 0].ravel(), x[2, ..., 1].ravel()])
    for each, flat in ((free, False), (u, True)):
        left = np.linalg.lstsq(columns, each[2, ..., 2].ravel(), rcond=None)[1]
        assert (left.sum() < 1e-20) == flat
    balanced(solution)
    assert u[2, 1, 1, 0] != pytest.approx(u[2, 0, 0, 0], rel=1e-3)  # in the plane they move as they like
    assert any("*MPC PLANE: linear" in note for note in load(tmp_path, BLOCK + "*MPC\nPLANE, TOP\n" + PUSH).notes)


def test_nodes_stay_on_their_line(tmp_path: Path) -> None:
    _, u, solution = moved(tmp_path, BLOCK + "*MPC\nSTRAIGHT, 203, 223, 213\n" + PUSH)
    middle = 0.5 * (u[2, 0, 2] + u[2, 2, 2])
    assert u[2, 1, 2, [0, 2]] == pytest.approx(middle[[0, 2]], abs=1e-12)
    assert u[2, 1, 2, 1] != pytest.approx(middle[1], rel=1e-3)  # along the line it moves as it likes
    balanced(solution)


def test_nodes_turn_in_the_mean(tmp_path: Path) -> None:
    """Three nodes of the top about z by 0.01, seen from their middle, while a force shifts them."""
    named = ", ".join(f"{n}, {n}, {n}" for n in (201, 203, 211))
    text = BLOCK.replace("*ELEMENT", "900, 0., 0., 2.\n*ELEMENT", 1) + f"*MPC\nMEANROT, {named}, 900\n"
    x, u, _ = moved(tmp_path, text + step("*BOUNDARY", "900, 1, 1, 0.01", "*CLOAD", "TOP, 2, 5."))
    arms, ways = (np.stack([each[2, 0, 0], each[2, 0, 2], each[2, 1, 0]]) for each in (x, u))
    arms, ways = arms - arms.mean(axis=0), ways - ways.mean(axis=0)
    turns = np.cross(arms, ways)[:, 2] / (arms**2).sum(axis=1)
    assert turns.mean() == pytest.approx(0.01, rel=1e-9)


@pytest.mark.parametrize(
    ("card", "words"),
    [
        ("BEAM, 201, 202", "BEAM is not supported; TIE, PIN, STRAIGHT, PLANE and MEANROT are"),
        ("STRAIGHT, 201, 202", "expected three nodes"),
        ("STRAIGHT, 201, 202, 213", "a node lies .* off the line"),
        ("PLANE, 201, 203, 223", "expected four nodes"),
        ("PLANE, 201, 203, 223, 112", "a node lies .* off the plane"),
        ("PLANE, 1, 101, 201, 101", "the nodes lie on one line; use STRAIGHT"),
        ("MEANROT, 201, 201, 203, 223", "each three times"),
        ("MEANROT, 201, 201, 201, 203, 203, 203, 202, 202, 202, 223", "lies on the axis"),
    ],
)
def test_what_is_refused(card: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        load(tmp_path, BLOCK + f"*MPC\n{card}\n" + PUSH)


def test_large_displacements_are_refused(tmp_path: Path) -> None:
    text = BLOCK + "*MPC\nPLANE, TOP\n" + PUSH.replace("*STEP", "*STEP, NLGEOM")
    with pytest.raises(InputError, match=r"PLANE: .* not supported with NLGEOM; use \*COUPLING, or small"):
        load(tmp_path, text)
    assert load(tmp_path, text, "NLGEOM").model.kinematics == "small"
