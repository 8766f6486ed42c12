"""Round parts in round holes: Lame's press fit, Persson's pin with clearance."""

from __future__ import annotations

import numpy as np

from abut.benchmarks.measures import contact_points, pressure_error
from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import join, rectangle, ring
from abut.model import Contact, Force, Model, Solid, Support
from abut.solution import Solution

INTERFERENCE = 0.01
LAME = {"stress": 1.171875, "strain": 1.287775, "axisymmetric": 1.287775}
LAME_SOURCE = "Lame's thick rings of radii 1, 2 and 3, E = 1000, nu = 0.3, interference 0.01"


def _press_fit(plane: str) -> Benchmark:
    def model(level: int) -> Model:
        n = 2**level
        material = LinearElastic(1000.0, 0.3)
        if plane == "axisymmetric":
            parts = {
                "hub": rectangle((2.0, 3.0), (0.0, 1.0), (4 * n, 5 * n), "quad8"),
                "shaft": rectangle((1.0, 2.0), (0.0, 1.0), (4 * n, 3 * n), "quad8"),
            }
            sides = [Support(f"{body}.{side}", y=0) for body in parts for side in ("bottom", "top")]
            contact = Contact("hub.left", "shaft.right", offset=-INTERFERENCE)
        else:
            parts = {
                "hub": ring((2.0, 3.0), cells=(4 * n, 20 * n)),
                "shaft": ring((1.0, 2.0), cells=(4 * n, 14 * n)),
            }
            sides = [Support(f"{body}.start", y=0) for body in parts] + [Support(f"{body}.end", x=0) for body in parts]
            contact = Contact("hub.inner", "shaft.outer", offset=-INTERFERENCE)
        return Model(join(parts), [Solid(body, material) for body in parts], sides, contacts=[contact], plane=plane)

    def measure(solution: Solution) -> dict[str, float]:
        exact = LAME[plane]
        _, p = contact_points(solution.contacts[0])
        uniform = pressure_error(solution, lambda x: np.full(len(x), exact)) / exact
        return {"pressure": float(p.mean()), "worst pressure": uniform}

    reason = "gaps between two interpolations of one circle, h^4, press like their size times E / h"
    if plane == "axisymmetric":
        reason = "quadratic cells, four through each wall"
    return Benchmark(
        f"press-fit-{plane}",
        f"press fit of two thick rings, {plane}",
        model,
        measure,
        {
            "pressure": Reference(LAME[plane], 2e-3, LAME_SOURCE, reason),
            "worst pressure": Reference(0.0, 1e-2, LAME_SOURCE, f"largest error over the exact pressure; {reason}"),
        },
    )


PERSSON = {10.0: (82.2206, 3.66156), 80.0: (0.126146, 0.611608)}  # half angle: E* dR / Q, p_max R / Q
PERSSON_SOURCE = "Persson 1964; closed form for identical materials, infinite plate (Ciavarella and Decuzzi 2001)"
LOADS = {10.0: 1e-4, 80.0: 2e-2}  # Q / (E* R): the clearance is small, and large against that of interpolated circles


def _pin(angle: float) -> Benchmark:
    (clearance, peak), load = PERSSON[angle], LOADS[angle]

    def model(level: int) -> Model:
        n = 2**level
        gap = clearance * load
        zone = [-90.0, -90.0 + 1.2 * angle]
        fine = {"y": zone}
        around = 24 * n
        parts = {
            "plate": ring((1.0 + gap, 200.0), (-90.0, 90.0), cells=(6 * n, around),
                          fine={"x": [1.0 + gap, 1.0 + gap + min(0.015 * angle, 0.5)], **fine}, growth=1.5),
            "pin": ring((0.05, 1.0), (-90.0, 90.0), (0.0, -gap), (6 * n, around + 3 * n),
                        fine={"x": [1.0 - min(0.015 * angle, 0.5), 1.0], **fine}, growth=1.5),
        }  # fmt: skip
        young = 1.0 - 0.3**2  # E* = E / (1 - nu^2) = 1
        sides = [Support(f"{body}.{side}", x=0) for body in parts for side in ("start", "end")]
        return Model(
            join(parts),
            [Solid(body, LinearElastic(young, 0.3)) for body in parts],
            [Support("plate.outer", x=0, y=0), *sides],
            [Force("pin.inner", (0.0, -0.5 * load))],
            [Contact("plate.inner", "pin.outer")],
            plane="strain",
        )

    def measure(solution: Solution) -> dict[str, float]:
        x, p = contact_points(solution.contacts[0])
        turn = np.rad2deg(np.arctan2(x[:, 0], -x[:, 1]))
        return {"max pressure": float(p.max()) / load, "half angle": float(turn[p > 0.02 * p.max()].max())}

    reason = "plate of radius 200 for an infinite one, a bore of 0.05 R in place of the point force in the pin"
    return Benchmark(
        f"pin-{angle:.0f}-degrees",
        f"pin with clearance in a plate, contact over {angle:.0f} degrees to each side",
        model,
        measure,
        {
            "max pressure": Reference(peak, 0.02, PERSSON_SOURCE, reason),
            "half angle": Reference(angle, 0.05, PERSSON_SOURCE, f"one facet (a tenth of the angle or less); {reason}"),
        },
    )


BENCHMARKS = (*(_press_fit(plane) for plane in LAME), *(_pin(angle) for angle in PERSSON))
