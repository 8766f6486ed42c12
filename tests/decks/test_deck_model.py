"""Decks solved, against theory: every kind of load and condition that a deck can state."""

import numpy as np
import pytest

import abut
from abut.errors import InputError
from models.decks import BRICKS, HELD, PAIR, PUSH, load, solve, step

E = 1000.0
CONTACT = BRICKS + PAIR + HELD


def tops(solution, number=-1):
    """Mean displacement of the highest points along the last axis, after a step."""
    points = solution.model.mesh.points
    high = points[:, -1] == points[:, -1].max()
    return solution.steps[number].displacement[high, -1].mean()


def test_pressure_through_contact(tmp_path):
    """Two bricks on each other under a pressure of 10: the same pressure between them, strain 10 / E in both."""
    solution = solve(tmp_path, CONTACT + PUSH)
    (contact,) = solution.contacts
    assert contact.force == pytest.approx([0.0, 0.0, 10.0], abs=1e-10)
    assert contact.max_pressure == pytest.approx(10.0, rel=1e-10)
    assert tops(solution) == pytest.approx(-2 * 10.0 / E, rel=1e-10)
    assert set(solution.model.mesh.bodies) == {"EALL-1", "EALL-2"}


def test_one_surface_in_two_pairs(tmp_path):
    """A brick between two others, both its faces one slave surface: each pair finds its own face, and carries the 10."""
    nodes = "".join(
        f"{n + 10}, {x},{y},2\n{n + 20}, {x},{y},3\n" for n, x, y in ((11, 0, 0), (12, 1, 0), (13, 1, 1), (14, 0, 1))
    )
    cap = f"*NODE, NSET=ALL\n{nodes}*ELEMENT, TYPE=C3D8, ELSET=CAP\n3, 21,22,23,24,31,32,33,34\n"
    text = BRICKS.replace("*ELSET, ELSET=EALL\nLOW, HIGH", cap + "*ELSET, ELSET=EALL\nLOW, HIGH, CAP")
    text = text.replace("NAME=SLAVE\n2, S1", "NAME=SLAVE\n2, S1\n2, S2\n*SURFACE, NAME=LID\n3, S1")
    text += PAIR.replace(
        "SLAVE, MASTER", "SLAVE, MASTER\n*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nSLAVE, LID"
    )
    solution = solve(tmp_path, text + HELD + PUSH.replace("2, P2", "3, P2"))
    assert [c.force[2] for c in solution.contacts] == pytest.approx([10.0, -10.0], abs=1e-9)
    assert tops(solution) == pytest.approx(-3 * 10.0 / E, rel=1e-10)


def test_loads_add_up_within_a_step_and_replace_those_of_earlier_ones(tmp_path):
    """As CalculiX does (checked with it): equal lines of one step add up, OP=MOD replaces, OP=NEW ends the others."""
    text = (
        CONTACT
        + step("*CLOAD", "TOP, 3, -1.", "TOP, 3, -1.")
        + step("*CLOAD", "TOP, 3, -3.")
        + step("*DLOAD", "2, P2, 1.", "2, P2, 1.", "*CLOAD, OP=NEW", "15, 1, 0.")
        + step("*DLOAD, OP=NEW", "*CLOAD", "TOP, 3, -1.")
    )
    solution = solve(tmp_path, text)
    forces = [s.contacts[0].force[2] for s in solution.steps]
    assert forces == pytest.approx([8.0, 12.0, 2.0, 4.0], rel=1e-10)
    assert [s.factor for s in solution.steps] == pytest.approx([0.25, 0.5, 0.75, 1.0])


def test_amplitudes_and_periods(tmp_path):
    """Steps of length 1 and 3 on one axis; the amplitude turns at time 2 of the second, where abut stops too."""
    text = (
        CONTACT + "*AMPLITUDE, NAME=A\n0., 0.5, 2., 2., 3., 0.\n*AMPLITUDE, NAME=T, TIME=TOTAL TIME\n0., 0., 4., 4.\n"
    )
    text += step("*DLOAD", "2, P2, 4.") + step("0.1, 3.", "*DLOAD, AMPLITUDE=A", "2, P2, 10.")
    solution = solve(tmp_path, text)
    assert [s.factor for s in solution.steps] == pytest.approx([0.25, 0.75, 1.0])
    assert [s.contacts[0].force[2] for s in solution.steps] == pytest.approx([4.0, 20.0, 0.0], abs=1e-8)
    total = text.replace("AMPLITUDE=A", "AMPLITUDE=T")
    assert [s.contacts[0].force[2] for s in solve(tmp_path, total).steps] == pytest.approx([4.0, 40.0], rel=1e-8)


