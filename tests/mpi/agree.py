"""Run under mpiexec: solve models by one process's own solvers and by all processes, and print how far they differ.

mpiexec -n N python tests/mpi/agree.py CASE,CASE,... [OPTION OF PETSC ...]
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

EXAMPLES = Path(__file__).parents[2] / "examples"
sys.path[:0] = [str(Path(__file__).parents[1]), str(Path(__file__).parent), str(EXAMPLES / "own-material")]

from abut.parallel.team import Team, lead  # noqa: E402

Cells = tuple[tuple[int, ...], tuple[int, ...]]


def patch(lower: str, upper: str, cells: Cells = ((3, 3, 3), (4, 4, 3)), **contact: Any) -> Any:
    """Two blocks in a general position, or in the plane, under pressure."""
    from models.patch import model, two_blocks

    return model(two_blocks(lower, upper, cells), **contact)


def press(n: int = 4, cell: str = "hex8", height: float = 1.0, **options: Any) -> Any:
    """A narrow block pressed askew into a wide one in two steps, heated and heavy: contact opens and closes."""
    import abut
    from abut.mesh.make import box, join

    mesh = join(
        {
            "wide": box([0, 1], [0, 1], [0, height], cells=[n + 1, n + 1, round(n * height)], cell=cell),
            "punch": box([0.3, 1.2], [0, 1], [height, 2 * height], cells=[n, n, round(n * height)], cell=cell),
        }
    )
    soft = abut.LinearElastic(1.0, 0.3, density=1e-4, expansion=1e-4)
    return abut.Model(
        mesh,
        [abut.Solid("wide", soft, temperature=3.0), abut.Solid("punch", abut.LinearElastic(10.0, 0.2))],
        supports=[
            abut.Support("wide.bottom", x=0.0, y=0.0, z=0.0),
            abut.Support("punch.top", x=0.0, y=0.0, z=lambda x: -0.02 + 0.04 * (x[:, 0] - 0.3)),
        ],
        loads=[abut.Gravity((0.0, 0.0, -9.81), on="wide"), abut.Temperature("wide", lambda x: 2.0 * x[:, 0])],
        contacts=[abut.Contact(contactor="wide.top", target="punch.bottom", **options)],
        solve=abut.SolveOptions(steps=2),
    )


def swinging(kinematics: str) -> Any:
    """A heavy surface that swings under forces that act from the start on, and comes into contact: terms with rates."""
    import abut
    from abut.mesh.make import join, rectangle
    from abut.model.rates import Newmark
    from models.inertia import Inertia

    mesh = join(
        {
            "beam": rectangle((0.0, 8.0), (0.2, 1.2), (16, 2), "quad4"),
            "stop": rectangle((5.0, 9.0), (-1.0, 0.0), (7, 2), "quad4"),
        }
    )
    at_once = abut.Amplitude(((0.0, 1.0), (1.0, 1.0)))
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(2000.0, 0.3)) for body in ("beam", "stop")],
        [abut.Support(where, x=0.0, y=0.0) for where in ("beam.left", "stop.bottom")],
        [abut.Traction("beam.right", (0.0, -2.0), amplitude=at_once)],
        contacts=[abut.Contact(contactor="beam.bottom", target="stop.top")],
        plane="strain",
        kinematics=kinematics,
        solve=abut.SolveOptions(steps=6),
        physics=[Inertia("beam.right", 0.7, 0.1), Newmark(3.0)],
    )


def alone() -> Any:
    """A block under its own weight, without any contact."""
    import abut
    from abut.mesh.make import box

    return abut.Model(
        box(cells=[6, 5, 4], cell="hex8"),
        [abut.Solid("body", abut.LinearElastic(1.0, 0.3, density=1.0))],
        [abut.Support("bottom", x=0.0, y=0.0, z=0.0)],
        [abut.Gravity((0.3, 0.0, -1.0))],
    )


def rigid() -> Any:
    """A rigid tool, held in part by an equation that couples it with a node of the block."""
    import abut
    from models.rigid import pressed

    model = pressed(x=0.0, y=-0.01)
    near = model.mesh.nodes_of("block.top")[:2]
    couple = abut.Equation((abut.Term(int(near[0]), "y", 1.0), abut.Term(int(near[1]), "y", -1.0)))
    return replace(model, equations=[couple])


def ball() -> Any:
    """A quarter of a ball on a quarter of a block, cells graded toward the contact: as in the benchmarks of time."""
    sys.path.insert(0, str(EXAMPLES.parent / "bench" / "contact"))
    import cases

    return cases.model("hertz-hex8", 20_000)


def lifted() -> Any:
    """A beam lifted off its floor, whose active set only interior points find soon."""
    from models.search import beam

    return beam(50, "quad4")


def loose() -> Any:
    """A pin between two lugs, of which contact alone holds two."""
    from models.search import pin

    return pin(17, 0.05, 0.03)


def clevis() -> Any:
    """A pin in eye and fork: one surface in two contacts, one of them with a list of bodies."""
    import abut
    from models.clevis import clevis as model

    built = model(
        abut.Contact(contactor="pin.round", target="eye", name="eye"),
        abut.Contact(contactor="pin", target=["arm1", "arm2"], name="arms"),
    )
    return replace(built, supports=[*built.supports, abut.Support("pin.top", x=0.01, y=0, z=0)])


def rubbed(n: int = 4) -> Any:
    """Friction in space: a block moved to and fro on another one, where some of it opens, sticks and slips."""
    from models.friction import rubbed as model

    return model(n)


def pushed() -> Any:
    """Friction in the plane, to and fro."""
    from models.friction import pushed as model

    return model()


def example(path: str) -> Any:
    """Of the examples."""
    from abut.job import load_job

    return load_job(EXAMPLES / path).model


def finite(name: str) -> Any:
    """With finite kinematics."""
    from finite_models import MODELS

    return MODELS[name]()


def metal(kinematics: str = "small") -> Any:
    """A block of metal that yields under a punch, which is then let go in part."""
    import abut
    from abut.mesh.make import box, join

    mesh = join(
        {
            "block": box([0, 2], [0, 1], [0, 1], cells=[4, 3, 3], cell="hex8"),
            "punch": box([0.5, 1.2], [0, 1], [1, 1.5], cells=[3, 2, 1], cell="hex8"),
        }
    )
    law = abut.Plastic(1.0, 0.3, 0.005, 0.05, backstresses=[(0.02, 0.0)])
    course = abut.Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, 0.95)))
    return abut.Model(
        mesh,
        [abut.Solid("block", law), abut.Solid("punch", abut.LinearElastic(10.0, 0.2))],
        [
            abut.Support("block.bottom", x=0.0, y=0.0, z=0.0),
            abut.Support("punch.top", x=0.0, y=0.0, z=-0.02, amplitude=course),
        ],
        contacts=[abut.Contact(contactor="punch.bottom", target="block.top")],
        solve=abut.SolveOptions(steps=4),
        kinematics=kinematics,
    )


def volumes(kinematics: str = "small", law: Any = None) -> Any:
    """The same of mixed tet10 cells, whose pressures belong to corners that processes share; two bodies that stick."""
    import abut
    from abut.mesh.make import box, join

    mesh = join(
        {
            "block": box([0, 2], [0, 1], [0, 1], cells=[3, 2, 2], cell="tet10"),
            "punch": box([0.5, 1.2], [0, 1], [1, 1.5], cells=[2, 2, 1], cell="tet10"),
        }
    )
    soft = law or abut.Plastic(1.0, 0.3, 0.005, 0.05)
    return abut.Model(
        mesh,
        [
            abut.Solid("block", soft, integration="mixed"),
            abut.Solid("punch", abut.Hencky(10.0, 0.49), integration="mixed")
            if kinematics == "finite"
            else abut.Solid("punch", abut.LinearElastic(10.0, 0.49), integration="mixed"),
        ],
        [abut.Support("block.bottom", x=0.0, y=0.0, z=0.0), abut.Support("punch.top", x=0.0, y=0.0, z=-0.02)],
        contacts=[abut.Contact(contactor="block.top", target="punch.bottom", friction=0.3)],
        solve=abut.SolveOptions(steps=2),
        kinematics=kinematics,
    )


def rubber_volumes() -> Any:
    """Mixed tet10 cells of rubber that hardly changes its volume."""
    import abut

    return volumes("finite", abut.MooneyRivlin(c10=0.12, c01=0.05, bulk=100.0))


def softening() -> Any:
    """The example of a user's own material with a history under finite strains."""
    import softening_rubber

    return softening_rubber.model(softening_rubber.SofteningRubber(1.0, 20.0))


