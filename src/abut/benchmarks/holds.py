"""A bar that is stretched by a hold, loaded while it is held, let go, and stays where it is then: bars in a row."""

from __future__ import annotations

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import box, join
from abut.model import Amplitude, Force, Hold, Model, Solid, SolveOptions, Support
from abut.solution import Solution

YOUNG, LENGTH, STRETCH, LOAD = 1000.0, 4.0, 0.02, 3.0  # a bar of 1 x 1
STIFFNESS = YOUNG / LENGTH
TIMES = (0.2, 0.4, 0.5, 0.6, 0.8, 1.0)
SOURCE = "a bar as a spring, E A / L: force of the hold plus load"
REASON = "uniform stresses (nu = 0); a hold gives a millionth of what a cell does"


def _bar(level: int) -> Model:
    """Stretched up to 0.2, loaded against it up to 0.4, let go from 0.4 to 0.6; from 0.8 on it stays, and the load goes."""
    cells = 2**level
    mesh = join({"bar": box((0.0, 1.0), (0.0, 1.0), (0.0, LENGTH), (cells, cells, 4 * cells), "hex8")})
    load = Amplitude(((0.0, 0.0), (0.2, 0.0), (0.4, 1.0), (0.8, 1.0), (1.0, 0.0)))
    return Model(
        mesh,
        [Solid("bar", LinearElastic(YOUNG, 0.0))],
        [Support("bar.bottom", x=0, y=0, z=0)],
        [Force("bar.top", (0.0, 0.0, -LOAD), load)],
        holds=[
            Hold("bar.top", z=STRETCH, reached=0.2, until=0.4, released=0.6, name="grip"),
            Hold("bar.top", z="stay", since=0.8, name="lock"),
        ],
        solve=SolveOptions(times=TIMES),
    )


def _measure(solution: Solution) -> dict[str, float]:
    """At each time displacement of the loaded end and the force of both holds there, of which one acts."""
    nodes = solution.model.mesh.nodes_of("bar.top")
    found: dict[str, float] = {}
    for time in TIMES:
        step = next(step for step in solution.steps if abs(step.factor - time) < 1e-9)
        found[f"displacement at {time:g}"] = float(step.displacement[nodes, 2].mean())
        found[f"force of holds at {time:g}"] = float(step.reactions["bar.top"][2])
    return found


def _wanted() -> dict[str, Reference]:
    """Held: the hold has what the bar pulls with, and the load. Let go: half of its force at 0.5, none at 0.6, when the
    load is on the bar alone; at 0.8 the lock takes over without a force, and has all of it once the load is gone."""
    held = STIFFNESS * STRETCH
    forces = (held, held + LOAD, 0.5 * (held + LOAD), 0.0, 0.0, -LOAD)
    loads = (0.0, -LOAD, -LOAD, -LOAD, -LOAD, 0.0)
    result = {}
    for time, force, load in zip(TIMES, forces, loads):
        way = (force + load) / STIFFNESS
        result[f"displacement at {time:g}"] = Reference(way, 1e-5, SOURCE, REASON)
        result[f"force of holds at {time:g}"] = Reference(force, 1e-5, SOURCE, REASON)
    return result


BENCHMARKS = (
    Benchmark("holds", "bar stretched, held, loaded, let go, and locked where it is", _bar, _measure, _wanted()),
)