def test_displacements_over_the_steps(tmp_path):
    text = CONTACT + step("*BOUNDARY", "TOP, 3, 3, -0.02") + step("*BOUNDARY", "TOP, 3, 3, -0.005")
    forces = [s.contacts[0].force[2] for s in solve(tmp_path, text).steps]
    assert forces == pytest.approx([E * 0.01, E * 0.0025], rel=1e-10)


def test_gravity(tmp_path):
    """The upper brick weighs density 2 times volume 1 times 9.81."""
    solution = solve(tmp_path, CONTACT + step("*DLOAD", "EALL, GRAV, 9.81, 0., 0., -2."))
    assert solution.contacts[0].force[2] == pytest.approx(19.62, rel=1e-10)
    with pytest.raises(InputError, match="needs a \\*DENSITY"):
        load(tmp_path, CONTACT.replace("*DENSITY\n2.\n", "") + step("*DLOAD", "EALL, GRAV, 9.81, 0., 0., -1."))


def test_temperature(tmp_path):
    """Both bricks between walls: 1e-3 of expansion times 30 degrees above the first temperature."""
    text = CONTACT + "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20.\n"
    text += step("*BOUNDARY", "TOP, 3", "*TEMPERATURE", "ALL, 50.") + step("*TEMPERATURE, OP=NEW", "TOP, 20.")
    pressures = [s.contacts[0].max_pressure for s in solve(tmp_path, text).steps]
    assert pressures == pytest.approx([E * 1e-3 * 30.0, 0.0], abs=1e-9)


def test_clearance_and_adjustment(tmp_path):
    """ADJUST removes an overlap of 0.004, however small its zone, as in CalculiX 2.20; CLEARANCE takes every gap's place."""
    text = CONTACT.replace("0,1", "0,0.996").replace("18, 0,1,2", "18, 0,1,2")
    lines = []
    for line in CONTACT.splitlines():
        fields = line.split(",")
        if fields[0] in ("11", "12", "13", "14") and len(fields) == 4:
            fields[3] = "0.996"
        lines.append(",".join(fields))
    text = "\n".join(lines) + "\n"
    rest = step("*BOUNDARY", "TOP, 3, 3, 0.")
    force = {}
    for adjust in ("", ", ADJUST=0.01", ", ADJUST=0.001"):
        force[adjust] = (
            solve(tmp_path, text.replace("INTERACTION=I,", f"INTERACTION=I{adjust},") + rest).contacts[0].force[2]
        )
    stiff = 1.0 / (1.0 / E + 1.004 / E)
    assert force[""] == pytest.approx(0.004 * stiff, rel=1e-6)
    assert force[", ADJUST=0.001"] == pytest.approx(0.0, abs=1e-9)
    assert force[", ADJUST=0.01"] == pytest.approx(0.0, abs=1e-9)
    down = step("*BOUNDARY", "TOP, 3, 3, -0.01")
    given = text.replace("*CONTACT PAIR", "*CLEARANCE, SLAVE=SLAVE, MASTER=MASTER, VALUE=0.002\n*CONTACT PAIR")
    assert solve(tmp_path, given + down).contacts[0].force[2] == pytest.approx((0.01 - 0.002) * stiff, rel=1e-6)
    assert load(tmp_path, given + down).model.contacts[0].offset == 0.002
    nodes = text.replace("*CONTACT PAIR", "*NSET, NSET=CLOSE\n11,12,13,14\n*CONTACT PAIR").replace(
        "INTERACTION=I,", "INTERACTION=I, ADJUST=CLOSE,"
    )
    assert solve(tmp_path, nodes + rest).contacts[0].force[2] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    "card", ["*TIE, NAME=T\nSLAVE, MASTER\n", PAIR.replace("HARD", "TIED")], ids=["tie", "contact"]
)
def test_tied(card, tmp_path):
    solution = solve(tmp_path, BRICKS + card + HELD + step("*DLOAD", "2, P2, -10."))
    assert tops(solution) == pytest.approx(2 * 10.0 / E, rel=1e-10)


