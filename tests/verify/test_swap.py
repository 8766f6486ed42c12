"""The second opinion (`abut verify JOB --swap`), and the certificate's line "sides"."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

import abut
from abut.cli import main
from abut.diagnosis.cures import cure
from abut.errors import InputError
from abut.verify.swap import swap, swapped
from models.pressure import line

EXAMPLES = Path(__file__).parents[2] / "examples"


def unlike(contactor: str, ratio: float = 10.0) -> abut.Model:
    """A cylinder twice as fine as the block it is pressed on, ``ratio`` times as stiff."""
    model = line("quad4", 16, contactor)
    coarse = line("quad4", 8, contactor).mesh
    fine = model.mesh
    mesh = abut.mesh.make.join({"cylinder": _body(fine, "cylinder"), "block": _body(coarse, "block")})
    solids = [
        abut.Solid("cylinder", abut.LinearElastic(70e3 * ratio, 0.3)),
        abut.Solid("block", abut.LinearElastic(70e3, 0.3)),
    ]
    return replace(model, mesh=mesh, solids=solids)


def _body(mesh: abut.Mesh, body: str) -> abut.Mesh:
    from abut.mesh.make import half_disc, rectangle

    n = 16 if body == "cylinder" else 8
    if body == "cylinder":
        return half_disc(50.0, (0.0, 50.0), fine=8.0, cells=n, cell="quad4")
    return rectangle((-100, 100), (-200, 0), (2 * n, n), "quad4", {"x": [-8, 8], "y": [-8, 0]})


def line_of(solution: abut.Solution) -> list[abut.solution.Check]:
    return [check for check in solution.certificate if check.name == "sides"]


def test_the_wrong_side_fails_and_swapping_mends_it() -> None:
    """The study's case: off by 38 % (16 facets on 8, moduli 10 to 1), the line says what to do; that way it is gone."""
    wrong = abut.solve(unlike("cylinder"))
    (check,) = line_of(wrong)
    assert not check.passed
    assert "2 times finer than its target and 10 times stiffer" in check.meaning
    assert 'swap the sides (contactor = "block.top", target = "cylinder.round")' in cure(check, wrong)
    assert "give surfaces = [...]" in cure(check, wrong)
    right = abut.solve(unlike("block"))
    assert line_of(right) == []
    (contact,) = unlike("cylinder").contacts
    free = abut.Contact(contact.contactor, contact.target)
    assert replace(wrong.model, contacts=[free]).contacts[0].contactor == "block.top"


@pytest.mark.parametrize("ratio", [1.0])
def test_a_finer_contactor_that_does_no_harm_passes(ratio: float) -> None:
    """Uniform pressure is exact from either side."""
    model = abut.benchmarks.BENCHMARKS["contrast-patch-stiff-fine"].model(0)
    (check,) = line_of(abut.solve(model))
    assert check.passed
    assert check.value < 1e-6


def test_both_agree_where_both_are_right() -> None:
    found = swap(line("quad4", 16))
    (each,) = found.comparisons
    assert found.passed
    assert each.contactors == ("'block.top'", "'cylinder.round'")
    assert each.of_force < 1e-6  # the load is given
    assert each.force[0] == pytest.approx(each.force[1], abs=1e-6 * abs(each.force[0]).max())
    assert each.local < 0.04
    (chart,) = found.charts
    assert set(chart.series) == {"as it is", "sides swapped"}


def test_they_differ_where_one_is_wrong() -> None:
    (each,) = swap(unlike("block")).comparisons
    assert not each.passed
    assert each.local > 0.2


def test_what_cannot_be_swapped() -> None:
    """A rigid side; a body on itself. Nothing left is an error that says why."""
    model = line("quad4", 8)
    rigid = replace(
        model, solids=model.solids[1:], supports=model.supports[:1], loads=[],
        rigid=[abut.Rigid("cylinder", x=0, y=-0.1, rz=0)],
    )  # fmt: skip
    with pytest.raises(InputError, match=r"'cylinder\.round' is rigid or held"):
        swapped(rigid)
    with pytest.raises(InputError, match="it has no contact"):
        swapped(replace(model, contacts=[]))


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = EXAMPLES / "hertz-line" / "quad4.toml"
    assert main(["verify", str(job), "--swap", "--output", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert "as it is" in out
    assert "both agree" in out
    report = (tmp_path / "report.html").read_text()
    assert "<h2>Sides swapped</h2>" in report
    data = json.loads(re.search(r'id="data">(.*?)</script>', report, re.S).group(1))  # type: ignore[union-attr]
    assert [len(chart["series"]) for chart in data["beside"]] == [2]
    assert main(["verify", str(EXAMPLES / "two-blocks" / "job.toml"), "--swap", "--output", str(tmp_path)]) == 1
    assert "the two differ at 'blocks'" in capsys.readouterr().out  # sharp edges of a block on six facets


@pytest.mark.long
def test_json_decks_and_mistakes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    deck = EXAMPLES / "deck" / "pad.inp"
    main(["verify", str(deck), "--swap", "--json", "--output", str(tmp_path)])
    (contact,) = json.loads(capsys.readouterr().out)["contacts"]
    assert contact["force_difference"] < 0.02
    assert main(["verify", "--swap"]) == 2
    assert "abut verify job.toml --swap" in capsys.readouterr().err
    assert main(["verify", str(EXAMPLES / "two-blocks" / "job.toml")]) == 0  # a path alone: the patch test
    assert "plane interface" in capsys.readouterr().out
