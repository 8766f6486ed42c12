"""Contact end to end where theory gives the answer: mixed meshes, joints in a surface, overlap, planes, heat, weight."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.job import load_job
from abut.mesh.facets import facet_keys, number_keys
from abut.mesh.make import block, box, join, rectangle
from abut.mesh.mesh import CellBlock, Mesh
from abut.output.results import write
from models.patch import errors, model
from models.split import split_base

EXACT = 1e-10
HEX27_IN_WEDGE15 = (  # nodes of a nine-node-faced hexahedron that make up its two halves
    (0, 1, 2, 4, 5, 6, 8, 9, 24, 12, 13, 25, 16, 17, 18),
    (0, 2, 3, 4, 6, 7, 24, 10, 11, 25, 14, 15, 16, 18, 19),
)


def mixed(lines: list[NDArray[np.float64]]) -> Mesh:
    """A block of hex20 columns, every second one of them halved into wedge15: quad8 and tri6 side by side on top."""
    whole = block.grid(lines, "hex27")
    nodes = whole.blocks[0].nodes
    centre = whole.points[nodes[:, 26]]
    column = sum(np.searchsorted(line, centre[:, a]) for a, line in enumerate(lines[:2]))
    halved = column % 2 == 0
    hexes = nodes[~halved][:, :20]
    wedges = np.concatenate([nodes[halved][:, list(half)] for half in HEX27_IN_WEDGE15])
    used = np.unique(np.concatenate([hexes.ravel(), wedges.ravel()]))
    number = np.full(len(whole.points), -1, dtype=np.int32)
    number[used] = np.arange(len(used))
    blocks = (CellBlock("hex20", number[hexes]), CellBlock("wedge15", number[wedges]))
    cells = np.arange(len(hexes) + len(wedges))
    bare = Mesh(whole.points[used], blocks, {"body": cells})
    surfaces = {}
    keys, rows = facet_keys(bare, np.arange(len(bare.points)))
    _, index = number_keys(keys[:1], keys)
    outside = np.bincount(index)[index] == 1
    for axis in range(3):
        for side, name in enumerate((("left", "right"), ("front", "back"), ("bottom", "top"))[axis]):
            level = lines[axis][-side]
            on = np.array([np.abs(bare.points[k[k >= 0], axis] - level).max() < 1e-9 for k in keys])
            surfaces[name] = rows[on & outside]
    return replace(bare, surfaces=surfaces)


@pytest.mark.parametrize("swap", [False, True])
def test_mixed_cells_pass_the_patch_test(swap: bool) -> None:
    """quad8 and tri6 facets in one contactor, and in one target."""
    lower = mixed([np.linspace(0, 1, 4), np.linspace(0, 1, 3), np.linspace(0, 1, 3)])
    upper = mixed([np.linspace(0, 1, 3), np.linspace(0, 1, 5), np.linspace(1, 1.8, 2)])
    mesh = join({"lower": lower, "upper": upper})
    assert {b.kind for b in mesh.blocks} == {"hex20", "wedge15"}
    pair = {"contactor": "upper.bottom", "target": "lower.top"} if swap else {}
    assert max(errors(model(mesh, **pair))) < EXACT


@pytest.mark.parametrize("contactor_below", [False, True])
def test_t_junctions_on_either_side(contactor_below: bool) -> None:
    solution = abut.solve(split_base(contactor_below))
    pressure = solution.contacts[0].pressure
    assert np.nanmax(np.abs(pressure / 1e-3 - 1.0)) < EXACT


@pytest.mark.parametrize("plate_carries", [False, True])
@pytest.mark.parametrize("cell", ["hex8", "hex20", "tet10"])
def test_overlap_and_edges_that_drop_off(plate_carries: bool, cell: str) -> None:
    """A punch turned by 30 degrees that overhangs the plate on one side; contactor larger or smaller than the target.
    Statics gives resultant and moment of the contact pressure."""
    punch = box((-0.5, 0.5), (-0.5, 0.5), (0, 0.6), (3, 3, 2), cell)
    turn = np.deg2rad(30)
    c, s = np.cos(turn), np.sin(turn)
    x = punch.points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + [0.8, 0.1, 0]
    mesh = join({"plate": box((-1, 1), (-1, 1), (-0.5, 0), (5, 5, 2), cell), "punch": replace(punch, points=x)})
    pair = ("plate.top", "punch.bottom") if plate_carries else ("punch.bottom", "plate.top")
    model = abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(1000.0, 0.3)) for body in mesh.bodies],
        [abut.Support("plate.bottom", x=0, y=0, z=0), abut.Support("punch.top", x=0, y=0)],
        [abut.Force("punch.top", (0.0, 0.0, -1.0))],
        [abut.Contact(contactor=pair[0], target=pair[1])],
        solve=abut.SolveOptions(steps=3),
    )
    solution = abut.solve(model)
    assert solution.converged
    area = solution.contacts[0]
    assert not area.covered.all()  # part of the contactor faces nothing
    for step in solution.steps:
        force = step.contacts[0].force
        assert force[2] == pytest.approx(step.factor * (-1.0 if plate_carries else 1.0), rel=1e-9)
        assert np.abs(step.reaction + step.load).max() < 1e-9
        assert np.abs(step.reactions["plate.bottom"][2] - step.factor) < 1e-9
    assert np.nanmin(area.pressure) > -0.1 * area.max_pressure


@pytest.mark.parametrize("plane", ["strain", "stress"])
@pytest.mark.parametrize("cell", ["quad4", "quad8", "tri6"])
def test_contact_in_the_plane(plane: str, cell: str) -> None:
    """Both sides held: p = E' eps with E' = E (1 - nu) / ((1 + nu) (1 - 2 nu)) or E / (1 - nu^2)."""
    mesh = join({"lower": rectangle((0, 1), (0, 1), (3, 2), cell), "upper": rectangle((0, 1), (1, 2), (4, 2), cell)})
    young, nu = 1000.0, 0.3
    held = [abut.Support(f"{body}.{side}", x=0) for body in ("lower", "upper") for side in ("left", "right")]
    model = abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(young, nu)) for body in mesh.bodies],
        [*held, abut.Support("lower.bottom", y=0), abut.Support("upper.top", y=-2e-3)],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top")],
        plane=plane,
    )
    modulus = young * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) if plane == "strain" else young / (1 - nu**2)
    pressure = abut.solve(model).contacts[0].pressure
    assert np.nanmax(np.abs(pressure / (1e-3 * modulus) - 1.0)) < EXACT


COLUMN = """
schema = 1
[mesh.bodies.lower]
kind = "box"
x = [0, 2]
y = [0, 2]
z = [0, 1]
cells = [2, 3, 2]
cell = "hex20"
[mesh.bodies.upper]
kind = "box"
x = [0, 2]
y = [0, 2]
z = [1, 3]
cells = [3, 2, 2]
cell = "tet10"
[materials.steel]
kind = "linear-elastic"
young = 200e3
poisson = 0.0
density = 7.8e-9
expansion = 1.2e-5
[[solids]]
body = "lower"
material = "steel"
temperature = {lower}
[[solids]]
body = "upper"
material = "steel"
temperature = {upper}
[[supports]]
on = "lower.bottom"
x = 0
y = 0
z = 0
[[supports]]
on = "upper.left"
x = 0
[[supports]]
on = "upper.front"
y = 0
{rest}
[[contacts]]
name = "joint"
contactor = "upper.bottom"
target = "lower.top"
[solve]
steps = 2
"""


def test_heat_between_walls(tmp_path: Path) -> None:
    """A column held at both ends, heated unevenly: p = E alpha (T1 h1 + T2 h2) / (h1 + h2), from a job file. The foot is
    held sideways too, which with nu = 0 matters only through the foot's own expansion: none there, T1 = 0."""
    job = tmp_path / "job.toml"
    job.write_text(COLUMN.format(lower=0, upper=60, rest='[[supports]]\non = "upper.top"\nz = 0'))
    solution = abut.solve(load_job(job).model)
    expected = 200e3 * 1.2e-5 * 60 * 2 / 3
    for step in solution.steps:
        pressure = step.contacts[0].pressure
        assert np.nanmax(np.abs(pressure / (step.factor * expected) - 1.0)) < EXACT


