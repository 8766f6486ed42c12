"""*MPC: nodes that stay on a line, in a plane or at a distance, the mean rotation of nodes; CalculiX's own examples
with these cards agree within 0.001 % at small loads (``docs/verification/decks.md``)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from models.decks import BRICKS, HELD, load, step

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
        ("SLIDE, 201, 202", "SLIDE is not supported; TIE, PIN, BEAM, DIST, STRAIGHT, PLANE and MEANROT are"),
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


LARGE = step("*CLOAD", "212, 3, -60.", "223, 1, 60.").replace("*STEP", "*STEP, NLGEOM")
CORNERS_OF_TOP = "201, 201, 201, 203, 203, 203, 221, 221, 221, 223, 223, 223"


@pytest.mark.parametrize(
    ("card", "acting", "kind", "wanted"),
    [
        (
            "PLANE, 201, 203, 221, 202, 211, 212, 213, 222, 223", LARGE, "plane",
            {201: (0.08177829, 0.08684198, 0.05562924), 212: (0.1640969, 0.02158905, -0.04284988),
             223: (0.473398, -0.1461379, -0.1578551)},
        ),
        (
            "STRAIGHT, 203, 223, 213", LARGE, "straight",
            {201: (0.0819407, 0.08687328, 0.04155272), 212: (0.1685336, 0.02732242, -0.1123806),
             223: (0.421985, -0.1061317, -0.1839525)},
        ),
        (
            "BEAM, 201, 223", LARGE, "distance",
            {201: (0.166638, 0.1341712, 0.07326414), 212: (0.1580387, 0.0251834, -0.1156424),
             223: (0.4307904, -0.1875078, -0.165174)},
        ),
        (
            f"MEANROT, {CORNERS_OF_TOP}, 900", step("*BOUNDARY", "900, 1, 1, 0.5").replace("*STEP", "*STEP, NLGEOM"),
            "mean-turn",
            {201: (0.606956, -0.3397428, -0.04839963), 223: (-0.606958, 0.3397428, -0.04839962)},
        ),
    ],
)  # fmt: skip
def test_large_displacements(
    card: str, acting: str, kind: str, wanted: dict[int, tuple[float, ...]], tmp_path: Path
) -> None:
    """CalculiX's displacements (2.20) of the same deck; it iterates to .5 % of the forces, which leaves up to 4e-4 of the
    largest one at any node."""
    text = BLOCK.replace("*ELEMENT", "900, 0., 0., 2.\n*ELEMENT", 1) + f"*MPC\n{card}\n" + acting
    model = load(tmp_path, text).model
    assert [connector.kind for connector in model.connectors] == [kind]
    x, u, solution = moved(tmp_path, text)
    assert solution.steps[-1].converged
    largest = max(abs(value) for each in wanted.values() for value in each)
    for node, each in wanted.items():
        k, j, i = node // 100, (node % 100 - 1) // 10, (node - 1) % 10
        assert u[k, j, i] == pytest.approx(each, abs=5e-4 * largest)
    if kind == "distance":
        ends = [(x + u)[2, 0, 0], (x + u)[2, 2, 2]]
        assert np.linalg.norm(np.subtract(*ends)) == pytest.approx(np.sqrt(8.0), rel=1e-9)
    if kind == "mean-turn":
        assert solution.steps[-1].connectors["mpc-1"].motion["turn"] == pytest.approx(0.5, rel=1e-9)


def test_a_mean_turn_under_a_moment(tmp_path: Path) -> None:
    """A force on the pilot is a moment: the one that a prescribed turn needs gives that turn. A pilot that is free binds
    nothing."""
    text = BLOCK.replace("*ELEMENT", "900, 0., 0., 2.\n*ELEMENT", 1) + f"*MPC\nMEANROT, {CORNERS_OF_TOP}, 900\n"
    large = text + step("*BOUNDARY", "900, 1, 1, 0.3").replace("*STEP", "*STEP, NLGEOM")
    drive = abut.solve(load(tmp_path, large).model).steps[-1].connectors["mpc-1"].drive
    pushed = text + step("*CLOAD", f"900, 1, {drive:.12g}").replace("*STEP", "*STEP, NLGEOM")
    turn = abut.solve(load(tmp_path, pushed).model).steps[-1].connectors["mpc-1"].motion["turn"]
    assert turn == pytest.approx(0.3, rel=1e-6)
    assert load(tmp_path, text + LARGE).model.connectors == ()


def test_ignored_large_displacements(tmp_path: Path) -> None:
    text = BLOCK + "*MPC\nPLANE, TOP\n" + PUSH.replace("*STEP", "*STEP, NLGEOM")
    model = load(tmp_path, text, "NLGEOM").model
    assert (model.kinematics, len(model.connectors)) == ("small", 0)


def test_two_nodes_at_a_distance(tmp_path: Path) -> None:
    """BEAM at small displacements: the distance stays in the linear part; other counts of nodes are refused."""
    x, u, _ = moved(tmp_path, BLOCK + "*MPC\nBEAM, 201, 223\n" + PUSH)
    along = x[2, 2, 2] - x[2, 0, 0]
    assert (u[2, 2, 2] - u[2, 0, 0]) @ along == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(InputError, match="BEAM: expected two nodes, got 9"):
        load(tmp_path, BLOCK + "*MPC\nBEAM, TOP\n" + PUSH)


STRIP = "*MPC\nDIST, 1, 1, 1, 15, 15, 15, 900\n*BOUNDARY\n900, 1, 1, 0.\n"
FLAT = "*TIE, NAME=T\nSLAVE, MASTER\n*EQUATION\n" + "".join(f"2\n{n}, 3, 1., 15, 3, -1.\n" for n in (16, 17, 18))


def strapped(most: float, strip: str = STRIP) -> str:
    return BRICKS.replace("*ELEMENT", f"900, {most}, 5., 0.\n*ELEMENT", 1) + HELD.replace("ALL", "TOP") + FLAT + strip


@pytest.mark.parametrize("finite", [False, True])
def test_nodes_no_farther_apart(finite: bool, tmp_path: Path) -> None:
    """A column of height 2 and stiffness E A / 2 under a growing force, whose flat top a strap holds from a stretch of .01
    on: free before, then there, with what the column does not take in the strap; pushed down it is slack. With NLGEOM
    forces differ by up to twice the strain of 1 %, of any law (nu = 0)."""
    lines = ["*AMPLITUDE, NAME=A", "0., 0., 0.25, 0.25, 0.5, 1., 1., -1."]
    text = strapped(2.01) + "\n".join(lines) + "\n" + step("*CLOAD, AMPLITUDE=A", "TOP, 3, 2.5")
    text = text.replace("*STEP", "*STEP, NLGEOM") if finite else text
    text = text.replace("*STATIC", "*STATIC, DIRECT\n0.25, 1.")
    solution = abut.solve(load(tmp_path, text).model)
    high = solution.model.mesh.points[:, 2] == 2.0
    for time, force in ((0.25, 2.5), (0.5, 10.0), (1.0, -10.0)):
        found = next(s for s in solution.steps if abs(s.factor - time) < 1e-9)
        (strap,) = found.connectors.values()
        stretch = min(force * 2.0 / 1000.0, 0.01)
        rel = 0.02 if finite else 1e-9
        assert found.displacement[high, 2] == pytest.approx(stretch, rel=rel)
        assert abs(strap.stop or 0.0) == pytest.approx(max(force - 500.0 * 0.01, 0.0), rel=rel, abs=1e-9)


def test_distances_that_are_none(tmp_path: Path) -> None:
    """Where direction 1 of the last node is free nothing is bounded, as in CalculiX; what cannot be is told."""
    free = load(tmp_path, strapped(2.01, STRIP.partition("*BOUNDARY")[0]) + step("*CLOAD", "TOP, 3, 2.5"))
    assert not free.model.connectors
    for text, said in (
        (strapped(1.9), "DIST: the nodes are 2 apart already, and may not be more than 1.9"),
        (strapped(2.01, STRIP.replace("15, 15, 15", "15, 15")), "DIST: expected two nodes, each three times"),
        (strapped(2.01, STRIP.replace("1, 1, 0.", "1, 1, 0.5")), "moves direction 1 of node 900"),
    ):
        with pytest.raises(InputError, match=said):
            load(tmp_path, text + step("*CLOAD", "TOP, 3, 2.5"))
