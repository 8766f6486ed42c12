"""The crushed half ring for CalculiX: one layer of C3D20 held in z, whose two faces move alike. Units: mm, MPa."""

from __future__ import annotations

import contextlib
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import abut
from abut.benchmarks.finite_contact import DEPTH

MM, MPA, THICK = 1e3, 1e-6, 5.0
STIFFNESS, SLOPE = (
    1e4,
    1e4,
)  # of penalty and stick, MPa/mm: 200 MPa press in 0.02
SMALLEST = 1e-7  # step, of 1

Cells = dict[str, NDArray[np.int64]]


def path(model: abut.Model, steps: int, folder: Path, seconds: float) -> NDArray[np.float64]:
    """Time and rise of the middle (mm) at the end of each increment, (n, 2), as far as CalculiX comes in ``seconds``."""
    (folder / "ring.inp").write_text(deck(model, 1.0 / steps), encoding="ascii")
    one = {**os.environ, "OMP_NUM_THREADS": "1"}
    with contextlib.suppress(subprocess.TimeoutExpired):
        subprocess.run(["ccx", "-i", "ring"], cwd=folder, env=one, capture_output=True, check=False, timeout=seconds)
    lines = (folder / "ring.dat").read_text(encoding="ascii").splitlines()
    rows = [line.split() for line in lines if line.strip()]
    return np.array([(float(head[-1]), float(row[2])) for head, row in zip(rows[::2], rows[1::2])])


def deck(model: abut.Model, step: float) -> str:
    """The whole input; ``step``: the longest, of 1. ``NeoHooke`` with volumetric "isochoric" is CalculiX's."""
    mesh, n, contact = model.mesh, len(model.mesh.points), model.contacts[0]
    cells = _layer(model)
    corners = np.unique(np.concatenate([rows[:, :4].ravel() for rows in cells.values()]))
    numbers = [*range(n), *range(n, 2 * n), *(corners + 2 * n)]
    heights = np.repeat([0.0, THICK, 0.5 * THICK], n)
    points = np.column_stack([np.tile(mesh.points * MM, (3, 1)), heights])
    lines = ["*NODE,NSET=ALL", *(f"{i + 1},{','.join(f'{v:.12g}' for v in points[i])}" for i in numbers)]
    lines += [*_elements(cells), *_surfaces(model, cells), *_laws(model)]
    lines += ["*CONTACT PAIR,INTERACTION=TOUCH,TYPE=SURFACE TO SURFACE", "CONTACTOR,TARGET"]
    lines += ["*SURFACE INTERACTION,NAME=TOUCH", "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR", f"{STIFFNESS:g}"]
    lines += ["*FRICTION", f"{contact.friction},{SLOPE:g}"] if contact.friction else []
    bottom, *ends = (mesh.nodes_of(support.on) for support in model.supports)
    held = {"BOTTOM": bottom, "ENDS": np.unique(np.concatenate(ends))}
    for name, nodes in held.items():
        lines += [f"*NSET,NSET={name}", *(str(i + 1) for i in numbers if i % n in set(nodes.tolist()))]
    lines += ["*NSET,NSET=MIDDLE", str(middle(mesh) + 1)]
    fixed = set(np.concatenate(list(held.values())).tolist())
    for i in numbers[n:]:
        if i % n not in fixed:
            lines += [f"*EQUATION\n2\n{i + 1},{axis},1.,{i % n + 1},{axis},-1." for axis in (1, 2)]
    lines += ["*BOUNDARY", "ALL,3,3", "BOTTOM,1,2", "ENDS,1,1", "*STEP,NLGEOM,INC=100000"]
    lines += ["*STATIC", f"{step:g},1.,{SMALLEST:g},{step:g}", "*BOUNDARY", f"ENDS,2,2,{-DEPTH * MM}"]
    return "\n".join([*lines, "*NODE PRINT,NSET=MIDDLE", "U", "*END STEP"]) + "\n"


def middle(mesh: abut.Mesh) -> int:
    """The node of the ring that is nearest to the block at the outset."""
    nodes = mesh.nodes_of("ring.outer")
    return int(nodes[np.argmin(mesh.points[nodes, 1])])


def _layer(model: abut.Model) -> Cells:
    """By body the nodes of its C3D20, (m, 20): at z = 0, at THICK, and corners between."""
    n, cells = len(model.mesh.points), {}
    for solid in model.solids:
        _, low, _ = next(iter(model.mesh.cells_of(solid.body)))
        corners, sides = low[:, :4], low[:, 4:]
        cells[solid.body] = np.hstack([corners, corners + n, sides, sides + n, corners + 2 * n])
    return cells


def _elements(cells: Cells) -> Iterator[str]:
    number = 0
    for body, rows in cells.items():
        yield f"*ELEMENT,TYPE=C3D20,ELSET={body.upper()}"
        for row in rows + 1:
            number += 1
            yield f"{number},{','.join(map(str, row[:15]))},\n{','.join(map(str, row[15:]))}"


def _surfaces(model: abut.Model, cells: Cells) -> Iterator[str]:
    """Faces S3 to S6 are those on the edges of the quadrilateral at z = 0."""
    rows, contact = np.concatenate(list(cells.values()))[:, :4], model.contacts[0]
    edges = {frozenset((row[i], row[i - 3])): (e, i + 3) for e, row in enumerate(rows.tolist(), 1) for i in range(4)}
    for name, surface in (("CONTACTOR", contact.contactor), ("TARGET", contact.target)):
        yield f"*SURFACE,NAME={name},TYPE=ELEMENT"
        for facet in model.mesh.surface(surface).nodes[:, :2].tolist():
            yield "{},S{}".format(*edges[frozenset(facet)])


def _laws(model: abut.Model) -> Iterator[str]:
    for solid in model.solids:
        lame, shear = (MPA * modulus for modulus in solid.material.moduli)
        name = solid.body.upper()
        yield f"*MATERIAL,NAME={name}\n*HYPERELASTIC,NEO HOOKE\n{0.5 * shear:.12g},{2.0 / (lame + 2.0 * shear / 3.0):.12g}"
        yield f"*SOLID SECTION,ELSET={name},MATERIAL={name}"
