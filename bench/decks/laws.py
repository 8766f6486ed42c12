"""Metal and rubber in abut and CalculiX: small decks of every law that both have, each on several elements and paths,
compared at every node after every step.

python bench/decks/laws.py [NAME ...] [--keep FOLDER] prints a line for each deck and the table of docs/verification/decks.md
(some minutes; needs ccx); --keep: writes the decks into a folder, too. Metal is solved with small strains, since CalculiX's
law for large ones is another one than abut's; rubber with NLGEOM.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from cards import read
from compare import largest, model_of, solved

from abut.mesh.make import box, join, rectangle
from abut.mesh.mesh import Mesh
from reference import difference, run

ELASTIC = "*ELASTIC\n210000., .3\n"
METALS = {
    "perfect": f"{ELASTIC}*PLASTIC\n300., 0.\n",
    "linear": f"{ELASTIC}*PLASTIC\n300., 0.\n1300., .5\n",
    "table": f"{ELASTIC}*PLASTIC\n250., 0.\n300., .002\n340., .01\n400., .05\n450., .2\n",
    "kinematic": f"{ELASTIC}*PLASTIC, HARDENING=KINEMATIC\n300., 0.\n1300., .5\n",
}
# D1 = .04: bulk moduli of 50, 20 to 25 times that of shear
RUBBERS = {
    "neo-hooke": "*HYPERELASTIC, NEO HOOKE\n1., .04\n",
    "mooney-rivlin": "*HYPERELASTIC, MOONEY-RIVLIN\n.7, .3, .04\n",
    "yeoh": "*HYPERELASTIC, YEOH\n1., -.05, .02, .04, 0., 0.\n",
    "reduced-polynomial": "*HYPERELASTIC, REDUCED POLYNOMIAL, N=2\n1., .05, .04, 0.\n",
    "ogden-1": "*HYPERELASTIC, OGDEN, N=1\n2., 3., .04\n",
    "ogden-2": "*HYPERELASTIC, OGDEN, N=2\n1.6, 2.5, -.4, -2., .04, 0.\n",
    "arruda-boyce": "*HYPERELASTIC, ARRUDA-BOYCE\n2., 3., .04\n",
}
# abut's cells of an element, and how many of them there are along it and across
ELEMENTS = {
    "C3D8": ("hex8", (4, 2, 2)), "C3D20R": ("hex20", (2, 1, 1)), "C3D10": ("tet10", (2, 1, 1)),
    "CPE8R": ("quad8", (4, 2)), "CAX8R": ("quad8", (4, 2)),
}  # fmt: skip
LENGTH = 4.0  # of bars, 1 by 1 across


@dataclass(frozen=True)
class Case:
    """steps: displacements (x, y) of the free end at the end of each; the other end is held. increments: of each step."""

    law: str
    element: str
    path: str
    steps: tuple[tuple[float, float], ...]
    increments: int = 10

    @property
    def name(self) -> str:
        return f"{self.law}-{self.element.lower()}-{self.path}"

    @property
    def rubber(self) -> bool:
        return self.law in RUBBERS


def cases() -> list[Case]:
    """All of them: strains of metal of about ten times where it yields, of rubber up to a half."""
    pulled, bent, cycle = ((0.04, 0.0),), ((0.0, 0.2),), ((0.04, 0.0), (-0.04, 0.0), (0.02, 0.0))
    result = []
    for law in METALS:
        result += [
            Case(law, "C3D8", "bent", bent),
            Case(law, "C3D8", "cycle", cycle),
            Case(law, "C3D10", "bent", bent),
        ]
        result += [Case(law, "CAX8R", "pulled", pulled)]
    far, sheared, squeezed = ((2.0, 0.0),), ((0.0, 1.5),), ((-1.0, 0.0), (-0.5, 0.5))
    for law in RUBBERS:
        result += [Case(law, "C3D8", "pulled", far), Case(law, "C3D20R", "sheared", sheared)]
        result += [Case(law, "CPE8R", "squeezed", squeezed), Case(law, "CAX8R", "pulled", far)]
    return result


def mesh_of(case: Case) -> Mesh:
    """A bar along x; axisymmetric: a disc, whose free side is the outer one."""
    cell, count = ELEMENTS[case.element]
    if len(count) == 3:
        return join({"bar": box((0, LENGTH), (0, 1), (0, 1), count, cell)})
    inner = 1.0 if case.element.startswith("CAX") else 0.0
    return join({"bar": rectangle((inner, inner + LENGTH), (0, 1), count, cell)})


def deck(case: Case) -> str:
    """The text of a deck."""
    mesh = mesh_of(case)
    (block,) = mesh.blocks
    law = (RUBBERS if case.rubber else METALS)[case.law]
    nodes = [", ".join([str(i), *(f"{x:.12g}" for x in point)]) for i, point in enumerate(mesh.points, 1)]
    rows = [", ".join(map(str, [i, *(cell + 1)])) for i, cell in enumerate(block.nodes, 1)]
    lines = ["*NODE, NSET=ALL", *nodes, f"*ELEMENT, TYPE={case.element}, ELSET=BAR", *map(_wrapped, rows)]
    x = mesh.points[:, 0]
    for name, at in (("HELD", x.min()), ("END", x.max())):
        lines += [f"*NSET, NSET={name}", *(f"{i}," for i in np.flatnonzero(np.isclose(x, at)) + 1)]
    lines += ["*MATERIAL, NAME=M", law.rstrip(), "*SOLID SECTION, ELSET=BAR, MATERIAL=M"]
    lines += ["1.,"] if mesh.dim == 2 and not case.element.startswith("CAX") else []
    lines += [f"*BOUNDARY\nHELD, 1, {mesh.dim}"]
    for along, across in case.steps:
        lines += [
            "*STEP, INC=1000" + (", NLGEOM" if case.rubber else ""),
            f"*STATIC{'' if case.rubber else ', DIRECT'}\n{1 / case.increments:g}, 1.",
        ]
        lines += [
            f"*BOUNDARY\nEND, 1, 1, {along:g}\nEND, 2, 2, {across:g}",
            *(["END, 3, 3, 0."] if mesh.dim == 3 else []),
        ]
        own = ", OUTPUT=2D" if mesh.dim == 2 else ""
        lines += [f"*CONTROLS, PARAMETERS=FIELD\n1.e-7, 1.e-5\n*NODE FILE, FREQUENCY=999999{own}\nU\n*END STEP"]
    return "\n".join(lines) + "\n"


def _wrapped(row: str) -> str:
    """Sixteen numbers a line."""
    numbers = row.split(", ")
    return ",\n".join(", ".join(numbers[i : i + 16]) for i in range(0, len(numbers), 16))


@dataclass(frozen=True)
class Compared:
    """difference: largest of all nodes and steps, over the largest displacement of its step; nodes: how many were
    compared."""

    case: Case
    difference: float
    nodes: int
    reason: str = ""


def compared(case: Case, folder: Path, limit: float = 300.0) -> Compared:
    """Both on the same file, as it is."""
    path = folder / f"{case.name}.inp"
    path.write_text(deck(case), encoding="ascii")
    model, at, nodes, _ = model_of(path, large=True)
    ours, theirs = solved(model, at, nodes), run(read(path), limit)
    assert largest(ours) > 0.0
    return Compared(case, difference(theirs, ours), len(ours[-1].keys() & theirs[-1].keys()))


def line(found: Compared) -> str:
    """In words."""
    return f"{found.case.name:36} {found.difference:10.2e}  {found.nodes} nodes {found.reason}"


def all_of(names: Sequence[str], folder: Path) -> list[Compared]:
    """Cases by name, or all of them; those that one of the two does not solve with the reason."""
    result = []
    for case in cases():
        if names and case.name not in names:
            continue
        try:
            result.append(compared(case, folder))
        except Exception as reason:
            result.append(Compared(case, float("nan"), 0, f"{type(reason).__name__}: {reason}"[:150]))
        print(line(result[-1]), flush=True)
    return result


def table(found: Sequence[Compared]) -> str:
    """Laws by element and path, in Markdown: the largest difference in percent."""
    ways = list(dict.fromkeys((x.case.element, x.case.path) for x in found))
    rows = [["law", *(f"{element}, {path}" for element, path in ways)], ["---"] * (len(ways) + 1)]
    for law in dict.fromkeys(x.case.law for x in found):
        own = {(x.case.element, x.case.path): x for x in found if x.case.law == law}
        rows.append([law, *(_percent(own[way]) if way in own else "" for way in ways)])
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def _percent(found: Compared) -> str:
    return "no result" if np.isnan(found.difference) else f"{100.0 * found.difference:.2g} %"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--keep", type=Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        kept = arguments.keep or Path(folder)
        kept.mkdir(parents=True, exist_ok=True)
        found = all_of(arguments.names, kept)
    print(table(found))
    within = sum(x.difference <= 0.01 for x in found)
    print(f"{len(found)} decks, {within} within 1 %")


if __name__ == "__main__":
    main()
