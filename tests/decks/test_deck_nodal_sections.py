"""Thickness at nodes of beams and plane elements, trusses at beams, turned edges of shells, beams that pull: theory."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from decks.test_deck_shells import LENGTH, WIDTH, at, strip

from abut.errors import InputError
from models.decks import load, solve, step

E = 1000.0
MATERIAL = f"*MATERIAL, NAME=M\n*ELASTIC\n{E}, 0.\n"


def line(count: int, section: str, more: str = "") -> str:
    """A cantilever of B32 along x, 10 long, held at node 1, its end node ``2 count + 1``."""
    nodes = [f"{i + 1}, {10.0 * i / (2 * count)!r}, 0., 0." for i in range(2 * count + 1)]
    cells = [f"{k + 1}, {2 * k + 1}, {2 * k + 2}, {2 * k + 3}" for k in range(count)]
    text = ["*NODE, NSET=ALL", *nodes, "*ELEMENT, TYPE=B32, ELSET=E", *cells]
    return "\n".join(text) + f"\n*BOUNDARY\n1, 1, 6\n{MATERIAL}*BEAM SECTION, ELSET=E, MATERIAL=M, {section}\n{more}"


def test_beam_with_the_widths_of_its_nodes(tmp_path: Path) -> None:
    """The same at every node is the section's own; a width that grows from w to v between two sections of a pulled bar of
    breadth b lets these move apart by F L ln (v / w) / (E b)."""
    bent = step("*CLOAD", "9, 2, .001", "9, 3, .002")
    own = solve(tmp_path, line(4, "SECTION=RECT\n.5, .25\n0., 1., 0.") + bent)
    given = "SECTION=RECT, NODAL THICKNESS\n9., 9.\n0., 1., 0."
    nodal = solve(tmp_path, line(4, given, "*NODAL THICKNESS\nALL, .5, .25\n") + bent)
    assert nodal.displacement == pytest.approx(own.displacement, rel=1e-9, abs=1e-12)

    widths = "*NODAL THICKNESS\n" + "".join(f"{i + 1}, {0.1 + i / 160!r}, .5\n" for i in range(17))
    pulled = solve(tmp_path, line(8, given, widths) + step("*CLOAD", "17, 1, 1."))
    points = pulled.model.mesh.points
    near, far = (
        pulled.displacement[np.abs(points[:, 0] - x) < 1e-9][:, 0].mean() for x in (1.25, 8.75)
    )  # beside the ends
    # half a per cent: the stress over a section of eight points
    assert far - near == pytest.approx(100.0 * np.log(1.875 / 1.125) / (E * 0.5), rel=5e-3)

    with pytest.raises(InputError, match=r"beam 1 has no thickness at one of its nodes; give it in \*NODAL THICKNESS"):
        load(tmp_path, line(4, given) + bent)


def test_plane_elements_with_the_thickness_of_their_nodes(tmp_path: Path) -> None:
    """A strip of plane stress, 10 by 1, whose thickness grows from 1 to 2, pulled by F: F L ln 2 / E."""
    ids: dict[tuple[int, int], int] = {}

    def node(i: int, j: int) -> int:
        return ids.setdefault((i, j), len(ids) + 1)

    cells = []
    for k in range(8):
        i = 2 * k
        corners = [node(i, 0), node(i + 2, 0), node(i + 2, 2), node(i, 2)]
        cells.append([k + 1, *corners, node(i + 1, 0), node(i + 2, 1), node(i + 1, 2), node(i, 1)])
    text = ["*NODE, NSET=ALL", *(f"{n}, {10.0 * i / 16!r}, {j / 2!r}" for (i, j), n in ids.items())]
    text += ["*ELEMENT, TYPE=CPS8, ELSET=E", *(", ".join(map(str, row)) for row in cells), "*BOUNDARY"]
    text += [f"{n}, 1" for (i, _), n in ids.items() if i == 0] + [f"{node(0, 0)}, 2", MATERIAL.rstrip()]
    text += ["*SOLID SECTION, ELSET=E, MATERIAL=M, NODAL THICKNESS"]
    thick = ["*NODAL THICKNESS", *(f"{n}, {1.0 + i / 16!r}" for (i, _), n in ids.items())]
    pull = step("*CLOAD", *(f"{node(16, j)}, 1, {share!r}" for j, share in ((0, 1 / 6), (1, 2 / 3), (2, 1 / 6))))
    solution = solve(tmp_path, "\n".join([*text, *thick]) + "\n" + pull)
    end = solution.displacement[solution.model.mesh.points[:, 0] > 10.0 - 1e-9][:, 0].mean()
    assert end == pytest.approx(10.0 * np.log(2.0) / E, rel=1e-3)
    with pytest.raises(
        InputError, match=r"element 1 has no thickness at one of its nodes; give it in \*NODAL THICKNESS"
    ):
        load(tmp_path, "\n".join(text) + "\n" + pull)


def test_truss_at_the_end_of_a_beam(tmp_path: Path) -> None:
    """A hinge: the force across is shared by 3 E I / L^3 of the beam and E A / l of the truss."""
    text = line(4, "SECTION=RECT\n.5, .5\n0., 1., 0.").replace("*ELEMENT", "99, 10., 20., 0.\n*ELEMENT", 1)
    text += "*ELEMENT, TYPE=T3D2, ELSET=T\n50, 9, 99\n*BOUNDARY\n99, 1, 3\n*SOLID SECTION, ELSET=T, MATERIAL=M\n.0002\n"
    solution = solve(tmp_path, text + step("*CLOAD", "9, 2, .001"))
    stiffness = 3.0 * E * 0.5**4 / 12.0 / 10.0**3 + E * 0.0002 / 20.0
    points = solution.model.mesh.points
    end = solution.displacement[(points[:, 0] > 10.0 - 1e-9) & (np.abs(points[:, 1]) < 0.3)][:, 1].mean()
    assert end == pytest.approx(0.001 / stiffness, rel=0.01)  # shear adds 3 E (h/L)^2 / 5 G, .4 % of the beam's share


@pytest.mark.parametrize("angle", [0.3, 1.0])
def test_edge_of_a_shell_turned_far(angle: float, tmp_path: Path) -> None:
    """An edge that turns by an angle a, and moves as it will, rolls the strip to an arc: L (sin a / a - 1) along it and
    L (1 - cos a) / a across."""
    solution = solve(tmp_path, strip() + step("*BOUNDARY", f"RIGHT, 5, 5, {angle}").replace("*STEP", "*STEP, NLGEOM"))
    end = at(solution, LENGTH, WIDTH / 2)
    arc = LENGTH / angle
    assert end[0] == pytest.approx(arc * np.sin(angle) - LENGTH, rel=0.01)
    assert end[2] == pytest.approx(-arc * (1.0 - np.cos(angle)), rel=0.005)


def test_layers_that_a_later_section_replaces_may_be_none(tmp_path: Path) -> None:
    thin = "*SHELL SECTION, ELSET=EALL, COMPOSITE\n0., , M\n"
    load_case = step("*DLOAD", "EALL, P, 1.E-3")
    head, _, tail = strip().partition("*SHELL SECTION")
    own = solve(tmp_path, strip() + load_case)
    replaced = solve(tmp_path, head + thin + "*SHELL SECTION" + tail + load_case)
    assert (replaced.displacement == own.displacement).all()
    with pytest.raises(InputError, match="thickness of the layer: expected a number > 0, got 0"):
        load(tmp_path, head + thin + load_case)


def bolt(normal: str = "1., 0., 0.", where: str = "7., 3., 0.") -> str:
    """Two cubes on a line, held at their far sides, and a beam between what their near sides do in the mean: DCOUP3D at
    nodes 101 (``where``) and 102, which the beam's ends 103 and 104 follow."""
    nodes, cells = [], []
    for k, x in ((0, 0.0), (1, 2.0)):
        for i, (y, z) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1))):
            nodes += [f"{8 * k + i + 1}, {x}, {y}., {z}.", f"{8 * k + i + 5}, {x + 1.0}, {y}., {z}."]
        cells.append(f"{k + 1}, " + ", ".join(str(8 * k + i) for i in range(1, 9)))
    nodes += [f"101, {where}", "102, 2., .5, .5", "103, 1., .5, .5", "104, 2., .5, .5", "105, 0., 0., 0."]
    near = (
        "*NSET, NSET=A\n5, 6, 7, 8\n*NSET, NSET=B\n9, 10, 11, 12\n",
        "*NSET, NSET=FAR\n1, 2, 3, 4, 13, 14, 15, 16\n",
    )
    equations = "".join(
        f"*EQUATION\n2\n{a}, {k}, 1., {b}, {k}, -1.\n" for a, b in ((101, 103), (102, 104)) for k in (1, 2, 3)
    )
    return (
        "*NODE\n" + "\n".join(nodes) + "\n*ELEMENT, TYPE=C3D8, ELSET=E\n" + "\n".join(cells) + "\n" + "".join(near)
        + "*ELEMENT, TYPE=B31, ELSET=BEAM\n10, 103, 104\n*ELEMENT, TYPE=DCOUP3D, ELSET=D1\n11, 101\n"
        + "*ELEMENT, TYPE=DCOUP3D, ELSET=D2\n12, 102\n" + MATERIAL + "*SOLID SECTION, ELSET=E, MATERIAL=M\n"
        + "*BEAM SECTION, ELSET=BEAM, MATERIAL=M, SECTION=RECT\n.01, .01\n0., 1., 0.\n"
        + f"*PRE-TENSION SECTION, ELEMENT=BEAM, NODE=105\n{normal}\n*BOUNDARY\nFAR, 1, 3\n"
        + "*DISTRIBUTING COUPLING, ELSET=D1\nA, 1.\n*DISTRIBUTING COUPLING, ELSET=D2\nB, 1.\n" + equations
    )  # fmt: skip


