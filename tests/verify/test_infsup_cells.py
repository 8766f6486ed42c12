"""The inf-sup test of contact pressures and pressures of mixed cells together."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import abut
from abut.cli import main
from abut.mesh.make import box, join, rectangle
from abut.mesh.quadrature import PRESSURES
from abut.verify import inf_sup, infsup
from abut.verify.cell_pressures import cell_inf_sup, continuous_inf_sup


def pad(n: int, pressure: str = "auto", integration: str = "mixed") -> abut.Model:
    """Rubber that hangs from a ceiling, on a plate of as many cells."""
    rubber = box((0, 1), (0, 1), (0, 1), (n, n, n), "tet10")
    plate = box((0, 1), (0, 1), (-0.5, 0), (n, n, 1), "tet10")
    return abut.Model(
        join({"rubber": rubber, "plate": plate}),
        [
            abut.Solid("rubber", abut.LinearElastic(3.0, 0.49), integration=integration),
            abut.Solid("plate", abut.LinearElastic(200.0, 0.3)),
        ],
        [abut.Support("rubber.top", x=0.0, y=0.0, z=0.0), abut.Support("plate.bottom", x=0.0, y=0.0, z=0.0)],
        contacts=[abut.Contact("rubber.bottom", "plate.top", pressure=pressure)],
    )


@pytest.mark.parametrize("pressure", ["dual", "P1", "P2"])
def test_together(pressure: str) -> None:
    """No larger than either alone, by its definition: fewer pressures have a larger least eigenvalue. That of cells alone is
    what a cube that is held on one side has, .565 .562 .5615 by another program; contact which is stable takes little of
    it, so that it does not fall with the mesh."""
    found = [inf_sup(pad(n, pressure)).levels[0] for n in (2, 3)]
    alone = []
    for n in (2, 3):
        mesh = box(cells=(n,) * 3, cell="tet10")
        alone.append(continuous_inf_sup(mesh, mesh.points[:, 2] > 1e-12))
    for level, cells in zip(found, alone):
        assert level.cells is not None
        assert level.cells <= min(level.trace, cells) * (1.0 + 1e-6)
        assert level.cells > 0.9 * min(level.trace, cells)
    assert "together" in inf_sup(pad(2, pressure)).verdict


def test_unstable_contact_shows_there_too() -> None:
    """Constant pressures on facets that match the target's: whatever displacements do not feel stays unfelt."""
    coarse, fine = (inf_sup(pad(n, "P0")).levels[0] for n in (2, 4))
    assert fine.cells is not None
    assert fine.cells <= fine.trace * (1.0 + 1e-6) < 0.6 * coarse.trace
    assert not inf_sup([pad(2, "P0"), pad(4, "P0")]).stable


def test_pressures_that_fall_together(monkeypatch: pytest.MonkeyPatch) -> None:
    """Contact alone may be stable: then what both have together decides."""
    values = iter([0.5, 0.3, 0.5, 1e-9])
    monkeypatch.setattr(infsup, "_with_cells", lambda *_: next(values))
    models = [pad(2), pad(4)]
    falling = inf_sup(models)
    assert not falling.stable
    assert "h^0.74" in falling.verdict  # log2 5/3
    assert "no displacement feels" in inf_sup(models).verdict


def flat_pad(cell: str, n: int, pressure: str = "auto", rigid: bool = False) -> abut.Model:
    """A square of rubber on a plate, its top held, or all but the side of contact on a rigid plate."""
    rubber = rectangle((0, 1), (0, 1), (n, n), cell)
    plate = rectangle((0, 1), (-0.5, 0), (n, n), cell)
    base = [abut.Solid("plate", abut.LinearElastic(200.0, 0.3))]
    held = ["top", "left", "right"] if rigid else ["top"]
    return abut.Model(
        join({"rubber": rubber, "plate": plate}),
        [abut.Solid("rubber", abut.LinearElastic(3.0, 0.5), integration="mixed"), *([] if rigid else base)],
        [abut.Support(f"rubber.{side}", x=0.0, y=0.0) for side in held]
        + ([] if rigid else [abut.Support("plate.bottom", x=0.0, y=0.0)]),
        contacts=[abut.Contact("rubber.bottom", "plate.top", pressure=pressure)],
        rigid=[abut.Rigid("plate", x=0.0, y=0.0, rz=0.0)] if rigid else [],
        plane="strain",
    )


@pytest.mark.parametrize("cell", ["tri6", "quad8", "quad9"])
def test_together_with_pressures_of_single_cells(cell: str) -> None:
    """As those that are continuous: no larger than either alone, of which contact that is stable takes little (a tenth where
    the cells' own constant still falls to its limit), and not falling with the mesh."""
    sizes, together = (4, 8), []
    levels = inf_sup([flat_pad(cell, n) for n in sizes]).levels
    for n, level in zip(sizes, levels):
        mesh = rectangle((0, 1), (0, 1), (n, n), cell)
        alone = cell_inf_sup(mesh, mesh.points[:, 1] < 1.0 - 1e-12, PRESSURES[cell])
        assert level.cells is not None
        assert level.cells <= min(level.trace, alone) * (1.0 + 1e-6)
        assert level.cells > 0.85 * min(level.trace, alone)
        together.append(level.cells)
    assert together[1] > 0.95 * together[0]


@pytest.mark.parametrize("cell", ["tri6", "quad9"])
def test_contact_on_the_only_free_side(cell: str) -> None:
    """Of a body that keeps its volume and is held everywhere else: its constant pressure and that of contact see the same
    volume, so that no displacement feels the two together."""
    result = inf_sup(flat_pad(cell, 4, "P1", rigid=True))
    assert result.levels[0].cells == pytest.approx(0.0, abs=1e-7)
    assert result.levels[0].spurious == 0
    assert not result.stable
    assert "no displacement feels" in result.verdict


def test_other_cells_have_none() -> None:
    """Fully integrated ones."""
    assert inf_sup(pad(2, integration="full")).levels[0].cells is None


JOB = """
schema = 1
[mesh.bodies.plate]
kind = "box"
x = [0, 1]
y = [0, 1]
z = [-0.5, 0]
cells = [2, 2, 1]
[mesh.bodies.rubber]
kind = "box"
x = [0, 1]
y = [0, 1]
z = [0, 1]
cells = [2, 2, 2]
cell = "tet10"
[materials.rubber]
kind = "linear-elastic"
young = 3
poisson = 0.4999
[[solids]]
body = "rubber"
material = "rubber"
[[solids]]
body = "plate"
material = "rubber"
[[supports]]
on = "plate.bottom"
x = 0
y = 0
z = 0
[[supports]]
on = "rubber.top"
x = 0
y = 0
z = -0.01
[[contacts]]
name = "foot"
surfaces = ["rubber.bottom", "plate.top"]
"""


def test_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A column more; in JSON too."""
    path = tmp_path / "job.toml"
    path.write_text(JOB)
    assert main(["infsup", str(path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[1].endswith("beta with cells")
    assert main(["infsup", "--json", str(path)]) == 0
    level = json.loads(capsys.readouterr().out)[0]["levels"][0]
    assert lines[2].split()[-1] == f"{level['cells']:.4f}"
