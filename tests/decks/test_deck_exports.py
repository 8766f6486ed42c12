"""Decks as FreeCAD, PrePoMax and Abaqus/CAE write them, in seven elements: solved as they are, and by way of a job file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.cli import main
from abut.io.deck.elements import FACES
from abut.job import load_job
from abut.mesh import make
from models.decks import load

YOUNG, PRESSURE = 1000.0, 10.0
CODES = {
    "C3D8": "hex8", "C3D8I": "hex8", "C3D20": "hex20", "C3D20R": "hex20", "C3D4": "tet4", "C3D10": "tet10",
    "C3D15": "wedge15",
}  # fmt: skip


def brick(cell: str, z: tuple[float, float], cells: int) -> abut.Mesh:
    return make.box([0, 1], [0, 1], z, cells=[cells, cells, cells], cell=cell)


def rows(numbers: list[int], width: int = 16) -> str:
    """Numbers on lines that end with a comma where they go on."""
    lines = [", ".join(map(str, numbers[i : i + width])) for i in range(0, len(numbers), width)]
    return ",\n".join(lines) + "\n"


def nodes(mesh: abut.Mesh, first: int) -> str:
    return "".join(f"{i + first}, {x:.6e}, {y:.6e}, {z:.6e}\n" for i, (x, y, z) in enumerate(mesh.points))


def elements(mesh: abut.Mesh, first_node: int, first: int) -> str:
    block = mesh.blocks[0].nodes + first_node
    return "".join(rows([first + i, *own], 11) for i, own in enumerate(block.tolist()))


def faces(mesh: abut.Mesh, name: str, first: int, label: str = "S") -> str:
    kind = mesh.blocks[0].kind
    number = {local: k + 1 for k, local in enumerate(FACES[kind])}
    return "".join(f"{first + cell}, {label}{number[local]}\n" for cell, local in mesh.surfaces[name].tolist())


def freecad(code: str, low: abut.Mesh, high: abut.Mesh) -> str:
    """Two solids, no parts, pressure by element faces, output cards in between."""
    n, m = len(low.points), low.n_cells
    bottom = rows((low.nodes_of("bottom") + 1).tolist(), 1)
    return f"""** written by FreeCAD inp file writer for CalculiX,Abaqus meshes
*Node, NSET=Nall
{nodes(low, 1)}{nodes(high, n + 1)}*Element, TYPE={code}, ELSET=Evolumes
{elements(low, 1, 1)}{elements(high, n + 1, m + 1)}*ELSET,ELSET=Eall
Evolumes
*NSET,NSET=ConstraintFixed
{bottom}*NSET, NSET=Sides, GENERATE
1, {n + len(high.points)}, 1
*SURFACE, NAME=DEPConstraintContact
{faces(high, "bottom", m + 1)}*SURFACE, NAME=INDConstraintContact
{faces(low, "top", 1)}*CONTACT PAIR, INTERACTION=INTConstraintContact, TYPE=SURFACE TO SURFACE
DEPConstraintContact, INDConstraintContact
*SURFACE INTERACTION, NAME=INTConstraintContact
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
1000000.0
*MATERIAL, NAME=Material
*ELASTIC
{YOUNG:.0f}, 0.0
*SOLID SECTION, ELSET=Evolumes, MATERIAL=Material

*STEP, INC=2000
*STATIC
1.0, 1.0, 1e-05, 1.0
*BOUNDARY
ConstraintFixed,1
ConstraintFixed,2
ConstraintFixed,3
Sides,1
Sides,2
*DLOAD
** ConstraintPressure
{faces(high, "top", m + 1, "P").replace(chr(10), f", {PRESSURE}" + chr(10))}*NODE FILE, OUTPUT=3D
U
*EL FILE
S, E
*NODE PRINT , NSET=ConstraintFixed, TOTALS=ONLY
RF
*OUTPUT
*END STEP
"""


def prepomax(code: str, low: abut.Mesh, high: abut.Mesh) -> str:
    """Sections and sets with blanks, Internal names, *DSLOAD on surfaces, friction, sets of several names."""
    n, m = len(low.points), low.n_cells
    return f"""************************************************************