def fields(name: str) -> Any:
    """With fields beside displacements."""
    from field_models import MODELS

    return MODELS[name]()


CASES: dict[str, Callable[[], Any]] = {
    "hex8": lambda: patch("hex8", "hex8"),
    "tet10-hex20": lambda: patch("tet10", "hex20"),
    "wedge6-tet4": lambda: patch("wedge6", "tet4"),
    "hex27-wedge15": lambda: patch("hex27", "wedge15", ((2, 2, 2), (3, 3, 2))),
    "plane": lambda: patch("quad8", "tri6", ((4, 3), (5, 4))),
    "tied": lambda: patch("hex8", "tet4", kind="tied"),
    "smooth": lambda: patch("hex8", "hex8", law="constraint-function"),
    "node-to-segment": lambda: patch("hex8", "hex8", method="node-to-segment"),
    "one-cell": lambda: patch("hex8", "hex8", ((1, 1, 1), (6, 6, 6))),
    "two-cells": lambda: patch("hex8", "hex8", ((1, 1, 1), (1, 1, 1))),
    "press": press,
    "press-smooth": lambda: press(law="constraint-function"),
    "rubbed-smooth": lambda: replace(
        rubbed(), contacts=[replace(c, law="constraint-function") for c in rubbed().contacts]
    ),
    "press-tet10": lambda: press(3, "tet10"),
    "tower": lambda: press(3, height=4.0),
    "larger": lambda: press(11),
    "alone": alone,
    "rigid": rigid,
    "clevis": clevis,
    "rubbed": rubbed,
    "pushed": pushed,
    "two-rings": lambda: example("two-rings/job.toml"),
    "hertz-line": lambda: example("hertz-line/quad8.toml"),
    "ball": ball,
    "lifted": lifted,
    "loose": loose,
    "metal": metal,
    "metal-finite": lambda: metal("finite"),
    "softening": softening,
    "swinging": lambda: swinging("small"),
    "swinging-finite": lambda: swinging("finite"),
    "volumes": volumes,
    "volumes-finite": lambda: volumes("finite"),
    "volumes-rubber": rubber_volumes,
    "pin-lug": lambda: example("pin-lug/job.toml"),
    **{
        name: partial(fields, name)
        for name in ("heated", "heated-moving", "bent", "hinged-lever", "slider-crank", "hinged-beams")
    },
    **{
        name: partial(finite, name)
        for name in ("beam", "folds", "jaws", "slid", "linear", "cushion", "punch", "pad", "turned")
    },
}


