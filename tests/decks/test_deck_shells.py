"""Shells of decks, expanded: beams and plates of the textbook, and CalculiX's displacements at the shell's nodes."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from models.decks import BRICKS, load, solve, step, write

CCX = shutil.which("ccx")
LENGTH, WIDTH, THICK, E = 10.0, 1.0, 0.1, 210000.0  # L / h = 100
INERTIA = WIDTH * THICK**3 / 12
Place = Callable[[NDArray[np.float64]], NDArray[np.float64]]


def strip(
    code: str = "S8R",
    nu: float = 0.0,
    count: int = 10,
    place: Place = lambda x: x,
    section: str = "",
    support: str = "1, 6",
) -> str:
    """A strip along x, two elements wide, in the plane of x and y or where ``place`` puts it; LEFT held, RIGHT its other
    end, MID its middle."""
    f = 2 if code[1] in "68" else 1
    ids: dict[tuple[int, int], int] = {}

    def node(i: int, j: int) -> int:
        return ids.setdefault((i, j), len(ids) + 1)

    elements = []
    for i in range(0, f * count, f):
        for j in range(0, 2 * f, f):
            square = [(i, j), (i + f, j), (i + f, j + f), (i, j + f)]
            for corners in [square] if code[1] in "48" else [square[:3], [square[0], *square[2:]]]:
                nodes = [node(*c) for c in corners]
                if f == 2:
                    following = [*corners[1:], corners[0]]
                    nodes += [node((a + c) // 2, (b + d) // 2) for (a, b), (c, d) in zip(corners, following)]
                elements.append(nodes)
    lines = [f"*ELEMENT, TYPE={code}, ELSET=EALL"]
    lines += [f"{k}, {', '.join(map(str, nodes))}" for k, nodes in enumerate(elements, start=1)]
    points = {n: place(np.array([LENGTH * i / (f * count), WIDTH * j / (2 * f), 0.0])) for (i, j), n in ids.items()}
    head = ["*NODE, NSET=ALL", *(f"{n}, {x:.17g}, {y:.17g}, {z:.17g}" for n, (x, y, z) in points.items())]
    for name, end in (("LEFT", 0), ("RIGHT", f * count)):
        lines += [f"*NSET, NSET={name}", *(f"{n}," for (i, _), n in ids.items() if i == end)]
    lines += ["*BOUNDARY", f"LEFT, {support}", "*MATERIAL, NAME=M", "*ELASTIC", f"{E}, {nu}", "*EXPANSION", "1.E-5"]
    lines += ["*DENSITY", "1.", f"*SHELL SECTION, ELSET=EALL, MATERIAL=M{section}", f"{THICK}"]
    return "\n".join([*head, *lines]) + "\n"


def at(
    solution: abut.Solution, x: float, y: float, below: float = THICK / 2, above: float = THICK / 2
) -> NDArray[np.float64]:
    """Mean displacement of both sides of a flat strip."""
    points = solution.model.mesh.points
    near = [np.linalg.norm(points - [x, y, z], axis=1).argmin() for z in (-below, above)]
    assert max(np.linalg.norm(points[n] - [x, y, z]) for n, z in zip(near, (-below, above))) < 1e-9
    return np.asarray(solution.displacement[near].mean(axis=0))


@pytest.mark.parametrize("code", ["S3", "S4", "S4R", "S6", "S8", "S8R"])
def test_thin_strips_do_not_lock(code: str, tmp_path: Path) -> None:
    """Clamped, 1:100, under a pressure that pushes along the normal: q L^4 / 8 E I. Ten elements for a curve of fourth
    order, which those of second order follow to about h^2."""
    solution = solve(tmp_path, strip(code) + step("*DLOAD", "EALL, P, 1.E-3"))
    assert at(solution, LENGTH, 0.0)[2] == pytest.approx(1e-3 * WIDTH * LENGTH**4 / (8 * E * INERTIA), rel=0.005)


@pytest.mark.parametrize("turn", [True, False])
def test_end_turned(turn: bool, tmp_path: Path) -> None:
    """A uniform moment bends to a parabola, which quadratic elements hold exactly: M L^2 / 2 E I, turn M L / E I. The moment
    in the shares of a line of second order."""
    angle = 1e-2
    shares = dict(zip(("1", "2", "3", "4", "5"), (1 / 12, 1 / 3, 1 / 6, 1 / 3, 1 / 12)))
    text = strip()
    ends = text.partition("NSET=RIGHT\n")[2].partition("*")[0].replace(",", "").split()
    rows = {
        float(line.split(",")[2]): line.split(",")[0]
        for line in text.split("*ELEMENT")[0].splitlines()[1:]
        if line.split(",")[0] in ends
    }
    moment = E * INERTIA * angle / LENGTH
    loads = [f"{rows[y]}, 5, {share * moment}" for y, share in zip(sorted(rows), shares.values())]
    given = ("*BOUNDARY", f"RIGHT, 5, 5, {angle}") if turn else ("*CLOAD", *loads)
    solution = solve(tmp_path, text + step(*given))
    assert at(solution, LENGTH, WIDTH / 2)[2] == pytest.approx(-angle * LENGTH / 2, rel=1e-6)
    assert at(solution, LENGTH / 2, 0.0)[2] == pytest.approx(-angle * LENGTH / 8, rel=1e-6)


@pytest.mark.parametrize(("offset", "side"), [("0.5", 1.0), ("SNEG", -1.0), ("0.25", 0.5)])
def test_offset(offset: str, side: float, tmp_path: Path) -> None:
    """Gravity along the strip pulls in its mid-surface, wherever its nodes are: rho g L^2 / 2 E at its end, no bending.
    Nodes on the positive side see the strip below them."""
    solution = solve(tmp_path, strip(section=f", OFFSET={offset}") + step("*DLOAD", "EALL, GRAV, 1., 1., 0., 0."))
    z = solution.model.mesh.points[:, 2]
    assert (z.min(), z.max()) == pytest.approx((THICK * (-0.5 - side / 2), THICK * (0.5 - side / 2)))
    end = at(solution, LENGTH, 0.0, THICK * (0.5 + side / 2), THICK * (0.5 - side / 2))
    assert end == pytest.approx([LENGTH**2 / (2 * E), 0.0, 0.0], rel=1e-3, abs=1e-9)


def test_thickness_of_nodes(tmp_path: Path) -> None:
    """Only where the section asks for it; then the one on its line is not used."""
    twice = f"*NODAL THICKNESS\nALL, {2 * THICK}\n"
    load_case = step("*DLOAD", "EALL, P, 1.E-3")
    plain = at(solve(tmp_path, strip() + twice + load_case), LENGTH, 0.0)[2]
    own = solve(tmp_path, strip(section=", NODAL THICKNESS") + twice + load_case)
    assert at(own, LENGTH, 0.0, THICK, THICK)[2] == pytest.approx(plain / 8, rel=2e-3)  # shear: (h / L)^2
    with pytest.raises(InputError, match=r"shell 1 has no thickness at one of its nodes; give it in \*NODAL THICKNESS"):
        load(tmp_path, strip(section=", NODAL THICKNESS") + load_case)


def test_warmer_on_one_side(tmp_path: Path) -> None:
    """A gradient g along the normal bends freely to the curvature alpha g, downwards where the top is warmer."""
    text = strip() + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20.\n" + step("*TEMPERATURE", "ALL, 20., 30.")
    assert at(solve(tmp_path, text), LENGTH, WIDTH / 2)[2] == pytest.approx(
        -1e-5 * 30.0 * LENGTH**2 / 2, rel=2e-3
    )  # held flat at its end


@pytest.mark.parametrize("face", ["SNEG", "S1"])
def test_contact_on_a_side(face: str, tmp_path: Path) -> None:
    """A shell that a pressure presses on a brick: p L / E of it and of half the shell above its face."""
    plate = "*NODE\n31, 0,0,1.1\n32, 1,0,1.1\n33, 1,1,1.1\n34, 0,1,1.1\n"
    low = (
        BRICKS.partition("*ELEMENT, TYPE=C3D8, ELSET=HIGH")[0]
        + "*NSET, NSET=BOTTOM\n1,2,3,4\n*SURFACE, NAME=MASTER\nLOW, S2\n"
    )
    text = low + plate + "*ELEMENT, TYPE=S4, ELSET=PLATE\n7, 31,32,33,34\n*SURFACE, NAME=SLAVE\nPLATE, " + face + "\n"
    text += "*MATERIAL, NAME=EL\n*ELASTIC\n1000., 0.\n*SOLID SECTION, ELSET=LOW, MATERIAL=EL\n"
    text += "*SHELL SECTION, ELSET=PLATE, MATERIAL=EL\n.2\n*NSET, NSET=PLATE\n31,32,33,34\n"
    text += "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n"
    text += "*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nSLAVE, MASTER\n"
    text += "*BOUNDARY\nBOTTOM, 1, 3\nALL, 1, 2\nPLATE, 1, 2\n" + step("*DLOAD", "PLATE, P2, 10.")
    solution = solve(tmp_path, text)
    points, u = solution.model.mesh.points, solution.displacement
    assert u[points[:, 2] > 1.15][:, 2] == pytest.approx(-10.0 * 1.2 / 1000.0, rel=1e-6)
    assert solution.contacts[0].force[2] == pytest.approx(10.0, rel=1e-9) or solution.contacts[0].force[
        2
    ] == pytest.approx(-10.0, rel=1e-9)


def test_fold_keeps_its_angle(tmp_path: Path) -> None:
    """An angle of two arms, a force P at the end of one across it: the end moves by P a^3 / 3EI + P a^2 b / EI. The fold is
    a knot, rigid over half the thickness, which shortens each arm by as much."""

    def angle(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array([min(x[0], LENGTH / 2), x[1], max(x[0] - LENGTH / 2, 0.0)])

    solution = solve(tmp_path, strip(place=angle) + step("*CLOAD", "RIGHT, 1, 1.E-3"))
    points, u = solution.model.mesh.points, solution.displacement
    arm, force = LENGTH / 2, 5e-3
    end = u[points[:, 2] > LENGTH / 2 - 1e-9][:, 0].mean()
    assert end == pytest.approx(force * arm**3 / (E * INERTIA) * (1 / 3 + 1), rel=0.02)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            strip(section=", COMPOSITE") + step("*DLOAD", "EALL, P, 1."),
            "COMPOSITE and MATERIAL: layers have a material",
        ),
        (strip(section=", OFFSET=TOP") + step("*DLOAD", "EALL, P, 1."), "OFFSET=TOP: expected a number"),
        (strip().replace(f"\n{THICK}\n", "\n0.\n") + step("*DLOAD", "EALL, P, 1."), "thickness: expected a number > 0"),
        (strip().partition("*SHELL")[0] + step("*DLOAD", "EALL, P, 1."), r"element 1 without \*SHELL SECTION"),
        (strip() + step("*CLOAD", "RIGHT, 6, 1."), "has a moment about the normal of its shell, which nothing resists"),
        (
            strip() + step("*CLOAD", "RIGHT, 5, 1.").replace("*STEP", "*STEP, NLGEOM"),
            r"\*CLOAD: moments at nodes of shells need small displacements",
        ),
        (strip() + step("*DLOAD", "EALL, PX, 1."), "load 'PX' is not supported|expected P1"),
        (
            strip("S4").replace("\n1, 1, ", "\n1, 2, ") + step("*DLOAD", "EALL, P, 1."),
            "has no area at one of its nodes",
        ),
    ],
)
def test_refused(text: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        load(tmp_path, text)


def test_meshes_of_shells_alone(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="S8R: shells and beams are read with the whole deck only"):
        Mesh.read(write(tmp_path, strip()))


def test_flat_shells_of_calculix_are_those_of_three_nodes(tmp_path: Path) -> None:
    """US3 with *USER ELEMENT and *USER SECTION, whose first constant is the thickness."""
    push = step("*DLOAD", "EALL, P, 1.E-3")
    user = strip("US3").replace(
        "*SHELL SECTION, ELSET=EALL, MATERIAL=M", "*USER SECTION, ELSET=EALL, MATERIAL=M, CONSTANTS=1"
    )
    user += "*USER ELEMENT, TYPE=US3, NODES=3, INTEGRATION POINTS=3, MAXDOF=6\n"
    same = solve(tmp_path, strip("S3") + push)
    assert (solve(tmp_path, user + push).displacement == same.displacement).all()
    assert any("C3D15 instead of a flat shell" in note for note in load(tmp_path, user + push).notes)


def test_in_an_assembly(tmp_path: Path) -> None:
    """Sections, thickness and normals of a part go with its instance."""
    text = strip(section=", NODAL THICKNESS") + f"*NODAL THICKNESS\nALL, {THICK}\n*NORMAL\nEALL, ALL, 0., 0., 1.\n"
    held, material = (
        text[text.index("*BOUNDARY") : text.index("*MATERIAL")],
        text[text.index("*MATERIAL") : text.index("*SHELL")],
    )
    part = text.replace(held, "").replace(material, "")
    whole = f"*PART, NAME=P\n{part}*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n0., 0., 5.\n"
    whole += "0., 0., 5., 1., 0., 5., 90.\n*END INSTANCE\n*END ASSEMBLY\n"
    whole += material + held.replace("LEFT", "I.LEFT") + step("*DLOAD", "I.EALL, P, 1.E-3")
    solution = solve(tmp_path, whole)
    tip = solution.displacement[solution.model.mesh.points[:, 0] > LENGTH - 1e-9]
    assert tip[:, 1].mean() == pytest.approx(
        -1e-3 * LENGTH**4 / (8 * E * INERTIA), rel=0.01
    )  # the normal z turned to -y


@pytest.mark.skipif(CCX is None, reason="CalculiX is not installed")
@pytest.mark.parametrize("code", ["S8R", "S6"])
def test_as_calculix(code: str, tmp_path: Path) -> None:
    """An arch, held at its foot, under pressure, end forces and in local axes: at every node of the shell."""
    radius = 8.0

    def arch(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array([radius * np.sin(x[0] / radius), x[1], radius * np.cos(x[0] / radius)])

    text = strip(code, nu=0.3, count=6, place=arch, section=", OFFSET=0.2")
    text += "*TRANSFORM, NSET=RIGHT, TYPE=C\n0., 0., 0., 0., 1., 0.\n" + step(
        "*DLOAD",
        "EALL, P, 1.E-3",
        "*CLOAD",
        "RIGHT, 1, 1.E-2",
        "*BOUNDARY",
        "RIGHT, 2, 2",
        "*NODE PRINT, NSET=ALL",
        "U",
    )
    path = write(tmp_path, text)
    solution = abut.solve(load(tmp_path, text).model)
    subprocess.run(["ccx", "-i", path.stem], cwd=tmp_path, check=True, capture_output=True)
    rows = [line.split() for line in path.with_suffix(".dat").read_text().splitlines()]
    wanted = {int(r[0]): (np.array(r[1:4], dtype=float), len(r) == 5) for r in rows if r and r[0].isdigit()}
    lines = [line.split(",") for line in text.partition("*ELEMENT")[0].splitlines()[1:]]
    points, u = solution.model.mesh.points, solution.displacement
    largest = max(np.abs(value).max() for value, _ in wanted.values())
    for number, *fields in lines:
        x = np.array(fields, dtype=float)
        up, width = np.array([x[0], 0.0, x[2]]) / radius, np.array([0.0, 1.0, 0.0])
        sides = [np.linalg.norm(points - (x + THICK * k * up), axis=1).argmin() for k in (-0.7, 0.3)]
        value, local = wanted[int(number)]  # "L": along the radius, the circumference and the axis
        axes = np.stack([up, np.cross(width, up), width]) if local else np.eye(3)
        assert axes @ u[sides].mean(axis=0) == pytest.approx(value, abs=0.003 * largest)


def test_on_the_edge_of_a_brick(tmp_path: Path) -> None:
    """A shell that shares nodes with the straight edge of a linear solid follows it all along: pulled, it lengthens by
    p L / E; by its ends alone it would be held half as well."""
    nodes = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n9,0,0,2\n10,0,1,2\n"
    text = nodes + "*ELEMENT, TYPE=C3D8, ELSET=BRICK\n1,1,2,3,4,5,6,7,8\n*ELEMENT, TYPE=S4, ELSET=SHEET\n2,5,8,10,9\n"
    text += "*NSET, NSET=ALL, GENERATE\n1,8\n*NSET, NSET=TOP\n9,10\n*MATERIAL, NAME=M\n*ELASTIC\n1000.,0.\n"
    text += "*SOLID SECTION, ELSET=BRICK, MATERIAL=M\n*SHELL SECTION, ELSET=SHEET, MATERIAL=M\n.2\n"
    text += "*BOUNDARY\nALL,1,3\nTOP,1,2\nTOP,3,3,.01\n"
    solution = solve(tmp_path, text + step())
    points = solution.model.mesh.points
    middle = (np.abs(points[:, 2] - 1.0) < 1e-9) & (np.abs(points[:, 1] - 0.5) < 1e-9)
    assert solution.displacement[middle].mean(axis=0) == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)


def joined(place: Place, cut: bool, section: str = "") -> str:
    """The strip of ten S8R, or its two halves whose edges equations join in all six directions."""
    text = strip("S8R", place=place, section=section)
    if not cut:
        return text
    nodes, rest = text.split("*ELEMENT, TYPE=S8R, ELSET=EALL\n", 1)
    elements, more = rest.split("*NSET, NSET=LEFT\n", 1)
    points = {int(row.split(",")[0]): row.split(",", 1)[1] for row in nodes.splitlines()[1:]}
    rows = [[int(n) for n in row.split(",")] for row in elements.splitlines()]
    left, right = ({n for row in rows if (row[0] <= 10) == first for n in row[1:]} for first in (True, False))
    twins = {n: n + 1000 for n in left & right}
    new = [row if row[0] <= 10 else [row[0], *(twins.get(n, n) for n in row[1:])] for row in rows]
    lines = [*nodes.splitlines(), *(f"{twins[n]},{points[n]}" for n in twins), "*ELEMENT, TYPE=S8R, ELSET=EALL"]
    lines += [", ".join(map(str, row)) for row in new] + ["*EQUATION"]
    lines += [f"2\n{twin}, {d}, 1., {n}, {d}, -1." for n, twin in twins.items() for d in range(1, 7)]
    return "\n".join([*lines, "*NSET, NSET=LEFT", more])


@pytest.mark.parametrize("angle", [0.0, 0.5])
def test_equations_of_turns_join_edges(angle: float, tmp_path: Path) -> None:
    """Two halves that move and turn alike where they meet are one strip, also where axes of turns lie across the normal.
    Without Poisson's ratio, by which a joined edge keeps its thickness."""

    def place(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array([x[0] * np.cos(angle), x[1], x[0] * np.sin(angle)])

    push = step("*CLOAD", "RIGHT, 3, 0.1", "RIGHT, 2, 0.1")
    ends = []
    for cut in (True, False):
        solution = solve(tmp_path, joined(place, cut) + push)
        points, u = solution.model.mesh.points, solution.displacement
        far = np.flatnonzero(points @ [np.cos(angle), 0.0, np.sin(angle)] > LENGTH - 1e-9)
        ends.append(u[far].mean(axis=0))
    assert ends[0] == pytest.approx(ends[1], rel=1e-5)
    assert abs(ends[0]).max() > 0.01 * LENGTH


def test_an_equation_that_turns_an_edge(tmp_path: Path) -> None:
    """Turns that equations give are those that supports give: of a node of no element, by its displacement."""
    text = strip("S8R")
    edge = text.split("*NSET, NSET=RIGHT\n")[1].split("*BOUNDARY")[0].replace(",", "").split()
    by_support = solve(tmp_path, text + step("*BOUNDARY", *(f"{n}, 5, 5, 0.01" for n in edge)))
    text = text.replace("*NSET, NSET=LEFT", "*NODE\n999, 0., 0., 5.\n*NSET, NSET=LEFT", 1)
    text += "*EQUATION\n" + "".join(f"2\n{n}, 5, 1., 999, 1, -1.\n" for n in edge)
    by_equation = solve(tmp_path, text + step("*BOUNDARY", "999, 1, 1, 0.01"))
    assert at(by_equation, LENGTH, 0.0) == pytest.approx(at(by_support, LENGTH, 0.0), rel=1e-4, abs=1e-9)
    assert at(by_equation, LENGTH, 0.0)[2] == pytest.approx(-0.01 * LENGTH / 2, rel=1e-3)  # even bending


def test_turns_in_equations_refused(tmp_path: Path) -> None:
    text = joined(lambda x: x, True)
    with pytest.raises(InputError, match="EQUATION: turns of nodes of shells need small displacements"):
        load(tmp_path, text + step("*CLOAD", "RIGHT, 3, 0.1").replace("*STEP", "*STEP, NLGEOM"))
    with pytest.raises(InputError, match="direction 7: expected 1 to 3"):
        load(tmp_path, text.replace(", 6, 1.,", ", 7, 1.,") + step("*CLOAD", "RIGHT, 3, 0.1"))
    bricks = BRICKS + "*EQUATION\n2\n15, 4, 1., 16, 4, -1.\n"
    with pytest.raises(InputError, match="EQUATION: direction 4: node 15 has no turn of its own"):
        load(tmp_path, bricks + step("*DLOAD", "2, P2, 10."))
