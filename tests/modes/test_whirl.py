"""Coriolis forces: whirling with and against a rotation, against closed forms."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.job.convert import write_job
from abut.job.load import load_job
from abut.mesh import make
from abut.output.modes import write_modes
from abut.report.modes import mode_lines, modes_tables

SPEED, MASS = 3.0, 4.0  # of a block 2 wide, 1 high and 1 thick, density 2


def block(along: float, across: float, speed: float = SPEED, **how: object) -> abut.Model:
    """On springs at both sides, as good as rigid."""
    mesh = make.join({"block": make.rectangle([0, 2], [0, 1], cells=[4, 2])})
    springs = [abut.Spring(side, f"block.{side}", x=along / 2.0, y=across / 2.0) for side in ("left", "right")]
    return abut.Model(
        mesh,
        plane="stress",
        solids=[abut.Solid("block", abut.LinearElastic(1e8, 0.0, density=MASS / 2.0))],
        springs=springs,
        loads=[abut.Centrifugal(speed, through=(1.0, 0.5), **how)],
        modes=[abut.Frequencies(2, coriolis=True)],
    )


def found(model: abut.Model) -> abut.solution.ModesResult:
    solution = abut.solve(model)
    assert all(check.passed for check in solution.certificate)
    return solution.modes[0]


@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize("along", [100.0, 60.0])
def test_a_mass_on_springs_whirls_with_and_against_its_rotation(along: float, kinematics: str) -> None:
    """(w^2 - a)(w^2 - b) = (2 Omega w)^2 with a, b = k / m - Omega^2; of equal springs sqrt(k / m) -+ Omega, in circles."""
    result = found(replace(block(along, 100.0), kinematics=kinematics))
    a, b = along / MASS - SPEED**2, 100.0 / MASS - SPEED**2
    squares = np.sort(np.roots([1.0, -(a + b + 4.0 * SPEED**2), a * b]))
    np.testing.assert_allclose(2.0 * np.pi * result.values, np.sqrt(squares), rtol=1e-5)
    np.testing.assert_allclose(result.growth, 0.0, atol=1e-5)
    # of an ellipse x = X cos(w t), y = Y sin(w t), Y / X = (a - w^2) / (2 Omega w) taken from the equation along x
    ratio = (a - squares) / (-2.0 * SPEED * np.sqrt(squares))
    np.testing.assert_allclose(result.whirl, -2.0 * ratio / (1.0 + ratio**2), rtol=1e-4)


def test_the_other_way_round() -> None:
    result = found(block(100.0, 100.0, -SPEED))
    np.testing.assert_allclose(2.0 * np.pi * result.values, [2.0, 8.0], rtol=1e-5)
    np.testing.assert_allclose(result.whirl, [1.0, -1.0], rtol=1e-5)  # with the rotation, whichever that is


def test_beyond_the_critical_speed_equal_springs_are_stable_and_unequal_ones_are_not() -> None:
    """Omega = 4.5 between sqrt(k / m) = sqrt(15) and 5: without Coriolis forces both were said to be unstable (Jeffcott)."""
    squares = np.roots([1.0, -(40.0 + 2.0 * 4.5**2), (15.0 - 4.5**2) * (25.0 - 4.5**2)])
    unequal = found(block(60.0, 100.0, 4.5))
    assert unequal.unstable.tolist() == [True, False]
    assert unequal.growth[0] == pytest.approx(np.sqrt(-squares.min()), rel=1e-5)
    equal = found(
        replace(block(60.0, 60.0, 4.5), modes=[abut.Frequencies(3, coriolis=True)])
    )  # the second turns the block
    assert not equal.unstable.any()
    np.testing.assert_allclose(
        2.0 * np.pi * equal.values[[0, 2]], [4.5 - np.sqrt(15.0), 4.5 + np.sqrt(15.0)], rtol=1e-5
    )


def test_at_the_critical_speed_whirling_stands_still() -> None:
    result = found(replace(block(100.0, 100.0, 5.0), modes=[abut.Frequencies(3, coriolis=True)]))
    np.testing.assert_allclose(2.0 * np.pi * result.values[[0, 2]], [0.0, 10.0], atol=1e-3)
    assert not result.unstable.any()


def test_a_free_ring_carries_its_waves_along() -> None:
    """Bryan (1890): the pattern of n waves lags by 2 / (n^2 + 1) of the turn, so w = w_n -+ 2 n Omega / (n^2 + 1) up to
    (Omega / w_n)^2 and (h / R)^2. Flying away in space is a double root Omega, which parts by the root of rounding."""
    thin, young, density = 0.02, 1e4, 1.0
    radii, halves = [1.0 - thin / 2.0, 1.0 + thin / 2.0], {"upper": [0.0, 180.0], "lower": [180.0, 360.0]}
    mesh = make.join({name: make.ring(radii, angles, cells=[1, 24]) for name, angles in halves.items()})
    second = np.sqrt(young * thin**2 / 12.0 / density) * 6.0 / np.sqrt(5.0)
    speed = 0.002 * second
    model = abut.Model(
        mesh,
        plane="stress",
        solids=[abut.Solid(name, abut.LinearElastic(young, 0.0, density=density)) for name in halves],
        contacts=[
            abut.Contact("upper.end", "lower.start", "left", kind="tied"),
            abut.Contact("upper.start", "lower.end", "right", kind="tied"),
        ],
        loads=[abut.Centrifugal(speed)],
        modes=[abut.Frequencies(5, coriolis=True)],
    )
    result = found(model)
    omega = 2.0 * np.pi * result.values
    np.testing.assert_allclose(omega[:3], [0.0, speed, speed], atol=1e-3 * speed)
    np.testing.assert_allclose(omega[3:].mean(), second, rtol=0.03)
    assert np.diff(omega[3:])[0] / speed == pytest.approx(1.6, rel=2e-3)
    assert not result.unstable[3:].any()


def test_large_models_are_solved_as_small_ones_are(monkeypatch: pytest.MonkeyPatch) -> None:
    """By Arnoldi's method and as a dense matrix."""
    few = found(block(60.0, 100.0))
    monkeypatch.setattr("abut.modes.arnoldi.BASIS", 10**6)
    np.testing.assert_allclose(found(block(60.0, 100.0)).values, few.values, rtol=1e-6)


