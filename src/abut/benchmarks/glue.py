"""Ties and contacts that act for a part of the time: glue that lets go, and glue that sets."""

from __future__ import annotations

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import box, join
from abut.model import Amplitude, Contact, Model, Solid, SolveOptions, Support
from abut.solution import Solution

YOUNG, WAY, SETS = 1000.0, 0.1, -0.04  # two blocks of 1 x 1 x 1 in a row; how far they are drawn; where glue sets
ROW = "two springs E A / L in a row"
ROUNDING = "exact but for rounding"


def _blocks(contacts: tuple[Contact, ...], way: Amplitude, level: int) -> Model:
    n = 2 ** (level + 1)
    spans, cells = {"low": (0.0, 1.0), "top": (1.0, 2.0)}, {"low": n, "top": n + 1}
    mesh = join({b: box((0.0, 1.0), (0.0, 1.0), z, (cells[b], cells[b], n), "hex8") for b, z in spans.items()})
    return Model(
        mesh,
        [Solid(body, LinearElastic(YOUNG, 0.0)) for body in spans],
        [Support("low.bottom", x=0, y=0, z=0), Support("top.top", x=0, y=0, z=1.0, amplitude=way)],
        contacts=contacts,
        solve=SolveOptions(times=(0.25, 0.5, 0.625, 0.75, 1.0)),
    )


def _lets_go(level: int) -> Model:
    """Drawn while glued; half of the glue's force is left at .625, none at .75; then both are pressed together."""
    glue = Contact("top.bottom", "low.top", "glue", kind="tied", until=0.5, released=0.75)
    touch = Contact("top.bottom", "low.top", "touch", since=0.5)
    way = Amplitude(((0.0, 0.0), (0.25, WAY), (0.75, WAY), (1.0, -WAY)))
    return _blocks((glue, touch), way, level)


def _sets(level: int) -> Model:
    """Pressed together, glued as they are then, and drawn."""
    touch = Contact("top.bottom", "low.top", "touch", until=0.5)
    glue = Contact("top.bottom", "low.top", "glue", kind="tied", since=0.5)
    return _blocks((touch, glue), Amplitude(((0.0, 0.0), (0.25, SETS), (0.5, SETS), (1.0, WAY))), level)


def _forces(solution: Solution) -> dict[str, float]:
    """What holds the lower end, positive where the blocks press."""
    return {f"force at {s.factor:g}": float(s.reactions["low.bottom"][2]) for s in solution.steps}


def _wanted(*forces: float) -> dict[str, Reference]:
    times = ("0.25", "0.5", "0.625", "0.75", "1")
    return {
        f"force at {time}": Reference(force, 1e-9 * max(map(abs, forces)), ROW, ROUNDING)
        for time, force in zip(times, forces)
    }


PULL = 0.5 * YOUNG * WAY
BENCHMARKS = (
    Benchmark(
        "glue-lets-go",
        "blocks drawn while glued, let go, and pressed together",
        _lets_go,
        _forces,
        _wanted(-PULL, -PULL, -0.5 * PULL, 0.0, PULL),
    ),
    Benchmark(
        "glue-sets",
        "blocks pressed together, glued, and drawn",
        _sets,
        _forces,
        _wanted(*(-0.5 * YOUNG * way for way in (SETS, SETS, 0.75 * SETS + 0.25 * WAY, 0.5 * (SETS + WAY), WAY))),
    ),
)