PLANE = """*NODE, NSET=ALL
1, 1,0
2, 2,0
3, 2,1
4, 1,1
*ELEMENT, TYPE=CAX4, ELSET=E
1, 1,2,3,4
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=E, MATERIAL=M
*BOUNDARY
1, 2
2, 2
*STEP
*STATIC
*BOUNDARY
3, 1
*CLOAD
3, 2, 4.71238898
4, 2, 4.71238898
*END STEP
"""


def test_forces_are_those_of_the_whole_turn(tmp_path):
    """A force 3 pi on a ring of area 3 pi stretches it by about 1 / E (checked with CalculiX: 1.0002e-3 with these
    forces at two nodes; exact only were they as 4 : 5)."""
    text = PLANE.replace("3, 2, 4.71238898", f"3, 2, {np.pi * 5 / 3:.10f}").replace(
        "4, 2, 4.71238898", f"4, 2, {np.pi * 4 / 3:.10f}"
    )
    solution = solve(tmp_path, text)
    assert solution.displacement[:, 1].max() == pytest.approx(1e-3, rel=1e-9)


def test_forces_are_shared_by_the_thickness(tmp_path):
    """Force 10 on a plate of width 1 and thickness 2."""
    text = PLANE.replace("CAX4", "CPS4").replace("MATERIAL=M\n", "MATERIAL=M\n2.\n").replace("4.71238898", "5.")
    solution = solve(tmp_path, text.replace("*BOUNDARY\n3, 1\n", "*BOUNDARY\n2, 1\n"))
    assert solution.displacement[:, 1].max() == pytest.approx(5e-3, rel=1e-10)
    assert any("times 2 gives the deck's" in note for note in load(tmp_path, text).notes)


def test_axes_of_a_support(tmp_path):
    """The bricks slide along a wall at 45 degrees: direction 1 of the rotated axes is held, y' is free."""
    turned = "*TRANSFORM, NSET=TOP, TYPE=R\n1., 0., 1., 0., 1., 0.\n"
    text = BRICKS + "*TIE, NAME=T\nSLAVE, MASTER\n" + turned + "*BOUNDARY\nBOTTOM, 1, 3\nALL, 2\n"
    solution = solve(tmp_path, text.replace("ALL, 2", "1, 2") + step("*BOUNDARY", "TOP, 1", "*CLOAD", "TOP, 3, 1."))
    points = solution.model.mesh.points
    high = points[:, 2] == 2.0
    u = solution.displacement[high]
    assert np.abs(u[:, 0] + u[:, 2]).max() < 1e-12
    assert np.abs(u).max() > 1e-3


@pytest.mark.parametrize(("along", "held"), [("1,0,0", 1), ("0,1,0", 2), ("0,0,1", 0)])
def test_nodes_on_the_axis_of_cylindrical_axes(along, held, tmp_path):
    """Any direction across may be the radial one there; CalculiX (transformatrix.f) takes y, z and x for an axis along x, y
    and z. The corner at the origin is held in that one alone."""
    text = BRICKS + f"*TRANSFORM, NSET=BOTTOM, TYPE=C\n0,0,0, {along}\n*BOUNDARY\n1, 1\n*TIE, NAME=T\nSLAVE, MASTER\n"
    model = load(tmp_path, text + step("*CLOAD", "TOP, 3, 1.")).model
    corner = int(np.flatnonzero((model.mesh.points == 0.0).all(axis=1))[0])
    on_it = [support for support in model.supports if corner in model.mesh.nodes_of(support.on)]
    assert [[getattr(s, name) is not None for name in "xyz"] for s in on_it] == [[k == held for k in range(3)]]
    with pytest.raises(InputError, match="the two points are the same"):
        load(tmp_path, text.replace(f"0,0,0, {along}", "0,0,1, 0,0,1.") + step("*CLOAD", "TOP, 3, 1."))


