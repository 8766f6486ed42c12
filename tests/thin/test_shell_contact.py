"""Shells in contact by their true faces, against beam theory: a strip lifted off the ground, one wrapped over a drum,
leaves of a spring."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from models.gmsh_files import write_msh
from models.thin import CLAMPED

E = 210e3
Numbers = NDArray[np.int64]


def plate(length: float, width: float, count: int, z: float, first: int = 0) -> tuple[NDArray[np.float64], Numbers]:
    """Points and cells of a strip along x, one cell wide; nodes from number ``first`` on."""
    x, y = np.meshgrid(np.linspace(0.0, length, count + 1), [0.0, width], indexing="ij")
    start = first + 2 * np.arange(count)
    cells = np.stack([start, start + 2, start + 3, start + 1], axis=1)
    return np.stack([x.ravel(), y.ravel(), np.full(x.size, z)], axis=1), cells


def below(x: NDArray[np.float64], top: NDArray[np.float64], first: int) -> tuple[NDArray[np.float64], Numbers]:
    """Points and hex8 cells of a body under a curve, from y = -2 to 12 and from z = -80 on."""
    columns = [(a, y, z) for a, b in zip(x, top) for y in (-2.0, 12.0) for z in (-80.0, b)]
    i = first + 4 * np.arange(len(x) - 1)
    return np.array(columns), np.stack([i, i + 4, i + 6, i + 2, i + 1, i + 5, i + 7, i + 3], axis=1)


def on_rigid(
    path: Path, length: float, count: int, thick: float, x: NDArray[np.float64], z: NDArray[np.float64]
) -> Path:
    """A strip "strip", "root" and "tip" its ends, on a body "base" with the surface "top"."""
    points, cells = plate(length, 10.0, count, thick / 2)
    others, bricks = below(x, z, len(points))
    groups = {
        "strip": {"quad4": cells},
        "root": {"line2": [[0, 1]]},
        "tip": {"line2": [[2 * count, 2 * count + 1]]},
        "base": {"hex8": bricks},
        "top": {"quad4": bricks[:, 4:]},
    }
    return write_msh(path, np.vstack([points, others]), groups)


def solved(
    thick: abut.Thick, material: abut.LinearElastic, loads: list[object], contacts: list[abut.Contact]
) -> abut.Solution:
    fixed = dict.fromkeys(("x", "y", "z", "rx", "ry", "rz"), 0.0)
    bodies = [body for body in thick.mesh.bodies if body != "base"]
    model = abut.Model(
        thick.mesh,
        [abut.Solid(body, material, integration="reduced") for body in bodies],
        thick.supports,
        [*thick.loads, *loads],  # type: ignore[list-item]
        contacts,
        equations=thick.equations,
        couplings=thick.couplings,
        rigid=[abut.Rigid("base", **fixed)] if "base" in thick.mesh.bodies else [],
    )
    return abut.solve(model)


def test_heavy_strip_lifted_at_its_edge(tmp_path: Path) -> None:
    """A strip of steel, 2 thick, lifted by .5: over l = (24 D d / q)^(1/4) = 330.88 it is in the air, the edge
    carries q l / 2 = .02548 by width; on the ground it lies with its weight alone. Where it comes down there is a line
    force, which takes a few facets to settle."""
    thick, length, lift, weight = 2.0, 600.0, 0.5, 7.85e-9 * 9810.0 * 2.0
    stiff = E * thick**3 / (12 * (1 - 0.3**2))
    lifted = (24 * stiff * lift / weight) ** 0.25
    assert lifted == pytest.approx(330.8833, abs=1e-4)
    path = on_rigid(tmp_path / "a.msh", length, 60, thick, np.array([-10.0, 610.0]), np.zeros(2))
    held = [abut.MidSupport("root", z=lift), abut.MidSupport("tip", x=0), abut.MidSupport("strip", y=0, rx=0)]
    steel = abut.LinearElastic(E, 0.3, density=7.85e-9)
    made = abut.thicken(path, {"strip": abut.Shell(thick)}, held)
    solution = solved(
        made, steel, [abut.Gravity((0.0, 0.0, -9810.0))], [abut.Contact("strip.sneg", "top", name="ground")]
    )
    contact = solution.contacts[0]
    assert weight * length - abs(contact.force[2]) / 10.0 == pytest.approx(weight * lifted / 2, rel=0.002)
    x = solution.model.mesh.points[contact.nodes][:, 0]
    assert x[contact.nodal_pressure > 1e-9].min() == pytest.approx(lifted, abs=length / 60)
    assert contact.nodal_pressure[x > 450.0] == pytest.approx(weight, rel=0.01)


def test_strip_wrapped_over_a_drum(tmp_path: Path) -> None:
    """Pressed down at its end by twice the force D / R L at which it begins to wrap: it lies up to L - D / R F = L / 2
    without pressure, with the moment D / R, and ends in a line force. Linear, so that the drum is a parabola; facets of a
    fortieth."""
    thick, length, radius = 2.0, 100.0, 200.0
    stiff = E * thick**3 / (12 * (1 - 0.3**2))
    force = 2 * stiff / (radius * length)
    x = np.linspace(-2.0, length + 2.0, 42)
    path = on_rigid(tmp_path / "a.msh", length, 40, thick, x, -(np.maximum(x, 0.0) ** 2) / (2 * radius))
    held = [abut.MidSupport("root", **CLAMPED), abut.MidSupport("strip", y=0, rx=0)]
    made = abut.thicken(path, {"strip": abut.Shell(thick)}, held)
    pull = abut.Traction("tip.edge", (0.0, 0.0, -force / thick))
    solution = solved(made, abut.LinearElastic(E, 0.3), [pull], [abut.Contact("strip.sneg", "top", name="drum")])
    contact, of = solution.contacts[0], abut.mid_surface(solution, "strip")
    x = solution.model.mesh.points[contact.nodes][:, 0]
    touching = x[contact.nodal_pressure > 0.1 * contact.nodal_pressure.max()]
    assert (touching.min(), touching.max()) == pytest.approx((length / 2, length / 2), abs=length / 40 + 0.1)
    end = of.displacement[of.points[:, 0] > length - 1e-9, 2]
    exact = length**2 / (8 * radius) + length**2 / (4 * radius) + force * (length / 2) ** 3 / (3 * stiff)
    assert end == pytest.approx(-exact, rel=0.002)
    lying = (of.points[:, 0] > 10.0) & (of.points[:, 0] < 40.0)
    assert of.moment[lying, 0].mean() == pytest.approx(stiff / radius, rel=0.005)


def test_five_leaves(tmp_path: Path) -> None:
    """Clamped together at one end, a force at the other on the uppermost: all bend alike, so each carries a fifth,
    and between them go .8, .6, .4, .2 of it. Cells of 20, on which the last facets stand for the tips."""
    length, thick, width = 200.0, 4.0, 10.0
    groups: dict[str, dict[str, object]] = {}
    points: list[NDArray[np.float64]] = []
    for k in range(5):
        own, cells = plate(length, width, 10, -k * thick, 22 * k)
        points.append(own)
        groups |= {f"leaf{k}": {"quad4": cells}, f"root{k}": {"line2": [[22 * k, 22 * k + 1]]}}
        groups[f"tip{k}"] = {"line2": [[22 * k + 20, 22 * k + 21]]}
    path = write_msh(tmp_path / "a.msh", np.vstack(points), groups)  # type: ignore[arg-type]
    held = [abut.MidSupport(f"root{k}", **CLAMPED) for k in range(5)]
    made = abut.thicken(path, {f"leaf{k}": abut.Shell(thick) for k in range(5)}, held)
    push = abut.Traction("tip0.edge", (0.0, 0.0, -1.0 / (thick * width)))
    contacts = [abut.Contact(f"leaf{k}.sneg", f"leaf{k + 1}.spos", name=f"between {k}") for k in range(4)]
    solution = solved(made, abut.LinearElastic(E, 0.0), [push], contacts)
    shares = [abs(float(contact.force[2])) for contact in solution.contacts]
    assert shares == pytest.approx([0.8, 0.6, 0.4, 0.2], rel=0.03)
    of = abut.mid_surface(solution, "leaf0")
    end = of.displacement[of.points[:, 0] > length - 1e-9, 2]
    assert end == pytest.approx(-(length**3) / (3 * E * 5 * width * thick**3 / 12), rel=0.005)
