"""Gaps that open as a parabola from an edge at which both sides end: leaves in contact all the way up to a common clamp."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.mesh.make import box, join, rectangle
from models.beam_theory import leaf_forces

LONG, SHORT, WIDE, LOAD = 20.0, 10.0, 2.0, 1.0  # lengths of leaves of thickness 1; by width
STEEL = abut.LinearElastic(210e3, 0.0)


def leaves(cell: str, count: int, clamp: str) -> abut.Model:
    """Two leaves, ``count`` facets along the shorter one, clamped in the mean of their section, which may swell, or tied to
    a block; a force at the end of the longer one."""
    solid = cell == "hex20"

    def part(x: tuple[float, float], z: tuple[float, float], along: int, high: int = 1) -> abut.Mesh:
        if solid:
            return box(x, (0.0, WIDE), z, (along, 2, high), cell)
        return rectangle(x, z, (along, high), cell)

    parts = {
        "long": part((0.0, LONG), (0.0, 1.0), round(count * LONG / SHORT)),
        "short": part((0.0, SHORT), (-1.0, 0.0), count),
    }
    if clamp == "block":
        parts["block"] = part((-3.0, 0.0), (-1.0, 1.0), 6, 4)
    mesh, up = join(parts), "z" if solid else "y"
    contacts = [abut.Contact(contactor="short.top", target="long.bottom", name="leaves")]
    if clamp == "block":
        supports = [abut.Support("block.left", **dict.fromkeys("xyz" if solid else "xy", 0.0))]
        contacts += [abut.Contact(f"{name}.left", "block.right", kind="tied") for name in ("long", "short")]
    else:
        x = mesh.points
        sets = {
            f"{name} middle": np.flatnonzero((x[:, 0] == 0.0) & (x[:, -1] == z))
            for name, z in (("long", 0.5), ("short", -0.5))
        }
        mesh = replace(mesh, node_sets={**mesh.node_sets, **sets})
        supports = [abut.Support(f"{name}.left", x=0.0) for name in ("long", "short")]
        supports += [abut.Support(name, **{up: 0.0}, **({"y": 0.0} if solid else {})) for name in sets]
    pull = (0.0, 0.0, -LOAD) if solid else (0.0, -LOAD)
    return abut.Model(
        mesh, [abut.Solid(name, STEEL) for name in mesh.bodies], supports, [abut.Traction("long.right", pull)], contacts,
        plane=None if solid else "stress",
    )  # fmt: skip


@pytest.mark.parametrize("clamp", ["section", "block"])
@pytest.mark.parametrize(("cell", "count"), [("quad8", 5), ("quad8", 10), ("tri6", 10), ("hex20", 5)])
def test_no_force_where_leaves_part(cell: str, count: int, clamp: str) -> None:
    """Between them acts the force of beam theory, at the end of the shorter one, which bends more: none at the clamp, from
    where the gap opens as a parabola. 1 %; a block that gives way takes 4 % off."""
    solution = abut.solve(leaves(cell, count, clamp))
    contact = solution.contacts[0]
    exact = leaf_forces([LONG, SHORT], 210e3 / 12.0, LOAD)[0] * (WIDE if cell == "hex20" else 1.0)
    assert abs(contact.force[-1]) == pytest.approx(exact, rel=0.01 if clamp == "section" else 0.05)
    x = solution.model.mesh.points[contact.nodes][:, 0]
    assert np.abs(contact.nodal_pressure[x < 0.5 * SHORT]).max() == 0.0


def test_contact_at_an_edge_alone() -> None:
    """Two blocks, flush, of which one turns and comes in by .006 at one end, which opens by .025 within a facet: in the
    mean it is open there, but the ends would lie in each other, so that dual functions stay."""
    mesh = join(
        {name: rectangle((0.0, 4.0), y, (8, 4), "quad8") for name, y in (("low", (-2.0, 0.0)), ("high", (0.0, 2.0)))}
    )

    def turned(x: np.ndarray) -> np.ndarray:
        return 0.05 * x[..., 0] - 0.006

    def force(pressure: str) -> float:
        model = abut.Model(
            mesh, [abut.Solid(name, abut.LinearElastic(1000.0, 0.3)) for name in mesh.bodies],
            [abut.Support("low.bottom", x=0.0, y=0.0), abut.Support("high.top", x=0.0, y=turned)],
            contacts=[abut.Contact("low.top", "high.bottom", pressure=pressure)], plane="strain",
        )  # fmt: skip
        contact = abut.solve(model).contacts[0]
        assert contact.active == 1
        return float(contact.force[1])

    assert force("auto") == pytest.approx(force("dual"), rel=1e-9)
