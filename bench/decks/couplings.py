"""Couplings and moments at reference nodes, abut beside CalculiX.

python bench/decks/couplings.py [C3D8|C3D20R|C3D10 ...] prints for a bar whose end is coupled to a node beside it the largest
difference of displacement over the largest displacement, with small displacements and with NLGEOM.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
from cards import read

import abut
from abut.decks.translation import load_deck
from abut.io.deck.elements import FACES
from abut.mesh import make
from abut.mesh.mesh import Mesh
from abut.problem.loads import force_and_moment
from abut.problem.rigid_bodies import rigid_bodies
from abut.problem.turns import rotation, slopes
from reference import run

CELLS = {"C3D8": "hex8", "C3D20R": "hex20", "C3D10": "tet10"}
LENGTH = 50.0
KINEMATIC = "*COUPLING, CONSTRAINT NAME=C, REF NODE=9999, SURFACE=TIP\n*KINEMATIC\n1, 3\n"
DISTRIBUTING = "*COUPLING, CONSTRAINT NAME=C, REF NODE=9999, SURFACE=TIP\n*DISTRIBUTING\n1, 6\n"
FORCE = "*CLOAD\n9999, 2, 1000.\n9999, 3, 500.\n"
BENT, TWISTED, BOTH = (
    "*CLOAD\n9999, 6, 40000.\n",
    "*CLOAD\n9999, 4, 100000.\n",
    "*CLOAD\n9999, 6, 40000.\n9999, 4, 40000.\n",
)
MOVED = "*BOUNDARY\n9999, 2, 2, 5.\n9999, 6, 6, 0.15\n9999, 3, 5\n"


def lines(numbers: Iterable[int]) -> str:
    """Ten numbers a line."""
    text = [str(number) for number in numbers]
    return ",\n".join(", ".join(text[i : i + 10]) for i in range(0, len(text), 10)) + "\n"


def bar(code: str) -> str:
    """The deck up to its coupling: held at one end, TIP the faces of the other."""
    box = make.box([0, LENGTH], [-2.5, 2.5], [-2, 2], cells=[10, 2, 2], cell=CELLS[code])
    mesh = make.join({"bar": box})
    text = "*NODE\n" + "".join(f"{i + 1}, {x:.12g}, {y:.12g}, {z:.12g}\n" for i, (x, y, z) in enumerate(mesh.points))
    text += f"9999, {LENGTH + 10}, 2., 1.\n*ELEMENT, TYPE={code}, ELSET=EALL\n"
    text += "".join(lines([i + 1, *(nodes + 1).tolist()]) for i, nodes in enumerate(mesh.blocks[0].nodes))
    text += f"*NSET, NSET=FIX\n{lines((mesh.nodes_of('bar.left') + 1).tolist())}{surface(mesh, code)}"
    return (
        text
        + "*MATERIAL, NAME=M\n*ELASTIC\n210000., 0.3\n*SOLID SECTION, ELSET=EALL, MATERIAL=M\n*BOUNDARY\nFIX, 1, 3\n"
    )


def surface(mesh: Mesh, code: str) -> str:
    """TIP, face by face."""
    tip = mesh.surface("bar.right")
    rows = [
        f"{cell + 1}, S{FACES[CELLS[code]].index(local) + 1}\n"
        for cell, local in zip(tip.cells.tolist(), tip.local.tolist())
    ]
    return "*SURFACE, NAME=TIP\n" + "".join(rows)


def as_it_is(model: abut.Model, _: abut.Solution) -> abut.Model:
    """What the deck says."""
    return model


def undeformed(model: abut.Model, _: abut.Solution) -> abut.Model:
    """With the forces that CalculiX takes of *DISTRIBUTING: those of the undeformed nodes."""
    (body,) = rigid_bodies(model)
    forces = sum(body.spread(*force_and_moment(model, load)) for load in model.loads)
    sets = {**model.mesh.node_sets, **{f"node {n}": np.array([n]) for n in body.nodes.tolist()}}
    loads = [abut.NodalForce(f"node {n}", force) for n, force in zip(body.nodes.tolist(), forces)]
    return replace(model, mesh=replace(model.mesh, node_sets=sets), loads=loads)


def conjugate(model: abut.Model, solution: abut.Solution) -> abut.Model:
    """With the moment that does the work of CalculiX's on changes of the rotation vector."""
    (load,) = model.loads
    for _ in range(10):
        vector = solution.steps[-1].rigid["C"].rotation
        spins = np.stack([slope @ rotation(vector).T for slope in slopes(vector)])
        by_vector = np.stack([spins[:, 2, 1], spins[:, 0, 2], spins[:, 1, 0]])
        changed = replace(model, loads=[replace(load, value=np.linalg.solve(by_vector.T, load.value))])
        solution = abut.solve(changed)
    return changed


def compare(code: str, coupling: str, loads: str, large: bool, change: Callable = as_it_is) -> float:
    """Largest difference over the largest displacement."""
    step = f"*STEP{', NLGEOM' * large}\n*STATIC\n0.25, 1.\n{loads}*NODE FILE, FREQUENCY=1000\nU\n*END STEP\n"
    text = bar(code) + coupling + step
    with tempfile.TemporaryDirectory() as folder:
        deck = Path(folder) / "deck.inp"
        deck.write_text(text)
        (other,) = run(read(deck), 300.0)[-1:]
        model = load_deck(deck).model
    solution = abut.solve(model)
    if change is not as_it_is:
        solution = abut.solve(change(model, solution))
    own = solution.displacement[: max(n for n in other if n < 9999)]
    theirs = np.array([other[i + 1] for i in range(len(own))])
    return float(np.linalg.norm(own - theirs, axis=1).max() / np.linalg.norm(theirs, axis=1).max())


ROWS = (
    ("*KINEMATIC, force", KINEMATIC, FORCE, as_it_is),
    ("*KINEMATIC, bending moment", KINEMATIC, BENT, as_it_is),
    ("*KINEMATIC, torque", KINEMATIC, TWISTED, as_it_is),
    ("*KINEMATIC, both", KINEMATIC, BOTH, as_it_is),
    ("*KINEMATIC, both, moment as CalculiX", KINEMATIC, BOTH, conjugate),
    ("*KINEMATIC, moved and turned", KINEMATIC, MOVED, as_it_is),
    ("*DISTRIBUTING, force", DISTRIBUTING, FORCE, as_it_is),
    ("*DISTRIBUTING, torque", DISTRIBUTING, TWISTED, as_it_is),
    ("*DISTRIBUTING, force as CalculiX", DISTRIBUTING, FORCE, undeformed),
    ("*DISTRIBUTING, torque as CalculiX", DISTRIBUTING, TWISTED, undeformed),
)

if __name__ == "__main__":
    for code in sys.argv[1:] or CELLS:
        for name, coupling, loads, change in ROWS:
            small = "" if change is not as_it_is else f"{compare(code, coupling, loads, False):.1e}"
            print(f"{code:8}{name:40}{small:10}{compare(code, coupling, loads, True, change):.1e}", flush=True)