EQUAL = "*EQUATION\n2\n16, 3, 1., 15, 3, -1.\n2\n17, 3, 1., 15, 3, -1.\n2\n18, 3, 1., 15, 3, -1.\n"


def test_equations(tmp_path):
    """One force on a plate held plane by equations acts as if spread."""
    solution = solve(tmp_path, CONTACT + EQUAL + step("*CLOAD", "17, 3, -10."))
    assert solution.contacts[0].force == pytest.approx([0.0, 0.0, 10.0], abs=1e-9)
    assert tops(solution) == pytest.approx(-2 * 10.0 / E, rel=1e-9)


def test_a_node_of_no_element_leads_a_plate(tmp_path):
    """Its displacement, or its force, reaches the plate through the equations."""
    text = CONTACT.replace("*ELEMENT", "*NODE\n99, 9., 9., 9.\n*ELEMENT", 1)
    text += "*EQUATION\n" + "".join(f"2\n{n}, 3, 1., 99, 1, -2.\n" for n in (15, 16, 17, 18))
    moved = solve(tmp_path, text + step("*BOUNDARY", "99, 1, 1, -0.01"))
    assert moved.contacts[0].force[2] == pytest.approx(E * 0.01, rel=1e-9)
    pushed = solve(tmp_path, text + step("*CLOAD", "99, 1, -10."))  # the plate moves twice as far: half the force
    assert pushed.contacts[0].force[2] == pytest.approx(5.0, rel=1e-9)
    assert tops(pushed) == pytest.approx(-2 * 5.0 / E, rel=1e-9)


def test_multipoint_ties(tmp_path):
    text = BRICKS + "*MPC\nTIE, 11, 5\nTIE, 12, 6\nPIN, 13, 7\nPIN, 14, 8\n" + HELD
    assert tops(solve(tmp_path, text + step("*DLOAD", "2, P2, -10."))) == pytest.approx(2 * 10.0 / E, rel=1e-9)


def test_rigid_body(tmp_path):
    """The upper brick pushed down as a whole: all of the strain is in the lower one."""
    text = CONTACT.replace("*ELEMENT", "*NODE\n99, 0.5, 0.5, 3.\n98, 0., 0., 0.\n*ELEMENT", 1).replace(
        "ALL, 1, 2", "BOTTOM, 1, 2\n5, 1, 2\n6, 2\n99, 1, 3\n98, 1, 3"
    )
    text += "*RIGID BODY, ELSET=HIGH, REF NODE=99, ROT NODE=98\n"
    solution = solve(tmp_path, text + step("*BOUNDARY", "99, 3, 3, -0.01"))
    assert solution.contacts[0].force[2] == pytest.approx(E * 0.01, rel=1e-9)  # on the slave, which is rigid
    assert any("contactor" in note and "the other side is rigid, or held" in note for note in solution.notes)
    assert tops(solution) == pytest.approx(-0.01, rel=1e-12)
    turned = text + step("*BOUNDARY", "99, 3, 3, -0.01") + step("*BOUNDARY", "98, 3, 3, 0.2")
    body = load(tmp_path, turned).model.rigid[0]
    assert (body.z, body.rz) == pytest.approx((-0.01, 0.2))
    assert [body.history("z")(t) for t in (0.5, 1.0)] == [1.0, 1.0]  # comes down in the first step
    assert [body.history("rz")(t) for t in (0.5, 1.0)] == [0.0, 1.0]  # and turns in the second
    free = text.replace("99, 1, 3", "99, 1, 2").replace("98, 1, 3", "98, 3")
    pushed = solve(tmp_path, free + step("*CLOAD", "99, 3, -5.", "98, 1, 0.2", "99, 5, -0.3"))
    assert pushed.contacts[0].force[2] == pytest.approx(5.0, rel=1e-9)
    loads = load(tmp_path, free + step("*CLOAD", "99, 3, -5.", "98, 1, 0.2")).model.loads
    assert [(type(one).__name__, one.value) for one in loads] == [
        ("Force", (0.0, 0.0, -5.0)),
        ("Moment", (0.2, 0.0, 0.0)),
    ]
    place = pushed.contacts[0].resultant.moment / -5.0  # the middle of the pressure balances the moments
    assert place[:2] == pytest.approx([-0.5 + 0.04, 0.5 - 0.06], rel=1e-6)
    assert load(tmp_path, text.replace("BODY, ELSET=HIGH", "BODY, NSET=TOP") + step()).model.rigid == ()  # a coupling


