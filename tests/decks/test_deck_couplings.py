"""*COUPLING and its relatives: what becomes of them, what they carry, what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.job import load_job
from abut.job.convert import write_job
from models.decks import BRICKS, load, solve, step

GLUED = BRICKS.replace("2, 11,12,13,14", "2, 5,6,7,8").replace("2, S1", "2, S2")  # one column, 1 x 1 x 2, E = 1000
REFERENCE = "*NODE, NSET=REF\n99, 0.5, 0.5, 3.\n"
PUSHED = "*SURFACE, NAME=PUSHED\n2, S2\n"
HELD = "*BOUNDARY\nBOTTOM, 1, 3\n"
KINEMATIC = "*COUPLING, CONSTRAINT NAME=Top, REF NODE=99, SURFACE=PUSHED\n*KINEMATIC\n"
DISTRIBUTING = KINEMATIC.replace("KINEMATIC", "DISTRIBUTING")
COLUMN = GLUED + REFERENCE + PUSHED + HELD


def test_a_kinematic_coupling_and_what_it_carries(tmp_path):
    """A column stretched and twisted at its reference node: F L / (E A); loads with courses of their own in two steps."""
    text = COLUMN + KINEMATIC + step("*CLOAD", "REF, 3, 10.", "99, 6, 2.") + step("*CLOAD", "99, 6, 5.")
    model = load(tmp_path, text).model
    (coupling,) = model.couplings
    assert (coupling.name, coupling.kind, coupling.reference, coupling.follow) == (
        "Top",
        "kinematic",
        (0.5, 0.5, 3.0),
        None,
    )
    assert coupling.given == ()
    force, moment = model.loads
    assert (type(force), force.on, force.value) == (abut.Force, "Top", (0.0, 0.0, 10.0))
    assert (type(moment), moment.value, moment.amplitude(0.5)) == (abut.Moment, (0.0, 0.0, 5.0), 0.4)
    first, second = solve(tmp_path, text).steps
    assert first.rigid["Top"].displacement[2] == pytest.approx(10.0 * 2.0 / 1000.0, rel=1e-9)
    assert second.rigid["Top"].rotation[2] / first.rigid["Top"].rotation[2] == pytest.approx(2.5, rel=1e-9)
    again = load_job(write_job(tmp_path / "job.toml", load(tmp_path, text))[0]).model
    assert (again.couplings, again.loads) == (model.couplings, model.loads)


def test_prescribed_motions_have_their_reactions(tmp_path):
    moves = step("*BOUNDARY", "99, 3, 3, 0.02", "99, 6, 6, 0.1", "99, 1, 2", "99, 4, 5")
    for text, kind in ((KINEMATIC, "kinematic"), (DISTRIBUTING, "distributing")):
        solution = solve(tmp_path, COLUMN + text + moves)
        result = solution.steps[-1].rigid["Top"]
        assert solution.model.couplings[0].kind == kind
        assert result.displacement == pytest.approx([0.0, 0.0, 0.02], abs=1e-12)
        assert result.rotation == pytest.approx([0.0, 0.0, 0.1], abs=1e-12)
        assert result.force == pytest.approx([0.0, 0.0, 10.0], rel=1e-9, abs=1e-9)
        assert result.moment[2] > 1.0


@pytest.mark.parametrize(
    "text",
    [
        KINEMATIC.replace("KINEMATIC\n", "KINEMATIC\n1, 3\n"),
        KINEMATIC.replace("KINEMATIC\n", "KINEMATIC\n1, 2\n3, 6\n"),
        KINEMATIC.replace("SURFACE=PUSHED", "SURFACE=PUSHED, ORIENTATION=O"),
        "*KINEMATIC COUPLING, REF NODE=REF\nTOP\n",
        "*KINEMATIC COUPLING, REF NODE=99\n15, 1, 3\n16, 1, 3\n17, 1, 3\n18, 1, 3\n",
        "*SURFACE, NAME=N, TYPE=NODE\nTOP,\n" + KINEMATIC.replace("=PUSHED", "=N"),
        "*SURFACE, NAME=N, TYPE=NODE\n15, \n16,\n" + KINEMATIC.replace("=PUSHED", "=N")
        + "*KINEMATIC COUPLING, REF NODE=99\n17\n18\n",
    ],
)  # fmt: skip
def test_ways_to_write_the_same(text, tmp_path):
    load_it = step("*CLOAD", "99, 1, 3.", "99, 6, 2.")
    one, other = (solve(tmp_path, COLUMN + t + load_it) for t in (KINEMATIC, text))
    assert np.abs(one.displacement - other.displacement).max() < 1e-10 * np.abs(one.displacement).max()


def test_weights_of_a_distributing_coupling(tmp_path):
    """Even ones are those of a surface of one face; others move the middle to which a force must go not to bend."""
    element = "*ELEMENT, TYPE=DCOUP3D, ELSET=D\n9, 99\n*DISTRIBUTING COUPLING, ELSET=D\n"
    push = step("*CLOAD", "99, 1, 3.")
    one, other = (solve(tmp_path, COLUMN + t + push) for t in (DISTRIBUTING, element + "TOP, 1.\n"))
    assert np.abs(one.displacement - other.displacement).max() < 1e-10 * np.abs(one.displacement).max()
    text = COLUMN + element + "15, 1.\n16, 3.\n17, 3.\n18, 1.\n" + push
    (coupling,) = load(tmp_path, text).model.couplings
    assert coupling.weights == (1.0, 3.0, 3.0, 1.0)


@pytest.mark.parametrize("listed", ["3", "1, 2", "1, 3", "1, 6", "4, 6"])
@pytest.mark.parametrize("direction", [1, 3])
def test_forces_of_a_distributing_coupling_go_all_ways(listed, direction, tmp_path):
    """CalculiX 2.20 spreads them alike, whatever directions are listed."""
    push = step("*CLOAD", f"99, {direction}, 3.")
    one, other = (solve(tmp_path, COLUMN + DISTRIBUTING + text + push) for text in ("", f"{listed}\n"))
    assert np.abs(one.displacement).max() > 1e-3
    assert np.array_equal(one.displacement, other.displacement)


def test_directions_that_a_distributing_coupling_lists_are_prescribed(tmp_path):
    """In others the reference node is free; a support there holds nothing."""
    text = COLUMN + DISTRIBUTING + "3\n" + step("*BOUNDARY", "99, 1, 2", "99, 3, 3, 0.02", "*CLOAD", "99, 1, 1.")
    translation = load(tmp_path, text)
    (coupling,) = translation.model.couplings
    assert coupling.given == ("z",)
    assert [note for note in translation.notes if "does not list direction 1: the line holds nothing" in note]
    result = solve(tmp_path, text).steps[-1].rigid["Top"]
    assert result.displacement[2] == pytest.approx(0.02, rel=1e-12)
    assert result.displacement[0] > 1e-3


def test_some_directions(tmp_path):
    text = COLUMN + KINEMATIC.replace("KINEMATIC\n", "KINEMATIC\n3\n")
    solution = solve(tmp_path, text + step("*BOUNDARY", "99, 4, 6", "*CLOAD", "99, 3, 10."))
    (coupling,) = solution.model.couplings
    assert coupling.follow == ("z",)
    assert solution.displacement[solution.model.mesh.nodes_of("TOP"), 2] == pytest.approx(0.02, rel=1e-9)


def test_large_displacements(tmp_path):
    """With NLGEOM the same coupling turns: a quarter turn of the reference node takes the points along."""
    text = COLUMN + KINEMATIC + step("*BOUNDARY", "99, 6, 6, 1.2", "99, 1, 2").replace("*STEP", "*STEP, NLGEOM")
    solution = solve(tmp_path, text)
    step_ = solution.steps[-1]
    assert step_.converged
    assert solution.model.finite
    moved = solution.model.mesh.points + step_.displacement
    arms = moved[solution.model.mesh.nodes_of("TOP")][:, :2] - 0.5
    assert np.linalg.norm(arms, axis=1) == pytest.approx(np.sqrt(0.5), rel=1e-12)
    assert step_.rigid["Top"].rotation[2] == pytest.approx(1.2, rel=1e-9)


PLANE = """*NODE
1, 0,0
2, 1,0
3, 1,1
4, 0,1
9, 0.5, 2.
*ELEMENT, TYPE=CPS4, ELSET=EALL
1, 1,2,3,4
*SURFACE, NAME=PUSHED
1, S3
*MATERIAL, NAME=EL
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=EALL, MATERIAL=EL
2.
*BOUNDARY
1, 1, 2
2, 2
"""


def test_plane_models_are_one_thick(tmp_path):
    coupled = PLANE + "*COUPLING, REF NODE=9, SURFACE=PUSHED\n*KINEMATIC\n"
    force, moment = load(tmp_path, coupled + step("*CLOAD", "9, 2, 10.", "9, 6, 4.")).model.loads
    assert (force.value, moment.value) == ((0.0, 5.0), (2.0,))
    with pytest.raises(InputError, match=r"\*CLOAD: moment 4 on node 9: plane models turn about z only \(6\)"):
        load(tmp_path, coupled + step("*CLOAD", "9, 4, 4."))
    with pytest.raises(InputError, match=r"\*CLOAD: moment 6 on node 9: nothing turns in axisymmetric models"):
        load(tmp_path, coupled.replace("CPS4", "CAX4") + step("*CLOAD", "9, 6, 4."))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (KINEMATIC.replace("*KINEMATIC\n", ""), r"\*COUPLING: the kind is missing; write \*KINEMATIC or \*DISTRIBUTING"),
        ("*KINEMATIC\n1, 3\n", r"\*KINEMATIC: it must follow its \*COUPLING card"),
        (KINEMATIC.replace("=99", "=98"), r"\*COUPLING: REF NODE 98 does not exist"),
        (KINEMATIC.replace("=99", "=NONE"), "REF NODE: expected a node number or a set of one node, got 'NONE'"),
        (KINEMATIC.replace("PUSHED", "PUSHD"), "no surface named 'PUSHD'; did you mean 'PUSHED'"),
        ("*ELSET, ELSET=NIL\n*SURFACE, NAME=E\nNIL, S1\n" + KINEMATIC.replace("PUSHED", "E"), "surface 'E' is empty"),
        (KINEMATIC + "3, 1\n", "directions 3 to 1: expected numbers from 1 to 6, in order"),
        (KINEMATIC + "4, 6\n", r"\*KINEMATIC: no displacement \(1, 2, 3\) is coupled"),
        (KINEMATIC.replace("PUSHED", "PUSHED, INFLUENCE RADIUS=-2."), "INFLUENCE RADIUS: expected a number > 0, got '-2.'"),
        (KINEMATIC.replace("PUSHED", "PUSHED, INFLUENCE RADIUS=.5"), r"couplings\[0\]\.radius: no point of .* nearest at"),
        (KINEMATIC.replace("PUSHED", "PUSHED, ORIENTATION=O") + "1\n", "no orientation named 'O'"),
        (
            "*ORIENTATION, NAME=O\n0, 0, 1, 1, 0, 0\n"
            + DISTRIBUTING.replace("PUSHED", "PUSHED, ORIENTATION=O") + step("*BOUNDARY", "99, 3, 3, 0.1"),
            "takes forces and moments along axes of its own, and no displacements",
        ),
        (DISTRIBUTING + "1, 2\n" + step("*BOUNDARY", "99, 3, 3, 0.1"), "does not list direction 3, and transmits no"),
        (DISTRIBUTING + "1, 3\n" + step("*CLOAD", "99, 4, 2."), "does not list direction 4, and transmits no moment"),
        (DISTRIBUTING.replace("UTING\n", "UTING, WEIGHTING METHOD=LINEAR\n"), "weights over the distance are not read"),
        (DISTRIBUTING.replace("UTING\n", "UTING, COUPLING=STRUCTURAL\n"), "solids have displacements only"),
        (KINEMATIC + DISTRIBUTING, "node 99 is the reference of another coupling .*give this one a node of its own"),
        (KINEMATIC + "*RIGID BODY, ELSET=EALL, REF NODE=99\n", "node 99 is that of a .RIGID BODY too"),
        (DISTRIBUTING.replace("=99", "=1"), "reference node 1 belongs to an element"),
        (KINEMATIC + "*TRANSFORM, NSET=REF\n0, 1, 0, 1, 0, 0\n", "node 99 is the reference of a coupling; give its forces"),
        (KINEMATIC + "*EQUATION\n2\n99, 1, 1., 1, 1, -1.\n", "node 99 is the reference of a rigid body or coupling"),
        ("*SURFACE, NAME=N, TYPE=NODE\nREF,\n" + KINEMATIC.replace("PUSHED", "N"), "none of its nodes belongs"),
        ("*KINEMATIC COUPLING, REF NODE=99\n", "its data line is missing: expected nodes and directions"),
        ("*KINEMATIC COUPLING, REF NODE=99\nTOP, 3, 1\n", "directions 3 to 1"),
        ("*KINEMATIC COUPLING, REF NODE=99, ORIENTATION=O\nTOP, 1\n", "no orientation named 'O'"),
        ("*DISTRIBUTING COUPLING, ELSET=D\nTOP, 1.\n", "ELSET=D: expected one element DCOUP3D or DCOUP2D"),
        ("*ELEMENT, TYPE=DCOUP3D, ELSET=D\n9, 98\n*DISTRIBUTING COUPLING, ELSET=D\nTOP, 1.\n", "node 98 does not exist"),
        ("*ELEMENT, TYPE=DCOUP3D, ELSET=D\n9, 99\n*DISTRIBUTING COUPLING, ELSET=D\nTOP, 0.\n", "weight: expected a num"),
    ],
)  # fmt: skip
def test_what_is_refused(text, message, tmp_path):
    with pytest.raises(InputError, match=message):
        load(tmp_path, COLUMN + text + step("*CLOAD", "15, 3, 1."))


def test_a_radius_and_axes_of_its_own(tmp_path):
    """Nodes within the radius of the reference, one top corner here; the first direction of axes turned by 30 degrees."""
    corner = REFERENCE + "*NODE\n98, 0., 0., 2.5\n" + PUSHED + HELD
    near = KINEMATIC.replace("=99", "=98").replace("=PUSHED", "=PUSHED, INFLUENCE RADIUS=0.6")
    model = load(tmp_path, GLUED + corner + near + step("*CLOAD", "98, 3, 1.")).model
    (coupling,) = model.couplings
    assert model.mesh.points[coupling.nodes(model.mesh)].tolist() == [[0.0, 0.0, 2.0]]
    axes = "*ORIENTATION, NAME=O\n0.866025403784, 0.5, 0, -0.5, 0.866025403784, 0\n"
    text = axes + COLUMN + KINEMATIC.replace("PUSHED", "PUSHED, ORIENTATION=O") + "1\n"
    moves = step("*BOUNDARY", "99, 1, 1, 0.02", "99, 2, 2, 0.01", "99, 3, 6")
    solution = solve(tmp_path, text + moves)
    top = solution.model.mesh.points[:, 2] == 2.0
    along = solution.displacement[top] @ [0.866025403784, 0.5, 0.0]
    assert along == pytest.approx(np.full(4, 0.02 * 0.866025403784 + 0.01 * 0.5), rel=1e-9)
    assert np.abs(solution.displacement[top, 1] - 0.01).min() > 1e-3  # free across


def test_nodes_of_two_couplings(tmp_path):
    text = COLUMN + "*NODE\n97, 0., 0., 5.\n*KINEMATIC COUPLING, REF NODE=97\nTOP\n99\n" + KINEMATIC
    with pytest.raises(InputError, match=r"node 99 is the reference of another coupling .*; couple the nodes of both"):
        load(tmp_path, text + step("*CLOAD", "15, 3, 1."))
    with pytest.raises(InputError, match=r"belongs to coupling '.*' too; take it out of one of them"):
        load(tmp_path, text.replace("TOP\n99", "TOP") + step("*CLOAD", "15, 3, 1."))


def test_a_reference_in_the_mesh_moves_as_one_of_the_points(tmp_path):
    one = solve(tmp_path, COLUMN + "*KINEMATIC COUPLING, REF NODE=15\n16\n17\n18\n" + step("*CLOAD", "15, 3, 4."))
    top = one.model.mesh.node_sets[one.model.couplings[0].on]
    assert len(top) == 4
    assert one.steps[-1].rigid[one.model.couplings[0].name].displacement == pytest.approx(
        one.displacement[top[0]], rel=1e-9
    )


def test_couplings_of_an_assembly(tmp_path):
    """As Abaqus/CAE writes them: reference and surface named in the assembly."""
    body = COLUMN.split("*SURFACE, NAME=MASTER")[0].replace("*NODE, NSET=REF\n99, 0.5, 0.5, 3.\n", "")
    body, material = COLUMN.partition("*MATERIAL")[0], "*MATERIAL" + COLUMN.partition("*MATERIAL")[2]
    section = "*SOLID SECTION, ELSET=EALL, MATERIAL=EL\n"
    material = material.replace(section, "").partition("*NODE")[0]
    text = f"*PART, NAME=P\n{body}{section}*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n"
    text += "*NODE\n1, 0.5, 0.5, 3.\n*NSET, NSET=_REF, INTERNAL\n1,\n*NSET, NSET=LOW, INSTANCE=I\nBOTTOM,\n"
    text += "*ELSET, ELSET=_TOP, INTERNAL, INSTANCE=I\n2,\n*SURFACE, NAME=TOP, INTERNAL\n_TOP, S2\n"
    text += f"*COUPLING, CONSTRAINT NAME=C, REF NODE=_REF, SURFACE=TOP\n*KINEMATIC\n*END ASSEMBLY\n{material}"
    text += "*BOUNDARY\nLOW, 1, 3\n" + step("*CLOAD", "_REF, 3, 10.")
    assert solve(tmp_path, text).steps[-1].rigid["C"].displacement[2] == pytest.approx(0.02, rel=1e-9)


def test_rotations_that_are_not_listed_are_free(tmp_path):
    text = COLUMN + DISTRIBUTING + "1, 3\n" + step("*BOUNDARY", "99, 3, 6, 0.1")
    assert load(tmp_path, text).model.couplings[0].given == ("z",)


def test_a_distributing_coupling_along_axes_of_its_own(tmp_path):
    """First axis z, second x, third y: a force along the first and a moment about it are what they are along z."""
    own = "*ORIENTATION, NAME=O\n0, 0, 1, 1, 0, 0\n" + DISTRIBUTING.replace("PUSHED", "PUSHED, ORIENTATION=O")
    turned = load(tmp_path, COLUMN + own + step("*CLOAD", "99, 1, 10.", "99, 4, 2.", "99, 6, 3.")).model
    force, moment = turned.loads
    assert force.value == pytest.approx((0.0, 0.0, 10.0))
    assert moment.value == pytest.approx((0.0, 3.0, 2.0))


def test_a_kinematic_coupling_around_an_axis(tmp_path):
    """Along cylindrical axes the second direction of a reference that turns moves each node around the axis by turn times
    radius, and leaves it free along the radius."""
    around = "*ORIENTATION, NAME=O, SYSTEM=CYLINDRICAL\n.5, .5, 0, .5, .5, 1\n"
    text = around + KINEMATIC.replace("PUSHED", "PUSHED, ORIENTATION=O") + "2\n"
    solution = solve(tmp_path, COLUMN + text + step("*BOUNDARY", "99, 1, 5", "99, 6, 6, 0.01"))
    top = solution.model.mesh.points[:, 2] == 2.0
    arm = solution.model.mesh.points[top, :2] - 0.5
    tangent = np.column_stack([-arm[:, 1], arm[:, 0]])
    assert np.sum(solution.displacement[top, :2] * tangent, axis=1) == pytest.approx(0.01 * np.sum(arm**2, axis=1))


def test_the_reference_in_a_set_of_point_elements(tmp_path):
    """The element DCOUP3D stands in a set that *ELSET makes."""
    point = "*ELEMENT, TYPE=DCOUP3D\n77, 99\n*ELSET, ELSET=POINT\n77\n"
    model = load(
        tmp_path, COLUMN + point + "*DISTRIBUTING COUPLING, ELSET=POINT\nTOP, 1.\n" + step("*CLOAD", "99, 3, 1.")
    ).model
    assert model.couplings[0].reference == (0.5, 0.5, 3.0)