def test_weight(tmp_path: Path) -> None:
    """A block that lies there by its weight alone: p = rho g h, and the supports carry both blocks."""
    job = tmp_path / "job.toml"
    job.write_text(COLUMN.format(lower=0, upper=0, rest='[[loads]]\nkind = "gravity"\nvalue = [0, 0, -9810]'))
    solution = abut.solve(load_job(job).model)
    expected = 7.8e-9 * 9810 * 2
    assert np.nanmax(np.abs(solution.contacts[0].pressure / expected - 1.0)) < 1e-8
    assert solution.steps[-1].reactions["lower.bottom"][2] == pytest.approx(7.8e-9 * 9810 * 12, rel=1e-9)
    write(solution, tmp_path / "results")
    text = (tmp_path / "results" / "summary.json").read_text()
    assert text.count('"force"') >= 2  # in every step


def test_interference_fit() -> None:
    """A negative offset is an interference: two columns between walls, p = E d / H."""
    mesh = join(
        {
            "lower": box((0, 1), (0, 1), (0, 1), (2, 2, 2), "hex8"),
            "upper": box((0, 1), (0, 1), (1, 2), (3, 3, 2), "hex8"),
        }
    )
    model = abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(100.0, 0.0)) for body in mesh.bodies],
        [abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", x=0, y=0, z=0)],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", offset=-0.004)],
    )
    assert np.nanmax(np.abs(abut.solve(model).contacts[0].pressure / 0.2 - 1.0)) < EXACT
