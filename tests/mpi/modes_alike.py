"""Run under mpiexec: frequencies and buckling loads by one process's own solvers and by all processes, compared.

mpiexec -n N python tests/mpi/modes_alike.py CASE,CASE,...
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

sys.path[:0] = [str(Path(__file__).parents[1])]

from abut.parallel.team import Team, lead  # noqa: E402

YOUNG, DENSITY, LENGTH, HEIGHT = 210e3, 7.85e-9, 200.0, 5.0  # N, mm, s


def stacked(kind: str, kinematics: str = "small", held: bool = True, **more: Any) -> Any:
    """Two plates on each other, held at one end or free."""
    import abut
    from abut.mesh import make

    steel = abut.LinearElastic(YOUNG, 0.0, density=DENSITY)
    plates = {
        "lower": make.rectangle([0, LENGTH], [0, HEIGHT], cells=[40, 2]),
        "upper": make.rectangle([0, LENGTH], [HEIGHT, 2 * HEIGHT], cells=[58, 2]),
    }
    ends = [abut.Support("lower.left", x=0, y=0), abut.Support("upper.left", x=0, y=0)] if held else []
    given = {"modes": [abut.Frequencies(4)], **more}
    return abut.Model(
        make.join(plates), plane="stress", kinematics=kinematics,
        solids=[abut.Solid("lower", steel), abut.Solid("upper", steel)],
        supports=ends, contacts=[abut.Contact("upper.bottom", "lower.top", kind=kind)], **given,
    )  # fmt: skip


def columns() -> Any:
    """Bonded, under forces along them, which make both buckle as one."""
    import abut

    pushed = [abut.Traction(f"{body}.right", (-1.0, 0)) for body in ("lower", "upper")]
    return stacked("tied", loads=pushed, modes=[abut.Buckling(2)])


def pressed(**more: Any) -> Any:
    """Blocks with friction, pressed together and sheared, so that some of the interface sticks and some slips, in space."""
    import abut
    from models.friction import rubbed

    model = rubbed(4)
    heavy = [replace(s, material=replace(s.material, density=1.0)) for s in model.solids]
    return replace(model, solids=heavy, modes=[abut.Frequencies(6)], **more)


def tool() -> Any:
    """A rigid tool on a block, held in part by an equation: unknowns that couple points of several parts."""
    import abut
    from models.rigid import pressed as model

    made = model(x=0.0, y=-0.01)
    heavy = [replace(s, material=replace(s.material, density=1.0)) for s in made.solids]
    near = made.mesh.nodes_of("block.top")[:2]
    couple = abut.Equation((abut.Term(int(near[0]), "y", 1.0), abut.Term(int(near[1]), "y", -1.0)))
    return replace(made, solids=heavy, equations=[couple], modes=[abut.Frequencies(5)])


def spinning() -> Any:
    """A beam that turns about an axis, and is shaken."""
    import abut
    from abut.mesh import make

    steel = abut.LinearElastic(YOUNG, 0.3, density=DENSITY)
    tip = abut.Traction("blade.right", (0.0, 1.0))
    return abut.Model(
        make.join({"blade": make.rectangle([50, 50 + LENGTH], [-10, 10], cells=[20, 3], cell="quad8")}),
        plane="stress", solids=[abut.Solid("blade", steel)], supports=[abut.Support("blade.left", x=0, y=0)],
        loads=[abut.Centrifugal(300.0)],
        modes=[abut.Frequencies(4), abut.Harmonic((100.0, 1000.0), loads=[tip], damping=0.02)],
    )  # fmt: skip


CASES: dict[str, Callable[[], Any]] = {
    "bonded": lambda: stacked("tied"),
    "sliding": lambda: stacked("contact"),
    "sliding-finite": lambda: stacked("contact", "finite"),
    "free": lambda: stacked("tied", held=False),
    "columns": columns,
    "pressed": pressed,
    "tool": tool,
    "spinning": spinning,
}


def compare(name: str, team: Team) -> dict[str, Any]:
    """Largest differences of what both find, over the largest value of each kind, and what the certificate says."""
    import numpy as np

    import abut

    model = CASES[name]()
    one = abut.solve(replace(model, solve=replace(model.solve, linear="direct")))
    many = abut.solve(replace(model, solve=replace(model.solve, linear="petsc")), team=team)
    a, b = one.modes[0], many.modes[0]

    def far(x: Any, y: Any) -> float:
        return float(np.abs(x - y).max(initial=0.0) / max(np.abs(x).max(initial=0.0), 1e-300))

    signs = np.sign(np.einsum("nid,nid->n", a.shapes, b.shapes))[:, None, None]
    moving = a.values != 0.0  # those of a body that is free may be any mixture
    return {
        "case": name,
        "values": b.values.tolist(),
        "far": float(np.abs(b.values / np.where(moving, a.values, 1.0) - moving).max()),
        "shapes": far(a.shapes[moving], (signs * b.shapes)[moving]),
        "effective": far(a.effective.sum(axis=0), b.effective.sum(axis=0)),
        "mass": far(a.mass, b.mass),
        "missing": b.missing,
        "certified": [[check.passed for check in solution.certificate] for solution in (one, many)],
        "largest": [far(x.largest, y.largest) for x, y in zip(one.responses, many.responses)],
    }  # fmt: skip


def counted(team: Team) -> dict[str, Any]:
    """How many frequencies lie below numbers between those that are found, by pivots."""
    import numpy as np

    from abut.analysis.linear_solvers import assembled_bodies
    from abut.modes.frequencies import densities, lowest
    from abut.modes.held import Held
    from abut.modes.together import Together
    from abut.problem.assembly import prescribed
    from abut.problem.clock import Clock

    model, by = replace(stacked("tied"), contacts=[]), Together(team)
    constraints, _ = prescribed(model)
    bodies = assembled_bodies(model, lambda _: None, lambda _: None, Clock(), team)
    stiffness, mass = bodies.reduce(constraints), bodies.mass(densities(model)).reduce(constraints)
    rows = constraints.free[:0]
    held = Held(stiffness, rows, np.zeros(0), False, np.zeros(0, int), by)
    squares = lowest(held, mass, 6).squares
    return {
        "case": "counted",
        "below": [by.factors(stiffness - 1.01 * float(square) * mass, held).negative for square in squares],
        "squares": squares.tolist(),
    }


def run(team: Team) -> int:
    """Print a line of JSON for each case."""
    for name in sys.argv[1].split(","):
        print(json.dumps(counted(team) if name == "counted" else compare(name, team)), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(lead(run, sys.argv[2:]))
