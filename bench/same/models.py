"""Small models at small displacements that both versions solve: every cell, contact, friction, ties, pressure spaces.

python bench/same/models.py GROUP FILE writes displacements, stresses, pressures, gaps, forces, tractions, slips and
iterations of each model of a group as JSON. The file of the working tree serves both versions: it takes only what both have.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import abut
from abut.mesh.make import box, half_disc, join, quarter_disc, rectangle
from abut.mesh.mesh import Mesh

PLANE = ("tri3", "tri6", "quad4", "quad8", "quad9")
SOLID = ("tet4", "tet10", "wedge6", "wedge15", "hex8", "hex20", "hex27")
SPACES = ("P0", "P1", "P1-discontinuous", "P2", "P2-discontinuous", "dual", "dual-P1")
STEEL = abut.LinearElastic(210e3, 0.3)
TILT, DOWN, ALONG = 0.004, 0.004, 0.004  # the upper block is turned by, pressed down by, and drawn along
DOWN_THEN_ALONG = (
    abut.Amplitude(((0.0, 0.0), (0.5, 0.0), (1.0, 1.0))),
    abut.Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, 1.0))),
)
Models = dict[str, abut.Model]


def blocks(cell: str, steps: int = 4, linear: str = "auto", cells: int = 4, **contact: Any) -> abut.Model:
    """A block pressed on another, tilted so that a part of the interface stays open, then drawn along; no nodes match."""
    along, down = DOWN_THEN_ALONG
    few = cells - 1
    if cell in PLANE:
        lower, upper = rectangle(cells=(cells, cells), cell=cell), rectangle((0, 1), (1, 2), (few, few), cell)
        moved = {"x": ALONG, "y": -DOWN}
    else:
        lower, upper = box(cells=(cells,) * 3, cell=cell), box((0, 1), (0, 1), (1, 2), (few,) * 3, cell)
        moved = {"x": ALONG, "y": 0.0, "z": -DOWN}
    fixed = dict.fromkeys(moved, 0.0)
    last = list(moved)[-1]
    aside = {name: value for name, value in moved.items() if name != last}
    return abut.Model(
        join({"lower": lower, "upper": _tilted(upper)}),
        [abut.Solid("lower", STEEL), abut.Solid("upper", STEEL)],
        [
            abut.Support("lower.bottom", **fixed),
            abut.Support("upper.top", **{last: moved[last]}, amplitude=down),
            abut.Support("upper.top", **aside, amplitude=along),
        ],
        contacts=[abut.Contact(contactor="lower.top", target="upper.bottom", **contact)],
        plane="strain" if cell in PLANE else None,
        solve=abut.SolveOptions(steps=steps, linear=linear),
    )


def _tilted(mesh: Mesh) -> Mesh:
    """Turned about the edge of the interface at x = 0, so that it opens toward x = 1."""
    c, s = math.cos(TILT), math.sin(TILT)
    points = mesh.points.copy()
    x, z = mesh.points[:, 0], mesh.points[:, -1] - 1.0
    points[:, 0], points[:, -1] = c * x - s * z, s * x + c * z + 1.0
    return replace(mesh, points=points)


def ball(cell: str, **contact: Any) -> abut.Model:
    """A ball on a block, axisymmetric."""
    round_one = quarter_disc(1.0, (0.0, 1.0), 0.2, 6, cell=cell)
    block = rectangle((0.0, 1.0), (-1.0, 0.0), (5, 5), cell, {"x": (0.0, 0.2), "y": (-0.2, 0.0)})
    return _pressed(join({"block": block, "ball": round_one}), "axisymmetric", **contact)


def cylinder(cell: str, **contact: Any) -> abut.Model:
    """A cylinder on a block, plane strain."""
    block = rectangle((-1.0, 1.0), (-1.0, 0.0), (8, 5), cell, {"x": (-0.2, 0.2), "y": (-0.2, 0.0)})
    return _pressed(join({"block": block, "ball": half_disc(1.0, (0.0, 1.0), 0.2, 8, cell=cell)}), "strain", **contact)


def _pressed(mesh: Mesh, plane: str, **contact: Any) -> abut.Model:
    """A ball or cylinder pressed on a block by its flat side."""
    return abut.Model(
        mesh,
        [abut.Solid("block", STEEL), abut.Solid("ball", STEEL)],
        [
            abut.Support("block.bottom", x=0.0, y=0.0), abut.Support("ball.flat", y=-0.02),
            abut.Support("ball.left" if plane == "axisymmetric" else "ball.axis", x=0.0),
        ],
        contacts=[abut.Contact(contactor="ball.round", target="block.top", **contact)],
        plane=plane,
        solve=abut.SolveOptions(steps=3),
    )  # fmt: skip


def _cells(**contact: Any) -> Models:
    return {cell: blocks(cell, **contact) for cell in (*PLANE, *SOLID)}


def _spaces() -> Models:
    """Discontinuous spaces fail the inf-sup condition: with friction the contact status found in them is not unique."""
    return {
        f"{cell} {space} friction {friction:g}": blocks(cell, pressure=space, friction=friction)
        for cell in ("quad8", "hex8")
        for space in SPACES
        for friction in ((0.0,) if space.endswith("discontinuous") else (0.0, 0.3))
    }


def _round() -> Models:
    makers = {"ball": ball, "cylinder": cylinder}
    return {
        f"{name} {cell} friction {friction:g}": make(cell, friction=friction)
        for name, make in makers.items()
        for cell in ("tri6", "quad4", "quad8")
        for friction in (0.0, 0.3)
    }


def _laws() -> Models:
    law = {f"{cell} constraint function": blocks(cell, law="constraint-function") for cell in ("quad4", "hex8")}
    methods = {f"quad4 {m}": blocks("quad4", method=m) for m in ("node-to-segment", "node-to-segment-two-pass")}
    return law | methods


def _multigrid() -> Models:
    kinds: dict[str, dict[str, Any]] = {"contact": {}, "friction": {"friction": 0.3}, "tie": {"kind": "tied"}}
    return {
        f"{cell} {kind}": blocks(cell, 2, "amg", 6 if cell == "hex8" else 4, **kinds[kind])
        for cell in ("hex8", "hex20", "tet10")
        for kind in kinds
    }


GROUPS: dict[str, Callable[[], Models]] = {
    "contact": _cells, "friction": lambda: _cells(friction=0.3), "rough": lambda: _cells(friction="rough"),
    "ties": lambda: _cells(kind="tied"), "round": _round, "pressure-spaces": _spaces, "laws": _laws,
    "multigrid": _multigrid,
}  # fmt: skip


def numbers(model: abut.Model) -> dict[str, Any]:
    """Of every step."""
    solution = abut.solve(model)
    return {"solver": solution.solver, "steps": [_of_step(step) for step in solution.steps]}


def _of_step(step: Any) -> dict[str, Any]:
    pair = step.contacts[0]
    arrays = {
        "displacement": step.displacement, "stress": step.stress, "reaction": step.reaction, "pressure": pair.pressure,
        "gap": pair.gap, "force": pair.contactor_forces,
    }  # fmt: skip
    if pair.friction is not None:
        arrays |= {"traction": pair.friction.traction, "slip": pair.friction.slip, "status": pair.friction.status}
    return {"iterations": len(step.iterations)} | {name: array.tolist() for name, array in arrays.items()}


def main() -> None:
    group, file = sys.argv[1:]
    found = {}
    for name, model in GROUPS[group]().items():
        try:
            found[name] = numbers(model)
        except abut.AbutError as error:
            found[name] = {"refused": str(error)}
    Path(file).write_text(json.dumps(found), encoding="utf-8")


if __name__ == "__main__":
    main()
