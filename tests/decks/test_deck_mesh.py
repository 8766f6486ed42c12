"""Meshes of Abaqus and CalculiX decks: node order and faces of every element type, sets, surfaces, bodies."""

from itertools import pairwise

import numpy as np
import pytest

from abut import Mesh
from abut._core import shape_functions
from abut.bodies.loads import stress_load, surface_area
from abut.cells import CELLS
from abut.errors import InputError
from abut.io.deck.elements import ELEMENTS
from abut.mesh.integrals import chunks, gradients
from abut.mesh.quadrature import stiffness_rule
from models.decks import MESH

# Corners, edges whose midpoints follow them, and faces S1, S2, ..., from the figures of the CalculiX manual (sections 6.2
# and *DLOAD) and of the Abaqus Analysis User's Guide ("Solid element library"), counted from 1 as there.
HEXAHEDRON = {
    "corners": [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0), (0, 0, 3), (2, 0, 3), (2, 1, 3), (0, 1, 3)],
    "edges": [(1, 2), (2, 3), (3, 4), (4, 1), (5, 6), (6, 7), (7, 8), (8, 5), (1, 5), (2, 6), (3, 7), (4, 8)],
    "faces": [(1, 2, 3, 4), (5, 8, 7, 6), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 8, 4), (4, 8, 5, 1)],
    "volume": 6.0,
}
TETRAHEDRON = {
    "corners": [(0, 0, 0), (2, 0, 0), (0, 1, 0), (0, 0, 3)],
    "edges": [(1, 2), (2, 3), (3, 1), (1, 4), (2, 4), (3, 4)],
    "faces": [(1, 2, 3), (1, 4, 2), (2, 4, 3), (3, 4, 1)],
    "volume": 1.0,
}
WEDGE = {
    "corners": [(0, 0, 0), (2, 0, 0), (0, 1, 0), (0, 0, 3), (2, 0, 3), (0, 1, 3)],
    "edges": [(1, 2), (2, 3), (3, 1), (4, 5), (5, 6), (6, 4), (1, 4), (2, 5), (3, 6)],
    "faces": [(1, 2, 3), (4, 5, 6), (1, 2, 5, 4), (2, 3, 6, 5), (3, 1, 4, 6)],
    "volume": 3.0,
}
TRIANGLE = {
    "corners": [(1, 0, 0), (3, 0, 0), (1, 1, 0)],
    "edges": [(1, 2), (2, 3), (3, 1)],
    "faces": [(1, 2), (2, 3), (3, 1)],
    "volume": 1.0,
}
QUADRILATERAL = {
    "corners": [(1, 0, 0), (3, 0, 0), (3, 1, 0), (1, 1, 0)],
    "edges": [(1, 2), (2, 3), (3, 4), (4, 1)],
    "faces": [(1, 2), (2, 3), (3, 4), (4, 1)],
    "volume": 2.0,
}
SHAPES = {"hex": HEXAHEDRON, "tet": TETRAHEDRON, "wed": WEDGE, "tri": TRIANGLE, "qua": QUADRILATERAL}


def write(tmp_path, text, name="deck.inp"):
    path = tmp_path / name
    path.write_text(text)
    return path


def element_deck(code):
    kind = ELEMENTS[code].kind
    shape = SHAPES[kind[:3]]
    points = [tuple(map(float, c)) for c in shape["corners"]]
    if CELLS[kind].nodes > len(points):
        points += [tuple((np.array(points[a - 1]) + points[b - 1]) / 2) for a, b in shape["edges"]]
    lines = ["*NODE"] + [f"{11 * i}, {x:g}, {y:g}, {z:g}" for i, (x, y, z) in enumerate(points, start=1)]
    numbers = [7, *(11 * i for i in range(1, len(points) + 1))]
    lines += [f"*ELEMENT, TYPE={code}, ELSET=E"]
    lines += [
        ", ".join(map(str, numbers[i : i + 16])) + ("," if len(numbers) > i + 16 else "")
        for i in range(0, len(numbers), 16)
    ]
    for i in range(len(shape["faces"])):
        lines += [f"*SURFACE, NAME=F{i + 1}", f"E, S{i + 1}"]
    return "\n".join(lines) + "\n", shape


