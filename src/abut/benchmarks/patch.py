"""Patch tests of the literature: uniform pressure through non-matching meshes is exact (REFERENCES of each record)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.benchmarks.measures import displacement_error, pressure_error
from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import block, join
from abut.mesh.mesh import Mesh
from abut.model import Contact, Model, Pressure, Solid, Support
from abut.model.conditions import support_along
from abut.solution import Solution

EXACT = "rounding only: the exact solution lies in the discrete spaces"


def shaken(low: float, high: float, cells: tuple[int, ...], cell: str, seed: int) -> Mesh:
    """A block of unit width between two heights with its inner corner points moved at random, edges left straight."""
    dim = len(cells)
    a, b = np.zeros(dim), np.ones(dim)
    a[-1], b[-1] = low, high

    def move(x: NDArray[np.float64]) -> NDArray[np.float64]:
        shift = 0.2 * np.random.default_rng(seed).uniform(-1.0, 1.0, x.shape) * (b - a) / np.array(cells)
        return x + np.where((np.abs(x - a) < 1e-9) | (np.abs(x - b) < 1e-9), 0.0, shift)

    return block.grid([np.linspace(p, q, k + 1) for p, q, k in zip(a, b, cells)], cell, move)


def _code_aster(level: int) -> Model:
    n = 2**level
    parts = {"lower": shaken(0, 1, (5 * n, 4 * n), "quad4", 1), "upper": shaken(1, 2, (7 * n, 4 * n), "quad4", 2)}
    steel = LinearElastic(2e6, 0.0)
    return Model(
        join(parts),
        [Solid(body, steel) for body in parts],
        [Support("lower.bottom", x=0, y=0), Support("upper.top", x=0, y=-0.1)],
        contacts=[Contact(contactor="lower.top", target="upper.bottom")],
        plane="strain",
    )


def _code_aster_measure(solution: Solution) -> dict[str, float]:
    nodes = solution.model.mesh.nodes_of("lower.top")
    return {
        "pressure": pressure_error(solution, lambda x: np.full(len(x), 1e5)) / 1e5,
        "interface": float(np.abs(solution.displacement[nodes, 1] + 0.05).max() / 0.05),
    }


V6_03_121 = "code_aster V6.03.121 (after El-Abbasi and Bathe 2001): p = 1e5, u_y = -0.05 at the interface"


def _taylor(level: int) -> Model:
    """The upper block covers the middle third of the lower one; both tops carry the same pressure."""
    n = 2**level
    lower = block.grid([np.linspace(0, 3, 9 * n + 1), np.linspace(0, 1, 3 * n + 1)], "quad4")
    upper = block.grid([np.linspace(1, 2, 4 * n + 1), np.linspace(1, 2, 3 * n + 1)], "quad4")
    mesh = join({"lower": lower, "upper": upper})
    rows = mesh.surfaces["lower.top"]
    x = mesh.points[mesh.facets(rows).nodes[:, :2], 0].mean(axis=1)
    under = (x > 1.0) & (x < 2.0)
    surfaces = {**mesh.surfaces, "under": rows[under], "beside": rows[~under]}
    mesh = Mesh(mesh.points, mesh.blocks, mesh.bodies, surfaces)
    material = LinearElastic(1000.0, 0.4)
    return Model(
        mesh,
        [Solid("lower", material), Solid("upper", material)],
        [Support("lower.bottom", y=0), Support("lower.left", x=0), Support("upper.left", x=_SIDE)],
        [Pressure("upper.top", 10.0), Pressure("beside", 10.0)],
        [Contact(contactor="upper.bottom", target="under")],
        plane="strain",
    )


_SIDE = 0.4 * 1.4 * 10.0 / 1000.0  # sideways displacement at x = 1 of a block held at x = 0: nu (1 + nu) p / E


def _taylor_measure(solution: Solution) -> dict[str, float]:
    def exact(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.column_stack([_SIDE * x[:, 0], -(1 - 0.4**2) * 10.0 / 1000.0 * x[:, 1]])

    return {
        "pressure": pressure_error(solution, lambda x: np.full(len(x), 10.0)) / 10.0,
        "displacement": displacement_error(solution, exact),
    }


def _ssnp170(dim: int, cells: tuple[str, str]) -> Benchmark:
    def model(level: int) -> Model:
        n = 2**level
        grids = ((2 * n, 3 * n, 2 * n), (3 * n, 2 * n, 2 * n)) if dim == 3 else ((5 * n, 3 * n), (7 * n, 3 * n))
        parts = {"lower": shaken(0, 1, grids[0], cells[0], 3), "upper": shaken(1, 2, grids[1], cells[1], 4)}
        material = LinearElastic(2000.0, 0.3)
        sides = [("left", "x"), ("front", "y")][: dim - 1]
        supports = [support_along(f"{body}.{side}", axis, 0.0) for body in parts for side, axis in sides]
        return Model(
            join(parts),
            [Solid(body, material) for body in parts],
            [support_along("lower.bottom", "xyz"[dim - 1], 0.0), *supports],
            [Pressure("upper.top", 25.0)],
            [Contact(contactor="lower.top", target="upper.bottom")],
            plane="strain" if dim == 2 else None,
        )

    def measure(solution: Solution) -> dict[str, float]:
        strain = 25.0 / 2000.0
        side, along = (0.3 * 1.3, 1 - 0.3**2) if dim == 2 else (0.3, 1.0)
        slopes = np.array([*[side] * (dim - 1), -along]) * strain
        return {
            "pressure": pressure_error(solution, lambda x: np.full(len(x), 25.0)) / 25.0,
            "displacement": displacement_error(solution, lambda x: x * slopes),
        }

    source = "code_aster SSNP170: sigma_n = -25, gap 0, bodies free to expand sideways"
    exact = Reference(0.0, 1e-10, source, EXACT)
    return Benchmark(
        f"patch-{cells[0]}-{cells[1]}",
        f"{dim}D incompatible meshes, {cells[0]} on {cells[1]}",
        model,
        measure,
        {"pressure": exact, "displacement": exact},
    )


BENCHMARKS = (
    Benchmark(
        "patch-compressed",
        "2D patch test, top moved down",
        _code_aster,
        _code_aster_measure,
        {
            "pressure": Reference(0.0, 1e-10, V6_03_121, EXACT),
            "interface": Reference(0.0, 1e-10, V6_03_121, EXACT),
        },
    ),
    Benchmark(
        "patch-punch",
        "Taylor-Papadopoulos patch test",
        _taylor,
        _taylor_measure,
        dict.fromkeys(
            ("pressure", "displacement"),
            Reference(0.0, 1e-10, "Taylor and Papadopoulos 1991: contact pressure 10 everywhere", EXACT),
        ),
    ),
    *(_ssnp170(2, (a, b)) for a, b in (("quad4", "quad8"), ("quad9", "tri6"), ("tri3", "quad4"), ("quad8", "quad9"))),
    *(
        _ssnp170(3, (a, b))
        for a, b in (("hex8", "hex20"), ("hex20", "hex27"), ("hex27", "tet10"), ("tet4", "hex8"), ("wedge15", "wedge6"))
    ),
)
