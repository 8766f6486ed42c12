"""CalculiX: the input deck of a case.

As a script, python bench/contact/calculix.py CASE DOFS KIND FOLDER writes FOLDER/deck.inp; KIND is mortar or penalty.

Contact is hard, which CalculiX takes, in both kinds, for a linear pressure over penetration with a stiffness of 50 times
Young's modulus (per mm here; it says so in its output): its own default, not ours. With friction it asks for a stiffness of
what sticks: a tenth of that, as its manual advises. Where a body yields or is of rubber the stiffness is given, 200 times
the softest modulus, as the default knows of elastic bodies only. Slave is abut's contactor. As many increments as abut takes
steps, which CalculiX may cut or lengthen; of metal that yields, whose force depends on them (2 % from 5 to 20), just those.
The rest is left at its default.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path

import cases
import numpy as np

import abut

NAMES = {"hex8": "C3D8", "hex20": "C3D20", "tet10": "C3D10"}
# Corner nodes of the faces S1, S2, ... of CalculiX's elements; its node order within the cell is abut's.
_HEX = ({0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 4, 5}, {1, 2, 5, 6}, {2, 3, 6, 7}, {0, 3, 4, 7})
_TET = ({0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {0, 2, 3})
FACES = {"hex8": _HEX, "hex20": _HEX, "tet10": _TET}
PENALTY = 200.0  # over the softest Young's modulus, per mm: a pressure of a fifth of it presses in by a micron
STICK = 5.0  # stiffness of what sticks over Young's modulus, per mm
TYPES = {"mortar": "MORTAR", "penalty": "SURFACE TO SURFACE"}


def faces(case: abut.Model, name: str) -> list[tuple[int, int]]:
    """A surface as (element, face) in CalculiX's numbers, both from 1."""
    result = []
    kinds = [block.kind for block in case.mesh.blocks]
    for cell, local in case.mesh.surfaces[name]:
        kind = kinds[int(np.searchsorted(case.mesh.starts, cell, side="right")) - 1]
        nodes = set(abut.cells.CELLS[kind].facets[local][1]) & set(range(abut.cells.CELLS[kind].corners))
        result.append((int(cell) + 1, FACES[kind].index(nodes) + 1))
    return result


def _rows(values: list[int], width: int = 12) -> Iterator[str]:
    for i in range(0, len(values), width):
        yield ", ".join(map(str, values[i : i + width])) + ("," if i + width < len(values) else "")


def deck(case: abut.Model, kind: str) -> Iterator[str]:
    """The lines of the input deck."""
    mesh, contact = case.mesh, case.contacts[0]
    reduced = [solid.body for solid in case.solids if solid.integration == "reduced"]
    yield "*NODE, NSET=NALL"
    for number, (x, y, z) in enumerate(mesh.points.tolist(), 1):
        yield f"{number}, {x!r}, {y!r}, {z!r}"
    for body in mesh.bodies:
        for cell, nodes, numbers in mesh.cells_of(body):
            yield f"*ELEMENT, TYPE={NAMES[cell]}{'R' if body in reduced else ''}, ELSET={body.upper()}"
            for number, row in zip((numbers + 1).tolist(), (nodes + 1).tolist()):
                yield from _rows([number, *row])
    for solid in case.solids:
        name = f"M{solid.body.upper()}"
        yield f"*MATERIAL, NAME={name}"
        yield from _law(solid.material)
        yield f"*SOLID SECTION, ELSET={solid.body.upper()}, MATERIAL={name}"
    for name, surface in (("SLAVE", contact.contactor), ("MASTER", contact.target)):
        yield f"*SURFACE, NAME={name}, TYPE=ELEMENT"
        yield from (f"{element}, S{face}" for element, face in faces(case, surface))
    yield "*NSET, NSET=FOOT"
    yield from _rows((mesh.nodes_of(case.supports[0].on) + 1).tolist())
    yield "*SURFACE INTERACTION, NAME=TOUCH"
    yield from _stiffness(case)
    if contact.friction:
        yield "*FRICTION"
        yield f"{contact.friction!r}, {STICK * case.solids[0].material.young!r}"
    yield f"*CONTACT PAIR, INTERACTION=TOUCH, TYPE={TYPES[kind]}"
    yield "SLAVE, MASTER"
    yield "*STEP, NLGEOM" if case.kinematics == "finite" else "*STEP"
    yields = any(isinstance(solid.material, abut.Plastic) for solid in case.solids)
    yield "*STATIC, DIRECT" if yields else "*STATIC"
    steps = case.solve.steps
    yield f"{1.0 / steps if isinstance(steps, int) else 1.0!r}, 1."
    yield "*BOUNDARY"
    for axis, values in cases.prescribed(case).items():
        yield from (f"{node + 1}, {axis + 1}, {axis + 1}, {value!r}" for node, value in values.items())
    yield "*NODE PRINT, NSET=FOOT, TOTALS=ONLY"
    yield "RF"
    yield "*END STEP"


def _law(material: object) -> Iterator[str]:
    """Cards of a material. Raises ValueError for one that has none."""
    if isinstance(material, abut.NeoHooke) and material.volumetric == "isochoric":
        lame, shear = material.moduli
        yield "*HYPERELASTIC, NEO HOOKE"
        yield f"{0.5 * shear!r}, {2.0 / (lame + 2.0 * shear / 3.0)!r}"
        return
    if not isinstance(material, (abut.LinearElastic, abut.Plastic)):
        raise ValueError(f"no cards for {material!r}")
    yield "*ELASTIC"
    yield f"{material.young!r}, {material.poisson!r}"
    if isinstance(material, abut.Plastic):
        yield "*PLASTIC"
        yield f"{material.yield_stress!r}, 0."
        yield f"{material.yield_stress + material.hardening!r}, 1."


def _stiffness(case: abut.Model) -> Iterator[str]:
    if all(isinstance(solid.material, abut.LinearElastic) for solid in case.solids):
        yield "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD"
    else:
        yield "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"
        yield f"{PENALTY * min(solid.material.modulus for solid in case.solids)!r}"


def write(case: abut.Model, kind: str, folder: Path) -> None:
    """Write folder/deck.inp."""
    (folder / "deck.inp").write_text("\n".join(deck(case, kind)) + "\n", encoding="ascii")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("case")
    parser.add_argument("dofs", type=int)
    parser.add_argument("kind", choices=TYPES)
    parser.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    case = cases.model(arguments.case, arguments.dofs)
    write(case, arguments.kind, arguments.folder)
    print(json.dumps({"dofs": cases.dofs(case)}))


if __name__ == "__main__":
    main()
