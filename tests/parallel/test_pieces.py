"""Fields in pieces: together they are the whole, as VTK's own reader sees it; nothing of an earlier run stays."""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import abut
from abut.bodies.solids import Solids
from abut.errors import InputError
from abut.mesh.make import box, join, rectangle
from abut.output.fields import write_fields
from abut.output.parallel import Pieces
from abut.output.results import is_written, write
from abut.parallel.partition import pieces
from abut.parallel.team import Kept
from abut.solution import Solution
from abut.solution.grids import field_grid
from models.pieces import names, probe, read, volume


class Team:
    """A team of processes that take turns; what goes to one and comes back is pickled, as by MPI."""

    def __init__(self, size: int) -> None:
        self.size = size
        self.stores: list[dict[str, Any]] = [{} for _ in range(size)]
        self.store = self.stores[0]
        self.numbers = count()

    def keep(self) -> Kept:
        return Kept(next(self.numbers))

    def each(
        self, function: Callable[..., Any], *shared: Any, per_rank: list[tuple[Any, ...]] | None = None
    ) -> list[Any]:
        sent = [pickle.dumps((function, *shared, *mine)) for mine in per_rank or [()] * self.size]
        calls = [pickle.loads(text) for text in sent]
        return [call(store, *arguments) for store, (call, *arguments) in zip(self.stores, calls)]


def dealt(size: int, solution: Solution) -> Team:
    """A team that has its parts of a solution's mesh."""
    team, mesh = Team(size), solution.model.mesh
    parts = pieces(mesh, np.sort(np.arange(mesh.n_cells) % size), size)
    for store, part in zip(team.stores, parts):
        store["part"] = Solids(part.mesh, {})
    team.store["pieces"] = parts
    return team


@pytest.fixture(scope="module")
def blocks() -> Solution:
    """Two blocks under their own weight, of hexahedra of second and wedges of first order."""
    mesh = join(
        {
            "upper": box(z=(1.0, 2.0), cells=(2, 3, 2), cell="wedge6"),
            "lower": box(x=(0.0, 1.5), cells=(3, 2, 2), cell="hex20"),
        }
    )
    steel = abut.LinearElastic(young=2e5, poisson=0.3, density=1.0)
    model = abut.Model(
        mesh,
        solids=[abut.Solid("upper", steel), abut.Solid("lower", steel)],
        supports=[
            abut.Support("lower.bottom", x=0, y=0, z=0),
            abut.Support("upper.left", x=0),
            abut.Support("upper.back", y=0),
        ],
        loads=[abut.Gravity((0.0, 0.0, -10.0))],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", name="c")],
    )
    return abut.solve(model)


@pytest.fixture(scope="module")
def plane() -> Solution:
    """A plane model without contact: vectors get a third component."""
    model = abut.Model(
        join({"b": rectangle(cells=(3, 2), cell="quad8")}),
        plane="strain",
        solids=[abut.Solid("b", abut.LinearElastic(1.0, 0.3))],
        supports=[abut.Support("b.bottom", x=0, y=0), abut.Support("b.top", x=0, y=-0.1)],
    )
    return abut.solve(model)


