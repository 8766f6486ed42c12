"""The certificate's line "stress error": its size, its cure, and what `abut check` makes of it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.analysis.stress_error import stress_error
from abut.bodies.recovery import recovered
from abut.bodies.solids import Solids
from abut.diagnosis.cures import cure
from abut.diagnosis.earlier import sizes_wanted
from abut.mesh.make import join, rectangle
from abut.output.results import summary
from models.certificate import fit, fit_pressure, plate
from models.patch import model, two_blocks
from models.stresses import hertz_line

STEEL = abut.LinearElastic(1.0, 0.0)


def cantilever(cells: tuple[int, int], cell: str = "quad4") -> abut.Model:
    """A moment at its end."""
    mesh = join({"beam": rectangle((0.0, 4.0), (-0.5, 0.5), cells, cell)})
    end = abut.Traction("beam.right", ("y", 0.0))
    held = [abut.Support("beam.left", x=0, y=0)]
    return abut.Model(mesh, [abut.Solid("beam", STEEL)], held, [end], plane="stress")


def off(solution: abut.Solution) -> float:
    error = solution.steps[-1].stress_error
    assert error is not None
    return error.whole


@pytest.mark.parametrize("n", [4, 8])
def test_triangles_in_bending(n: int) -> None:
    """Stress y over the height 1, of which right-angled triangles with legs 1 / n hold their mean: h^2 / 18 is the mean
    square of the rest, 1 / 12 that of the stress. Recovery finds the stress itself."""
    mesh = rectangle((0.0, 4.0), (-0.5, 0.5), (4 * n, n), "tri3")
    solids = Solids(mesh, dict.fromkeys(mesh.bodies, STEEL), "stress")
    stress = np.zeros((mesh.n_cells, 1, 6))
    stress[:, 0, 0] = mesh.points[mesh.blocks[0].nodes].mean(axis=1)[:, 1]
    values = recovered(solids, solids.points, [stress])
    found = stress_error(solids, np.zeros_like(mesh.points), [stress], values, ())
    assert found is not None
    assert found.whole == pytest.approx(np.sqrt(12.0 / 18.0) / n, rel=1e-9)


def test_uniform_stress_has_none() -> None:
    solution = abut.solve(model(two_blocks("quad4", "quad8", ((4, 3), (3, 2)))))
    assert off(solution) < 1e-10


def test_cells_root_mean_square_is_the_body() -> None:
    """By volume, of cells that are alike."""
    solution = abut.solve(cantilever((16, 4), "tri3"))
    error = solution.steps[-1].stress_error
    assert error is not None
    assert np.sqrt((error.cells**2).mean()) == pytest.approx(error.whole, rel=1e-9)


def test_a_coarse_contact_warns_and_says_which_cells(tmp_path: Path) -> None:
    """A sixth of the size, as wanted, brings the error near contact to what was announced, within a half: at the edge of
    contact, where the stress has a root, it falls more slowly than inside."""
    coarse = abut.solve(hertz_line("quad4", 3))
    line = next(c for c in coarse.certificate if c.name == "stress error")
    assert line.verdict == "warn"
    error = coarse.steps[-1].stress_error
    assert error is not None
    wanted = {e.body: e for e in error.near}
    assert set(wanted) == {"block", "cylinder"}
    assert f"{wanted['block'].wanted:.2g} (now {wanted['block'].size:.2g}) in 'block'" in cure(line, coarse)
    fine = (
        abut.solve(hertz_line("quad4", round(3 * wanted["block"].size / wanted["block"].wanted))).steps[-1].stress_error
    )
    assert fine is not None
    assert max(e.error for e in fine.near) == pytest.approx(0.05, rel=0.5)
    (tmp_path / "summary.json").write_text(json.dumps(summary(coarse)))
    told = sizes_wanted(tmp_path)
    assert {finding.where for finding in told} == {"body 'block'", "body 'cylinder'"}
    assert f"cells of {wanted['block'].wanted:.2g} there would bring that to 5%" in {finding.cure for finding in told}


def test_without_an_earlier_run_nothing_is_said(tmp_path: Path) -> None:
    assert sizes_wanted(tmp_path / "none") == []
    for text in ("", "[]", "{}", '{"steps": [{"stress_error": {}}]}'):
        (tmp_path / "summary.json").write_text(text)
        assert sizes_wanted(tmp_path) == []


@pytest.mark.parametrize(("cell", "around"), [("quad4", (8, 12)), ("quad4", (16, 24)), ("tri3", (16, 24))])
def test_the_mean_pressure_of_a_fit(cell: str, around: tuple[int, int]) -> None:
    """The strain energy of bodies that are moved, not loaded, is the least of all that they can take, and of cells too high
    by the square of the error in the energy norm (Galerkin); it is half of what the interference does on the pressure. The
    exact one is that of smooth rings, so that facets have a part in it."""
    solution = abut.solve(fit(around, cell))
    error = solution.steps[-1].stress_error
    assert error is not None
    pressure = solution.contacts[0].pressure
    off = float(np.nanmean(pressure)) / fit_pressure() - 1.0
    assert off == pytest.approx(error.stiffer, rel=0.5)
    (line,) = (check for check in solution.certificate if check.name == "stress error")
    assert f"up to about {error.stiffer:.1%} too much pressure in the mean" in line.meaning


def test_a_load_sets_the_mean() -> None:
    (line,) = (check for check in abut.solve(hertz_line("quad4", 3)).certificate if check.name == "stress error")
    assert "in the mean" not in line.meaning


@pytest.mark.long
@pytest.mark.parametrize(("cell", "n"), [("quad4", 4), ("quad4", 8), ("tri3", 4), ("tri3", 8)])
def test_the_force_of_a_block_pressed_down(cell: str, n: int) -> None:
    """The force does half of its way as strain energy: too high by the same share, of that on a mesh of second order that is
    four or eight times as fine. At the block's corners stresses have no bound and are recovered worse: within a third."""
    (fine, _), (coarse, said) = pressed_down("quad8", 32), pressed_down(cell, n)
    assert coarse / fine - 1.0 == pytest.approx(said, rel=1.0 / 3.0)


def pressed_down(cell: str, n: int) -> tuple[float, float]:
    """Force, and what is said of its error."""
    solution = abut.solve(plate(cell, n, n))
    error = solution.steps[-1].stress_error
    assert error is not None
    return abs(float(solution.contacts[0].force[1])), error.stiffer
