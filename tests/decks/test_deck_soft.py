"""PRESSURE-OVERCLOSURE of decks: how far surfaces would overlap, and solved as it is. Two bricks in a row, E = 1000,
1 x 1 x 1, no Poisson's ratio, under a pressure of 10: the top comes down by 0.02 and the overclosure; so in CalculiX."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.cli import main
from abut.decks.overclosure import overlaps
from abut.job.load import load_job
from abut.verify import law_tangents
from models.decks import BRICKS, HELD, PAIR, PUSH, write

LAWS = {
    "LINEAR\n1000.": 0.01,
    "LINEAR\n1000., 1.E-6, 0.1": 0.01,  # what belongs to nodes to surface is not needed
    "TABULAR\n0., 0.\n0., 0.001\n5., 0.011\n20., 0.021": 0.011 + 5.0 * 0.01 / 15.0,
    "EXPONENTIAL\n0.01, 5.": 0.01 * math.log(2.0) / math.log(100.0),
}


def deck(law: str, step: str = "*STEP") -> str:
    return (BRICKS + PAIR.replace("HARD", law) + HELD + PUSH).replace("*STEP", step)


@pytest.mark.parametrize(("law", "overlap"), LAWS.items(), ids=[law.split("\n")[0] for law in LAWS])
def test_contact_of_the_deck(law: str, overlap: float, tmp_path: Path) -> None:
    """Exact contact says what is missing; --soft-contact solves it. An exponential law is a table, 0.2 % off in between."""
    path = write(tmp_path, deck(law))
    exact, soft = load_job(path), load_job(path, soft=True)
    assert any("replaced by exact contact" in note for note in exact.notes)
    solution = abut.solve(exact.model)
    assert -solution.displacement[:, 2].min() == pytest.approx(0.02, rel=1e-9)
    (said,) = overlaps(solution, exact.own_laws)
    assert f"overlap by {overlap:.2g}"[:15] in said
    assert "--soft-contact" in said
    assert any("solved as it is" in note for note in soft.notes)
    solution = abut.solve(soft.model)
    assert solution.converged
    tolerance = 2e-3 * overlap if "EXP" in law else 1e-9
    assert -solution.displacement[:, 2].min() == pytest.approx(0.02 + overlap, abs=tolerance)
    assert overlaps(solution, soft.own_laws) == []


def test_large_displacements(tmp_path: Path) -> None:
    """The bricks are a little stiffer (Saint Venant and Kirchhoff), the law is the same."""
    path = write(tmp_path, deck("LINEAR\n1000.", "*STEP, NLGEOM"))
    exact, soft = (abut.solve(load_job(path, soft=own).model) for own in (False, True))
    assert soft.converged
    assert exact.displacement[:, 2].min() - soft.displacement[:, 2].min() == pytest.approx(0.01, rel=1e-6)


def test_notes_of_a_run_have_the_overlap(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write(tmp_path, deck("LINEAR\n1000."))
    assert main(["run", str(path), "--output", str(tmp_path / "out")]) == 0
    assert "would let the surfaces overlap by 0.01, 0.5 of the largest displacement" in capsys.readouterr().out
    assert "would let the surfaces overlap" in (tmp_path / "out" / "summary.json").read_text()
    assert main(["run", str(path), "--soft-contact", "--output", str(tmp_path / "out")]) == 0
    assert "would let" not in capsys.readouterr().out


def test_a_converted_deck_keeps_its_law(tmp_path: Path) -> None:
    path = write(tmp_path, deck("TABULAR\n0., 0.\n5., 0.01\n20., 0.02"))
    assert main(["convert", str(path), str(tmp_path / "job.toml"), "--soft-contact", "--quiet"]) == 0
    (contact,) = load_job(tmp_path / "job.toml").model.contacts
    assert contact.law == abut.PressureOverclosure(((0.0, 0.0), (0.01, 5.0), (0.02, 20.0)))


def test_friction_goes_with_exact_contact(tmp_path: Path) -> None:
    path = write(tmp_path, deck("LINEAR\n1000.\n*FRICTION\n0.3"))
    with pytest.raises(abut.InputError, match="friction goes with exact contact"):
        load_job(path, soft=True)
    assert load_job(path, ignore=["FRICTION"], soft=True).model.contacts[0].friction == 0.0
    job = tmp_path / "job.toml"
    job.write_text("schema = 1\n")
    with pytest.raises(abut.InputError, match="--soft-contact is for decks"):
        load_job(job, soft=True)


POINTS = ((0.0, 0.0), (0.01, 5.0), (0.02, 20.0))


def test_the_law() -> None:
    law = abut.PressureOverclosure(POINTS)
    over = np.array([-0.01, 0.004, 0.015, 0.03])
    pressures = np.array([0.0, 2.0, 12.5, 35.0])
    assert [law.overclosure(p) for p in pressures[1:]] == pytest.approx(over[1:])
    met = law.evaluate(-over[:, None], pressures[:, None], None)
    assert np.abs(met.residual).max() < 1e-13
    assert met.closed.tolist() == [False, True, True, True]
    assert law_tangents(law, -over[:, None], np.array([[0.5], [1.0], [2.0], [3.0]])) < 1e-6
    for wrong in (
        [(0.0, 0.0)],
        [(0.0, 1.0), (1.0, 2.0)],
        [(0.0, 0.0), (0.0, 1.0)],
        [(0.0, 0.0), (1.0, math.inf)],
        "soft",
        3,
    ):
        with pytest.raises(abut.InputError, match="overclosure: expected"):
            abut.PressureOverclosure(wrong)


@pytest.mark.parametrize("linear", ["direct", "amg"])
def test_a_body_that_soft_contact_alone_holds(linear: str) -> None:
    """A block that rests on another one with a part of its round foot, with every solver: at the largest pressure p = k g,
    and the sum of the pressures is the load."""
    mesh = abut.mesh.make.join(
        {
            "low": abut.mesh.make.box([0, 2], [0, 2], [0, 1], cells=[6, 6, 3]),
            "high": abut.mesh.make.box([0, 1], [0, 1], [1, 2], cells=[4, 4, 3]),
        }
    )
    points = mesh.points.copy()
    bottom = mesh.nodes_of("high.bottom")
    points[bottom, 2] += 0.04 * points[bottom, 0] ** 2  # the far side stays open
    mesh = replace(mesh, points=points)
    steel = abut.LinearElastic(young=1000.0, poisson=0.3)
    sides = [abut.Support(f"high.{side}", **{axis: 0.0}) for side, axis in (("left", "x"), ("front", "y"))]
    law = abut.PressureOverclosure([(0.0, 0.0), (1.0, 200.0)])
    solution = abut.solve(
        abut.Model(
            mesh, [abut.Solid("low", steel), abut.Solid("high", steel)],
            [abut.Support("low.bottom", x=0, y=0, z=0), *sides], [abut.Pressure("high.top", 1.0)],
            [abut.Contact("high.bottom", "low.top", law=law)], solve=abut.SolveOptions(linear=linear),
        )
    )  # fmt: skip
    (contact,) = solution.contacts
    assert solution.converged
    assert contact.force[2] == pytest.approx(1.0, rel=1e-7)
    assert contact.area < 0.9
    assert contact.max_penetration == pytest.approx(contact.max_pressure / 200.0, rel=0.2)
