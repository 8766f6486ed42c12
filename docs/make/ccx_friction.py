"""A hub turned on a shaft by abut and by CalculiX, on one mesh: table of docs/verification/methods.md.

python docs/make/ccx_friction.py [--page] (about two minutes of CalculiX; apt install calculix-ccx). The hub and shaft of
examples/twisted-hub without the flange: the nodes of the hub's upper end beyond a radius of 22 are turned instead.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import abut
from abut.mesh import make
from page import DOCS, write_table

PAGE = DOCS / "verification" / "methods.md"
HEADER = ["angle", "abut, N m", "2 pi r^2 L mu p, N m", "CalculiX, N m"]
FIT, FRICTION, TURN, RADIUS, LENGTH = 0.004, 0.15, 0.003, 10.0, 20.0
STEPS = 4  # of the turn, after one of the fit
STIFFNESS, SLOPE = 1e7, 1e6  # of CalculiX's penalty and stick: 39 MPa press in 4e-6, a thousandth of the fit
FACES = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))  # S1 to S6 of C3D20
BODIES, SIDES = ("shaft", "hub"), {"BORE": "hub.inner", "ROUND": "shaft.round"}


def hub_on_shaft() -> abut.Mesh:
    """Both bodies, and the node set ``grip`` that is turned."""
    shaft = make.cylinder(RADIUS, [0, 45], cells=(1, 32, 10), inner=4.0)
    hub = make.cylinder(30.0, [15, 15 + LENGTH], cells=(2, 32, 6), inner=RADIUS)
    mesh = make.join({"shaft": shaft, "hub": hub})
    top = mesh.nodes_of("hub.top")
    grip = top[np.hypot(*mesh.points[top, :2].T) > 22.0]
    return replace(mesh, node_sets={**mesh.node_sets, "grip": grip})


def turned(mesh: abut.Mesh) -> abut.Solution:
    """abut's solution: the fit, then the turn in steps."""
    fit, turn = abut.Amplitude([(0, 0), (0.5, 1)]), abut.Amplitude([(0.5, 0), (1, 1)])
    steel = abut.LinearElastic(210e3, 0.3)
    return abut.solve(
        abut.Model(
            mesh,
            [abut.Solid(body, steel) for body in BODIES],
            [
                abut.Support("shaft.bottom", x=0, y=0, z=0),
                abut.Support("grip", z=0),
                abut.Support("grip", x=lambda x: -TURN * x[:, 1], amplitude=turn),
                abut.Support("grip", y=lambda x: TURN * x[:, 0], amplitude=turn),
            ],
            contacts=[
                abut.Contact(contactor="hub.inner", target="shaft.round", friction=FRICTION, offset=-FIT, amplitude=fit)
            ],
            solve=abut.SolveOptions(times=[0.5, *np.linspace(0.5, 1.0, STEPS + 1)[1:].tolist()]),
        )
    )


def by_abut() -> list[list[str]]:
    """Angle, torque, and the torque by Coulomb's law for the mean pressure, of every step of the turn."""
    rows = []
    for step in turned(hub_on_shaft()).steps[1:]:
        contact = step.contacts[0]
        law = 2.0 * np.pi * RADIUS**2 * LENGTH * FRICTION * contact.statistics.mean
        rows.append(
            [f"{TURN * (2.0 * step.factor - 1.0):.5f}", f"{-contact.resultant.moment[2] / 1e3:.2f}", f"{law / 1e3:.2f}"]
        )
    return rows


def deck(mesh: abut.Mesh) -> str:
    """The same for CalculiX: surface to surface contact with penalty, the interference built into the shaft."""
    points = mesh.points.copy()
    points[mesh.nodes_of("shaft.round"), :2] *= 1.0 + FIT / RADIUS
    lines = ["*NODE,NSET=ALL", *(f"{i},{x:.12g},{y:.12g},{z:.12g}" for i, (x, y, z) in enumerate(points, 1))]
    cells: dict[int, tuple[int, NDArray[np.int64]]] = {}
    for body in BODIES:
        lines.append(f"*ELEMENT,TYPE=C3D20,ELSET={body.upper()}")
        for _, nodes, numbers in mesh.cells_of(body):
            for cell, own in zip(numbers, nodes):
                cells[int(cell)] = (len(cells) + 1, own)
                text = [str(v) for v in (len(cells), *(own + 1))]
                lines += [",".join(text[:16]) + ",", ",".join(text[16:])]
    for name, surface in SIDES.items():
        side = mesh.surface(surface)
        lines.append(f"*SURFACE,NAME={name},TYPE=ELEMENT")
        for cell, facet in zip(side.cells, side.nodes):
            number, own = cells[int(cell)]
            face = next(i for i, f in enumerate(FACES, 1) if set(own[list(f)]) == set(facet[:4]))
            lines.append(f"{number},S{face}")
    lines += ["*MATERIAL,NAME=STEEL", "*ELASTIC", "210000,0.3"]
    lines += [f"*SOLID SECTION,ELSET={body.upper()},MATERIAL=STEEL" for body in BODIES]
    lines += ["*CONTACT PAIR,INTERACTION=FIT,TYPE=SURFACE TO SURFACE", "BORE,ROUND", "*SURFACE INTERACTION,NAME=FIT"]
    lines += ["*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR", f"{STIFFNESS:g}", "*FRICTION", f"{FRICTION},{SLOPE:g}"]
    for name, nodes in (("BOTTOM", mesh.nodes_of("shaft.bottom")), ("GRIP", mesh.node_sets["grip"])):
        lines += [f"*NSET,NSET={name}", *(str(n + 1) for n in nodes)]
    lines += ["*BOUNDARY", "BOTTOM,1,3", "GRIP,3,3"]
    for angle, steps in ((0.0, 1), (TURN, STEPS)):
        lines += ["*STEP,INC=1000", "*STATIC,DIRECT", f"{1.0 / steps:g},1.", "*BOUNDARY"]
        for n in mesh.node_sets["grip"]:
            x, y = mesh.points[n, :2]
            lines += [f"{n + 1},1,1,{-angle * y:.12g}", f"{n + 1},2,2,{angle * x:.12g}"]
        lines += ["*NODE PRINT,NSET=GRIP", "RF", "*END STEP"]
    return "\n".join(lines) + "\n"


def by_calculix(mesh: abut.Mesh) -> list[float]:
    """The torque on the grip at the end of every step of the turn. Raises SystemExit where CalculiX fails."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "hub.inp").write_text(deck(mesh), encoding="utf-8")
        one = {**os.environ, "OMP_NUM_THREADS": "1"}
        done = subprocess.run(["ccx", "-i", "hub"], cwd=folder, env=one, capture_output=True, text=True, check=False)
        if "Job finished" not in done.stdout:
            raise SystemExit(done.stdout[-2000:])
        torques: list[float] = []
        for line in (Path(folder) / "hub.dat").read_text(encoding="utf-8").splitlines():
            if "forces" in line:
                torques.append(0.0)
            elif line.split():
                node, *force = line.split()
                x, y = mesh.points[int(node) - 1, :2]
                torques[-1] += x * float(force[1]) - y * float(force[0])
    return torques[1:]


def main() -> None:
    own, other = by_abut(), by_calculix(hub_on_shaft())
    rows = [[*row, f"{torque / 1e3:.2f}"] for row, torque in zip(own, other)]
    for row in rows:
        print("  ".join(row))
    if "--page" in sys.argv:
        write_table(PAGE, "friction", HEADER, rows)


if __name__ == "__main__":
    main()
