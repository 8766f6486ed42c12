"""Cyclic symmetry: a sector with its sides joined is the whole."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.benchmarks import BENCHMARKS, run
from abut.cli import main
from abut.errors import InputError
from abut.mesh.make import box, join, rectangle, ring

STEEL = abut.LinearElastic(1000.0, 0.3, 1.0)


def test_closed_form() -> None:
    for outcome in run(BENCHMARKS["ring-sector"]):
        assert outcome.passed, outcome


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_without_the_equations_it_is_another_model(kinematics: str) -> None:
    """The same sector with free sides gives way more; with them small loads do the same under both kinematics."""
    model = BENCHMARKS["ring-sector"].model(0)
    loads = [replace(model.loads[0], value=(0.0, 1e-3))]
    whole = abut.solve(replace(model, loads=loads, kinematics=kinematics)).displacement
    linear = abut.solve(replace(model, loads=loads)).displacement
    assert whole == pytest.approx(linear, abs=1e-5 * np.abs(linear).max())
    free = abut.solve(replace(model, loads=loads, equations=(), kinematics=kinematics)).displacement
    assert np.abs(free).max() > 1.05 * np.abs(whole).max()


def around(degrees: float, cells: int) -> abut.Mesh:
    """A ring from the angle 0 on, a strip bent round."""
    flat = join({"ring": rectangle((1.0, 1.5), (0.0, degrees), (1, cells), "quad4")})
    r, angle = flat.points[:, 0], np.deg2rad(flat.points[:, 1])
    return replace(flat, points=np.column_stack([r * np.cos(angle), r * np.sin(angle)]))


def vibrating(mesh: abut.Mesh, equations: Sequence[abut.Equation], asked: abut.Frequencies) -> abut.Model:
    held = [abut.Support("ring.left", x=0, y=0)]
    solids = [abut.Solid("ring", STEEL)]
    return abut.Model(mesh, solids, held, plane="strain", equations=equations, modes=[asked])


def test_nodal_diameters() -> None:
    """Frequencies of all nodal diameters of a sixth of a ring are those of the whole one, whose seam is closed node by node;
    of half of the sectors the sector gives each twice as often."""
    whole = around(360.0, 18)
    seam = zip(np.unique(whole.nodes_of("ring.bottom")), np.unique(whole.nodes_of("ring.top")))
    closed = [
        abut.Equation((abut.Term(int(a), axis, 1.0), abut.Term(int(b), axis, -1.0))) for a, b in seam for axis in "xy"
    ]
    wanted = abut.solve(vibrating(whole, closed, abut.Frequencies(8))).modes[0].values
    added = abut.add_sectors(around(60.0, 3), [abut.Sector("ring.bottom", "ring.top", 6)])
    asked = abut.Frequencies(4, diameters=(0, 1, 2, 3), sectors=6, side="ring.bottom nodes")
    modes = abut.solve(vibrating(added.mesh, added.equations, asked)).modes
    found = np.sort(np.concatenate([one.values[:: 2 if one.diameter == 3 else 1] for one in modes]))
    assert found[:8] == pytest.approx(wanted, rel=1e-7)  # squares to that of the whole ring's solution


def test_nodes_on_the_axis_stay_there() -> None:
    """A quarter of a solid shaft, named by its own planes: the axis moves along itself only."""
    mesh = join({"b": box((0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (2, 2, 2), "hex8")})
    added = abut.add_sectors(mesh, [abut.Sector("b.left", "b.front", 4)])
    model = abut.Model(
        added.mesh, [abut.Solid("b", STEEL)], [abut.Support("b.bottom", z=0)],
        [abut.Traction("b.top", (0.0, 0.0, 3.0))], equations=added.equations,
    )  # fmt: skip
    moved = abut.solve(model).displacement
    axis = (mesh.points[:, :2] == 0.0).all(axis=1)
    assert np.abs(moved[axis, :2]).max() < 1e-12
    strain = 3.0 / 1000.0
    assert moved == pytest.approx(
        mesh.points * (-0.3 * strain, -0.3 * strain, strain), abs=1e-12
    )  # a bar that is drawn


@pytest.mark.parametrize(
    ("sector", "said"),
    [
        (("ring.start", "ring.end", 5), r"sectors\[0\]: no node of 'ring.end' is where .* is one of 5 sectors on"),
        (("ring.start", "ring.outer", 9), "no node of 'ring.outer'"),
        (("ring.stat", "ring.end", 9), r"sectors\[0\].side: no surface or node set named 'ring.stat'"),
        (("ring.start", "ring.end", 9, (0, 0, 1)), r"sectors\[0\].axis: the model is 2D; leave axis out"),
        (("ring.start", "ring.end", 9, None, (0, 0, 1)), r"sectors\[0\].origin: expected 2 numbers, got 3"),
    ],
)
def test_sides_that_do_not_fit(sector: tuple, said: str) -> None:
    mesh = join({"ring": ring((1.0, 2.0), (20.0, 60.0), cells=(2, 3))})
    with pytest.raises(InputError, match=said):
        abut.add_sectors(mesh, [abut.Sector(*sector)])
    with pytest.raises(InputError, match="sectors: expected a whole number of 2 or more, got 1"):
        abut.Sector("ring.start", "ring.end", 1)


JOB = """schema = 1
model.plane = "stress"
materials.steel = { kind = "linear-elastic", young = 1000, poisson = 0.3, density = 1.0 }
solids = [{ body = "disc", material = "steel" }]
supports = [{ on = "disc.inner", y = 0, axes = { kind = "cylindrical" } }]
loads = [{ kind = "centrifugal", speed = 1.0 }]
mesh.bodies.disc = { kind = "ring", radii = [1, 5], angles = [10, 40], cells = [8, 6] }
sectors = [{ side = "disc.start", other = "disc.end", sectors = 12 }]
probes = [{ name = "rim", at = [3.83022221559489, 3.2139380484326963], of = ["displacement"] }]
"""


def test_rotating_disc_in_a_job(tmp_path: Path) -> None:
    """Timoshenko's growth of the rim of a disc with a bore, read at 40 degrees, on the side that is followed."""
    (tmp_path / "job.toml").write_text(JOB)
    assert main(["run", "--quiet", str(tmp_path / "job.toml")]) in (0, 3)
    head, *_, last = (tmp_path / "results" / "probe_rim.csv").read_text().splitlines()
    row = dict(zip(head.split(","), last.split(",")))
    found = np.hypot(float(row["displacement_x"]), float(row["displacement_y"]))
    growth = 1.0 / 4.0 * 5.0 / 1000.0 * ((1 - 0.3) * 5.0**2 + (3 + 0.3) * 1.0**2)
    assert found == pytest.approx(growth, rel=1e-3)
