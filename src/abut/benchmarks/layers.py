"""Thin bonded layers of rubber that keeps its volume, under a rigid cylinder and a rigid ball, contact 2, 5 and 10
thicknesses to each side: locked cells give the profile of a layer that changes its volume."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import join, rectangle, ring
from abut.model import Contact, Model, Rigid, Solid, Support
from abut.solution import Solution

ROUND = 400.0  # radius over the half width of contact
BEYOND = 10.0  # thicknesses of layer outside the contact
SOURCE = (
    "integral equation of contact on a bonded incompressible layer, solved in tests/benchmarks/test_bonded_layers.py"
)
WITHIN = {"tri6": 0.03, "quad9": 0.01}
REASON = "3 cells through the thickness; the integral equation itself is solved to 1e-3"


@dataclass(frozen=True)
class Layer:
    """Depth, force and largest pressure at which the half width of contact is ``half_width``, on a layer of thickness and
    shear modulus 1 under a body of radius 1: all three go with one over the radius. force: of a cylinder by its length."""

    body: str
    half_width: float
    depth: float
    force: float
    largest: float


LAYERS = (
    Layer("cylinder", 2.0, 1.3292, 50.868, 18.417),
    Layer("cylinder", 5.0, 6.1792, 1436.0, 227.53),
    Layer("cylinder", 10.0, 21.057, 26139.0, 2199.6),
    Layer("ball", 2.0, 1.8196, 110.86, 16.127),
    Layer("ball", 5.0, 8.9783, 6631.2, 182.48),
    Layer("ball", 10.0, 31.228, 219290.0, 1691.1),
)


def _layer(known: Layer, cell: str) -> Benchmark:
    radius = ROUND * known.half_width

    def model(level: int) -> Model:
        n = 2**level
        width = known.half_width + BEYOND
        layer = rectangle((0.0, width), (-1.0, 0.0), (round(3 * width) * n, 3 * n), cell)
        over = degrees(1.5 / ROUND)  # half as far again as contact goes
        facets = round(6 * known.half_width) * n
        body = ring((radius - 1.0, radius), (-90.0, over - 90.0), (0.0, radius), (1, facets), "quad8")
        depth, ball = known.depth / radius, known.body == "ball"
        return Model(
            join({"layer": layer, known.body: body}),
            [Solid("layer", LinearElastic(3.0, 0.5), integration="mixed")],
            [Support("layer.bottom", x=0.0, y=0.0), Support("layer.left", x=0.0)],
            contacts=[Contact("layer.top", f"{known.body}.outer")],
            rigid=[Rigid("ball", y=-depth) if ball else Rigid("cylinder", x=0.0, y=-depth, rz=0.0)],
            plane="axisymmetric" if ball else "strain",
        )

    def measure(solution: Solution) -> dict[str, float]:
        contact = solution.contacts[0]
        share = 1.0 if known.body == "ball" else 2.0
        return {"force": share * abs(float(contact.force[1])), "largest pressure": contact.max_pressure}

    return Benchmark(
        f"layer-{known.body}-{known.half_width:g}-{cell}",
        f"bonded incompressible layer under a rigid {known.body}, contact {known.half_width:g} thicknesses to each side, "
        f"mixed {cell}",
        model,
        measure,
        {
            "force": Reference(known.force / radius, WITHIN[cell], SOURCE, REASON),
            "largest pressure": Reference(known.largest / radius, WITHIN[cell], SOURCE, REASON),
        },
    )


BENCHMARKS = tuple(_layer(known, cell) for known in LAYERS for cell in ("tri6", "quad9"))