def test_without_rotation_there_is_nothing_to_find() -> None:
    stopped = abut.Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, 0.0)))
    for model, said in (
        (replace(block(60.0, 100.0), loads=[]), "nothing turns"),
        (block(60.0, 100.0, amplitude=stopped), "nothing turns at time 1"),
        (replace(block(60.0, 100.0), loads=[abut.Centrifugal(1.0), abut.Centrifugal(2.0)]), "about two axes"),
    ):
        with pytest.raises(InputError, match=said):
            abut.solve(model)
    with pytest.raises(InputError, match="stiffening"):
        abut.Frequencies(2, coriolis=True, stiffening=False)
    with pytest.raises(InputError, match="have no twist"):
        abut.solve(replace(block(60.0, 100.0), plane="axisymmetric", springs=[], loads=[abut.Centrifugal(1.0)]))


def test_whirling_is_printed_and_written(tmp_path: Path) -> None:
    solution = abut.solve(block(100.0, 100.0))
    head, first, second = mode_lines(solution.modes[0])
    assert "whirl" in head
    assert "all 2 stable" in head
    assert first.endswith(", 1")
    assert second.endswith(", -1")
    assert [row[3] for row in modes_tables(solution)[0][1]] == ["1.000", "-1.000"]
    write_modes(tmp_path, solution, False)
    with open(tmp_path / "modes.csv", newline="") as file:
        assert [float(row["whirl"]) for row in csv.DictReader(file)] == pytest.approx([1.0, -1.0])


JOB = """schema = 1
model.plane = "stress"
materials.steel = { kind = "linear-elastic", young = 1e8, poisson = 0.0, density = 2.0 }
solids = [{ body = "block", material = "steel" }]
springs = [{ name = "bearing", on = "block.bottom", x = 100, y = 100 }]
loads = [{ kind = "centrifugal", speed = 3.0, through = [1.0, 0.5] }]
mesh.bodies.block = { kind = "rectangle", x = [0, 2], y = [0, 1], cells = [4, 2] }
frequencies = { count = 3, coriolis = true }
"""


def test_a_job_asks_for_it(tmp_path: Path) -> None:
    (tmp_path / "job.toml").write_text(JOB)
    copy, *_ = write_job(tmp_path / "copy.toml", load_job(tmp_path / "job.toml"))
    model = load_job(copy).model
    assert model.modes == (abut.Frequencies(3, coriolis=True),)
    assert len(found(model)) == 3
