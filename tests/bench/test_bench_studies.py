"""The study of sides: its problems have the pressures that it compares with, and it tells the wrong side."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import abut
from abut.cells import CELLS
from abut.diagnosis.cures import cure, cures
from abut.mesh.make import box, join

sys.path.insert(0, str(Path(__file__).parents[2] / "bench" / "sides"))

import problems
import study


@pytest.mark.parametrize("cell", ["quad8", "tri6", "hex20"])
def test_a_linear_pressure_is_exact_in_cells_of_second_order(cell: str) -> None:
    """With either side, whatever the ratio of moduli and the sizes; abut takes the softer one."""
    row = study.run(problems.column((cell, cell), 1e3, (4, 6)), 0.04, both=True)
    assert max(row.errors) < 1e-8
    assert row.chosen == 1
    assert row.why.startswith("softer")


def test_the_wrong_side_is_told() -> None:
    """A stiff cylinder three times as fine as its soft block, on few facets: twice the pressure that is right, and said."""
    row = study.run(problems.line(("quad4", "quad4"), 1e3, (12, 4)), 0.04, both=True)
    assert (row.chosen, row.said, row.silent) == (1, True, False)
    assert row.errors[0] > 0.5 > 5.0 * row.errors[1]


def test_the_wrong_side_is_told_where_it_costs_little() -> None:
    """Half as fine again and ten times as stiff: off by more than the 4 % that the study allows, by too little for the line
    "sides" to fail; that of the error warns, and its cure is the other side. With that one nothing advises to swap."""
    case = problems.line(("tri3", "tri3"), 10.0, (12, 8))
    row = study.run(case, 0.04, both=True)
    assert row.errors[0] > 0.04 > row.errors[1]
    assert (row.chosen, row.said, row.silent) == (1, True, False)
    wrong, right = (abut.solve(case.forced(side)) for side in (0, 1))
    ways = {check.name: cure(check, wrong) for check in wrong.certificate if check.warns}
    assert ways["pressure error"].startswith("swap the sides (contactor = ")
    assert not any("swap" in cure(check, right) for check in right.certificate)


def test_no_side_of_two_alike_is_to_be_swapped() -> None:
    """Of one modulus and about as fine, on four facets over the half width: finer ones help, not the other side."""
    case = problems.line(("quad4", "quad4"), 1.0, (4, 5))
    solution = abut.solve(case.forced(0))
    (way,) = (cure(check, solution) for check in solution.certificate if check.name == "pressure error")
    assert way.startswith("refine both")


def test_a_finer_contactor_is_told() -> None:
    """Of alike bodies, too: off by more than the 4 % that the study allows, where the other side is not."""
    case = problems.line(("tri3", "tri3"), 1.0, (20, 8))
    wrong, right = (abut.solve(case.forced(side)) for side in (0, 1))
    assert case.error(wrong) > 0.04 > case.error(right)
    assert "sides" in {check.name for check in wrong.certificate if not check.passed}
    assert "sides" not in {check.name for check in right.certificate}


@pytest.mark.long
def test_a_little_finer_tetrahedra_are_told() -> None:
    """From 1.25 times as fine on; the same meshes of hexahedra do no harm."""
    cases = {cell: problems.ball((cell, cell), 1.0, (6, 8)) for cell in ("tet4", "hex8")}
    told = {}
    for cell, case in cases.items():
        wrong = abut.solve(case.forced(1))
        told[cell] = [check.passed for check in wrong.certificate if check.name == "sides"]
        if cell == "tet4":
            assert case.error(wrong) > 0.06 > case.error(abut.solve(case.forced(0)))
    assert told == {"tet4": [False], "hex8": []}


@pytest.mark.long
def test_much_softer_tetrahedra() -> None:
    """Under a stiff quarter ball, facets alike: either side has the pressure within half of what the study allows (9 %),
    and no line fails. With friction, where the forces that straight tetrahedra leave are not taken off (Z12), the middle,
    where two planes of symmetry meet, is off by more, and that is told; .01 of friction itself changes pressures by less."""
    case = problems.ball(("tet4", "hex8"), 1e-3, (8, 8))
    for side in (1, 0):
        solution = abut.solve(case.forced(side))
        assert case.error(solution) < 0.045
        assert all(check.passed for check in solution.certificate if check.name == "sides")
    model = case.forced(1)
    rough = abut.solve(replace(model, contacts=[replace(contact, friction=0.01) for contact in model.contacts]))
    assert case.error(rough) > 0.09
    (way,) = (way for check, way in cures(rough) if check.name == "sides")
    assert "swap" in way


@pytest.mark.long
def test_the_edge_of_a_punch_is_no_hollow() -> None:
    """Beside a sharp edge, where the pressure has no limit, it is hollow on planes of symmetry as elsewhere; the middle of a
    quarter punch on softer tetrahedra is as flat as theory has it."""
    block = box((0, 3), (0, 3), (-3, 0), (12, 12, 5), "tet4")
    parts = {"punch": box((0, 1), (0, 1), (0, 0.6), (4, 4, 2), "hex8"), "block": block}
    held = [abut.Support(f"{b}.{s}", **{axis: 0.0}) for b in parts for s, axis in (("left", "x"), ("front", "y"))]
    solids = [abut.Solid(b, abut.LinearElastic(young, 0.3)) for b, young in zip(parts, (1e6, 1e3))]
    contact = abut.Contact(contactor="punch.bottom", target="block.top")
    load = [abut.Force("punch.top", (0.0, 0.0, -1.0))]
    model = abut.Model(join(parts), solids, [*held, abut.Support("block.bottom", z=0.0)], load, [contact])
    (line,) = (check for check in abut.solve(model).certificate if check.name == "sides")
    assert line.passed


def test_every_facet_type_is_in_the_study() -> None:
    """On both sides alike, and all problems of a part can be built."""
    cells = {cell for part in study.PARTS.values() for pair in part.cells for cell in pair}
    assert cells == {name for name, cell in CELLS.items() if cell.facets and name not in ("pyramid5",)}
    for part in study.PARTS.values():
        case = next(part.cases())
        assert isinstance(case, problems.Case)
        assert min(case.sizes) >= 8


def test_the_summary() -> None:
    """Of the chosen side, the better and the worse one; nothing of what was not solved."""
    case = problems.column(("quad4", "quad4"), 1.0, (10, 10))
    rows = [
        study.Row(case, (0.01, 0.2), 0, "", True, 0.04), study.Row(case, (0.03, 0.5), 1, "", False, 0.04),
        study.Row(case, (math.nan, 0.02), 1, "", False, 0.04),
    ]  # fmt: skip
    ((part, cells, count, taken, limit, *_, wrong),) = study.summary("column", rows)
    assert (part, cells, count, taken, limit, wrong) == ("column", "quad4", "3", "50.0", "4.0", "1 of 1")
    assert [row.silent for row in rows] == [False, False, False]
    assert isinstance(case.model(), abut.Model)