@pytest.mark.parametrize(("normal", "sign"), [("1., 0., 0.", 1.0), ("", 1.0), ("-2., 0., 0.", -1.0)])
def test_beam_that_pulls(normal: str, sign: float, tmp_path: Path) -> None:
    """The tension of the beam stretches what it pulls at by F L / E A, wherever the reference of its ends was put; a normal
    from its second end to its first makes it press, and is told."""
    text = bolt(normal).replace("\n\n", "\n") + step("*CLOAD", "105, 1, 3.")
    translation = load(tmp_path, text)
    assert any("forces > 0 press" in note for note in translation.notes) == (sign < 0.0)
    solution = solve(tmp_path, text)
    x, u = solution.model.mesh.points, solution.displacement
    for face, way in ((1.0, 1.0), (2.0, -1.0)):
        assert u[x[:, 0] == face] == pytest.approx(
            np.tile([sign * way * 3.0 / E, 0.0, 0.0], (4, 1)), rel=1e-9, abs=1e-12
        )


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("ELEMENT=BEAM", "ELEMENT=E", "expected an element number or a set of one element"),
        ("ELEMENT=BEAM", "ELEMENT=1", "ELEMENT=1: no beam"),
        ("101, 2, 1., 103, 2, -1.", "101, 2, 1., 103, 2, 1.", "end 103 of the beam does not hang on one node alone"),
        ("FAR, 1, 3\n", "FAR, 1, 3\n104, 4, 6\n", "nodes of beam 10 have loads or supports"),
        ("105, 1, 3.", "105, 2, 3.", "takes a force in direction 1 alone"),
        ("*STEP", "*STEP, NLGEOM", "with NLGEOM the beam turns"),
        (
            "10, 103, 104\n",
            "10, 103, 104\n20, 104, 4\n",
            "set of one element",
        ),
    ],
)
def test_beams_that_do_more_than_pull_are_refused(old: str, new: str, words: str, tmp_path: Path) -> None:
    text = bolt() + step("*CLOAD", "105, 1, 3.")
    assert old in text
    with pytest.raises(InputError, match=words):
        load(tmp_path, text.replace(old, new))
