"""Models with fields beside displacements, for tests/mpi/agree.py."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

YOUNG, ALPHA, HOT, LENGTH, CONDUCTIVITY = 200e3, 1e-3, 80.0, 5.0, 0.04
GAP = ALPHA * HOT * LENGTH / 8.0  # half of what half the heat closes


def heated(kinematics: str) -> Any:
    """A bar that is heated in two steps until it presses a cold block, held across: temperatures at nodes, coupled."""
    import numpy as np

    import abut
    from abut.mesh.make import join, rectangle
    from models.conduction import Conduction

    sides = {
        "bar": rectangle((0.0, LENGTH), (0.0, 1.0), (6, 2), "quad8"),
        "block": rectangle((LENGTH + GAP, 2.0 * LENGTH + GAP), (0.0, 1.0), (4, 3), "quad4"),
    }
    mesh = join(sides)
    mesh = replace(mesh, node_sets={"all": np.arange(len(mesh.points))})
    cold = [(on, 0.0, None) for on in ("bar.left", "block.left", "block.right")]
    steel = abut.LinearElastic(YOUNG, 0.0, expansion=ALPHA)
    return abut.Model(
        mesh,
        [abut.Solid(body, steel) for body in mesh.bodies],
        [abut.Support("all", y=0.0), abut.Support("bar.left", x=0.0), abut.Support("block.right", x=0.0)],
        contacts=[abut.Contact(contactor="bar.right", target="block.left")],
        plane="strain",
        kinematics=kinematics,
        solve=abut.SolveOptions(steps=2),
        physics=[Conduction(CONDUCTIVITY, (("bar.right", HOT, None), *cold))],
    )


def bent() -> Any:
    """A cantilever of quad4 with incompatible modes: unknowns of cells, whose processes have them."""
    import abut
    from abut.mesh.make import join, rectangle
    from models.incompatible import IncompatibleModes

    steel = abut.LinearElastic(YOUNG, 0.0)
    return abut.Model(
        join({"beam": rectangle((0.0, 10.0), (0.0, 1.0), (10, 2), "quad4")}),
        [abut.Solid("beam", steel, integration="full")],
        [abut.Support("beam.left", x=0.0, y=0.0)],
        [abut.Traction("beam.right", (0.0, 1.0))],
        plane="stress",
        physics=[IncompatibleModes(steel)],
    )


def joined(name: str) -> Any:
    """A benchmark of connectors, whose forces are unknowns of no place."""
    from abut.benchmarks import BENCHMARKS

    return BENCHMARKS[name].model(0)


MODELS: dict[str, Callable[[], Any]] = {
    "heated": partial(heated, "small"),
    "heated-moving": partial(heated, "small-strain"),
    "bent": bent,
    **{name: partial(joined, name) for name in ("hinged-lever", "slider-crank", "hinged-beams")},
}