** Heading +++++++++++++++++++++++++++++++++++++++++++++++++
*Heading
Hash: x, Date: 1/1/2024, Unit system: MM_TON_S_C
*Node
{nodes(low, 1)}{nodes(high, n + 1)}*Element, Type={code}, Elset=Solid_part-1
{elements(low, 1, 1)}*Element, Type={code}, Elset=Solid_part-2
{elements(high, n + 1, m + 1)}*Nset, Nset=Internal_Selection-1_Fixed-1
{rows((low.nodes_of("bottom") + 1).tolist())}*Nset, Nset=All_sides, Generate
1, {n + len(high.points)}
*Elset, Elset=Internal_Selection-1_Solid_Section-1
Solid_part-1,
Solid_part-2
*Surface, Name=Internal_Slave, Type=Element
{faces(high, "bottom", m + 1)}*Surface, Name=Internal_Master, Type=Element
{faces(low, "top", 1)}*Surface, Name=Pressed, Type=Element
{faces(high, "top", m + 1)}*Physical constants, Absolute zero=-273.15, Stefan Boltzmann=5.670374E-11
*Material, Name=Steel
*Density
7.8E-09
*Elastic
{YOUNG:.0f}, 0
*Expansion, Zero=20
1.1E-05
*Solid section, Elset=Internal_Selection-1_Solid_Section-1, Material=Steel
*Surface interaction, Name=Surface_interaction-1
*Surface behavior, Pressure-overclosure=Hard
*Friction
0.2, 5000
*Contact pair, Interaction=Surface_interaction-1, Type=Surface to surface, Adjust=0.001
Internal_Slave, Internal_Master
*Step, Inc=100
*Static, Solver=Pardiso
0.5, 1, 1E-05, 1
*Output, Frequency=1
*Boundary, op=New
** Name: Fixed-1
*Boundary
Internal_Selection-1_Fixed-1, 1, 6, 0
*Boundary
All_sides, 1, 2, 0
*Cload, op=New
*Dload, op=New
** Name: Pressure-1
*Dsload
Pressed, P, {PRESSURE}
*Node file
RF, U
*El file
S, E, NOE
*Contact file
CDIS, CSTR
*End step
"""


def cae(code: str, low: abut.Mesh, high: abut.Mesh) -> str:
    """Parts, instances moved, sets and surfaces of the assembly, an amplitude, field and history output."""
    part = "*Part, name={name}\n*Node\n{nodes}*Element, type={code}\n{elements}"
    part += "*Elset, elset=Set-1, generate\n1, {count}, 1\n"
    section = "** Section: Section-1\n*Solid Section, elset=Set-1, material=Material-1\n,\n*End Part\n"
    texts = []
    for name, mesh in (("Low", low), ("High", high)):
        own = part.format(name=name, nodes=nodes(mesh, 1), code=code, elements=elements(mesh, 1, 1), count=mesh.n_cells)
        texts.append(f"{own}*Nset, nset=All, generate\n1, {len(mesh.points)}, 1\n{section}")
    bottom = rows((low.nodes_of("bottom") + 1).tolist())
    top = "".join(
        f"*Elset, elset=_Top_{side}, internal, instance=High-1\n{cells}" for side, cells in _by_side(high, "top")
    )
    return f"""*Heading
** Job name: Job-1 Model name: Model-1
*Preprint, echo=NO, model=NO, history=NO, contact=NO
{"".join(texts)}*Assembly, name=Assembly
*Instance, name=Low-1, part=Low
*End Instance
*Instance, name=High-1, part=High
          0.,           0.,           0.
*End Instance
*Nset, nset=Fixed, instance=Low-1
{bottom}{top}*Surface, type=ELEMENT, name=Top
{"".join(f"_Top_{side}, {side}{chr(10)}" for side, _ in _by_side(high, "top"))}{
        _surface("Slave", high, "bottom", "High-1")
    }{_surface("Master", low, "top", "Low-1")}*End Assembly
*Amplitude, name=Amp-1
0., 0., 1., 1.
*Material, name=Material-1
*Elastic
{YOUNG:.0f}., 0.
*Surface Interaction, name=IntProp-1
1.,
*Friction
0.,
*Surface Behavior, pressure-overclosure=HARD
*Contact Pair, interaction=IntProp-1, type=SURFACE TO SURFACE
Slave, Master
*Step, name=Step-1, nlgeom=NO
*Static
1., 1., 1e-05, 1.
*Boundary
Fixed, ENCASTRE
Low-1.All, 1, 2
High-1.All, 1, 2
*Dsload, amplitude=Amp-1
Top, P, {PRESSURE}
*Restart, write, frequency=0
*Output, field, variable=PRESELECT
*Output, history, variable=PRESELECT
*End Step
"""


def _by_side(mesh: abut.Mesh, name: str) -> list[tuple[str, str]]:
    found: dict[str, list[int]] = {}
    for line in faces(mesh, name, 1).splitlines():
        cell, side = line.split(", ")
        found.setdefault(side, []).append(int(cell))
    return [(side, rows(cells)) for side, cells in sorted(found.items())]


def _surface(name: str, mesh: abut.Mesh, of: str, instance: str) -> str:
    sides = _by_side(mesh, of)
    sets = "".join(f"*Elset, elset=_{name}_{s}, internal, instance={instance}\n{cells}" for s, cells in sides)
    return f"{sets}*Surface, type=ELEMENT, name={name}\n" + "".join(f"_{name}_{s}, {s}\n" for s, _ in sides)


@pytest.mark.parametrize("code", [pytest.param(c, marks=pytest.mark.long) if c != "C3D10" else c for c in CODES])
@pytest.mark.parametrize("style", [freecad, prepomax, cae])
def test_exports(style: Callable[[str, abut.Mesh, abut.Mesh], str], code: str, tmp_path: Path) -> None:
    """Two cubes of other meshes under a pressure, no Poisson's ratio: the top goes down by 2 p / E, contact carries p; the
    job file that the deck becomes gives the same."""
    text = style(code, brick(CODES[code], (0.0, 1.0), 1), brick(CODES[code], (1.0, 2.0), 2))
    deck = load(tmp_path, text)
    target = tmp_path / "job.toml"
    assert main(["convert", str(tmp_path / "deck.inp"), str(target), "--quiet"]) == 0
    for model in (deck.model, load_job(target).model):
        solution = abut.solve(model)
        at = model.mesh.points[:, 2] > 2.0 - 1e-9
        assert solution.converged
        np.testing.assert_allclose(solution.displacement[at, 2], -2.0 * PRESSURE / YOUNG, rtol=1e-8)
        assert abs(solution.contacts[0].force[2]) == pytest.approx(PRESSURE, rel=1e-8)
