"""Bodies that go and come back without stress: half of a bar, and a second layer of fill."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import box, join
from abut.mesh.mesh import Mesh
from abut.model import Amplitude, Gravity, Model, Removal, Solid, SolveOptions, Support
from abut.solution import Solution

YOUNG, LENGTH, STRETCH = 1000.0, 4.0, 0.02  # a bar of 1 x 1, whose halves are two bodies
TIMES = (0.25, 0.5, 0.75, 1.0)
WEIGHT, LOWER, UPPER = 5.0, 3.0, 1.0  # per volume; heights of two layers of 1 x 1
FAINT = "what is away keeps 1e-9 of its stiffness"


def _split(mesh: Mesh, body: str, axis: int, at: float, names: tuple[str, str]) -> Mesh:
    """A mesh whose only body is cut in two below and above a plane between cells; the halves share nodes."""
    middle = np.concatenate([mesh.points[block.nodes].mean(axis=1)[:, axis] for block in mesh.blocks])
    cells = mesh.bodies[body]
    halves = {name: cells[(middle[cells] < at) == (i == 0)] for i, name in enumerate(names)}
    return replace(mesh, bodies=halves)


def _bar(level: int) -> Model:
    """Stretched up to 0.25 and held; one half goes from 0.25 to 0.75 (half of its force is left at 0.5) and comes back then;
    the whole is stretched as much again up to 1."""
    cells = 2 ** (level + 1)
    whole = join({"bar": box((0.0, 1.0), (0.0, 1.0), (0.0, LENGTH), (cells, cells, 2 * cells), "hex8")})
    mesh = _split(whole, "bar", 0, 0.5, ("left", "right"))
    stretch = Amplitude(((0.0, 0.0), (0.25, 1.0), (0.75, 1.0), (1.0, 2.0)))
    return Model(
        mesh,
        [Solid(name, LinearElastic(YOUNG, 0.0)) for name in ("left", "right")],
        [Support("bar.bottom", x=0, y=0, z=0), Support("bar.top", z=STRETCH, amplitude=stretch)],
        removals=[Removal("right", until=0.25, released=0.75, since=0.75)],
        solve=SolveOptions(times=TIMES),
    )


def _forces(solution: Solution) -> dict[str, float]:
    found = {f"force at {step.factor:g}": float(step.reactions["bar.top"][2]) for step in solution.steps}
    top = solution.model.mesh.nodes_of("bar.top")
    x = solution.model.mesh.points[top, 0]
    for name, half in (("left", x < 0.25), ("right", x > 0.75)):
        found[f"stress in the {name} half"] = float(solution.steps[-1].stress[top[half], 2].mean())
    return found


def _bar_wanted() -> dict[str, Reference]:
    """Each half has E A / (2 L); the one that comes back counts from the length that it has then."""
    half = YOUNG * STRETCH / LENGTH / 2.0
    forces = dict(zip(TIMES, (2.0 * half, 1.5 * half, half, 3.0 * half)))
    source = "two springs in parallel, E A / L each; the second counts from the length at which it comes back"
    result = {f"force at {time:g}": Reference(force, 1e-6, source, FAINT) for time, force in forces.items()}
    for name, stress in (("left", 4.0 * half), ("right", 2.0 * half)):
        result[f"stress in the {name} half"] = Reference(stress, 1e-6, source, FAINT)
    return result


def _fill(level: int) -> Model:
    """The lower layer has its weight up to 0.5; then the upper one comes, with its own."""
    cells = 2**level
    height = LOWER + UPPER
    whole = join({"fill": box((0.0, 1.0), (0.0, 1.0), (0.0, height), (cells, cells, 4 * cells), "hex20")})
    mesh = _split(whole, "fill", 2, LOWER, ("lower", "upper"))
    tops = {
        name: np.flatnonzero(np.abs(mesh.points[:, 2] - z) < 1e-9) for name, z in (("seam", LOWER), ("crest", height))
    }
    soil = LinearElastic(YOUNG, 0.0, density=1.0)
    return Model(
        replace(mesh, node_sets=tops),
        [Solid(name, soil) for name in ("lower", "upper")],
        [Support("fill.bottom", x=0, y=0, z=0)],
        [Gravity((0.0, 0.0, -WEIGHT), amplitude=Amplitude(((0.0, 0.0), (0.5, 1.0))))],
        removals=[Removal("upper", since=0.5)],
        solve=SolveOptions(times=(0.5, 1.0)),
    )


def _settlements(solution: Solution) -> dict[str, float]:
    mesh, found = solution.model.mesh, {}
    for step in solution.steps:
        for name in ("seam", "crest"):
            found[f"settlement of the {name} at {step.factor:g}"] = float(
                -step.displacement[mesh.nodes_of(name), 2].mean()
            )
    return found


def _fill_wanted() -> dict[str, Reference]:
    """Without the layers that come one after the other the crest would settle by half of the weight of all, times the
    height, over E."""
    first = WEIGHT * LOWER**2 / 2.0 / YOUNG
    seam = first + WEIGHT * UPPER * LOWER / YOUNG
    crest = seam + WEIGHT * UPPER**2 / 2.0 / YOUNG
    source = "columns under their own weight, w h^2 / (2 E), and a load, w h; the crest is placed on the settled layer"
    values = {("seam", 0.5): first, ("crest", 0.5): first, ("seam", 1): seam, ("crest", 1): crest}
    return {
        f"settlement of the {name} at {time:g}": Reference(value, 1e-5, source, FAINT)
        for (name, time), value in values.items()
    }


BENCHMARKS = (
    Benchmark("half-returns", "bar, half of which goes and comes back without stress", _bar, _forces, _bar_wanted()),
    Benchmark(
        "fill",
        "second layer of fill, placed on the first one when that has settled",
        _fill,
        _settlements,
        _fill_wanted(),
    ),
)