@pytest.mark.parametrize("code", sorted(code for code, element in ELEMENTS.items() if not element.thin))
def test_node_order_and_faces(code, tmp_path):
    text, shape = element_deck(code)
    mesh = Mesh.read(write(tmp_path, text))
    volume = 0.0
    for kind, nodes, _ in chunks(mesh):
        assert kind == ELEMENTS[code].kind
        xi, weights = stiffness_rule(kind)
        det = gradients(mesh.points, nodes, shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))[1])[1]
        volume += float((det @ weights).sum())
    assert volume == pytest.approx(shape["volume"], rel=1e-12)  # exact: the map is affine
    dim = mesh.dim
    corners = np.array(shape["corners"], float)[:, :dim]
    total = 0.0
    for i, face in enumerate(shape["faces"], start=1):
        surface = mesh.surface(f"F{i}")
        expected = corners[np.array(face) - 1]
        own = CELLS[mesh.blocks[0].kind].facets[int(surface.local[0])][0]
        at = mesh.points[surface.nodes[0, : CELLS[own].corners]]
        assert sorted(map(tuple, at.tolist())) == sorted(map(tuple, expected.tolist()))
        push = np.array([stress_load(surface, np.eye(dim)).reshape(-1, dim).sum(axis=0)])[
            0
        ]  # area times outward normal
        assert push @ (expected.mean(axis=0) - corners.mean(axis=0)) > 0.0
        assert np.linalg.norm(push) == pytest.approx(surface_area(surface), rel=1e-12)
        total = total + push
    assert np.abs(total).max() < 1e-12  # a closed surface


BRICKS = "*HEADING\n two bricks, the second on top\n" + MESH + "*NODE, NSET=ALL\n99, 5,5,5\n"


def test_sets(tmp_path):
    text = BRICKS + (
        "*NSET, NSET=bottom, GENERATE\n1, 4\n*NSET, NSET=odd, GENERATE\n 1, 8, 2\n"
        "*nset, nset=Both\nBOTTOM, 18,\n*NSET, NSET=both\n17\n*NSET, NSET=OFLOW, ELSET=low\n*NSET,NSET=LOOSE\n99, 1\n"
    )
    mesh = Mesh.read(write(tmp_path, text))
    z = {name: sorted(mesh.points[own].tolist()) for name, own in mesh.node_sets.items()}
    assert [x[2] for x in z["bottom"]] == [0.0] * 4
    assert len(z["odd"]) == 4
    assert len(z["Both"]) == 6  # the two cards add up, in any case of letters
    assert len(z["OFLOW"]) == 8
    assert z["LOOSE"] == [[0.0, 0.0, 0.0]]  # node 99 belongs to no element


def test_bodies_are_sets_of_elements_without_sections(tmp_path):
    mesh = Mesh.read(write(tmp_path, BRICKS))
    assert sorted(mesh.bodies) == ["HIGH", "LOW"]


def test_bodies_are_connected_parts_of_sections(tmp_path):
    text = BRICKS + "*ELSET, ELSET=Both\nLOW, HIGH\n*SOLID SECTION, ELSET=BOTH, MATERIAL=none\n"
    mesh = Mesh.read(write(tmp_path, text))
    assert sorted(mesh.bodies) == ["Both-1", "Both-2"]
    assert mesh.points[mesh.nodes_of("Both-1")][:, 2].max() == 1.0


def test_surfaces_of_nodes_and_of_all_free_faces(tmp_path):
    text = BRICKS + (
        "*NSET, NSET=UP\n5,6,7,8\n*SURFACE, NAME=up, TYPE=NODE\nUP\n*SURFACE, NAME=SKIN\nHIGH,\n"
        "*SURFACE, NAME=LONE, TYPE=NODE\n1, 1.0\n"
    )
    mesh = Mesh.read(write(tmp_path, text))
    up = mesh.surface("up")
    assert len(up) == 1
    assert (mesh.points[up.node_ids][:, 2] == 1.0).all()
    assert surface_area(mesh.surface("SKIN")) == pytest.approx(6.0)
    assert "LONE" in mesh.node_sets  # a single node makes up no face
    assert "UP" in mesh.node_sets


