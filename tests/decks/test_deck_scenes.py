"""Twenty decks as FreeCAD, PrePoMax and Abaqus/CAE write them: two cubes of other meshes, one on the other, E = 1000, no
Poisson's ratio, density 2, expansion 1e-3, joined, loaded and held in every way that these programs have. Each against a
closed form, as a deck and by way of the job file that it becomes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from decks.test_deck_exports import _by_side, _surface, brick, elements, faces, nodes, rows

import abut
from abut.cli import main
from abut.job import load_job
from models.decks import load

E, RHO, ALPHA = 1000.0, 2.0, 1e-3
LOW, HIGH = brick("hex8", (0.0, 1.0), 1), brick("hex8", (1.0, 2.0), 2)
N, M = len(LOW.points), LOW.n_cells
TOP = rows((HIGH.nodes_of("top") + N + 1).tolist())
REF = N + len(HIGH.points) + 1  # a reference node in the middle of the top, and one for turns beside it

FREECAD = f"""** written by FreeCAD inp file writer for CalculiX,Abaqus meshes
*Node, NSET=Nall
{nodes(LOW, 1)}{nodes(HIGH, N + 1)}*Node, NSET=Refs
{REF}, 0.5, 0.5, 2.
{REF + 1}, 0.5, 0.5, 2.
*Element, TYPE=C3D8, ELSET=Evolumes
{elements(LOW, 1, 1)}{elements(HIGH, N + 1, M + 1)}*ELSET,ELSET=Eall
Evolumes
*NSET,NSET=ConstraintFixed
{rows((LOW.nodes_of("bottom") + 1).tolist(), 1)}*NSET,NSET=ConstraintTop
{TOP}*NSET, NSET=Sides, GENERATE
1, {REF - 1}, 1
*SURFACE, NAME=DEP
{faces(HIGH, "bottom", M + 1)}*SURFACE, NAME=IND
{faces(LOW, "top", 1)}*MATERIAL, NAME=Material
*ELASTIC
1000, 0.0
*DENSITY
2
*EXPANSION
1e-3
*SOLID SECTION, ELSET=Evolumes, MATERIAL=Material
"""
PREPOMAX = f"""** Heading +++++++++++++++++++++++++++++++++++++++++++++++++
*Heading
Hash: x, Date: 1/1/2024, Unit system: MM_TON_S_C
*Node
{nodes(LOW, 1)}{nodes(HIGH, N + 1)}{REF}, 0.5, 0.5, 2.
*Element, Type=C3D8, Elset=Solid_part-1
{elements(LOW, 1, 1)}*Element, Type=C3D8, Elset=Solid_part-2
{elements(HIGH, N + 1, M + 1)}*Nset, Nset=Internal_Fixed
{rows((LOW.nodes_of("bottom") + 1).tolist())}*Nset, Nset=Internal_Top
{TOP}*Nset, Nset=All_sides, Generate
1, {REF - 1}
*Nset, Nset=Ref
{REF}
*Elset, Elset=Internal_Section
Solid_part-1,
Solid_part-2
*Surface, Name=Internal_Slave, Type=Element
{faces(HIGH, "bottom", M + 1)}*Surface, Name=Internal_Master, Type=Element
{faces(LOW, "top", 1)}*Surface, Name=Pressed, Type=Element
{faces(HIGH, "top", M + 1)}*Physical constants, Absolute zero=-273.15, Stefan Boltzmann=5.670374E-11
*Material, Name=Steel
*Density
2
*Elastic
1000, 0
*Expansion, Zero=20
1.0E-03
*Solid section, Elset=Internal_Section, Material=Steel
"""
CAE_PART = "*Part, name={name}\n*Node\n{nodes}*Element, type=C3D8\n{elements}*Nset, nset=All, generate\n1, {n}, 1\n"
CAE_PART += "*Elset, elset=Set-1, generate\n1, {m}, 1\n*Solid Section, elset=Set-1, material=Material-1\n,\n*End Part\n"


def cae(more: str = "", instance: str = "0., 0., 0.\n") -> str:
    """The assembly with more in it; ``instance``: how the upper part is moved and turned to where it stands."""
    parts = [
        CAE_PART.format(
            name=name, nodes=nodes(mesh, 1), elements=elements(mesh, 1, 1), n=len(mesh.points), m=mesh.n_cells
        )
        for name, mesh in (("Low", LOW), ("High", HIGH))
    ]
    top = "".join(f"*Elset, elset=_Top_{s}, internal, instance=High-1\n{cells}" for s, cells in _by_side(HIGH, "top"))
    return f"""*Heading