def test_pretension(tmp_path):
    """A bar of two bricks, glued, clamped at both ends and cut in the middle: tension 10 draws each half out by 10 L / E."""
    text = BRICKS.replace("2, 11,12,13,14", "2, 5,6,7,8").replace("2, S1", "2, S2")
    text = text.replace("*ELEMENT", "*NODE\n99, 9., 9., 9.\n*ELEMENT", 1)
    text += "*PRE-TENSION SECTION, SURFACE=MASTER, NODE=99\n*BOUNDARY\nBOTTOM, 1, 3\nTOP, 1, 3\n"
    solution = solve(tmp_path, text + step("*CLOAD", "99, 1, 10."))
    points, u = solution.model.mesh.points, solution.displacement
    cut = points[:, 2] == 1.0
    assert cut.sum() == 8
    assert sorted(u[cut, 2]) == pytest.approx([-0.01] * 4 + [0.01] * 4, rel=1e-9)
    for normal, sign in (("0., 0., 1.\n", 1.0), ("0., 0., -2.\n", -1.0)):  # as CalculiX's example pret1 has it
        given = text.replace("NODE=99\n", f"NODE=99\n{normal}") + step("*CLOAD", "99, 1, 10.")
        assert np.allclose(solve(tmp_path, given).displacement, sign * u, atol=1e-12)
        assert any("the normal points into the elements of 'MASTER'" in n for n in load(tmp_path, given).notes) == (
            sign < 0
        )
    closed = solve(tmp_path, text + step("*BOUNDARY", "99, 1, 1, 0.02"))
    assert np.allclose(np.abs(closed.displacement[cut, 2]), 0.01, rtol=1e-9)
    with pytest.raises(InputError, match="no neighbour beyond the cut"):
        load(tmp_path, text.replace("SURFACE=MASTER", "SURFACE=SLAVE") + step())