@pytest.mark.parametrize("size", [2, 3])
@pytest.mark.parametrize("name", ["blocks", "plane"])
def test_pieces_are_the_whole(name: str, size: int, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    solution = request.getfixturevalue(name)
    whole, parts = write(solution, tmp_path / "whole"), tmp_path / "parts"
    write(replace(solution, processes=size), parts, fields=Pieces(dealt(size, solution)))
    assert names(parts) == ["fields_0001.pvtu", *(f"fields_0001_{i:04d}.vtu" for i in range(size))]
    assert (parts / "fields.pvd").read_text() == (whole / "fields.pvd").read_text().replace(".vtu", ".pvtu")
    assert json.loads((parts / "summary.json").read_text())["processes"] == size
    assert json.loads((whole / "summary.json").read_text())["processes"] == 1
    one, other = read(whole / "fields_0001.vtu"), read(parts / "fields_0001.pvtu")
    assert one.GetNumberOfCells() == other.GetNumberOfCells()
    kinds = [sorted(grid.GetCellType(i) for i in range(grid.GetNumberOfCells())) for grid in (one, other)]
    assert kinds[0] == kinds[1]
    assert volume(other) == pytest.approx(volume(one), rel=1e-12)
    mesh = solution.model.mesh
    middles = np.concatenate([mesh.points[block.nodes].mean(axis=1) for block in mesh.blocks])
    places = np.pad(middles + 0.01, ((0, 0), (0, 3 - mesh.dim)))  # inside cells, off their symmetry
    expected, found = probe(one, places), probe(other, places)
    assert list(found) == list(expected) == ["displacement", "stress", "von_mises", "body", "stress_error"]
    for key, values in expected.items():
        assert np.abs(found[key] - values).max() <= 1e-12 * np.abs(values).max(), key
    assert np.ptp(expected["von_mises"]) > 0.0  # what is compared is not constant


def test_pyvista_reads_pieces(blocks: Solution, tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    write(blocks, tmp_path, fields=Pieces(dealt(3, blocks)))
    grid = pyvista.read(tmp_path / "fields_0001.pvtu")
    assert grid.n_cells == blocks.model.mesh.n_cells
    assert {"displacement", "stress", "von_mises"} <= set(grid.point_data)
    assert set(np.unique(grid.cell_data["body"])) == {0, 1}
    reader = pyvista.get_reader(tmp_path / "fields.pvd")
    assert reader.read()[0].n_cells == grid.n_cells


def test_more_processes_than_cells(plane: Solution, tmp_path: Path) -> None:
    write(plane, tmp_path, fields=Pieces(dealt(8, plane)))
    assert len(names(tmp_path)) == 1 + 6
    assert read(tmp_path / "fields_0001.pvtu").GetNumberOfCells() == 6


def test_nothing_of_another_number_of_processes_stays(plane: Solution, tmp_path: Path) -> None:
    step = plane.steps[0]
    other = tmp_path / "fields_00011_0000.vtu"  # of step 11, which this run has not
    other.write_text("")
    for size in (4, 2, 1, 3):
        writer = write_fields if size == 1 else Pieces(dealt(size, plane))
        write(plane, tmp_path, fields=writer)
        pieces = [f"fields_0001_{i:04d}.vtu" for i in range(size)]
        expected = ["fields_0001.vtu"] if size == 1 else ["fields_0001.pvtu", *pieces]
        assert sorted({*names(tmp_path)} - {other.name}) == expected
        assert f'file="{expected[0]}"' in (tmp_path / "fields.pvd").read_text()
        assert is_written(tmp_path, plane, step)
    assert not other.exists()
    (tmp_path / "fields_0001_0002.vtu").unlink()
    assert not is_written(tmp_path, plane, step)


def test_the_list_is_never_there_before_its_pieces(
    plane: Solution, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A run that is killed while it writes pieces leaves no file that names them, not even an old one."""
    write(plane, tmp_path, fields=Pieces(dealt(3, plane)))
    team, seen = dealt(2, plane), []
    each = team.each

    def killed(function: Any, *shared: Any, per_rank: Any = None) -> Any:
        seen.append((tmp_path / "fields_0001.pvtu").exists())
        if function.__name__ == "write_piece":
            raise KeyboardInterrupt
        return each(function, *shared, per_rank=per_rank)

    monkeypatch.setattr(team, "each", killed)
    with pytest.raises(KeyboardInterrupt):
        Pieces(team)(tmp_path, plane.model, plane.steps[0])
    assert seen[-1] is False


def test_a_piece_that_cannot_be_written(plane: Solution, tmp_path: Path) -> None:
    """Raised by process 0, after all have answered."""
    team = dealt(2, plane)
    writer = Pieces(team)
    (tmp_path / "fields_0001_0001.vtu").mkdir()
    with pytest.raises(InputError, match=r"cannot write .*fields_0001_0001\.vtu"):
        writer(tmp_path, plane.model, plane.steps[0])
    assert not (tmp_path / "fields_0001.pvtu").exists()


def test_arrays_named_are_those_written(blocks: Solution, tmp_path: Path) -> None:
    """Name, type and components in the list fit each piece: VTK drops what does not."""
    write(blocks, tmp_path, fields=Pieces(dealt(2, blocks)))
    step = blocks.steps[0]
    grid = field_grid(blocks.model.mesh, step.displacement, step.stress)
    data = read(tmp_path / "fields_0001.pvtu")
    for found, expected in ((data.GetPointData(), grid.point_data), (data.GetCellData(), grid.cell_data)):
        assert [found.GetArrayName(i) for i in range(found.GetNumberOfArrays())] == list(expected)
        for key, values in expected.items():
            assert found.GetArray(key).GetNumberOfComponents() == values[0].size