** Job name: Job-1 Model name: Model-1
*Preprint, echo=NO, model=NO, history=NO, contact=NO
{"".join(parts)}*Assembly, name=Assembly
*Instance, name=Low-1, part=Low
*End Instance
*Instance, name=High-1, part=High
{instance}*End Instance
*Node
1, 0.5, 0.5, 2.
*Nset, nset=Ref
1,
*Nset, nset=Fixed, instance=Low-1
{rows((LOW.nodes_of("bottom") + 1).tolist())}*Nset, nset=Lid, instance=High-1
{rows((HIGH.nodes_of("top") + 1).tolist())}{top}*Surface, type=ELEMENT, name=Top
{"".join(f"_Top_{s}, {s}{chr(10)}" for s, _ in _by_side(HIGH, "top"))}{_surface("Slave", HIGH, "bottom", "High-1")}{
        _surface("Master", LOW, "top", "Low-1")
    }{more}*End Assembly
*Material, name=Material-1
*Density
2.,
*Elastic
1000., 0.
*Expansion
0.001,
"""


def step(*lines: str, head: str = "*STEP, INC=2000\n*STATIC\n1.0, 1.0, 1e-05, 1.0") -> str:
    return "\n".join([head, *lines, "*NODE FILE", "U", "*EL FILE", "S, E", "*END STEP", ""])


def contact(slave: str, master: str, mu: str = "") -> str:
    text = "*SURFACE INTERACTION, NAME=INT\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1000000.0\n"
    return f"{text}{mu}*CONTACT PAIR, INTERACTION=INT, TYPE=SURFACE TO SURFACE\n{slave}, {master}\n"


Check = Callable[[abut.Solution], None]


def lid(value: float) -> Check:
    """Where the top is."""

    def check(solution: abut.Solution) -> None:
        at = solution.model.mesh.points[:, 2] > 2.0 - 1e-9
        assert solution.displacement[at, 2] == pytest.approx(value, rel=1e-7, abs=1e-11)

    return check


def pressed(force: float, sideways: float = 0.0) -> Check:
    """What contact carries, up and along x."""

    def check(solution: abut.Solution) -> None:
        found = np.abs(solution.contacts[0].force)
        assert found[[2, 0]] == pytest.approx([force, sideways], rel=1e-7, abs=1e-7)

    return check


@dataclass(frozen=True)
class Scene:
    text: str
    checks: tuple[Check, ...]


FC_HELD = [
    "*BOUNDARY",
    "ConstraintFixed,1",
    "ConstraintFixed,2",
    "ConstraintFixed,3",
    "*BOUNDARY",
    "Sides,1",
    "Sides,2",
]
FC_TIE = "*TIE, NAME=ConstraintTie, ADJUST=NO, POSITION TOLERANCE=0.01\nDEP, IND\n"
FC_CONTACT = contact("DEP", "IND")
FC_TURN = f"*RIGID BODY, NSET=ConstraintTop, REF NODE={REF}, ROT NODE={REF + 1}\n"
PP_HELD = ["*Boundary, op=New", "*Boundary", "Internal_Fixed, 1, 6, 0", "*Boundary", "All_sides, 1, 2, 0"]
PP_LOADS = ["*Cload, op=New", "*Dload, op=New"]
PP_TIE = "*Tie, Name=Tie-1, Position tolerance=0.01, Adjust=No\nInternal_Slave, Internal_Master\n"
PP_CONTACT = contact("Internal_Slave", "Internal_Master")
PP_RUB = contact("Internal_Slave", "Internal_Master", "*FRICTION\n0.2, 5000\n")
PP_KINEMATIC = f"*Coupling, Constraint name=Rigid-1, Ref node={REF}, Surface=Pressed\n*Kinematic\n1, 6\n"
PP_SPREAD = PP_KINEMATIC.replace("*Kinematic\n1, 6", "*Distributing\n1, 3")
CAE_HELD = ["*Boundary", "Fixed, ENCASTRE", "Low-1.All, 1, 2", "High-1.All, 1, 2"]
CAE_HEAD = "*Step, name=Step-1, nlgeom=NO\n*Static\n1., 1., 1e-05, 1."
CAE_TIE = "*Tie, name=Constraint-1, adjust=yes, type=SURFACE TO SURFACE\nSlave, Master\n"
CAE_PAIR = contact("Slave", "Master")
GLUED = 2.0 * 10.0 / E  # both cubes under 10
SCENES = {
    "FreeCAD: tie under a pressure": Scene(
        FREECAD + FC_TIE + step(*FC_HELD, "*DLOAD", faces(HIGH, "top", M + 1, "P").replace("\n", ",10.\n").rstrip()),
        (lid(-GLUED), pressed(10.0)),
    ),
    "FreeCAD: weight on contact": Scene(
        FREECAD + FC_CONTACT + step(*FC_HELD, "*DLOAD", "Eall,GRAV,10.,0.,0.,-1."),
        (lid(-RHO * 10.0 * 2.0**2 / (2.0 * E)), pressed(RHO * 10.0)),
    ),
    "FreeCAD: displacement on contact": Scene(
        FREECAD + FC_CONTACT + step(*FC_HELD, "*BOUNDARY", "ConstraintTop,3,3,-0.01"), (lid(-0.01), pressed(E * 0.005))
    ),
    "FreeCAD: warm between walls": Scene(
        FREECAD
        + FC_CONTACT
        + "*INITIAL CONDITIONS,TYPE=TEMPERATURE\nNall,300.0\n"
        + step(*FC_HELD, "*BOUNDARY", "ConstraintTop,3", "*TEMPERATURE", "Nall,310.0"),
        (lid(0.0), pressed(E * ALPHA * 10.0)),
    ),
    "FreeCAD: rigid lid with a force at its node": Scene(
        FREECAD + FC_TIE + FC_TURN + step(*FC_HELD, "*BOUNDARY", f"{REF + 1},1,3", "*CLOAD", f"{REF},3,-10."),
        (lid(-GLUED), pressed(10.0)),
    ),
    "FreeCAD: rotating bar": Scene(
        FREECAD + FC_TIE + step(*FC_HELD, "*DLOAD", "Eall,CENTRIF,9.,0.,0.,0.,1.,0.,0."),
        (lid(RHO * 9.0 * 2.0**3 / (3.0 * E)), pressed(RHO * 9.0 * (2.0**2 - 1.0) / 2.0)),
    ),
    "PrePoMax: tie, force spread from a node": Scene(
        PREPOMAX + PP_TIE + PP_SPREAD + step(*PP_HELD, *PP_LOADS, "*Cload", f"{REF}, 3, -10"),
        (lid(-GLUED), pressed(10.0)),
    ),
    "PrePoMax: rigid face led by its node": Scene(
        PREPOMAX
        + PP_CONTACT
        + PP_KINEMATIC
        + step(*PP_HELD, "*Boundary", "Ref, 1, 2, 0", "Ref, 3, 3, -0.01", "Ref, 4, 6, 0"),
        (lid(-0.01), pressed(E * 0.005)),
    ),
    "PrePoMax: pressed, then drawn along": Scene(
        PREPOMAX
        + PP_RUB
        + step("*Boundary", "Internal_Fixed, 1, 6, 0", "All_sides, 1, 2, 0", "*Dsload", "Pressed, P, 10")
        + step(
            "*Boundary",
            *(f"{i}, 1, 1, 0.01" for i in range(N + 1, REF)),
        ),
        (lid(-GLUED), pressed(10.0, 2.0)),
    ),
    "PrePoMax: springs under a force": Scene(
        PREPOMAX
        + PP_TIE
        + PP_SPREAD
        + "*Element, Type=SPRING1, Elset=Spring-1\n"
        + "".join(f"{900 + i}, {node}\n" for i, node in enumerate((HIGH.nodes_of("top") + N + 1).tolist()))
        + f"*Spring, Elset=Spring-1\n3\n{500.0 / 9.0!r}\n"
        + PP_KINEMATIC.replace("Rigid-1", "Stiff")
        .replace(f"Ref node={REF}", f"Ref node={REF + 9}")
        .replace("*Coupling", f"*Node\n{REF + 9}, 0.5, 0.5, 2.\n*Coupling")
        .replace("1, 6", "3, 3")
        + step(*PP_HELD, "*Boundary", f"{REF + 9}, 4, 6, 0", "*Cload", f"{REF + 9}, 3, -10"),
        (lid(-10.0 / (E / 2.0 + 500.0)),),
    ),
    "PrePoMax: amplitude over two steps": Scene(
        PREPOMAX
        + PP_TIE
        + "*Amplitude, Name=Amp-1, Time=Total time\n0, 0, 2, 1\n"
        + step(*PP_HELD, "*Dsload, Amplitude=Amp-1", "Pressed, P, 10")
        + step("*Dsload, Amplitude=Amp-1", "Pressed, P, 20"),
        (lid(-2.0 * GLUED), pressed(20.0)),
    ),
    "PrePoMax: load taken off again": Scene(
        PREPOMAX
        + PP_CONTACT
        + step(*PP_HELD, "*Dsload", "Pressed, P, 10")
        + step(*PP_HELD, *PP_LOADS, "*Dsload", "Pressed, P, 4"),
        (lid(-0.4 * GLUED), pressed(4.0)),
    ),
    "CAE: instance moved, tied": Scene(
        cae()
        .replace(
            nodes(HIGH, 1),
            "".join(f"{i + 1}, {x - 3.0:.6e}, {y:.6e}, {z + 5.0:.6e}\n" for i, (x, y, z) in enumerate(HIGH.points)),
        )
        .replace("0., 0., 0.\n*End Instance", "3., 0., -5.\n*End Instance")
        + CAE_TIE
        + step(*CAE_HELD, "*Dsload", "Top, P, 10.", head=CAE_HEAD),
        (lid(-GLUED), pressed(10.0)),
    ),
    "CAE: instance turned, tied": Scene(
        cae(instance="0., 0., 0.\n0., 0., 0., 1., 0., 0., 90.\n").replace(
            nodes(HIGH, 1), "".join(f"{i + 1}, {x:.6e}, {z:.6e}, {-y:.6e}\n" for i, (x, y, z) in enumerate(HIGH.points))
        )
        + CAE_TIE
        + step(*CAE_HELD, "*Dsload", "Top, P, 10.", head=CAE_HEAD),
        (lid(-GLUED), pressed(10.0)),
    ),
    "CAE: coupling to a reference point": Scene(
        cae("*Coupling, constraint name=Constraint-2, ref node=Ref, surface=Top\n*Kinematic\n")
        + CAE_PAIR
        + step(*CAE_HELD, "Ref, 1, 2", "Ref, 4, 6", "*Cload", "Ref, 3, -10.", head=CAE_HEAD),
        (lid(-GLUED), pressed(10.0)),
    ),
    "CAE: general contact": Scene(
        cae()
        + "*Surface Interaction, name=IntProp-1\n1.,\n*Friction\n0.,\n*Surface Behavior, pressure-overclosure=HARD\n"
        + "*Contact\n*Contact Inclusions, ALL EXTERIOR\n*Contact Property Assignment\n ,  , IntProp-1\n"
        + step(*CAE_HELD, "*Dsload", "Top, P, 10.", head=CAE_HEAD),
        (lid(-GLUED), pressed(10.0)),
    ),
    "CAE: equations between a lid and a node": Scene(
        cae("*Equation\n2\nLid, 3, 1.\nRef, 3, -1.\n")
        + CAE_TIE
        + step(*CAE_HELD, "*Cload", "Ref, 3, -10.", head=CAE_HEAD),
        (lid(-GLUED), pressed(10.0)),
    ),
    "CAE: rigid instance on contact": Scene(
        cae("*Elset, elset=Hard, instance=High-1, generate\n1, 8, 1\n*Rigid Body, ref node=Ref, elset=Hard\n")
        + CAE_PAIR
        + step(
            "*Boundary",
            "Fixed, ENCASTRE",
            "Low-1.All, 1, 2",
            "Ref, 1, 2",
            "Ref, 4, 6",
            "Ref, 3, 3, -0.01",
            head=CAE_HEAD,
        ),
        (lid(-0.01), pressed(E * 0.01)),
    ),
    "CAE: clearance closed by two steps": Scene(
        cae()
        + "*Amplitude, name=Amp-1\n0., 0., 1., 1.\n"
        + CAE_PAIR
        + "*Clearance, master=Master, slave=Slave, value=0.005\n"
        + step(*CAE_HELD, "*Boundary, amplitude=Amp-1", "Lid, 3, 3, -0.005", head=CAE_HEAD)
        + step("*Boundary", "Lid, 3, 3, -0.015", head=CAE_HEAD.replace("Step-1", "Step-2")),
        (lid(-0.015), pressed(E * 0.005)),
    ),
    "CAE: interference fit": Scene(
        cae()
        + CAE_PAIR
        + step(*CAE_HELD, "Lid, 3, 3", "*Contact Interference", "Slave, Master, 0.", head=CAE_HEAD)
        + step("*Boundary, op=NEW", *CAE_HELD[1:], "Lid, 3, 3, -0.002", head=CAE_HEAD.replace("Step-1", "Step-2")),
        (lid(-0.002), pressed(E * 0.001)),
    ),
}


@pytest.mark.parametrize("name", SCENES)
def test_scenes(name: str, tmp_path: Path) -> None:
    deck = load(tmp_path, SCENES[name].text)
    target = tmp_path / "job.toml"
    assert main(["convert", str(tmp_path / "deck.inp"), str(target), "--quiet"]) == 0
    for model in (deck.model, load_job(target).model):
        solution = abut.solve(model)
        assert solution.converged
        for check in SCENES[name].checks:
            check(solution)