def sector(sectors, start, n=4):
    """A sector of a ring with radii 1 and 2 and height 0.5 from an angle on; its sides are SIDE and NEXT."""
    angles, radii = np.linspace(start, start + 2 * np.pi / sectors, n + 1), np.linspace(1.0, 2.0, 9)
    number = np.arange(1, 2 * len(angles) * len(radii) + 1).reshape(2, len(angles), len(radii))
    lines = ["*NODE, NSET=ALL"]
    for k, j, i in np.ndindex(number.shape):
        x, y = radii[i] * np.cos(angles[j]), radii[i] * np.sin(angles[j])
        lines.append(f"{number[k, j, i]}, {float(x)!r}, {float(y)!r}, {0.5 * k}")
    lines.append("*ELEMENT, TYPE=C3D8, ELSET=E")
    cells = list(np.ndindex(n, len(radii) - 1))
    for e, (j, i) in enumerate(cells, start=1):
        own = [number[k, j + b, i + a] for k in range(2) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
        lines.append(f"{e}, {', '.join(map(str, own))}")
    for name, j in (("SIDE", 0), ("NEXT", n)):
        lines += [f"*NSET, NSET=N{name}", *(f"{m}," for m in number[:, j].ravel())]
        lines += [f"*SURFACE, NAME={name}, TYPE=NODE", f"N{name},"]
    lines += ["*ELSET, ELSET=INNER", *(f"{e}," for e, (_, i) in enumerate(cells, start=1) if i == 0)]
    return "\n".join(lines) + "\n"


RUBBER = """*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*EXPANSION
1e-3
*SOLID SECTION, ELSET=E, MATERIAL=M
"""


@pytest.mark.parametrize("start", [0.0, 0.3], ids=["along the axes", "across"])
def test_cylindrical_axes(start, tmp_path):
    """A quarter of a ring whose ends may only move radially, between planes, swells under heat by (1 + nu) alpha T r."""
    text = sector(4, start) + RUBBER + "*TRANSFORM, NSET=ALL, TYPE=C\n0,0,0, 0,0,1.\n"
    text += "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 0.\n*BOUNDARY\nNSIDE, 2\nNNEXT, 2\nALL, 3\n"
    solution = solve(tmp_path, text + step("*TEMPERATURE", "ALL, 10."))
    assert bool(solution.model.equations) == (start != 0.0)
    expected = 1.3 * 1e-3 * 10.0 * solution.model.mesh.points * [1.0, 1.0, 0.0]
    assert np.allclose(solution.displacement, expected, rtol=0.0, atol=1e-10)


@pytest.mark.parametrize(
    "transform", ["TYPE=C\n0,0,0, 0,0,1.", "TYPE=R\n1,2,.5, -2,1,0."], ids=["cylindrical", "rectangular"]
)
def test_forces_along_axes_of_their_own(transform, tmp_path):
    """The same displacements as under these forces written along x, y and z, node by node."""
    text = sector(6, 0.3) + RUBBER + "*BOUNDARY\nNSIDE, 1, 3\n"
    local = np.array([0.5, 1.0, -0.2])
    nodes = load(tmp_path, text + step("*CLOAD", "NNEXT, 1, 1.")).model.mesh.points
    members = [int(line.rstrip(",")) for line in text.partition("*NSET, NSET=NNEXT\n")[2].partition("*")[0].split()]
    lines = []
    for number in members:
        x = nodes[number - 1]
        first = np.array([x[0], x[1], 0.0]) if transform.startswith("TYPE=C") else np.array([1.0, 2.0, 0.5])
        third = np.array([0.0, 0.0, 1.0]) if transform.startswith("TYPE=C") else np.cross(first, [-2.0, 1.0, 0.0])
        axes = [first / np.linalg.norm(first), np.zeros(3), third / np.linalg.norm(third)]
        axes[1] = np.cross(axes[2], axes[0])
        lines += [f"{number}, {k}, {value!r}" for k, value in enumerate((local @ np.array(axes)).tolist(), start=1)]
    written = solve(tmp_path, text + step("*CLOAD", *lines)).displacement
    turned = text + f"*TRANSFORM, NSET=NNEXT, {transform}\n"
    own = solve(tmp_path, turned + step("*CLOAD", *(f"NNEXT, {k}, {v}" for k, v in enumerate(local.tolist(), start=1))))
    assert own.displacement == pytest.approx(written, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("sides", ["NEXT, SIDE", "SIDE, NEXT"])
def test_cyclic_symmetry(sides, tmp_path):
    """A sixth of a ring under pressure inside, plane strain: Lame's displacement, within the error of 8 linear cells."""
    text = sector(6, 0.3) + RUBBER
    text += f"*TIE, NAME=T, CYCLIC SYMMETRY\n{sides}\n*CYCLIC SYMMETRY MODEL, N=6, TIE=T\n0,0,0, 0,0,1.\n"
    text += "*TRANSFORM, NSET=ALL, TYPE=C\n0,0,0, 0,0,1.\n*BOUNDARY\nALL, 3\n1, 2\n"
    solution = solve(tmp_path, text + step("*DLOAD", "INNER, P6, 1."))
    points = solution.model.mesh.points
    radius = np.hypot(points[:, 0], points[:, 1])
    radial = (solution.displacement[:, :2] * points[:, :2]).sum(axis=1) / radius
    tangential = (solution.displacement[:, 0] * -points[:, 1] + solution.displacement[:, 1] * points[:, 0]) / radius
    a, b, nu = 1.0, 2.0, 0.3
    lame = (1 + nu) / E * a**2 / (b**2 - a**2) * ((1 - 2 * nu) * radius + b**2 / radius)
    assert np.abs(radial / lame - 1).max() < 0.02
    assert np.abs(tangential).max() < 0.002 * lame.max()
    by_radius = [np.ptp(radial[np.abs(radius - r) < 1e-9]) for r in np.unique(radius.round(9))]
    assert max(by_radius) < 0.01 * lame.max()
    with pytest.raises(InputError, match="has no partner"):
        load(tmp_path, text.replace("N=6", "N=5") + step())


def test_modes_of_cyclic_symmetry_are_those_alike_in_all_sectors_unless_others_are_asked_for(tmp_path):
    text = sector(6, 0.3) + RUBBER.replace("*SOLID", "*DENSITY\n1e-9\n*SOLID")
    text += "*TIE, NAME=T, CYCLIC SYMMETRY\nNEXT, SIDE\n*CYCLIC SYMMETRY MODEL, N=6, TIE=T\n0,0,0, 0,0,1.\n"
    text += "*TRANSFORM, NSET=ALL, TYPE=C\n0,0,0, 0,0,1.\n*BOUNDARY\nALL, 3\n1, 2\n*STEP\n*FREQUENCY\n2\n"
    alone = load(tmp_path, text + "*END STEP\n")
    assert alone.model.modes[0].diameters == (0,)
    assert any("nodal diameter 0" in note for note in alone.notes)
    job = load(tmp_path, text + "*SELECT CYCLIC SYMMETRY MODES, NMIN=1, NMAX=2\n*END STEP\n")
    assert job.model.modes[0].diameters == (1, 2)
    assert not any("without effect" in note or "nodal diameter" in note for note in job.notes)


def test_nodes_as_a_surface(tmp_path):
    """The faces that the nodes make up; a node that equations bind to others stands for their face."""
    text = CONTACT.replace(
        "*SURFACE, NAME=SLAVE\n2, S1", "*NSET, NSET=S\n11,12,13,14\n*SURFACE, NAME=SLAVE, TYPE=NODE\nS"
    )
    job = load(tmp_path, text + PUSH)
    assert any("the faces that the nodes of *SURFACE 'SLAVE' make up" in note for note in job.notes)
    assert abut.solve(job.model).contacts[0].force[2] == pytest.approx(10.0, rel=1e-10)
    alone = text.replace("11,12,13,14\n*SURFACE", "13,\n*SURFACE")
    with pytest.raises(InputError, match=r"\*SURFACE: node 13 of surface 'SLAVE' make up no face"):
        load(tmp_path, alone + PUSH)
    bound = "*EQUATION\n2\n11, 3, 1., 13, 3, -1.\n2\n12, 3, 1., 13, 3, -1.\n2\n14, 3, 1., 13, 3, -1.\n"
    assert len(load(tmp_path, alone + bound + PUSH).model.mesh.surfaces["SLAVE"]) == 1


GENERAL = """*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE={}
*CONTACT
*CONTACT INCLUSIONS, ALL EXTERIOR
*CONTACT PROPERTY ASSIGNMENT
 , , I
"""


@pytest.mark.parametrize("kind", ["HARD", "TIED"])
def test_general_contact_finds_what_a_pair_names(tmp_path, kind):
    text = BRICKS + "{}" + HELD + PUSH
    named = solve(tmp_path, text.format(PAIR.replace("HARD", kind)))
    job = load(tmp_path, text.format(GENERAL.format(kind)))
    found = abut.solve(job.model)
    assert any("general contact: found" in note for note in job.notes)
    assert found.displacement == pytest.approx(named.displacement, abs=1e-12)
    assert abs(found.contacts[0].force) == pytest.approx(abs(named.contacts[0].force), rel=1e-9, abs=1e-9)


def test_general_contact_that_is_not_supported(tmp_path):
    text = BRICKS + GENERAL.format("HARD") + HELD + PUSH
    for change, said in (
        (", ALL EXTERIOR", "only ALL EXTERIOR"),
        (" , , I", "no .SURFACE INTERACTION named 'J'"),
        ("*CONTACT INCLUSIONS, ALL EXTERIOR\n", "no .CONTACT INCLUSIONS"),
        (" , , I", "interaction for single surfaces"),
    ):
        other = {"only": "", "no .SURFACE": " , , J", "no .CONTACT": "", "interaction": "SLAVE, MASTER, I"}
        new = next(value for start, value in other.items() if said.startswith(start))
        with pytest.raises(abut.InputError, match=said):
            load(tmp_path, text.replace(change, new))
