"""Rates of convergence: a smooth contact over the whole interface, and the edge of a contact with its singularity.

Both on flat interfaces that do not match: two cells on one side lie against three (nearly so at the edge of contact).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial

import numpy as np
from numpy.typing import NDArray

from abut.benchmarks.errors import displacement_l2, energy_norm, pressure_l2
from abut.benchmarks.exact import EdgeOfContact, WaveField, Waves, full_contact
from abut.benchmarks.record import Benchmark, Reference
from abut.cells import CELLS
from abut.fields import Field
from abut.materials.elastic import LinearElastic
from abut.mesh.make import block, join
from abut.mesh.mesh import Mesh
from abut.model import BodyForce, Contact, Model, Solid, Support, Traction
from abut.solution import Solution

PLANE = ("tri3", "tri6", "quad4", "quad8", "quad9")
SOLID = ("tet4", "tet10", "hex8", "hex20", "hex27")
MATERIALS = {"lower": LinearElastic(10.0, 0.3), "upper": LinearElastic(20.0, 0.2)}
SIDES = {"left": (0, -1.0), "right": (0, 1.0), "front": (1, -1.0), "back": (1, 1.0)}  # axis and sign of the normal
# The n of _smooth_model and _edge_model by level; further levels go on by the last step.
Levels = tuple[int, int, int, int]
SMOOTH_LEVELS: Mapping[str, Levels] = dict.fromkeys(PLANE, (2, 4, 8, 16)) | {
    cell: (2, 4, 6, 8) if CELLS[cell].degree == 1 else (2, 3, 4, 5) for cell in SOLID
}
EDGE_LEVELS: Mapping[str, Levels] = dict.fromkeys(PLANE, (3, 6, 9, 16)) | {
    cell: (3, 5, 7, 10) if CELLS[cell].degree == 1 else (2, 3, 4, 5) for cell in SOLID
}


def _number(levels: Levels, level: int) -> int:
    beyond = max(level - len(levels) + 1, 0)
    return levels[min(level, len(levels) - 1)] + beyond * (levels[-1] - levels[-2])


def _two_boxes(
    cell: str, low: tuple[float, ...], high: tuple[float, ...], height: float, cells: tuple[tuple[int, ...], ...]
) -> Mesh:
    """A box from z = -height to 0 and one from 0 to height over the same base between two corners; cells (n, ..) of
    either."""
    parts = {}
    for body, counts, (bottom, top) in zip(MATERIALS, cells, ((-height, 0.0), (0.0, height))):
        ends = zip((*low, bottom), (*high, top), counts)
        parts[body] = block.grid([np.linspace(a, b, n + 1) for a, b, n in ends], cell)
    return join(parts)


# ---- smooth contact ----


def _wave(amplitude: float, k: tuple[float, ...], phase: float, dim: int) -> Waves:
    return Waves(((amplitude, 0, k[: dim - 1], phase),))


def smooth_fields(dim: int) -> tuple[Mapping[str, WaveField], Waves]:
    """Fields of both bodies and the pressure between them, > 0 everywhere. The bodies differ in material, in how they move
    along the interface and in how they bend; what they share is the pressure and the level of the interface."""
    wave = partial(_wave, dim=dim)
    pressure = wave(1.0, (0.0, 0.0), 0.0) + wave(0.4, (1.4, 0.7), 0.3)
    level = wave(0.03, (1.05, -0.7), 0.5)
    slides = {
        "lower": [wave(0.05, (1.4, 0.35), 0.2), wave(0.04, (0.35, 1.05), 1.0)],
        "upper": [wave(-0.04, (0.7, 1.05), 0.4), wave(0.03, (1.05, -0.7), 0.6)],
    }
    curves = {
        "lower": [wave(0.06, (1.05, 0.7), 0.0), wave(0.05, (0.7, 0.7), 0.7), wave(0.05, (0.7, 1.4), 0.4)],
        "upper": [wave(-0.05, (0.7, 0.35), 0.9), wave(0.04, (1.4, 0.35), 0.1), wave(-0.06, (1.4, 0.7), 0.8)],
    }
    return {
        body: full_contact(
            pressure, level, slides[body][: dim - 1], [*curves[body][: dim - 1], curves[body][-1]], material
        )
        for body, material in MATERIALS.items()
    }, pressure


def _smooth_model(cell: str, n: int) -> Model:
    """Base and top move as the exact field says; so do the sides along the interface. Along its normal, where the rim of
    the contact must stay free, the sides carry the exact shear tractions."""
    dim = CELLS[cell].dim
    fields, _ = smooth_fields(dim)
    cells = tuple((per * n, *[max(round(per * n / 2), 1)] * (dim - 1)) for per in (2, 3))
    mesh = _two_boxes(cell, (0.0,) * (dim - 1), (1.0, 0.5)[: dim - 1], 0.5, cells)
    loads: list[BodyForce | Traction] = []
    supports = []
    for body, field in fields.items():
        end = "bottom" if body == "lower" else "top"
        sides = ("left", "right", "front", "back")[: 2 * dim - 2]
        supports.append(_held(f"{body}.{end}", field.displacement, range(dim)))
        supports += [_held(f"{body}.{side}", field.displacement, range(dim - 1)) for side in sides]
        loads.append(BodyForce(field.body_force, body))
        loads += [Traction(f"{body}.{side}", _traction(field, side)) for side in sides]
    return Model(
        mesh,
        [Solid(body, material) for body, material in MATERIALS.items()],
        supports,
        loads,
        [Contact(contactor="lower.top", target="upper.bottom")],
        plane="strain" if dim == 2 else None,
    )


def _held(on: str, displacement: Field, axes: Iterable[int]) -> Support:
    """Components of an exact displacement prescribed."""
    given: dict[int, Field] = {a: partial(_component, displacement, a) for a in axes}
    return Support(on, x=given.get(0), y=given.get(1), z=given.get(2))


def _component(displacement: Field, a: int, x: NDArray[np.float64]) -> NDArray[np.float64]:
    return displacement(x)[:, a]


def _traction(field: WaveField, side: str) -> Field:
    axis, sign = SIDES[side]
    return lambda x: sign * field.stress(x)[:, :, axis]


def _smooth_measure(solution: Solution) -> dict[str, float]:
    fields, pressure = smooth_fields(solution.model.dim)
    return {
        "displacement": displacement_l2(solution, {body: f.displacement for body, f in fields.items()}),
        "energy": energy_norm(solution, {body: f.gradient for body, f in fields.items()}),
        "pressure": pressure_l2(solution, pressure),
    }


# ---- edge of contact ----


def edge_fields() -> dict[str, EdgeOfContact]:
    """The field of each body at an edge of contact at x = 0."""
    return {body: EdgeOfContact(1.0, material, body == "upper") for body, material in MATERIALS.items()}


def _edge_model(cell: str, n: int) -> Model:
    """The edge of contact lies at two thirds of the width. With 3 n + 1 cells on one side and 3 m + 2, about half as many
    again, on the other, it is at two thirds of a facet of the one and one third of the other on all levels: the error
    depends on where in its facet the edge lies, and would jump from level to level. In 3D a slice two cells thick on one
    side and three on the other, held by its symmetry: the same as a thick body whose mesh is mirrored again and again."""
    dim = CELLS[cell].dim
    fields = edge_fields()
    lower = 3 * n + 1
    along = lower, 3 * round(lower / 2 - 2 / 3) + 2
    cells = tuple((k, *[layers] * (dim - 2), round(k / 1.5)) for k, layers in zip(along, (2, 3)))
    mesh = _two_boxes(cell, (-1.0, 0.0)[: dim - 1], (0.5, 3.0 / lower)[: dim - 1], 1.0, cells)
    supports = []
    for body, field in fields.items():
        ends = "left", "right", "bottom" if body == "lower" else "top"
        supports += [_held(f"{body}.{end}", field.displacement, (0, dim - 1)) for end in ends]
        if dim == 3:
            supports += [Support(f"{body}.{side}", y=0.0) for side in ("front", "back")]
    return Model(
        mesh,
        [Solid(body, material) for body, material in MATERIALS.items()],
        supports,
        contacts=[Contact(contactor="lower.top", target="upper.bottom")],
        plane="strain" if dim == 2 else None,
    )


def _edge_measure(solution: Solution) -> dict[str, float]:
    return {"energy": energy_norm(solution, {body: f.gradient for body, f in edge_fields().items()})}


# ---- records ----

SMOOTH_SOURCE = (
    "manufactured solution; with degree p the displacement is approximated to order p + 1, the energy to p, and with stable "
    "spaces these and the pressure, to p at least, are reached (Brezzi and Fortin 1991)"
)
EDGE_SOURCE = (
    "third term of Williams' series (Williams 1957) as in the regularity of contact (Moussaoui and Khodja 1992): the "
    "displacement lies in H^s for s < 5/2 only, so that the energy is approximated to order 1 by degree 1, else 3/2"
)
REASON = (
    "bounds the relative error from the coarsest level on, some way above what was measured there; the rate is fitted over "
    "four levels, and 0.1 leaves room for terms of higher order"
)


def _rates(source: str, expected: Mapping[str, tuple[float, float]]) -> dict[str, Reference]:
    """References from quantity -> (rate, bound of the error)."""
    return {name: Reference(0.0, bound, source, REASON, rate) for name, (rate, bound) in expected.items()}


def _smooth(cell: str) -> Benchmark:
    levels = SMOOTH_LEVELS[cell]
    linear = CELLS[cell].degree == 1
    return Benchmark(
        f"smooth-{cell}",
        f"smooth pressure over a non-matching interface, {cell}",
        lambda level: _smooth_model(cell, _number(levels, level)),
        _smooth_measure,
        _rates(
            SMOOTH_SOURCE,
            {"displacement": (2.0, 0.05), "energy": (1.0, 0.2), "pressure": (1.0, 0.15)}
            if linear
            else {"displacement": (3.0, 2e-3), "energy": (2.0, 0.015), "pressure": (2.0, 0.015)},
        ),
        len(levels),
        lambda level: 1.0 / _number(levels, level),
    )


def _edge(cell: str) -> Benchmark:
    levels = EDGE_LEVELS[cell]
    linear = CELLS[cell].degree == 1
    return Benchmark(
        f"signorini-{cell}",
        f"edge of contact that the active set has to find, {cell}",
        lambda level: _edge_model(cell, _number(levels, level)),
        _edge_measure,
        _rates(EDGE_SOURCE, {"energy": (1.0, 0.15) if linear else (1.5, 0.02)}),
        len(levels),
        lambda level: 1.0 / (3 * _number(levels, level) + 1),
    )


BENCHMARKS = (*(_smooth(cell) for cell in PLANE + SOLID), *(_edge(cell) for cell in PLANE + SOLID))