def test_names_that_stand_for_several_things(tmp_path):
    text = BRICKS + "*NSET, NSET=LOW\n1\n*SURFACE, NAME=LOW\n1, S2\n"
    mesh = Mesh.read(write(tmp_path, text))
    assert (set(mesh.bodies), set(mesh.surfaces), set(mesh.node_sets)) == (
        {"LOW", "HIGH"}, {"LOW-surface"}, {"ALL", "LOW-nodes"},
    )  # fmt: skip


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (BRICKS.replace("2, 11,12,13", "2, 11,12,33"), r"deck.inp:23: \*ELEMENT: element 2: node 33 does not exist"),
        (BRICKS.replace("15,16,17,18", "15,16,17"), r":23: \*ELEMENT: element 2 has 7 nodes, but C3D8 needs 8"),
        (BRICKS.replace("15,16,17,18", "15,16,17,18,1"), r":23: .* has 9 nodes"),
        (BRICKS.replace("2, 11,12", "1, 11,12"), r":23: .*element 1 is given twice"),
        (BRICKS.replace("18, 0,1,2", "1, 0,1,2"), r":19: .*node 1 is given twice"),
        (BRICKS.replace("18, 0,1,2", "18, 0,l,2"), r":19: \*NODE: y: expected a number, got 'l'"),
        (BRICKS.replace("18, 0,1,2", "18, 0,nan,2"), r":19: \*NODE: y: expected a number, got 'nan'"),
        (BRICKS.replace("C3D8", "C3D4H"), r":20: \*ELEMENT: element type C3D4H: .*not supported"),
        (BRICKS.replace("C3D8", "T2D3"), "T2D3: trusses are not supported; model the part with solid"),
        (BRICKS + "*NSET, NSET=A\nBOTOM\n", r":27: \*NSET: no node set named 'BOTOM'; known: ALL"),
        (BRICKS + "*SURFACE, NAME=A\nLOW, S7\n", r":27: \*SURFACE: face label 'S7': expected S1 to S6"),
        (BRICKS + "*SURFACE, NAME=A, TYPE=CYLINDER\n1,1\n", "TYPE=CYLINDER"),
        (BRICKS + "*NSET\n1\n", "parameter NSET is missing"),
        (BRICKS + "*NGEN\n1, 8\n", "generated nodes are not read"),
        (BRICKS + "*PART, NAME=A\n", r"\*PART: \*END PART is missing; add it"),
        ("*NODE\n1, 0, 0\n", "no \\*ELEMENT cards"),
        ("1, 2, 3\n*NODE\n", ":1: a data line before the first card"),
        ("** nothing\n", "no card in the file"),
        ("*\n1, 2.\n", "a star without the name"),
    ],
)
def test_faults_are_named_with_their_place(text, words, tmp_path):
    with pytest.raises(InputError, match=words):
        Mesh.read(write(tmp_path, text))


def test_lines_end_anyhow_and_numbers_are_fortran(tmp_path):
    text = BRICKS.replace("18, 0,1,2", "18, 0, 1.D0, 2.d-0 ,").replace("\n", "\r\n")
    mesh = Mesh.read(write(tmp_path, text))
    assert mesh.points.max() == 2.0
    assert all(a != b for a, b in pairwise(sorted(mesh.bodies)))


def test_includes(tmp_path):
    head, tail = BRICKS.split("*ELEMENT, TYPE=C3D8, ELSET=LOW\n")
    nodes = head.split("*NODE, NSET=ALL\n")[1]
    write(tmp_path, nodes, "nodes.txt")
    write(tmp_path, "*ELEMENT, TYPE=C3D8, ELSET=LOW\n" + tail, "elements.inc")
    deck = "*NODE, NSET=ALL, INPUT=nodes.txt\n*INCLUDE,\n INPUT=elements.inc\n"
    assert sorted(Mesh.read(write(tmp_path, deck)).bodies) == ["HIGH", "LOW"]
    with pytest.raises(InputError, match=r"elements.inc:2: .*node 1 does not exist"):
        Mesh.read(write(tmp_path, "*INCLUDE, INPUT=elements.inc\n"))
    with pytest.raises(InputError, match=r"deck.inp:1: included file .*none.inc does not exist"):
        Mesh.read(write(tmp_path, "*INCLUDE, INPUT=none.inc\n"))
    with pytest.raises(InputError, match="includes itself"):
        Mesh.read(write(tmp_path, "*INCLUDE, INPUT=deck.inp\n"))
    with pytest.raises(InputError, match="the file is missing"):
        Mesh.read(write(tmp_path, "*INCLUDE\n"))
