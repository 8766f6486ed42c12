"""Complex frequencies of sliding assemblies: the squeal of two modes in closed form, and a pad on a moving slab."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse as sp

import abut
import abut.analysis.modes
from abut.bodies.mass import mass
from abut.cli import main
from abut.errors import InputError
from abut.job import load_job
from abut.job.convert import write_job
from abut.mesh import make
from abut.modes.frequencies import densities
from abut.modes.sliding import UnsymmetricFactors
from abut.output.modes import write_modes
from abut.report.modes import mode_lines, modes_tables

PRESS = 1e-3  # small beside the block, so that displacements are small


def two_modes(friction: float, dim: int = 2) -> abut.Model:
    """A rigid block of mass 1 on a weightless slab that yields in its height alone, by 1 per force, and is drawn along x.

    A spring of 2 on the block's slanted face, one of 1 along x and the slab's 1 under the block make
    K = [[2, -1 + mu], [-1, 2]] and M = 1, as 1 + mu would with the slab drawn the other way."""
    make_one, up = (make.rectangle, "y") if dim == 2 else (make.box, "z")
    cell = "quad4" if dim == 2 else "hex8"
    flat = [[0.0, 1.0]] * (dim - 1)
    block, slab = (make_one(*flat, [low, low + 1.0], cells=[1] * dim, cell=cell) for low in (1.0, 0.0))
    points = block.points.copy()
    points[(points[:, 0] == 1.0) & (points[:, -1] == 2.0), 0] = 2.0
    mesh = make.join({"block": replace(block, points=points), "slab": slab})
    first, *others = mesh.nodes_of("block").tolist()
    mesh = replace(mesh, node_sets={**mesh.node_sets, "slab": mesh.nodes_of("slab"), "block": mesh.nodes_of("block")})
    aside = {"y": 0.0} if dim == 3 else {}
    return abut.Model(
        mesh,
        plane="stress" if dim == 2 else None,
        solids=[
            abut.Solid("block", abut.LinearElastic(1.0, 0.0, density=1.0 / 1.5)),
            abut.Solid("slab", abut.LinearElastic(1.0, 0.0)),
        ],
        supports=[
            abut.Support("slab", x=0.05, **aside),
            abut.Support("slab.bottom", **{up: 0.0}),
            *([abut.Support("block", **aside)] if aside else []),
        ],
        loads=[abut.Traction("block.top", (0.0,) * (dim - 1) + (-PRESS / 2.0,))],
        springs=[abut.Spring("slanted", "block.right", normal=2.0), abut.Spring("along", "block.left", x=1.0)],
        contacts=[abut.Contact("block.bottom", "slab.top", friction=friction)],
        equations=[
            abut.Equation((abut.Term(first, along, 1.0), abut.Term(other, along, -1.0)), 0.0)
            for other in others
            for along in ("x", up)
        ],
        modes=[abut.Frequencies(2, stiffening=False, complex=True)],
    )


def pad(friction: float, force: float = 0.0, complex: bool = True) -> abut.Model:
    """Pressed on a stiffer slab that is drawn along under it, with a force along its right side."""
    above, below = (
        make.rectangle(x, y, cells=n) for x, y, n in (([-10, 10], [0, 40], [4, 5]), ([-30, 30], [-20, 0], [12, 3]))
    )
    mesh = make.join({"pad": above, "slab": below})
    return abut.Model(
        mesh,
        plane="strain",
        solids=[
            abut.Solid("pad", abut.LinearElastic(70e3, 0.3, density=2.7e-9)),
            abut.Solid("slab", abut.LinearElastic(210e3, 0.3, density=7.85e-9)),
        ],
        supports=[abut.Support("pad.top", x=0, y=-0.01), abut.Support("slab.bottom", x=1.0, y=0)],
        loads=[abut.Force("pad.right", (0.0, force))] if force else [],
        contacts=[abut.Contact("pad.bottom", "slab.top", friction=friction)],
        modes=[abut.Frequencies(6, stiffening=False, complex=complex)],
    )


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("friction", [0.0, 0.5, 0.9, 1.2, 2.0])
def test_two_modes_merge_where_friction_is_1(friction: float, dim: int):
    """omega^2 = 2 +- sqrt(1 - mu) of matrices of two by two, exact but for what held gaps give way by, 1e-9."""
    result = abut.solve(two_modes(friction, dim)).modes[0]
    omega = np.sqrt(2.0 + np.array([-1.0, 1.0]) * np.sqrt(complex(1.0 - friction)))
    np.testing.assert_allclose(2.0 * np.pi * result.values, omega.real, rtol=1e-8)
    np.testing.assert_allclose(np.sort(result.growth), np.sort(-omega.imag), atol=1e-8)
    assert result.unstable.sum() == (friction > 1.0)
    assert result.slips == (friction > 0.0)
    assert all(check.passed for check in result.certificate)


def captured(model: abut.Model, monkeypatch: pytest.MonkeyPatch) -> tuple[abut.Solution, list[Any]]:
    """With what complex frequencies were found from."""
    given: list[Any] = []
    usual = abut.analysis.modes.complex_frequencies

    def listening(*all_of_it):
        given.extend(all_of_it)
        return usual(*all_of_it)

    monkeypatch.setattr(abut.analysis.modes, "complex_frequencies", listening)
    return abut.solve(model), given


def test_frequencies_are_those_of_the_whole_pencil(monkeypatch: pytest.MonkeyPatch):
    """Arnoldi's method on factors against LAPACK's QZ of displacements and multipliers, whose mass is zero. At this
    friction part of the contact sticks, part is open, and two modes have merged."""
    solution, (model, constraints, held, slides, _) = captured(pad(1.2), monkeypatch)
    result = solution.modes[0]
    heavy = constraints.reduce(mass(model.mesh, densities(model))).toarray()
    stiff = sp.bmat([[held.stiffness + slides.skew, -slides.pushing.T], [-held.rows, -sp.diags(held.give)]]).toarray()
    squares = scipy.linalg.eigvals(stiff, scipy.linalg.block_diag(heavy, np.zeros((len(held.give),) * 2)))
    squares = squares[np.isfinite(squares)]
    omega = np.sqrt(squares[np.argsort(np.abs(squares))][: len(result)])
    np.testing.assert_allclose(2.0 * np.pi * result.values, omega.real, rtol=1e-5)
    np.testing.assert_allclose(np.sort(result.growth), np.sort(-omega.imag), atol=1e-5 * np.abs(omega).max())
    assert result.unstable.any()
    assert result.residual < 1e-8


@pytest.mark.parametrize(("kinematics", "tolerance"), [("small", 1e-6), ("finite", 5e-5)])
def test_the_stiffness_is_that_of_sliding_under_load(
    kinematics: str, tolerance: float, monkeypatch: pytest.MonkeyPatch
):
    """A force along the pad's side while all of it slips, friction with the change of pressure: Newton's method finds the
    change that the factors do; large displacements but for what is quadratic in it."""
    without, (_, constraints, held, slides, _) = captured(replace(pad(0.4), kinematics=kinematics), monkeypatch)
    force = 1.0
    loaded = abut.solve(replace(pad(0.4, force), modes=[], kinematics=kinematics))
    change = loaded.steps[-1].displacement - without.steps[-1].displacement
    points, forces = without.model.mesh.points, np.zeros_like(change)
    side = np.flatnonzero(points[:, 0] == 10.0)
    side = side[(points[side, 1] >= 0.0) & np.isin(side, without.model.mesh.nodes_of("pad"))]
    side = side[np.argsort(points[side, 1])]
    for first in range(0, len(side) - 2, 2):  # Simpson's rule on each of five edges
        forces[side[first : first + 3], 1] += force / 5.0 * np.array([1.0, 4.0, 1.0]) / 6.0
    factors = UnsymmetricFactors((held.stiffness + slides.skew).tocsr(), held, slides.pushing)
    found = constraints.free @ factors.solve(constraints.free.T @ forces.ravel())
    np.testing.assert_allclose(found, change.ravel(), atol=tolerance * np.abs(change).max())


def test_without_friction_they_are_the_real_ones():
    complex_ones, real = (abut.solve(pad(0.0, complex=wanted)).modes[0] for wanted in (True, False))
    np.testing.assert_allclose(complex_ones.values, real.values, rtol=1e-8)
    assert not complex_ones.growth.any()
    assert not complex_ones.slips


def test_complex_is_true_or_false():
    with pytest.raises(InputError, match="complex"):
        abut.Frequencies(complex=1)


def test_what_is_unstable_is_printed_and_written(tmp_path: Path):
    """One of two modes grows; the phase of a mode that grows is not the same everywhere, so it has two parts."""
    solution = abut.solve(two_modes(1.2))
    lines = mode_lines(solution.modes[0])
    assert "1 of 2 unstable: the fastest grows at 0.157147" in lines[0]
    assert [line.endswith(", unstable") for line in lines[1:]] == [True, False]
    (_, rows, title) = modes_tables(solution)[0]
    assert [row[3] for row in rows] == ["unstable", ""]
    assert "1 of 2 unstable" in title
    write_modes(tmp_path, solution, True)
    with open(tmp_path / "modes.csv", newline="") as file:
        table = list(csv.DictReader(file))
    assert [row["unstable"] for row in table] == ["yes", "no"]
    np.testing.assert_allclose([float(row["growth_rate"]) for row in table], [0.157147, -0.157147], atol=5e-7)
    assert b'"complex_frequency_0001_imaginary"' in (tmp_path / "modes.vtu").read_bytes()
    assert np.abs(solution.modes[0].imaginary).max() > 0.1 * np.abs(solution.modes[0].shapes).max()
    assert "nothing slips" in mode_lines(abut.solve(two_modes(0.0)).modes[0])[0]


JOB = """schema = 1
model.plane = "strain"
materials.lining = { kind = "linear-elastic", young = 70e3, poisson = 0.3, density = 2.7e-9 }
materials.steel = { kind = "linear-elastic", young = 210e3, poisson = 0.3, density = 7.85e-9 }
solids = [{ body = "pad", material = "lining" }, { body = "slab", material = "steel" }]
supports = [{ on = "pad.top", x = 0, y = -0.01 }, { on = "slab.bottom", x = 1, y = 0 }]
contacts = [{ name = "sole", contactor = "pad.bottom", target = "slab.top", friction = 1.2 }]
mesh.bodies.pad = { kind = "rectangle", x = [-10, 10], y = [0, 40], cells = [4, 5] }
mesh.bodies.slab = { kind = "rectangle", x = [-30, 30], y = [-20, 0], cells = [12, 3] }
frequencies = { count = 4, complex = true }
"""


def test_a_job_asks_for_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Modes 3 and 4 have merged, so that three are four."""
    (tmp_path / "job.toml").write_text(JOB)
    copy, *_ = write_job(tmp_path / "copy.toml", load_job(tmp_path / "job.toml"))
    assert load_job(copy).model.modes == (abut.Frequencies(4, complex=True),)
    assert main(["run", str(copy)]) == 0
    assert "1 of 4 unstable: the fastest grows at" in capsys.readouterr().out
    three = replace(load_job(copy).model, modes=[abut.Frequencies(3, complex=True)])
    assert len(abut.solve(three).modes[0]) == 4