def compare(name: str, team: Team) -> dict[str, Any]:
    """Largest differences of displacement, pressure, stress, reactions and what is remembered, with friction of traction and
    slip too, each over the largest value."""
    import numpy as np

    import abut

    model = CASES[name]()
    one = abut.solve(replace(model, solve=replace(model.solve, linear="direct")))
    many = abut.solve(replace(model, solve=replace(model.solve, linear="petsc")), team=team)

    def far(a: Any, b: Any) -> float:
        return float(np.nanmax(np.abs(np.asarray(a) - b)) / max(np.nanmax(np.abs(a)), 1e-300))

    worst: dict[str, float] = {"displacement": 0.0, "pressure": 0.0, "stress": 0.0, "reaction": 0.0}
    rubbing = [c for step in one.steps for c in step.contacts if c.friction is not None]
    largest = {c.name: 0.0 for c in rubbing}  # slip, of all steps: where all sticks it is rounding
    for c in rubbing:
        largest[c.name] = max(largest[c.name], float(np.nanmax(np.abs(c.friction.total_slip))))
    for p, q in zip(one.steps, many.steps, strict=True):
        assert abs(p.factor - q.factor) < 1e-12
        on = list(p.reactions)
        pairs = {
            "displacement": (p.displacement, q.displacement),
            "stress": (p.stress, q.stress),
            "reaction": ([p.reactions[s] for s in on] or [0.0], [q.reactions[s] for s in on] or [0.0]),
        }
        for what, (a, b) in pairs.items():
            worst[what] = max(worst[what], far(a, b))
        for field, values in p.remembered.items():
            worst["remembered"] = max(worst.get("remembered", 0.0), far(values, q.remembered[field]))
        for c, d in zip(p.contacts, q.contacts, strict=True):
            worst["pressure"] = max(worst["pressure"], far(c.pressure, d.pressure))
            assert [check.passed for check in c.checks] == [check.passed for check in d.checks]
            told = f"{name} at {p.factor}: {c.segments, c.active} and {d.segments, d.active} segments and closed nodes"
            # Where nodes of both surfaces lie on each other rounding decides whether there is a sliver between them.
            assert abs(c.segments - d.segments) <= 0.02 * c.segments + 2, told
            # At the edge of contact a node whose pressure is rounding counts as open or closed.
            doubtful = np.count_nonzero(np.abs(c.pressure) < 1e-6 * np.nanmax(np.abs(c.pressure)))
            assert abs(c.active - d.active) <= min(doubtful, 2), told
            if c.friction is not None:
                assert np.array_equal(c.friction.status, d.friction.status)
                worst["traction"] = max(worst.get("traction", 0.0), far(c.friction.traction, d.friction.traction))
                slid = float(np.nanmax(np.abs(c.friction.total_slip - d.friction.total_slip)))
                worst["slip"] = max(worst.get("slip", 0.0), slid / largest[c.name])
    owner = team.store["owner"]
    sides = [[np.bincount(owner[s.cells], minlength=team.size).tolist() for s in (c.contactor, c.target)]
             for c in many.contacts]  # fmt: skip
    return {
        "case": name,
        **worst,
        "converged": many.converged,
        "solutions": [len(step.iterations) for step in many.steps],
        "alone": [len(step.iterations) for step in one.steps],
        "solver": many.solver,
        "note": many.notes[-1],
        "cells": np.bincount(owner, minlength=team.size).tolist(),
        "facets": sides,
    }


def run(team: Team) -> int:
    """Print a line of JSON for each case."""
    for name in sys.argv[1].split(","):
        print(json.dumps(compare(name, team)), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(lead(run, sys.argv[2:]))
