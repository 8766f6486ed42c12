"""Values of result files on meshes of their own: temperatures of another mesh, and a part cut out of a whole."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from abut.benchmarks.record import Benchmark, Reference
from abut.io.vtu import write_vtu
from abut.materials.elastic import LinearElastic
from abut.mesh.make import box, join, rectangle
from abut.mesh.mesh import Mesh
from abut.model import Model, Solid, Support, Temperature
from abut.probing.result_field import ResultField, result_field
from abut.solution import Solution
from abut.types import Array

YOUNG, POISSON, EXPANSION = 200e3, 0.3, 12e-6
WARM, RISE, SIZES = 20.0, 6.0, (4.0, 1.5, 1.0)  # temperature WARM + RISE x in a bar
CURVATURE, LENGTH, HALF = 1e-4, 20.0, 2.0  # of a bent beam; how much of it is cut out: from 6 to 13


def _written(mesh: Mesh, name: str, values: Array) -> tuple[ResultField, ...]:
    """The columns of values at points, written to a file and read again."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "values.vtu"
        write_vtu(path, mesh.points, [(block.kind, block.nodes) for block in mesh.blocks], {name: values})
        return tuple(result_field(path, name, k) for k in range(values.shape[1] if values.ndim > 1 else 1))


def _warm(level: int) -> Model:
    """Heated by a field that tetrahedra of another size hold exactly, free to expand."""
    n = 2**level
    x, y, z = ((0.0, size) for size in SIZES)
    other = join({"bar": box(x, y, z, (5, 3, 2), "tet4")})
    (field,) = _written(other, "temperature", WARM + RISE * other.points[:, 0])
    mesh = join({"bar": box(x, y, z, (3 * n, n, n), "hex20")})
    return Model(
        mesh,
        [Solid("bar", LinearElastic(YOUNG, POISSON, expansion=EXPANSION))],
        [Support("bar.front", y=0), Support("bar.bottom", z=0), Support("bar.left", x=_flat)],
        [Temperature("bar", field)],
    )


def _flat(points: Array) -> Array:
    """Along x at x = 0: the end bulges, as what is warmer beyond it is wider."""
    return np.asarray(-0.5 * EXPANSION * RISE * (points[:, 1] ** 2 + points[:, 2] ** 2))


def _warmth(solution: Solution) -> dict[str, float]:
    mesh, step = solution.model.mesh, solution.steps[-1]
    corner = int(np.argmin(np.linalg.norm(mesh.points - (SIZES[0], 0.0, 0.0), axis=1)))
    width = int(np.argmin(np.linalg.norm(mesh.points - (SIZES[0], SIZES[1], 0.0), axis=1)))
    return {
        "lengthening": float(step.displacement[corner, 0]),
        "widening": float(step.displacement[width, 1]),
        "stress": float(np.abs(step.stress).max()),
    }


def _cut(level: int) -> Model:
    """A part of a bent beam, whose rim follows the whole."""
    n = 2**level
    whole = join({"beam": rectangle((0.0, LENGTH), (-HALF, HALF), (9, 3), "quad8")})
    x, y = whole.points.T
    moved = np.column_stack([-CURVATURE * x * y, 0.5 * CURVATURE * x**2, np.zeros(len(x))])
    along, across, _ = _written(whole, "displacement", moved)
    part = join({"part": rectangle((6.0, 13.0), (-HALF, HALF), (4 * n, 2 * n), "quad8")})
    sides = [Support(f"part.{side}", x=along, y=across) for side in ("left", "right", "bottom", "top")]
    return Model(part, [Solid("part", LinearElastic(YOUNG, 0.0))], sides, plane="stress")


def _bent(solution: Solution) -> dict[str, float]:
    mesh, step = solution.model.mesh, solution.steps[-1]
    top = mesh.nodes_of("part.top")
    off = step.stress[:, 0] + YOUNG * CURVATURE * mesh.points[:, 1]
    return {"stress at the top": float(step.stress[top, 0].mean()), "elsewhere": float(np.abs(off).max())}


FREE = "a free body with a temperature that is linear has no stress; u = a (T0 x + g (x^2 - y^2 - z^2) / 2)"
EXACT = "quadratic cells hold it"
BENCHMARKS = (
    Benchmark(
        "mapped-temperature", "bar heated by the temperatures of a file with other cells", _warm, _warmth,
        {
            "lengthening": Reference(EXPANSION * (WARM + 0.5 * RISE * SIZES[0]) * SIZES[0], 1e-8, FREE, EXACT),
            "widening": Reference(EXPANSION * (WARM + RISE * SIZES[0]) * SIZES[1], 1e-8, FREE, EXACT),
            "stress": Reference(0.0, 1e-8 * YOUNG * EXPANSION * WARM, FREE, EXACT),
        },
    ),
    Benchmark(
        "submodel", "part of a bent beam, moved at its rim as the result file of the whole says", _cut, _bent,
        {
            "stress at the top": Reference(-YOUNG * CURVATURE * HALF, 1e-8, "pure bending, E k y", EXACT),
            "elsewhere": Reference(0.0, 1e-8 * YOUNG * CURVATURE * HALF, "pure bending, E k y", EXACT),
        },
    ),
)  # fmt: skip
